"""How much work something is, told without a clock or by a yardstick that is measured beside it.

Seconds say more about who else uses the machine than about the code.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from types import FrameType
from typing import Any


class TooManyCallsError(AssertionError):
    """More calls than a test allows."""


def calls_of(work: Callable[[], object], most: int) -> int:
    """How many functions `work` calls, those of C included; the same number on every machine.

    Raises `TooManyCallsError` as soon as there are more than `most`, so that what has no end ends.
    """
    count = 0

    def note(frame: FrameType, event: str, argument: Any) -> None:
        nonlocal count
        if event in ("call", "c_call"):
            count += 1
            if count > most:
                sys.setprofile(None)
                raise TooManyCallsError(f"more than {most} calls")

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(before)
    return count


def growth(work: Callable[[int], object], size: int, factor: int, most: float) -> float:
    """How many times the processor time of `work(size)` the work at `factor` times that size takes.

    `factor` where the work grows with the size, its square where it grows with the square. Each time is the least of
    three, or of as many more as a busy machine needs until it is below `most`, up to twenty.
    """
    small = large = math.inf
    for count in range(1, 21):
        small, large = min(small, _seconds(work, size)), min(large, _seconds(work, size * factor))
        if count >= 3 and large < most * small:
            break
    return large / small


def _seconds(work: Callable[[int], object], size: int) -> float:
    begin = time.process_time()
    work(size)
    return max(time.process_time() - begin, 1e-3)  # below a millisecond the clock itself counts
