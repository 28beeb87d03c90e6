"""LinuxCNC's own sample programs and the tests of its interpreter: what it reads means the same here.

The samples come with Debian's package, the tests with its source package, which is fetched where apt knows one; a
folder in the variable LINUXCNC_TESTS takes its place. What a test says of its tool table counts here, too.
"""

from __future__ import annotations

import os
import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from agreement import compared, settings
from explained import explanation
from linuxcnc import CORPUS, Interpreter, source

from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import ToolTable

pytestmark = pytest.mark.slow

_FOLDERS = [Path("/usr/share/linuxcnc"), Path("/usr/share/doc/linuxcnc")]
_PROGRAMS = (".ngc", ".nc", ".tap")
# programs that go on for minutes, or need what is no part of an interpreter
_LEFT_OUT = {
    "smartprobe.ngc": "probes 85 s long",
    "systems.ngc": "three minutes of splines",
    "g71-endless-loop.ngc": "a cycle of lathes, and LinuxCNC does not end",
}
_OF_PYTHON = re.compile(rb"_py_|\(py[,a-z]|^\s*;py,", re.IGNORECASE | re.MULTILINE)


def _below(folder: Path) -> list[Path]:
    found = [path for path in sorted(folder.rglob("*")) if path.suffix in _PROGRAMS and path.is_file()]
    return [path for path in found if path.name not in _LEFT_OUT]


def _own_table(program: Path) -> Path:
    """The tool table that the test beside `program` names, else that of the corpus."""
    test = program.parent / "test.sh"
    named = re.search(r"-t\s+(\S+)", test.read_text(errors="replace")) if test.is_file() else None
    table = program.parent / named[1] if named else CORPUS / "tools.tbl"
    return table if table.is_file() else CORPUS / "tools.tbl"


def _disagreements(paths: list[Path], interpreter: Interpreter) -> tuple[int, list[str]]:
    """How many of the programs LinuxCNC accepts, and the differences that nothing explains."""
    accepted, unexplained = 0, []
    for path in paths:
        program, table = path.read_bytes(), _own_table(path)
        if _OF_PYTHON.search(program):  # calls what the test's own INI file remaps
            continue
        interpreter.set_folders(path.parent, path.parent)
        interpreter.set_tools(table)
        verdict = interpreter.run(program)
        accepted += verdict.status == "ok"
        tools, _ = ToolTable.read(SourceText.read(table))
        ours = replace(settings(), tool_table=tools, subroutines=(path.parent,), max_blocks=3_000_000)
        found = compared(program, verdict, ours)
        if found.differences and not explanation(program, verdict, found):
            unexplained.append(f"{path}: {found.differences[0]}")
    return accepted, unexplained


def test_sample_programs_agree(interpreter: Interpreter) -> None:
    paths = [path for folder in _FOLDERS for path in _below(folder)]
    assert len(paths) >= 180
    accepted, unexplained = _disagreements(paths, interpreter)

    assert accepted >= 100
    assert not unexplained, "\n\n".join(unexplained)


def test_programs_of_its_tests_agree(interpreter: Interpreter, tmp_path: Path) -> None:
    root = Path(os.environ["LINUXCNC_TESTS"]) if "LINUXCNC_TESTS" in os.environ else source(tmp_path)
    if root is None:
        pytest.skip("apt knows no source package; name a folder with LinuxCNC's tests in LINUXCNC_TESTS")
    paths = _below(root / "tests" if (root / "tests").is_dir() else root)
    assert len(paths) >= 300
    accepted, unexplained = _disagreements(paths, interpreter)

    assert accepted >= 200
    assert not unexplained, "\n\n".join(unexplained)
