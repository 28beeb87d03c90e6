"""What collision checks of an arm in a furnished cell cost, beside the removal of the same program.

    python -m benchmarks.collisions [BLOCKS]

The reference job on the KR 10, with a bench, posts, shelves, pipes and clamps around it. A stopwatch stands on the
checks before the run and on those within it (`stages`), and shows what processor time they take of a whole run.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

from benchmarks import job
from benchmarks.reference import run

CHECKS, REMOVAL = "collision checks", "material + process"


def furniture() -> list[str]:
    """Fixtures of the cell: what stands near the arm, and what stands near the part."""
    found = ["  bench: {box: [400, 300, 200], in: world, xyz: [420, -150, 40]}"]
    for k in range(8):
        found.append(f"  post_{k}: {{box: [40, 40, 1800], in: world, xyz: [{-900 + 250 * k}, 1000, 0]}}")
        found.append(f"  shelf_{k}: {{box: [300, 300, 20], in: world, xyz: [-900, {-900 + 220 * k}, {200 + 120 * k}]}}")
    for k in range(4):
        found.append(f"  pipe_{k}: {{cylinder: [60, 1500], in: world, xyz: [{200 + 300 * k}, -950, 0]}}")
    for k, (x, y) in enumerate([(-30, 10), (-30, 40), (105, 10), (105, 40)]):
        found.append(f"  clamp_{k}: {{box: [25, 12, 18], in: table, xyz: [{x}, {y}, 0]}}")
    return found


def main(blocks: int = job.BLOCKS) -> None:
    run(["gcodesim", "warm-up"])  # so that no compiling is timed
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program, cell = job.write(folder, "kr10", blocks)
        bare = cell.read_text()
        stages = {}
        for what, text in {"bare": bare, "furnished": bare + "fixtures:\n" + "\n".join(furniture()) + "\n"}.items():
            cell.write_text(text)
            times = folder / f"{what}.json"
            order = ["run", str(program), "--cell", str(cell), "--world", "kinematic", "--out", str(folder / what)]
            run(["benchmarks.stages", str(times), *order])
            stages[what] = json.loads(times.read_text())
            spent, removal = stages[what][CHECKS], stages[what][REMOVAL]
            print(f"{what:10} {CHECKS} {spent:6.2f} s, {REMOVAL} {removal:6.2f} s: {spent / removal:5.2f} x   goal 1 x")
        times = folder / "shape.json"
        run(["benchmarks.stages", str(times), *order, "--only", "shape"])
        removal = json.loads(times.read_text())[REMOVAL]
        spent = stages["furnished"][CHECKS]
        print(f"beside removal alone, {removal:.2f} s: {spent / removal:.2f} x")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
