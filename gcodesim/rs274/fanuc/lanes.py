"""Which lines of a Fanuc program are read by themselves, and which thousands at a time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gcodesim.diagnostics.text import LONG

if TYPE_CHECKING:
    from gcodesim.rs274.fanuc.executor import FanucExecutor
    from gcodesim.rs274.fanuc.lane import FanucLane

_LONG_IN_CELL: Final = 50_000
"""Bytes from which on the lane pays in a cell, whose plan needs most of what the lane imports."""

_WORTH_COMPILING: Final = 1_000_000
"""Bytes from which on compiling the lane, once for each version, takes little longer than doing without it."""


class FanucLanes:
    """The compiled lane of one run, opened where the program is long enough."""

    def __init__(self, do: FanucExecutor) -> None:
        self._do = do
        self._lane: FanucLane | None = None
        size, choice = len(do.run.source.raw), do.settings.lane
        pays = size >= (_LONG_IN_CELL if do.settings.has_cell else LONG)
        self._wanted = {"grammar": False, "compiled": True}.get(choice, pays)
        self._may_compile = choice == "compiled" or size >= _WORTH_COMPILING

    def lane_at(self, block: int) -> FanucLane | None:
        """The compiled lane, when the line at hand may be tried in it."""
        if not self._wanted:
            return None
        if self._lane is None:
            from gcodesim.rs274.fanuc.lane import FanucLane, is_ready  # imports numpy, and perhaps the compiler

            if not (self._may_compile or is_ready()):
                self._wanted = False
                return None
            self._lane = FanucLane(self._do)
        return self._lane if self._lane.is_open() else None
