"""The door to the compiled lane: state in, a batch of moves and the state after them out."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.finding import Caller
from gcodesim.native import ArrayType, NativeKernel
from gcodesim.rs274.arcs import PLANE_AXES
from gcodesim.rs274.compensation import is_on
from gcodesim.rs274.control import Control
from gcodesim.rs274.ends import start_point
from gcodesim.rs274.plain import layout_kernels as at
from gcodesim.rs274.plain import waiting
from gcodesim.rs274.plain.columns import Column
from gcodesim.units import DEG, INCH, MINUTE

MOST_MOVES: Final = 1 << 15
"""Rows of a batch; so much memory is in use at a time however long the program is."""

_MOVES_OF_LINE = 16  # room in short files, for holes
_SHORT_RUN = 12  # lines; below that the way through the door costs more than the lines by themselves
_LONGEST_PAUSE = 64

RUN_LINES: Final = NativeKernel(
    "gcodesim.rs274.plain.move_kernels",
    "run_lines",
    [
        ArrayType("u1", readonly=True),
        ArrayType("i8"),
        ArrayType("f8"),
        ArrayType("i8"),
        ArrayType("f8", 2),
        ArrayType("i4", 2),
        ArrayType("f8", 2),
        ArrayType("i4", 2),
    ],
    integers=3,
)
_KNOWN_CYCLES: Final = frozenset((730, 810, 820, 830, 850, 890))


class PlainLane:
    """Executes the plain lines of one file; `eager` tries every line, whether it may pay or not."""

    def __init__(self, source: SourceText, longest_line: int, *, eager: bool = False) -> None:
        self._table = source.table
        self._name = source.name
        self._longest = longest_line
        self._eager = eager
        self._pause, self._next_pause = 0, 1
        self._numbers, self._modes = np.zeros(at.NUMBERS), np.zeros(at.MODES, dtype=np.int64)
        room = min(_MOVES_OF_LINE * len(self._table) + _MOVES_OF_LINE, MOST_MOVES)
        self._moves = np.empty((room, at.END_FEED))
        self._facts = np.empty((room, at.FACTS), dtype=np.int32)
        self._shapes = np.empty((room, at.SHAPE))
        self._acts = np.empty((room, 2), dtype=np.int32)
        self._run = RUN_LINES.bind(
            self._table.data, self._table.starts, self._numbers, self._modes,
            self._moves, self._facts, self._shapes, self._acts,
        )  # fmt: skip

    def is_open(self, control: Control) -> bool:
        """Whether the line at hand may be tried: the state is one that the kernels know, and trying may pay."""
        if self._pause > 0:
            self._pause -= 1
            return False
        state = control.state
        if state.comp_leaving or state.nurbs_order or state.diameter:
            return False
        return waiting.is_known(state) if is_on(control) else not state.held

    def run(
        self, control: Control, first: int, last: int, block: int, callers: tuple[Caller, ...]
    ) -> tuple[int, MoveBatch | None]:
        """Execute lines from index `first` to before `last` as far as they are plain.

        `block` is the number of the first one. Returns the index of the next line, and the moves.
        """
        state, shift = control.state, block - first - 1
        beside = is_on(control)
        if beside and not waiting.is_of(state, self._name, callers, shift):
            return first, None
        _write_state(control, self._numbers, self._modes)
        index = self._run(first, last, self._longest)
        self._judge(index - first)
        if index == first:
            return index, None
        _take_over(control, self._numbers, self._modes)
        if beside:
            waiting.take_over(state, self._numbers, self._modes, (self._name, callers, shift))
        if self._modes[at.ROWS] == 0:
            return index, None
        return index, self._batch(control, callers, shift)

    def _batch(self, control: Control, callers: tuple[Caller, ...], block_shift: int) -> MoveBatch:
        """The rows of the last call."""
        rows, arcs, acts = self._modes[at.ROWS : at.ACTS + 1].tolist()
        moves, facts = self._moves[:rows].copy(), self._facts[:rows].copy()
        return MoveBatch(
            file=self._name,
            callers=callers,
            kind=facts[:, at.KIND],
            word=facts[:, at.WORD],
            end=moves[:, :6],
            feed=moves[:, 6],
            rotary=facts[:, at.ROTARY] != 0,
            per_revolution=control.state.feed_mode == 950,
            place=facts[:, at.LINE : at.LINE + 3],
            block_shift=block_shift,
            shapes=self._shapes[:arcs].copy(),
            acts=self._acts[:acts].copy(),
            path=control.path_mode(),
            dwell=float(self._numbers[at.CYCLE_P]),
        )

    def _judge(self, lines: int) -> None:
        """Leave the line that stopped the run to the other lane, after short runs some more."""
        if lines >= _SHORT_RUN or self._eager:
            self._next_pause = 1
        else:
            self._next_pause = min(2 * self._next_pause, _LONGEST_PAUSE)
        self._pause = self._next_pause


def _write_state(control: Control, numbers: Column, modes: Column) -> None:
    state = control.state
    turn = math.radians(state.rotation)
    words = dict(state.cycle_words)
    depth = "xyz"[PLANE_AXES[state.plane][2]]
    runs = (
        state.cycle == state.motion and state.cycle in _KNOWN_CYCLES and "r" in words and depth in words
    ) and not state.side
    numbers[: at.TARGET] = (*start_point(control)[:6], *state.g92[:6], *state.origin[:6])
    numbers[at.COS : at.ARC_CENTRE] = (
        math.cos(turn), math.sin(turn), state.unit, state.feed, state.feed_unit, DEG, MINUTE,
        state.cycle_start, words.get("r", 0.0), words.get(depth, 0.0), words.get("q", 0.0), words.get("p", 0.0),
    )  # fmt: skip
    beside = is_on(control)
    if beside:
        waiting.write(state, numbers, modes)
    modes[: at.SIDE + 1] = (
        state.motion, state.plane, state.incremental, state.centre_absolute, state.feed_mode,
        state.rotation != 0.0, state.unit == INCH, state.speed != 0.0,
        state.cycle if runs else -1, state.retract == 990, state.path == 610,
        state.side != 0, state.side if beside else 0,
    )  # fmt: skip


def _take_over(control: Control, numbers: Column, modes: Column) -> None:
    state = control.state
    current = numbers[at.CURRENT : at.CURRENT + 6].tolist()
    motion, plane, incremental, centre_absolute, *_ = modes[: at.COMPENSATES].tolist()
    if modes[at.CYCLE] >= 0:
        depth = "xyz"[PLANE_AXES[state.plane][2]]
        words = dict(state.cycle_words)
        words["r"], words[depth] = float(numbers[at.CYCLE_R]), float(numbers[at.CYCLE_DEPTH])
        state.cycle_words = tuple(words.items())
    if not is_on(control):
        state.current = (*current, *state.current[6:])
    state.feed, state.feed_unit = float(numbers[at.FEED]), float(numbers[at.FEED_UNIT])
    state.motion, state.plane = motion, plane
    state.incremental, state.centre_absolute = bool(incremental), bool(centre_absolute)
    if modes[at.MOVED]:
        state.cycle = -1
