"""How things are timed and printed here: processor time, the median of some runs, and the ratio to a yardstick."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any

RUNS = 5


def seconds(work: Callable[[], Any], runs: int = RUNS) -> float:
    """Median processor time [s] of `work`, which runs once beforehand to be warm."""
    work()
    spent = []
    for _ in range(runs):
        begin = time.process_time()
        work()
        spent.append(time.process_time() - begin)
    return max(statistics.median(spent), 1e-9)


def show(what: str, ours: float, yardstick: str, theirs: float, unit: str, goal: float | None = None) -> None:
    """One line: two rates, their ratio, and the goal of the ratio."""
    wanted = "" if goal is None else f"   goal {goal:g} x"
    print(f"{what:34} {ours:14,.0f} {unit}   {yardstick:38} {theirs:14,.0f}   {ours / theirs:9.1f} x{wanted}")
