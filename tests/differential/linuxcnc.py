"""LinuxCNC's own interpreter, run on one program after the other.

`rs274` of Debian's package `linuxcnc-uspace` is started once for each program, which
costs it 15 ms; everything around it (a private copy of the executable, ini
file, tool table) is made once. What it prints is brought into the form of the
conformance corpus by the corpus' own `oracle.py`.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

CORPUS = Path(__file__).parent.parent / "data" / "conformance" / "rs274"
PACKAGE = "linuxcnc-uspace"
_APT = Path("/etc/apt")
_PATIENCE = 30.0  # [s] for one program
_MOST_OUTPUT = 20_000_000  # bytes; a program that prints more has no end


@cache
def oracle() -> ModuleType:
    """The corpus' `oracle.py`."""
    spec = importlib.util.spec_from_file_location("conformance_oracle", CORPUS / "oracle.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def install() -> str:
    """Empty when `rs274` is there, else why it is not. Installs the package where that is possible."""
    if shutil.which("rs274"):
        return ""
    if os.name != "posix" or os.geteuid() != 0 or not shutil.which("apt-get"):
        return f"the program rs274 is missing: install the Debian package {PACKAGE}"
    for command in (["apt-get", "update", "-qq"], ["apt-get", "install", "-y", "-qq", PACKAGE]):
        done = subprocess.run(command, capture_output=True, env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"})
        if done.returncode:
            return f"{' '.join(command)} failed: {done.stderr.decode(errors='replace').strip()[-300:]}"
    return "" if shutil.which("rs274") else f"the package {PACKAGE} brings no rs274"


def source(folder: Path) -> Path | None:
    """The source package unpacked below `folder`, which brings the interpreter's own tests; None where apt has none.

    apt's own list of sources stays as it is: a copy of it that asks for sources is used.
    """
    lists = folder / "lists"
    (lists / "partial").mkdir(parents=True)
    wanted = folder / "wanted.list"
    wanted.write_text(
        "".join(_sources_of(path) for path in [_APT / "sources.list", *(_APT / "sources.list.d").glob("*")])
    )
    options = [
        "-o",
        f"Dir::Etc::sourcelist={wanted}",
        "-o",
        "Dir::Etc::sourceparts=-",
        "-o",
        f"Dir::State::lists={lists}",
    ]
    for command in (["update", "-qq"], ["source", "--download-only", "-qq", PACKAGE]):
        if subprocess.run(["apt-get", *options, *command], cwd=folder, capture_output=True).returncode:
            return None
    archive = next(folder.glob("linuxcnc_*.orig.tar.*"), None)
    if archive is None or subprocess.run(["tar", "-xf", archive], cwd=folder, capture_output=True).returncode:
        return None
    return next((path for path in sorted(folder.iterdir()) if (path / "tests" / "interp").is_dir()), None)


def _sources_of(path: Path) -> str:
    """The entries of a list of sources, in either of apt's forms, as lines that ask for sources."""
    if not path.is_file():
        return ""
    text = path.read_text()
    if path.suffix != ".sources":
        return re.sub(r"^deb (.*)$", r"deb-src \1", "\n".join(re.findall(r"^deb .*$", text, re.M)), flags=re.M) + "\n"
    out = []
    for entry in re.split(r"\n\s*\n", text):
        fields = dict(re.findall(r"^([A-Za-z-]+):[ \t]*(.*)$", entry, re.M))
        signed = f"[signed-by={fields['Signed-By']}] " if "Signed-By" in fields else ""
        for address in fields.get("URIs", "").split():
            for suite in fields.get("Suites", "").split():
                out.append(f"deb-src {signed}{address} {suite} {fields.get('Components', '')}\n")
    return "".join(out)


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What the interpreter made of a program: `status` is ok, error, endless or crash; `text` the guilty line."""

    status: str
    message: str = ""
    text: str = ""
    events: list[dict[str, Any]] = field(default_factory=list)
    parameters: dict[str, float] = field(default_factory=dict)
    complaint: str = ""


class Interpreter:
    """A folder of its own in which programs are run; use it as a context."""

    def __init__(self, *, tools: Path = CORPUS / "tools.tbl", subroutines: Path = CORPUS / "subs") -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="rs274-")
        self.folder = Path(self._folder.name)
        self.set_tools(tools)
        self.program = self.folder / "program.ngc"
        self.executable = oracle().private_copy(oracle().find_rs274(), str(self.folder), "mm")
        self.set_folders(self.folder, subroutines)

    def set_tools(self, table: Path) -> None:
        """The tool table."""
        self.tools = oracle().read_tool_table(str(table))
        shutil.copy(table, self.folder / "tool.tbl")

    def set_folders(self, prefix: Path, subroutines: Path | str) -> None:
        """Where O-word subroutines in files of their own are looked for; several folders joined by colons."""
        text = f"[DISPLAY]\nPROGRAM_PREFIX = {prefix}\n[RS274NGC]\nHAL_PIN_VARS = 0\nSUBROUTINE_PATH = {subroutines}\n"
        (self.folder / "run.ini").write_text(text + "[TRAJ]\nLINEAR_UNITS = mm\n")

    def __enter__(self) -> Interpreter:
        return self

    def __exit__(self, *_: object) -> None:
        self._folder.cleanup()

    def run(self, program: bytes, *, block_delete: bool = False, parameters: str = "") -> Verdict:
        """Interpret `program`; spline points come from a second, slower way in."""
        self.program.write_bytes(program)
        variables = self.folder / "run.var"
        variables.write_text(parameters)
        command = [self.executable, "-g", "-t", "tool.tbl", "-v", "run.var", "-i", "run.ini"]
        command += ["-b"] * block_delete + [str(self.program)]
        environment = {"PATH": os.environ["PATH"], "HOME": str(self.folder), "LC_ALL": "C"}
        with (self.folder / "out").open("w+b") as out, (self.folder / "err").open("w+b") as err:
            try:
                code = subprocess.run(
                    command,
                    cwd=self.folder,
                    env=environment,
                    stdin=subprocess.DEVNULL,
                    stdout=out,
                    stderr=err,
                    timeout=_PATIENCE,
                ).returncode
            except subprocess.TimeoutExpired:
                return Verdict(status="endless")
            if out.tell() > _MOST_OUTPUT or err.tell() > _MOST_OUTPUT:
                return Verdict(status="endless")
            out.seek(0)
            err.seek(0)
            printed, said = out.read().decode("latin-1"), err.read().decode("latin-1")
        error, rest = oracle().read_error(code, said)
        if error and (not error["text"] or error["text"].startswith("num_spindles")):  # a message of two lines
            error["text"] = next((line for line in rest if line), "")
        if code < 0:
            return Verdict(status="crash", message=f"signal {-code}")
        try:
            world = oracle().normalize(printed, self.tools)
        except (ValueError, OverflowError) as problem:  # it printed nan or inf
            return Verdict(status="crash", message=f"no number: {problem}")
        complaint = ""
        if error is None and "NURBS" in printed:
            complaint = self._spline_points(world, parameters, block_delete)
        return Verdict(
            status="error" if error else "ok",
            message=error["message"] if error else "",
            text=(error["text"] or "") if error else "",
            events=world.events,
            parameters=oracle().read_parameters(str(variables)),
            complaint=complaint,
        )

    def _spline_points(self, world: Any, parameters: str, block_delete: bool) -> str:
        (self.folder / "preview.var").write_text(parameters)
        arguments = argparse.Namespace(
            machine_units="mm", block_delete=block_delete, timeout=_PATIENCE, stock=False, program=str(self.program)
        )
        seen = oracle().run_preview(
            arguments,
            str(self.folder),
            str(self.program),
            str(self.folder / "tool.tbl"),
            str(self.folder / "preview.var"),
            str(self.folder / "run.ini"),
        )
        if seen is None:
            return "no Python with the gcode module"
        return oracle().merge_preview(world, seen) or ""
