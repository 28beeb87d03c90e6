"""A test suite of many small programs: first run, and again with nothing changed.

    python -m benchmarks.suite [PROGRAMS]

Three of four programs run on a machine tool in the kinematic world, one of eight on an arm, one of eight in the bullet
world. The yardstick is the same programs simulated one after the other in one process, without comparing anything.
Wall time is with two workers.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CELLS = {
    "mill.yaml": "gcodesim: 1\nmachine: gantry_xyz\n"
    "stock: {box: [60, 40, 10], zero: top-front-left, material: al6082_t6, resolution: 0.5}\n"
    "tools: {1: {type: flat_end_mill, diameter: 6}, 2: {type: drill, diameter: 5}}\nsimulation: {world: kinematic}\n",
    "arm.yaml": "gcodesim: 1\nrobots: {arm: {model: kuka_kr10_r1100_2}}\n"
    "work_offsets: {G54: {in: world, xyz: [600, 0, 300]}}\n"
    "stock: {box: [60, 40, 10], in: G54, zero: top-front-left, material: al6082_t6, resolution: 0.5}\n"
    "tools: {1: {type: flat_end_mill, diameter: 6, length: 40}, 2: {type: drill, diameter: 5}}\n"
    "simulation: {world: kinematic}\n",
}
CELLS["bullet.yaml"] = CELLS["mill.yaml"].replace("kinematic", "bullet")
SIMULATE = """
import sys
from pathlib import Path
import gcodesim
for path in sorted(Path().glob("*.nc")):
    cell = path.with_suffix(".test.yaml").read_text().split()[1]
    gcodesim.simulate(path, cell)
"""


def program(number: int) -> str:
    """A contour and two holes, each program with sizes of its own: about 30 blocks, half a minute of machine time."""
    x, y, depth = 8 + number % 7, 8 + number % 5, 0.5 + (number % 9) * 0.1
    lines = ["G21 G90 G17 G94", "T1 M6", "G43 H1", "S9000 M3", f"G0 X{x} Y{y}", "G0 Z2"]
    for level in (1, 2):
        lines += [f"G1 Z{-level * depth:.2f} F300", f"G1 X{x + 30} F{700 + number}", f"G3 X{x + 35} Y{y + 5} I0 J5"]
        lines += [f"G1 Y{y + 20}", f"G1 X{x}", f"G1 Y{y}"]
    lines += ["G0 Z20", "M5", "T2 M6", "G43 H2", "S4000 M3", f"G0 X{x + 15} Y{y + 10}", "G0 Z2"]
    lines += ["G81 Z-4 R1 F150", f"X{x + 25}", "G80", "G0 Z20", "M5", "M2"]
    return "\n".join(lines) + "\n"


def main(count: int = 200) -> None:
    with tempfile.TemporaryDirectory() as folder:
        for name, text in CELLS.items():
            (Path(folder) / name).write_text(text)
        for number in range(count):
            cell = {3: "arm.yaml", 7: "bullet.yaml"}.get(number % 8, "mill.yaml")
            (Path(folder) / f"p{number:03}.nc").write_text(program(number))
            (Path(folder) / f"p{number:03}.test.yaml").write_text(f"cell: {cell}\n")
        command = [sys.executable, "-m", "gcodesim"]
        measured([*command, "warm-up"], folder)
        wall, bare = measured([sys.executable, "-c", SIMULATE], folder)
        print(f"{count} programs simulated, one process    {wall:6.1f} s wall {bare:6.1f} s processor")
        for what, arguments in {
            "accept": ("accept", "-j", "2"),
            "test": ("test", "-j", "2"),
            "test --changed, nothing changed": ("test", "-j", "2", "--changed"),
        }.items():
            wall, processor = measured([*command, *arguments], folder)
            print(
                f"{what:<38} {wall:6.1f} s wall {processor:6.1f} s processor, {processor / bare:.2f} x simulating alone"
            )


def measured(command: list[str], folder: str) -> tuple[float, float]:
    """Seconds of wall and of processor that a command takes with all its processes."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    environment = {**os.environ, "GCODESIM_TEST_CACHE": str(Path(folder) / "memory")}
    subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - begin, spent


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
