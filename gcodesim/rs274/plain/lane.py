"""The door to the compiled lane: state in, a batch of moves and the state after them out."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.finding import Caller
from gcodesim.rs274.control import Control
from gcodesim.rs274.plain import move_kernels as k
from gcodesim.rs274.plain.columns import Column
from gcodesim.units import DEG, INCH, MINUTE

MOST_MOVES: Final = 1 << 15
"""Rows of a batch; so much memory is in use at a time however long the program is."""

_SHORT_RUN = 12  # lines; below that the way through the door costs more than the lines by themselves
_LONGEST_PAUSE = 64


class PlainLane:
    """Executes the plain lines of one file; `eager` tries every line, whether it may pay or not."""

    def __init__(self, source: SourceText, longest_line: int, *, eager: bool = False) -> None:
        self._eager = eager
        self._name = source.name
        self._table = source.table
        self._longest = longest_line
        self._pause, self._next_pause = 0, 1

    def is_open(self, control: Control) -> bool:
        """Whether the line at hand may be tried: the state is one that the kernels know, and trying may pay."""
        if self._pause > 0:
            self._pause -= 1
            return False
        state = control.state
        return not (state.side or state.comp_leaving or state.held or state.nurbs_order or state.diameter)

    def run(
        self, control: Control, first: int, last: int, block: int, callers: tuple[Caller, ...]
    ) -> tuple[int, MoveBatch | None]:
        """Execute lines from index `first` to before `last` as far as they are plain.

        `block` is the number of the first one. Returns the index of the next line, and the moves.
        """
        table = self._table
        numbers, modes = _state_as_arrays(control)
        room = min(last - first, MOST_MOVES)
        rows = _Rows(room)
        index = k.run_lines(
            table.data, table.starts, first, last, self._longest, numbers, modes,
            rows.kind, rows.end, rows.feed, rows.rotary, rows.place, rows.center, rows.normal, rows.sweep, rows.turns,
        )  # fmt: skip
        self._judge(index - first)
        if index == first:
            return index, None
        _take_over(control, numbers, modes)
        n, m = int(modes[k.ROWS]), int(modes[k.ARCS])
        if n == 0:
            return index, None
        return index, rows.batch(n, m, self._name, callers, block - first - 1, control.state.feed_mode == 950)

    def _judge(self, lines: int) -> None:
        """After short runs leave some lines to the other lane before the next try."""
        if lines >= _SHORT_RUN or self._eager:
            self._next_pause = 1
        else:
            self._pause = self._next_pause
            self._next_pause = min(2 * self._next_pause, _LONGEST_PAUSE)


class _Rows:
    """Room for the moves of one call."""

    def __init__(self, room: int) -> None:
        self.kind = np.empty(room, dtype=np.uint8)
        self.end = np.empty((room, 6))
        self.feed = np.empty(room)
        self.rotary = np.empty(room, dtype=np.bool_)
        self.place = np.empty((room, 3), dtype=np.int32)
        self.center = np.empty((room, 3))
        self.normal = np.empty((room, 3))
        self.sweep = np.empty(room)
        self.turns = np.empty(room, dtype=np.int64)

    def batch(
        self, n: int, m: int, file: str, callers: tuple[Caller, ...], block_shift: int, per_revolution: bool
    ) -> MoveBatch:
        """The first `n` moves with `m` arcs; copied where most of the room is empty, so that it is not kept."""
        full = 2 * n >= len(self.kind)

        def kept(column: Column, count: int) -> Column:
            part = column[:count]
            return part if full and 2 * count >= len(column) else part.copy()

        return MoveBatch(
            file=file,
            callers=callers,
            kind=kept(self.kind, n),
            end=kept(self.end, n),
            feed=kept(self.feed, n),
            rotary=kept(self.rotary, n),
            per_revolution=per_revolution,
            place=kept(self.place, n),
            block_shift=block_shift,
            center=kept(self.center, m),
            normal=kept(self.normal, m),
            sweep=kept(self.sweep, m),
            turns=kept(self.turns, m),
        )


def _state_as_arrays(control: Control) -> tuple[Column, Column]:
    state = control.state
    turn = math.radians(state.rotation)
    numbers = np.array(
        (
            *state.current[:6], *state.g92[:6], *state.origin[:6],
            math.cos(turn), math.sin(turn), state.unit, state.feed, state.feed_unit, DEG, MINUTE,
        )
    )  # fmt: skip
    modes = np.array(
        (
            state.motion, state.plane, state.incremental, state.centre_absolute, state.feed_mode,
            state.rotation != 0.0, state.unit == INCH, state.speed != 0.0, 0, 0, 0,
        ),
        dtype=np.int64,
    )  # fmt: skip
    return numbers, modes


def _take_over(control: Control, numbers: Column, modes: Column) -> None:
    state = control.state
    after = numbers.tolist()
    motion, plane, incremental, centre_absolute, *_ = modes.tolist()
    state.current = (*after[k.CURRENT : k.CURRENT + 6], *state.current[6:])
    state.feed, state.feed_unit = after[k.FEED], after[k.FEED_UNIT]
    state.motion, state.plane = motion, plane
    state.incremental, state.centre_absolute = bool(incremental), bool(centre_absolute)
    if modes[k.MOVED]:
        state.cycle = -1
