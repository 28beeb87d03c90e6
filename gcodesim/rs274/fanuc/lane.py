"""The door to the compiled lane of a Fanuc program: thousands of straight moves come as one batch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, cast

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon.batch import MoveBatch
from gcodesim.compiled import Kernel
from gcodesim.compiled.arguments import Argument, name_of
from gcodesim.compiled.object_code import is_kept
from gcodesim.rs274.fanuc import lane_kernels as at
from gcodesim.rs274.fanuc.vectors import BY_VECTOR
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.tool_point import CENTRE_POINT
from gcodesim.units import DEG, INCH, MINUTE

if TYPE_CHECKING:
    from gcodesim.rs274.fanuc.executor import FanucExecutor

Array = NDArray[np.float64]

MOST_ROWS: Final = 1 << 15
"""Rows of a batch; so much memory is in use at a time however long the program is."""

_WORTH_A_BATCH: Final = 12  # moves; fewer are looked at faster one by one
_SHORT_RUN: Final = 6  # lines; below that the way through the door costs more than the lines by themselves
_LONGEST_PAUSE: Final = 64
_PER_MM, _PER_INCH, _PER_DEGREE = 1000.0, 10000.0, 1000.0  # increments, as in increments.py
_STRAIGHT: Final = (0, 10)
_REALS, _WHOLE = Argument("f8", 1), Argument("i8", 1)
_TAKES: Final = (
    Argument("u1", 1, readonly=True),
    _WHOLE,
    Argument(parts=(_REALS, _WHOLE, _REALS, _WHOLE), named=name_of(at.StraightState) or ""),
    Argument(parts=(Argument("f8", 2), Argument("i4", 2)), named=name_of(at.StraightRows) or ""),
    _WHOLE,
)
"""What `read_lines` is called with."""


def is_ready() -> bool:
    """Whether the lane can be opened without compiling it."""
    return is_kept(cast(Kernel, at.read_lines), _TAKES)


class FanucLane:
    """Carries out the lines that the kernels know."""

    def __init__(self, do: FanucExecutor) -> None:
        self._do = do
        self._eager = do.settings.lane == "compiled"
        self.worth_a_batch = 1 if self._eager else _WORTH_A_BATCH
        self._pause, self._next_pause = 0, 1
        self._text = do.run.source.table
        words, has = np.zeros(at.LETTERS), np.zeros(at.LETTERS, dtype=np.int64)
        self._state = at.StraightState(np.zeros(at.NUMBERS), np.zeros(at.MODES, dtype=np.int64), words, has)
        self._rows = at.StraightRows(np.empty((MOST_ROWS, at.VALUES)), np.empty((MOST_ROWS, at.FACTS), dtype=np.int32))

    def is_open(self) -> bool:
        """Whether the line at hand may be tried: the state is one that the kernels know, and trying may pay."""
        if self._pause > 0:
            self._pause -= 1
            return False
        do, control = self._do, self._do.control
        state = control.state
        if do.run.failed is not None or control.writing or control.in_increments or control.settings.columns:
            return False
        if do.flow.frame.file is not do.file or do.flow.running.calls or control.has_figure:
            return False
        if state.motion not in _STRAIGHT or state.feed_mode != 940 or state.incremental:
            return False
        if state.side or state.held or state.comp_leaving or state.corner is not None or state.plane_begun is not None:
            return False
        return self._knows_directions()

    def _knows_directions(self) -> bool:
        """Whether the tool's length, and vectors if they are in force, mean what the kernels take them for."""
        control = self._do.control
        state, law = control.state, control.settings.tool_point
        if state.length_mode not in CENTRE_POINT:
            return not state.point_control
        if not state.point_control or law is None:
            return False
        return state.length_mode != BY_VECTOR or law.words_of(np.zeros((0, 3))) is not None

    def run(self, block: int, most: int) -> tuple[int, MoveBatch | None, tuple[ProgramFile, int]]:
        """Carry out at most `most` lines from the one at hand on, as far as the kernels know them.

        `block` is the number of the first one. Returns how many, the moves, and file and index of the last line.
        """
        do, frame, control = self._do, self._do.flow.frame, self._do.control
        state, first = control.state, self._do.flow.frame.at
        end, until = do.flow.running.part.end, do.settings.until
        end = end if until is None else min(end, until - 1)
        numbers, modes = self._state.numbers, self._state.modes
        per_length = _PER_INCH if state.unit == INCH else _PER_MM
        now = (*state.current[:6], state.feed, state.feed_unit, state.unit, per_length, _PER_DEGREE)
        numbers[: at.PER_ANGLE + 1] = now
        modes[:] = (state.motion, state.length_mode == BY_VECTOR, control.sequence)
        place = np.array([first, min(most, end - first), control.dialect.longest_line], dtype=np.int64)
        done = at.read_lines(self._text.data, self._text.starts, self._state, self._rows, place)
        self._judge(done)
        if done == 0:
            return 0, None, (frame.file, first)
        batch = self._batch(block - first, done)
        frame.at = first + done
        control.span, control.block_number = batch.span(done - 1), int(batch.block[-1])
        state.motion, control.sequence, state.cycle = int(modes[at.MOTION]), int(modes[at.SEQUENCE]), -1
        state.feed, state.feed_unit = float(numbers[at.FEED]), float(numbers[at.FEED_UNIT])
        return done, batch, (frame.file, first + done - 1)

    def _judge(self, lines: int) -> None:
        """Leave the line that stopped the run to the executor, after short runs some more."""
        if lines >= _SHORT_RUN or self._eager:
            self._next_pause = 1
        else:
            self._next_pause = min(2 * self._next_pause, _LONGEST_PAUSE)
        self._pause = self._next_pause

    def _batch(self, blocks_before: int, count: int) -> MoveBatch:
        """The moves of the last call, which are made."""
        control = self._do.control
        state = control.state
        values, facts = self._rows.values[:count].copy(), self._rows.facts[:count].copy()
        if self._state.modes[at.BY_VECTOR]:
            self._turn(values, facts[:, at.DIRECTED])
        points = values[:, :6]
        before = np.concatenate([[state.current[:6]], points[:-1]])
        moved = points != before
        linear = moved[:, :3].any(axis=1) | ~moved[:, 3:].any(axis=1)
        feed = values[:, at.FEED] * np.where(linear, values[:, at.FEED_UNIT], DEG) / MINUTE
        feeds = facts[:, at.KIND] == 1
        end = (points + np.array(state.g92[:6])) + np.array(state.origin[:6])
        scale = np.array([state.unit] * 3 + [DEG] * 3)
        state.current = (*points[-1].tolist(), *state.current[6:])
        none = np.zeros(count, dtype=np.int32)
        return MoveBatch(
            origins=((self._do.file.name, self._do.flow.frame.callers),),
            kind=facts[:, at.KIND].copy(),
            word=facts[:, at.KIND].copy(),
            end=end * scale,
            feed=np.where(feeds, feed, 0.0),
            rotary=feeds & ~linear,
            per_revolution=False,
            place=facts[:, at.LINE : at.END_COLUMN + 1] + np.array([1, 0, 0], dtype=np.int32),
            origin=none,
            block=facts[:, at.LINE] + np.int32(blocks_before),
            shapes=np.zeros((0, 8)),
            acts=np.zeros((0, 2), dtype=np.int32),
            path=control.path_mode(),
            dwell=0.0,
        )

    def _turn(self, values: Array, directed: NDArray[np.int32]) -> None:
        """Put the words that point the tool along I J K into rows with `directed` (n,)."""
        control = self._do.control
        state, law = control.state, control.settings.tool_point
        assert law is not None
        ways = np.zeros((len(values), 3))
        here = np.flatnonzero(directed)
        found = law.words_of(values[here, at.DIRECTION : at.DIRECTION + 3])
        assert found is not None
        ways[here] = found
        offset = control.si_axes(state.tool_offset)[3:]
        frame = np.array([state.current[3:6], state.g92[3:6], state.origin[3:6], offset, [DEG] * 3])
        points = np.ascontiguousarray(values[:, :6])
        at.turn_along(directed.astype(np.int64), ways, frame, points)
        values[:, 3:6] = points[:, 3:6]
