"""The door to the compiled lane: state in, a batch of moves and the state after them out."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.finding import Caller
from gcodesim.native import ArrayType, NativeKernel
from gcodesim.rs274.control import Control
from gcodesim.rs274.plain import move_kernels as k
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.scan_kernels import MOST_CODES
from gcodesim.units import DEG, INCH, MINUTE

MOST_MOVES: Final = 1 << 15
"""Rows of a batch; so much memory is in use at a time however long the program is."""

_SHORT_RUN = 12  # lines; below that the way through the door costs more than the lines by themselves
_LONGEST_PAUSE = 64


_BATCH: Final = (("u1", 1), ("f8", 2), ("f8", 1), ("?", 1), ("i4", 2), ("f8", 2), ("f8", 2), ("f8", 1), ("i8", 1))
_ROOM: Final = (("f8", 1), ("i8", 1), ("i8", 1), ("f8", 1), ("f8", 1))

RUN_LINES: Final = NativeKernel(
    "gcodesim.rs274.plain.move_kernels",
    "run_lines",
    [
        ArrayType("u1", readonly=True),
        ArrayType("i8"),
        ArrayType("f8"),
        ArrayType("i8"),
        *(ArrayType(item, dimensions) for item, dimensions in (*_BATCH, *_ROOM)),
    ],
    integers=3,
)


class PlainLane:
    """Executes the plain lines of one file; `eager` tries every line, whether it may pay or not."""

    def __init__(self, source: SourceText, longest_line: int, *, eager: bool = False) -> None:
        table = source.table
        self._name = source.name
        self._longest = longest_line
        self._eager = eager
        self._pause, self._next_pause = 0, 1
        self._numbers, self._modes = np.zeros(k.NUMBERS), np.zeros(k.MODES, dtype=np.int64)
        self._rows = _Rows(min(len(table), MOST_MOVES))
        room = (
            np.zeros(26),
            np.zeros(MOST_CODES + 1, dtype=np.int64),
            np.zeros(4, dtype=np.int64),
            np.zeros(6),
            np.zeros(6),
        )
        self._run = RUN_LINES.bind(table.data, table.starts, self._numbers, self._modes, *self._rows.columns(), *room)
        self._alive = (table, room)  # what the kernel holds pointers to

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
        _write_state(control, self._numbers, self._modes)
        index = self._run(first, last, self._longest)
        self._judge(index - first)
        if index == first:
            return index, None
        _take_over(control, self._numbers, self._modes)
        moves, arcs = int(self._modes[k.ROWS]), int(self._modes[k.ARCS])
        if moves == 0:
            return index, None
        per_revolution = control.state.feed_mode == 950
        return index, self._rows.batch(moves, arcs, self._name, callers, block - first - 1, per_revolution)

    def _judge(self, lines: int) -> None:
        """Leave the line that stopped the run to the other lane, after short runs some more."""
        if lines >= _SHORT_RUN or self._eager:
            self._next_pause = 1
        else:
            self._next_pause = min(2 * self._next_pause, _LONGEST_PAUSE)
        self._pause = self._next_pause


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

    def columns(self) -> tuple[Column, ...]:
        """All of them, as the kernel takes them."""
        return (
            *(self.kind, self.end, self.feed, self.rotary, self.place),
            *(self.center, self.normal, self.sweep, self.turns),
        )

    def batch(
        self, moves: int, arcs: int, file: str, callers: tuple[Caller, ...], block_shift: int, per_revolution: bool
    ) -> MoveBatch:
        """A copy of the first moves and arcs."""
        return MoveBatch(
            file=file,
            callers=callers,
            kind=self.kind[:moves].copy(),
            end=self.end[:moves].copy(),
            feed=self.feed[:moves].copy(),
            rotary=self.rotary[:moves].copy(),
            per_revolution=per_revolution,
            place=self.place[:moves].copy(),
            block_shift=block_shift,
            center=self.center[:arcs].copy(),
            normal=self.normal[:arcs].copy(),
            sweep=self.sweep[:arcs].copy(),
            turns=self.turns[:arcs].copy(),
        )


def _write_state(control: Control, numbers: Column, modes: Column) -> None:
    state = control.state
    turn = math.radians(state.rotation)
    numbers[:] = (
        *state.current[:6], *state.g92[:6], *state.origin[:6],
        math.cos(turn), math.sin(turn), state.unit, state.feed, state.feed_unit, DEG, MINUTE,
    )  # fmt: skip
    modes[:] = (
        state.motion, state.plane, state.incremental, state.centre_absolute, state.feed_mode,
        state.rotation != 0.0, state.unit == INCH, state.speed != 0.0, 0, 0, 0,
    )  # fmt: skip


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
