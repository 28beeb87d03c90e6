"""The same commands in two checkouts, by turns: has a change made anything slower?

    python -m benchmarks.against OLD [RUNS] [BLOCKS]

OLD is the folder of another checkout; the new one is this folder. Both are run by this Python. Each command runs RUNS
times in each, the two taking turns, so that what else the machine does meets both; the least processor time of whole
processes counts. BLOCKS is the length of the reference job. All kernels of both are compiled before, and byte code is
kept in a folder of this run: stale byte code beside the sources of one checkout, or kernels that only one has ready,
would count as a change.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks import job

SLOWER = 0.03
"""What a change may cost that has another purpose."""


def spent(tree: Path, arguments: list[str], byte_code: Path) -> float:
    """User and system time [s] of one process with the sources of `tree`; `byte_code`: the folder for it."""
    surroundings = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    before = _of_children()
    done = subprocess.run(
        [sys.executable, "-m", "gcodesim", *arguments],
        cwd=tree,
        env={**surroundings, "PYTHONPYCACHEPREFIX": str(byte_code)},
        check=False,
        capture_output=True,
        text=True,
    )
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stdout + done.stderr)
    return _of_children() - before


def _of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def compare(
    what: str, trees: tuple[Path, Path], commands: tuple[list[str], list[str]], runs: int, byte_code: Path
) -> float:
    """Least time of the new over the least of the old, printed."""
    for tree, arguments in zip(trees, commands, strict=True):
        spent(tree, arguments, byte_code)  # so that what is compiled once is in the cache
    times: tuple[list[float], list[float]] = ([], [])
    for turn in range(runs):
        for side in (0, 1) if turn % 2 == 0 else (1, 0):
            times[side].append(spent(trees[side], commands[side], byte_code))
    old, new = min(times[0]), min(times[1])
    print(f"{what:34} {old:10.3f} s {new:10.3f} s {new / old:9.3f} x   goal {1.0 + SLOWER:g} x", flush=True)
    return new / old


def main(old: str, runs: int = 7, blocks: int = job.BLOCKS) -> int:
    trees = (Path(old).resolve(), Path(__file__).resolve().parents[1])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        byte_code = folder / "byte code"
        for part in (folder / "job", folder / "short", byte_code):
            part.mkdir()
        for tree in trees:
            spent(tree, ["warm-up"], byte_code)
        long_job = [job.write(folder / "job", machine, blocks) for machine in ("gantry", "kr10")]
        program, cell = job.write(folder / "short", "gantry", 20)

        def both(*arguments: str) -> tuple[list[str], list[str]]:
            return tuple([word.format(out=folder / side) for word in arguments] for side in ("old", "new"))  # type: ignore[return-value]

        def run(program: Path, cell: Path, world: str) -> tuple[list[str], list[str]]:
            return both("run", str(program), "--cell", str(cell), "--world", world, "--out", "{out}")

        ratios = [
            compare("lint, 20 blocks", trees, both("lint", str(program)), 3 * runs, byte_code),
            compare("check, 20 blocks", trees, both("check", str(program), "--cell", str(cell)), 3 * runs, byte_code),
            compare("run, 20 blocks, kinematic", trees, run(program, cell, "kinematic"), 2 * runs, byte_code),
            compare("run, 20 blocks, bullet", trees, run(program, cell, "bullet"), 2 * runs, byte_code),
            *(
                compare(f"reference job, {machine}, {world}", trees, run(*files, world), runs, byte_code)
                for machine, files in zip(("gantry", "KR 10"), long_job, strict=True)
                for world in ("kinematic", "bullet")
            ),
        ]
    return 0 if max(ratios) <= 1.0 + SLOWER else 1


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], *map(int, sys.argv[2:])))
