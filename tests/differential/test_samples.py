"""LinuxCNC's own sample programs, as Debian's package installs them: what its interpreter reads means the same here.

The tests of its interpreter are in its source package only; those in a folder that the variable
LINUXCNC_TESTS names are run as well.
"""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from agreement import differences, settings
from explained import explanation
from linuxcnc import Interpreter

pytestmark = pytest.mark.slow

_FOLDERS = [Path("/usr/share/linuxcnc"), Path("/usr/share/doc/linuxcnc")]
_PROGRAMS = (".ngc", ".nc", ".tap")
# programs that go on for minutes, or need what is no part of an interpreter
_LEFT_OUT = {
    "smartprobe.ngc": "probes 85 s long",
    "systems.ngc": "three minutes of splines",
}


def _programs() -> list[Path]:
    more = [Path(os.environ["LINUXCNC_TESTS"]).resolve()] if "LINUXCNC_TESTS" in os.environ else []
    found = [path for folder in [*_FOLDERS, *more] for path in sorted(folder.rglob("*")) if path.suffix in _PROGRAMS]
    return [path for path in found if path.is_file() and path.name not in _LEFT_OUT]


def test_sample_programs_agree(interpreter: Interpreter) -> None:
    assert len(_programs()) >= 180
    unexplained = []
    accepted = 0
    for path in _programs():
        program = path.read_bytes()
        interpreter.set_folders(path.parent, path.parent)
        verdict = interpreter.run(program)
        accepted += verdict.status == "ok"
        ours = replace(settings(), subroutines=(path.parent,), max_blocks=3_000_000)
        found = differences(program, verdict, ours)
        if found and not explanation(program, verdict, found[0]):
            unexplained.append(f"{path}: {found[0]}")
    assert accepted >= 100
    assert not unexplained, "\n\n".join(unexplained)
