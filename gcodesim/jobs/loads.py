"""Loads above what the cell allows: how much, and for how long."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks.lasting import Lasting, in_words
from gcodesim.frames import Array
from gcodesim.units import KW

if TYPE_CHECKING:
    from gcodesim.cell.settings import Limits

BRIEF: Final = 0.05
"""[s] up to which the inertia of a spindle and its motor carry it over a peak: some 50 turns at 60,000 rpm."""


@dataclass(slots=True, kw_only=True, eq=False)
class Load:
    """A figure of the steps, `column` of the sheet, with its `limit` in SI; `unit` is that of messages, `per` in SI.

    `seconds` is the time above the limit, `longest` the longest stretch of it, `begin` when it first is [s]. `turns`:
    it is a load of the spindle, which turns on through a short peak.
    """

    code: str
    column: str
    limit: float
    per: float
    unit: str
    what: str
    turns: bool
    seconds: float = 0.0
    longest: float = 0.0
    begin: float = 0.0
    _above: Lasting = field(default_factory=lambda: Lasting(1))

    def add(self, values: Array, ticks: NDArray[np.int64], dt: float) -> bool:
        """Add `values` (n,) of steps, each of some `ticks` (n,) of `dt` [s]; whether any of them is above the limit."""
        above = np.abs(values) > self.limit
        self._above.add(above[:, None], ticks)
        seconds, longest, begin = self._above.in_seconds(dt)
        self.seconds, self.longest, self.begin = float(seconds[0]), float(longest[0]), float(begin[0])
        return bool(above.any())

    @property
    def brief(self) -> bool:
        """Whether it is nothing but short peaks of the spindle's load."""
        return self.turns and 0.0 < self.longest <= BRIEF

    @property
    def duration(self) -> str:
        """In words: how long in all, and at most at a time."""
        return in_words(self.seconds, self.longest)


def loads_of(limits: Limits) -> list[Load]:
    """The loads for which a cell has limits."""
    asked = (
        ("GS510", "power", limits.spindle_power, KW, "kW", "power of the spindle", True),
        ("GS511", "torque", limits.spindle_torque, 1.0, "N·m", "torque of the spindle", True),
        ("GS512", "force", limits.force, 1.0, "N", "force on the tool", False),
    )
    return [
        Load(code=code, column=column, limit=limit, per=per, unit=unit, what=what, turns=turns)
        for code, column, limit, per, unit, what, turns in asked
        if limit is not None
    ]
