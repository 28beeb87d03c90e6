"""A block of 100 x 100 x 50 mm in cells of 0.1 mm, and 10 m of a ball end mill over it, as a whole process.

python -m benchmarks.fine [RESOLUTION_MM]
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.reference import run
from benchmarks.surface import HEIGHT, SIZE, raster
from gcodesim.units import MM

GOAL_MB = 1000.0
CELL = """gcodesim: 1
machine: gantry_xyz
stock: {{box: [{size}, {size}, {height}], zero: top-front-left, material: al6082_t6, resolution: {cell}}}
tools: {{1: {{type: ball_end_mill, diameter: 6, flutes: 2, length: 60}}}}
"""


def spent(command: list[str]) -> tuple[float, float, float]:
    """Wall and processor time [s] of a process, and the most memory that it had [MB]."""
    begin = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}")
    return time.perf_counter() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024.0


def main(cell: float = 0.1) -> None:
    tips = raster() / MM
    lines = ["G21 G90 G17 G94 G64 P0.005", "T1 M6", "G43 H1", "S18000 M3", "G0 X-5 Y0 Z5", "G1 Z0 F2000"]
    lines += [f"G1 X{x:.3f} Y{y:.3f} Z{z:.4f}" for x, y, z in tips.tolist()] + ["G0 Z5", "M5", "M2"]
    run(["gcodesim", "warm-up"])  # so that no compiling is timed
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "raster.nc").write_text("\n".join(lines) + "\n")
        (folder / "cell.yaml").write_text(CELL.format(size=SIZE, height=HEIGHT, cell=cell))
        given = [
            sys.executable,
            "-m",
            "gcodesim",
            "run",
            str(folder / "raster.nc"),
            "--cell",
            str(folder / "cell.yaml"),
        ]
        given += ["--world", "kinematic", "--out", str(folder / "out")]
        for what, more in {"with forces and log": [], "--only shape": ["--only", "shape"]}.items():
            wall, processor, memory = spent([*given, *more])
            print(f"{what:20} {wall:6.1f} s wall {processor:6.1f} s processor {memory:6.0f} MB, goal {GOAL_MB:.0f} MB")


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
