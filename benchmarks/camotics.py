"""Whole runs of projects of CAMotics at their own resolution, beside `camsim` where that is on the PATH.

    python -m benchmarks.camotics FOLDER [CELL_MM [NAME...]]

FOLDER is the folder `examples` of a checkout of CAMotics, or any with projects in folders below it. A project that
names a script (`.tpl`) takes the program of that name beside it, if there is one. CELL_MM is a resolution for all of
them, NAME those that are wanted. Times are processor time of whole processes, of ours at default settings with forces
and the log, and of `--only shape`; camsim runs in one thread. Cells are written by `init --from`. What is left of their
stock stands beside the volume of camsim's surface, which is of another stock where a project leaves its size to the
program. Byte code is kept, as Python does unless it is told not to.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.fine import spent
from benchmarks.reference import run

PROGRAMS = (".nc", ".ngc", ".gcode", ".gc", ".tap")
SHARE = 0.1
"""Of camsim's time that the shape alone may take."""


def projects(folder: Path) -> list[tuple[Path, Path]]:
    """Projects with their one program; others are named and left out."""
    found = []
    for project in sorted(folder.glob("*/*.camotics")):
        files = [project.parent / name for name in json.loads(project.read_text()).get("files", [])]
        programs = [
            next((path for ending in PROGRAMS if (path := file.with_suffix(ending)).exists()), file) for file in files
        ]
        if len(programs) == 1 and programs[0].suffix in PROGRAMS and programs[0].exists():
            found.append((project, programs[0]))
        else:
            print(f"{project.stem:20} left out: {', '.join(file.name for file in files) or 'no file'}")
    return found


def camsim(project: Path, program: Path, cell: float, folder: Path) -> tuple[float, float, float] | None:
    """Processor time [s], memory [MB] and volume [mm³] of camsim; None where it is not installed."""
    command = shutil.which("camsim")
    if command is None:
        return None
    content = {**json.loads(project.read_text()), "files": [str(program)]}
    own = folder / project.name
    own.write_text(json.dumps(content))
    surface = folder / "camsim.stl"
    _, seconds, memory = spent([command, "--threads", "1", "--resolution", f"{cell:g}", str(own), str(surface)])
    return seconds, memory, volume(surface)


def volume(surface: Path) -> float:
    """Volume within the triangles of a binary STL file, in its unit."""
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    a, b, c = np.fromfile(surface, kind, offset=84)["corners"].astype(float).swapaxes(0, 1)
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def compare(project: Path, program: Path, cell: float | None, folder: Path) -> None:
    """Print the line of one project."""
    copied = folder / program.name
    shutil.copyfile(program, copied)
    own = folder / project.name
    own.write_text(json.dumps({**json.loads(project.read_text()), "files": [copied.name]}))
    run(["gcodesim", "init", str(folder / "cell"), "--from", str(own)])
    place = folder / "cell" / "cell.yaml"
    if cell is not None:
        place.write_text(re.sub(r"resolution: [^,}\n]*", f"resolution: {cell:g} mm", place.read_text()))
    order = ["gcodesim", "run", str(copied), "--cell", str(place), "--world", "kinematic", "--fail-on", "never"]
    ours = spent([sys.executable, "-m", *order, "--out", str(folder / "out")])
    shape = spent([sys.executable, "-m", *order, "--out", str(folder / "shape"), "--only", "shape"])[1]
    results = json.loads((folder / "out" / "results.json").read_text())
    stocks = results["stocks"].values()
    size = max((stock["resolution_mm"] for stock in stocks), default=None)  # as it fits into the stock
    if size is None:
        print(f"{project.stem:20} left out: its cell has no stock")
        return
    theirs = camsim(project, copied, size, folder)
    line = f"{project.stem:20} {size:6.3f} mm {results['time']['total_s']:9.0f} s of machine time"
    line += f"{ours[1]:8.2f} s {ours[2]:6.0f} MB, --only shape {shape:6.2f} s"
    if theirs is not None:
        seconds, memory, left = theirs
        line += f", camsim {seconds:6.2f} s {memory:6.0f} MB: {ours[1] / seconds:5.2f} x and {shape / seconds:5.3f} x"
        rest, bound = (sum(stock[key] for stock in stocks) for key in ("remaining_mm3", "error_bound_mm3"))
        line += f"; {rest:.0f} within {bound:.0f} mm3, camsim {left:.0f}"
    print(line, flush=True)


def main(folder: Path | None = None, cell: float | None = None, names: tuple[str, ...] = ()) -> None:
    if folder is None:
        print("FOLDER with projects of CAMotics is not given")
        return
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    run(["gcodesim", "warm-up"])  # so that no compiling is timed
    print(f"goals: below camsim; --only shape below {SHARE:g} of it")
    for project, program in projects(folder):
        if not names or project.stem in names:
            with tempfile.TemporaryDirectory() as scratch:
                compare(project, program, cell, Path(scratch))


if __name__ == "__main__":
    given = sys.argv[1:]
    main(Path(given[0]) if given else None, float(given[1]) if len(given) > 1 else None, tuple(given[2:]))
