"""Which lane reads the next line: the compiled one costs an import, so short programs do without it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final, Protocol

from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.text import LONG
from gcodesim.rs274.control import Control
from gcodesim.rs274.flow import FlowControl
from gcodesim.rs274.settings import Settings

if TYPE_CHECKING:
    from gcodesim.canon.batch import MoveBatch
    from gcodesim.rs274.plain.lane import PlainLane
    from gcodesim.rs274.program_file import ProgramFile

_MANY_BLOCKS: Final = 6_000
"""Blocks after which a short program, which then has a loop, has cost as much as the import."""

LONG_IN_CELL: Final = 50_000
"""Bytes from which on the lane pays in a cell, whose plan needs most of what the lane imports."""

_MANY_IN_CELL: Final = 1_500
"""Blocks after which it pays there for a shorter text."""

_BLOCKS_OF_HOLE: Final = 8
"""A block of a canned cycle costs as much as this many others."""

_PLAIN_WORTH_COMPILING: Final = 5_000_000
"""Bytes from which on compiling the plain lane, once for each version, takes little longer than doing without it."""

WORTH_COMPILING: Final = 1_000_000
"""The same of languages whose lines take longer by themselves, or whose lane is smaller."""

_BLOCKS_WORTH_COMPILING: Final = 1_000_000


class Lane(Protocol):
    """A compiled lane: it carries out lines as far as it knows them; fewer moves than `worth_a_batch` go one by one."""

    worth_a_batch: int

    def is_open(self) -> bool:
        """Whether the line at hand may be tried."""
        ...

    def run(self, block: int, most: int) -> tuple[int, MoveBatch | None, tuple[ProgramFile, int]]:
        """Carry out at most `most` lines, of which the first is number `block`.

        Returns how many, the moves, and file and index of the last line.
        """
        ...


class Lanes(Protocol):
    """Which lane a run has for its next line."""

    def lane_at(self, block: int) -> Lane | None:
        """The compiled lane, when the line at hand may be tried in it; `block` counts those so far."""
        ...


class LongLanes:
    """The compiled lane of a run that is opened where the program is long enough: `pays` says so.

    `open_lane` opens it, and gets told whether that may take compiling; None: it would.
    """

    def __init__(self, choice: str, pays: bool, may_compile: bool, open_lane: Callable[[bool], Lane | None]) -> None:
        self._lane: Lane | None = None
        self._wanted = {"grammar": False, "compiled": True}.get(choice, pays)
        self._may_compile, self._open = choice == "compiled" or may_compile, open_lane

    def lane_at(self, block: int) -> Lane | None:
        """The compiled lane, when the line at hand may be tried in it."""
        if not self._wanted:
            return None
        if self._lane is None:
            self._lane = self._open(self._may_compile)
            if self._lane is None:
                self._wanted = False
                return None
        return self._lane if self._lane.is_open() else None


class PlainLanes:
    """The compiled lane of one run, opened once it pays; longer lines than `longest` are left to the other."""

    def __init__(
        self, source: SourceText, settings: Settings, control: Control, flow: FlowControl, longest: int
    ) -> None:
        self._control, self._flow, self._longest = control, flow, longest
        self._lane: PlainLane | None = None
        self._eager = settings.lane == "compiled"
        self._may_compile = self._eager or len(source.raw) >= _PLAIN_WORTH_COMPILING
        long, many = (LONG_IN_CELL, _MANY_IN_CELL) if settings.has_cell else (LONG, _MANY_BLOCKS)
        self._from = {"grammar": None, "compiled": 0}.get(settings.lane, 0 if len(source.raw) >= long else many)

    def lane_at(self, block: int) -> PlainLane | None:
        """The compiled lane, when the line at hand may be tried in it; `block` counts those so far."""
        lane = self._lane
        if lane is None:
            if self._from is None:
                return None
            if block < self._from and (self._control.state.cycle < 0 or block * _BLOCKS_OF_HOLE < self._from):
                return None
            from gcodesim.rs274.plain.lane import PlainLane, is_ready  # imports numpy, and perhaps the compiler

            if not (self._may_compile or is_ready() or block >= _BLOCKS_WORTH_COMPILING):
                self._from = _BLOCKS_WORTH_COMPILING
                return None
            lane = self._lane = PlainLane(self._control, self._flow, self._longest, eager=self._eager)
        return lane if lane.is_open() else None
