"""The door to the compiled lane: state in, a batch of moves and the state after them out."""

from __future__ import annotations

import math
from functools import partial
from typing import Final, Literal, cast

import numpy as np

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.canon.batch import MoveBatch
from gcodesim.compiled import Kernel
from gcodesim.compiled.arguments import Argument, name_of
from gcodesim.compiled.object_code import is_kept
from gcodesim.diagnostics.span_table import Origin
from gcodesim.rs274.arcs import PLANE_AXES, allowed_miss
from gcodesim.rs274.compensation import Held, is_on
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects.dialect import Dialect
from gcodesim.rs274.ends import start_point
from gcodesim.rs274.flow import FlowControl
from gcodesim.rs274.plain import layout_kernels as at
from gcodesim.rs274.plain import waiting
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.execute_kernels import LaneRows, LaneState, LaneText, run_lines
from gcodesim.rs274.plain.program_state import ProgramState
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.units import DEG, INCH, MINUTE, RPM

MOST_MOVES: Final = 1 << 15
"""Rows of a batch; so much memory is in use at a time however long the program is."""

_MOST_LINES: Final = 1 << 18  # of one call, so that loops without moves meet the clock now and then
_SHORT_RUN = 6  # lines; below that the way through the door costs more than the lines by themselves
_LONGEST_PAUSE = 64
_WORTH_A_BATCH = 12  # moves; fewer are looked at faster one by one

_REALS, _WHOLE = Argument("f8", 1), Argument("i8", 1)
_TAKES: Final = (
    Argument(parts=(Argument("u1", 1, readonly=True), _WHOLE), named=name_of(LaneText) or ""),
    Argument(parts=(_REALS, _WHOLE, _REALS, _WHOLE), named=name_of(LaneState) or ""),
    Argument(
        parts=(Argument("f8", 2), Argument("i4", 2), Argument("f8", 2), Argument("i4", 2)),
        named=name_of(LaneRows) or "",
    ),
    *[Argument("i8")] * 3,
)
"""What `run_lines` is called with."""
_PECK, _DWELL = {"q": at.CYCLE_Q}, {"p": at.CYCLE_P}
_WORDS_OF_SOME: Final = {730: _PECK, 830: _PECK, 820: _DWELL, 890: _DWELL}
_KNOWN_LETTERS: Final = "abcfgijkpqrsxyz"  # what the kernels make something of
_DIRECTIONS: Final[tuple[Literal["ccw", "off", "cw"], ...]] = ("ccw", "off", "cw")
_KNOWN_USERS: Final = frozenset(("g2", "g3", "g73", "g82", "g83", "g89"))  # codes of theirs that take some letters
_KNOWN_CYCLES: Final = frozenset((730, 810, 820, 830, 850, 890))


def is_ready() -> bool:
    """Whether the lane can be opened without compiling it."""
    return is_kept(cast(Kernel, run_lines), _TAKES)


class PlainLane:
    """Executes the lines of a program that the kernels know, of at most `longest` characters.

    `eager` tries every line, whether it may pay or not.
    """

    def __init__(self, control: Control, flow: FlowControl, longest: int, *, eager: bool = False) -> None:
        self._control, self._flow, self._longest = control, flow, longest
        self._eager = eager
        self.worth_a_batch = 0 if eager else _WORTH_A_BATCH
        self._pause, self._next_pause = 0, 1
        self._numbers, self._modes = np.zeros(at.NUMBERS), np.zeros(at.MODES, dtype=np.int64)
        self._moves = np.empty((MOST_MOVES, at.MOVE))
        self._facts = np.empty((MOST_MOVES, at.FACTS), dtype=np.int32)
        self._shapes = np.empty((MOST_MOVES, at.SHAPE))
        self._acts = np.empty((MOST_MOVES, 2), dtype=np.int32)
        self._program = ProgramState(control, flow, self._modes, self._numbers)
        _write_dialect(control.dialect, self._modes)
        self._bind()

    def _bind(self) -> None:
        program = self._program
        self._run = partial(
            run_lines,
            LaneText(program.text.data, program.text.starts),
            LaneState(self._numbers, self._modes, program.memory, program.tables),
            LaneRows(self._moves, self._facts, self._shapes, self._acts),
        )

    def is_open(self) -> bool:
        """Whether the line at hand may be tried: the state is one that the kernels know, and trying may pay."""
        if self._pause > 0:
            self._pause -= 1
            return False
        state = self._control.state
        if state.comp_leaving or state.nurbs_order or state.diameter or state.point_control or self._program.is_full:
            return False
        return waiting.is_known(state) if is_on(self._control) else not state.held

    def run(self, block: int, most: int) -> tuple[int, MoveBatch | None, tuple[ProgramFile, int]]:
        """Execute at most `most` lines from the one at hand on, as far as the kernels know them.

        `block` is the number of the first one. Returns how many, the moves, and file and index of the last line.
        """
        control, flow, program = self._control, self._flow, self._program
        if program.add_files():
            self._bind()
        program.write()
        first = program.text.base_of(flow.frame.file) + flow.frame.at
        beside = is_on(control)
        _write_state(control, self._numbers, self._modes)
        if beside:
            (move,) = control.state.held
            assert type(move) is Held
            origin = program.chain((move.span.file, move.span.callers))
            line = program.placed(origin)[1] + move.span.line
            waiting.write(control.state, self._numbers, self._modes, line, origin)
        self._modes[at.PLACE + 3] = block
        done = self._run(first, min(most, _MOST_LINES), self._longest)
        if self._modes[at.FLOWS] == at.FLOWS_WANTED:
            program.find_flows()
            self._bind()
            if done == 0:
                return self.run(block, most)
        self._judge(done)
        if done == 0:
            return 0, None, (flow.frame.file, flow.frame.at)
        last = program.take_over()
        _take_over(control, self._numbers, self._modes)
        if beside:
            waiting.take_over(control.state, self._numbers, self._modes, program.placed)
        return done, self._batch() if self._modes[at.ROWS] else None, last

    def _batch(self) -> MoveBatch:
        """The rows of the last call."""
        rows, arcs, acts = self._modes[at.ROWS : at.ACTS + 1].tolist()
        moves, facts = self._moves[:rows].copy(), self._facts[:rows].copy()
        origins, origin = self._origins(facts)
        spindle = self._control.state.spindle
        direction = (spindle > 0) - (spindle < 0)
        return MoveBatch(
            origins=origins,
            kind=facts[:, at.KIND],
            word=facts[:, at.WORD],
            end=moves[:, :6],
            feed=moves[:, 6],
            rotary=facts[:, at.ROTARY] != 0,
            per_revolution=self._control.state.feed_mode == 950,
            place=facts[:, at.LINE : at.LINE + 3],
            origin=origin,
            block=facts[:, at.LINE + 3],
            shapes=self._shapes[:arcs].copy(),
            acts=self._acts[:acts].copy(),
            path=self._control.path_mode(),
            dwell=float(self._numbers[at.CYCLE_P]),
            speed=moves[:, at.MOVE_SPEED] * (RPM if direction else 0.0) if self._modes[at.S_SAID] else None,
            direction=_DIRECTIONS[direction + 1],
        )

    def _origins(self, facts: Column) -> tuple[tuple[Origin, ...], Column]:
        """Files and chains of callers of the moves, and which each move has; makes line numbers of indices."""
        chains, place = facts[:, at.LINE + 4], facts[:, at.LINE]
        if (chains == chains[0]).all():
            origin, before_first = self._program.placed(int(chains[0]))
            place -= before_first
            chains[:] = 0
            return (origin,), chains
        known: dict[Origin, int] = {}
        numbers, which = np.unique(chains, return_inverse=True)
        placed = [self._program.placed(number) for number in numbers.tolist()]
        place -= np.array([before_first for _, before_first in placed], dtype=np.int32)[which]
        chains[:] = np.array([known.setdefault(origin, len(known)) for origin, _ in placed], dtype=np.int32)[which]
        return tuple(known), chains

    def _judge(self, lines: int) -> None:
        """Leave the line that stopped the run to the other lane, after short runs some more."""
        if lines >= _SHORT_RUN or self._eager:
            self._next_pause = 1
        else:
            self._next_pause = min(2 * self._next_pause, _LONGEST_PAUSE)
        self._pause = self._next_pause


def _write_dialect(dialect: Dialect, modes: Column) -> None:
    """What the kernels have to know of it."""
    known = [
        letter
        for letter in _KNOWN_LETTERS
        if letter == "g"
        or (letter in dialect.letters and not _KNOWN_USERS.isdisjoint(dialect.users.get(letter, _KNOWN_USERS)))
    ]
    modes[at.PLAIN_LETTERS] = sum(1 << (ord(letter) - ord("a")) for letter in known)
    modes[at.COMPUTES : at.BY_START + 1] = (
        dialect.computes,
        not _KNOWN_CYCLES.isdisjoint(dialect.g_groups),
        dialect.arcs_name_axes,
        dialect.arc_miss is not None,
    )


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
        cos(turn), sin(turn), state.unit, state.feed, state.feed_unit, DEG, MINUTE,
        state.cycle_start, words.get("r", 0.0), words.get(depth, 0.0), words.get("q", 0.0), words.get("p", 0.0),
    )  # fmt: skip
    numbers[at.CYCLE_DWELL], modes[at.RUNNING] = state.cycle_dwell, state.cycle
    numbers[at.ARC_ALWAYS : at.ARC_MOST + 1] = allowed_miss(control)
    numbers[at.SPEED], modes[at.TAKES_S] = state.speed, state.speed != 0.0 and not state.surface_speed
    beside = is_on(control)
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
    cycle = int(modes[at.CYCLE])
    if cycle >= 0:
        words = {} if modes[at.STARTED] else dict(state.cycle_words)
        places = {"xyz"[PLANE_AXES[plane][2]]: at.CYCLE_DEPTH, "r": at.CYCLE_R, **_WORDS_OF_SOME.get(cycle, {})}
        state.cycle_words = tuple((words | {letter: float(numbers[place]) for letter, place in places.items()}).items())
    state.cycle, state.cycle_start = int(modes[at.RUNNING]), float(numbers[at.CYCLE_START])
    state.cycle_dwell = float(numbers[at.CYCLE_DWELL])
    state.retract = 990 if modes[at.RETRACT_TO_R] else 980
    if not is_on(control):
        state.current = (*current, *state.current[6:])
    state.feed, state.feed_unit = float(numbers[at.FEED]), float(numbers[at.FEED_UNIT])
    if modes[at.S_SAID]:
        state.speed, state.speed_unit = float(numbers[at.SPEED]), state.unit
    state.motion, state.plane = motion, plane
    state.incremental, state.centre_absolute = bool(incremental), bool(centre_absolute)
