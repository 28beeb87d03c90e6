"""How much of a program is executed before it is given up: blocks, moves, seconds and findings."""

from __future__ import annotations

import math
import time
from typing import Final, NamedTuple

from gcodesim.rs274.settings import Settings

# blocks that a program may execute, by the dialect's speed, and events; so many, and so many a line
_MOST_BLOCKS: Final = 20_000_000
_MOST_SLOW_BLOCKS: Final = 1_000_000
_MOST_EVENTS: Final = 2_000_000
_MOST_ROUNDS: Final = 10
_MOST_FINDINGS: Final = 1000  # a file that is not a program would fill the screen
_CHECK_CLOCK_EVERY: Final = 4096  # blocks


class Exceeded(NamedTuple):
    """What a program has used up: a finding in parts, and the option that allows more of it ("" if none does)."""

    code: str
    message: str
    limit: float
    unit: str
    option: str = ""


class Allowance:
    """What one execution of a program of `lines` lines may use."""

    def __init__(self, settings: Settings, *, lines: int, is_quick: bool) -> None:
        rounds = _MOST_ROUNDS * lines
        self.most_blocks = (_MOST_BLOCKS if is_quick else _MOST_SLOW_BLOCKS) + rounds
        self._most_events: float = _MOST_EVENTS + rounds
        if settings.max_blocks is not None:
            self.most_blocks, self._most_events = settings.max_blocks, math.inf
        self._events = 0
        self._seconds = settings.time_limit
        self._deadline = math.inf if self._seconds is None else time.monotonic() + self._seconds
        self._next_clock = _CHECK_CLOCK_EVERY

    def spend(self, events: int) -> None:
        """So many events have come."""
        self._events += events

    def forgive(self, seconds: float) -> None:
        """Leave time that somebody else has taken out of the time for reading."""
        self._deadline += seconds

    def exceeded(self, blocks: int, faults: int) -> Exceeded | None:
        """What is used up after so many blocks and faults."""
        if blocks > self.most_blocks:
            return self.no_end(f"the program did not end within {self.most_blocks} blocks")
        if self._events > self._most_events:
            most = int(self._most_events)
            return Exceeded("GS134", f"the program did not end within {most} moves", most, "moves", "--max-blocks")
        if self._is_late(blocks):
            limit = self._seconds or 0.0
            return Exceeded(
                "GS135", f"reading the program took longer than {limit:g} s", limit, "s", option="--time-limit"
            )
        if faults >= _MOST_FINDINGS:
            return Exceeded("GS015", f"more than {_MOST_FINDINGS} findings: reading stops here", _MOST_FINDINGS, "")
        return None

    def no_end(self, message: str) -> Exceeded:
        """A program that never ends, or not within its blocks."""
        return Exceeded("GS134", message, self.most_blocks, "blocks", option="--max-blocks")

    def _is_late(self, blocks: int) -> bool:
        """Whether the time is used up; the clock is read only now and then."""
        if blocks < self._next_clock or math.isinf(self._deadline):
            return False
        self._next_clock = blocks + _CHECK_CLOCK_EVERY
        return time.monotonic() > self._deadline
