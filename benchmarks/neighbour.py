"""pybullet_industrial 1.0.4 on its own terms: lines of G-code a second, as the reference job's yardstick.

    python -m benchmarks.neighbour [LINES]

Installed into a virtual environment of its own that is thrown away; when it cannot be had, the reason is printed.
Its GCodeProcessor drives a robot with a tool on simple lines; gcodesim's own rate stands beside it, for the whole
pipeline.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import venv
from pathlib import Path

from gcodesim.kinematics import MODELS

PACKAGE = "pybullet_industrial==1.0.4"

SCRIPT = """
import sys, time
import numpy as np
import pybullet as p
import pybullet_industrial as pi

urdf, program = sys.argv[1:]
p.connect(p.DIRECT)
robot = pi.RobotBase(urdf, [0, 0, 0], [0, 0, 0, 1])
lines = open(program).read()
processor = pi.GCodeProcessor(lines, robot)
begin = time.process_time()
count = 0
for line in processor:
    count += 1
print(len(lines.splitlines()) / (time.process_time() - begin))
"""


def rate(lines: int) -> float | str:
    """Lines a second, or why there are none."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        venv.create(folder / "venv", with_pip=True)
        python = str(folder / "venv" / "bin" / "python")
        install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", PACKAGE]
        done = subprocess.run(install, check=False, capture_output=True, text=True)
        if done.returncode:
            return (done.stderr.strip().splitlines() or ["pip failed"])[-1]
        program = folder / "lines.nc"
        program.write_text("\n".join(f"G1 X{0.6 + 0.0005 * i:.4f} Y0.0 Z0.6 A0 B0 C0" for i in range(lines)) + "\n")
        (folder / "lines.py").write_text(SCRIPT)
        done = subprocess.run(
            [python, str(folder / "lines.py"), str(MODELS["kuka_kr10_r1100_2"].path), str(program)],
            check=False,
            capture_output=True,
            text=True,
        )
        if done.returncode:
            return (done.stderr.strip().splitlines() or ["no word"])[-1]
        return float(done.stdout.split()[-1])


def main(lines: int = 200) -> None:
    found = rate(lines)
    if isinstance(found, str):
        print(f"{PACKAGE} left out: {found}")
    else:
        print(f"{PACKAGE}, GCodeProcessor: {found:.0f} lines/s")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
