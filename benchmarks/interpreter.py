"""`gcodesim lint` as a whole process beside LinuxCNC's own interpreter, `rs274 -g`, on the same files.

    python -m benchmarks.interpreter [PROGRAM [LINES]]

LINES are rounds of the loop where PROGRAM is `calls` or `macros`. Each is started in turn, best of some runs by user
processor time, output discarded. The interpreter is Debian's package `linuxcnc-uspace`; where it is missing only our
own times are printed. What it prints with -g are canonical calls; `lint` prints findings, but computes the same events
and looks at each of them.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Final

from benchmarks import cam

RUNS: Final = 3
_PLAIN = ("raster", "arcs", "five axes", "compensation")
JOBS: Final = (
    *((name, lines) for lines in (20_000, 200_000, 1_000_000) for name in _PLAIN),
    ("drilling", 200_000),
    ("calls", 20_000),
    ("macros", 20_000),
)
_TOOLS = "T1 P1 Z2.0 D0.25 ; a mill\n"  # inch, as a machine without an ini file has it
_INI = "[EMCIO]\nTOOL_TABLE = tool.tbl\n[TRAJ]\nAXES = 6\nCOORDINATES = XYZABC\n"


def user_seconds(command: list[str], folder: Path) -> float:
    """User time [s] of a process."""
    environment = {**os.environ, "LC_ALL": "C"}
    process = subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):
        raise RuntimeError(f"{command[0]} ended with {process.returncode}")
    return usage.ru_utime


def compare(name: str, lines: int, folder: Path) -> None:
    """One line: both times, and how many times faster we are."""
    program = folder / "program.ngc"
    program.write_bytes(cam.text(cam.PROGRAMS[name](lines)))
    ours = [sys.executable, "-m", "gcodesim", "lint", "--max-blocks", str(10**9), str(program)]
    theirs = ["rs274", "-g", "-t", "tool.tbl", "-v", "parameters.var", "-i", "machine.ini", str(program)]
    has_yardstick = shutil.which("rs274") is not None
    best, yardstick = float("inf"), float("inf")
    for _ in range(RUNS):
        best = min(best, user_seconds(ours, folder))
        if has_yardstick:
            (folder / "parameters.var").write_text("")
            yardstick = min(yardstick, user_seconds(theirs, folder))
    beside = f"rs274 -g {yardstick:7.2f} s   {yardstick / best:6.2f} x" if has_yardstick else "rs274 is not installed"
    print(f"{name:14} {lines:9,}   lint {best:7.2f} s   {beside}", flush=True)


def main(program: str | None = None, lines: int | None = None) -> None:
    """All jobs, those of one program, or that program at another size."""
    jobs = [job for job in JOBS if program in (None, job[0])]
    if program is not None and lines is not None:
        jobs = [(program, lines)]
    with tempfile.TemporaryDirectory(prefix="interpreter-") as name:
        folder = Path(name)
        (folder / "tool.tbl").write_text(_TOOLS)
        (folder / "machine.ini").write_text(_INI)
        environment = os.environ.get("PYTHONPATH", "")
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (os.getcwd(), environment)))
        warm = folder / "warm.ngc"
        warm.write_bytes(cam.text(cam.raster(150_000)))
        user_seconds(
            [sys.executable, "-m", "gcodesim", "lint", str(warm)], folder
        )  # machine code is made once for a version
        for job in jobs:
            compare(*job, folder)


def _lines(text: str) -> int:
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"LINES must be a whole number above 0, not {text}")
    return int(text)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m benchmarks.interpreter", description=__doc__.partition("\n")[0])
    parser.add_argument("program", nargs="?", choices=list(cam.PROGRAMS), help="which program; all of them when none")
    parser.add_argument("lines", nargs="?", type=_lines, help="how long it is; the sizes of the table when not given")
    main(**vars(parser.parse_args()))
