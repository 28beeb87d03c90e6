"""What a command costs before it does anything: whole processes against a bare interpreter.

python -m benchmarks.start [RUNS]
"""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks import job


def process(arguments: list[str], runs: int) -> float:
    """Median of user and system time [s] of a python process with these arguments."""
    spent = []
    for _ in range(runs):
        before = _of_children()
        subprocess.run([sys.executable, *arguments], check=False, capture_output=True)
        spent.append(_of_children() - before)
    return statistics.median(spent)


def _of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(runs: int = 5) -> None:
    with tempfile.TemporaryDirectory() as name:
        program, cell = job.write(Path(name), "gantry", 20)
        run = ["-m", "gcodesim", "run", str(program), "--cell", str(cell)]
        cases = (
            ("bare interpreter", ["-c", "pass"], None),
            ("--help", ["-m", "gcodesim", "--help"], 0.15),
            ("canon, 20 blocks", ["-m", "gcodesim", "canon", str(program)], 0.4),
            ("check, 20 blocks", ["-m", "gcodesim", "check", str(program), "--cell", str(cell)], 0.35),
            ("run, 20 blocks, kinematic", [*run, "--world", "kinematic", "--out", str(Path(name) / "out")], 0.9),
            ("run, 20 blocks, bullet", [*run, "--world", "bullet", "--out", str(Path(name) / "out")], None),
        )
        for _, arguments, _ in cases:
            process(arguments, 1)  # so that what is compiled once is in the cache
        bare = 0.0
        for what, arguments, goal in cases:
            spent = process(arguments, runs)
            bare = bare or spent
            wanted = "" if goal is None else f"   goal {goal:g} s"
            print(f"{what:34} {spent:14.3f} s   {spent / bare:9.1f} x a bare interpreter{wanted}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
