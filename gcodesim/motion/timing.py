"""The time law: how fast the pieces of a path are run under caps on speed and acceleration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend_kernels import CYCLE
from gcodesim.motion.look_ahead import LookAhead, known_of_last, queue_of
from gcodesim.motion.pieces import Pieces
from gcodesim.motion.sight_kernels import SeenCaps, within_sight
from gcodesim.motion.standing import Standstill
from gcodesim.motion.timing_kernels import PhaseColumns, end_speeds, times_at, trapezoids
from gcodesim.motion.tool_path import PathEvent
from gcodesim.motion.trajectory import Phases, TimedEvent, Trajectory

NO_CAP: Final = 1e30


@frozen(kw_only=False, eq=False)
class Softness:
    """What k segments allow a law of time with bounded `jerk` (k,), all along each of them.

    `calm` and `push` (k,) are the jerk and the acceleration allowed while the end of a segment is passed.
    """

    jerk: Array
    calm: Array
    push: Array

    def with_fixed(self, count: int, order: NDArray[np.intp]) -> Softness:
        """Those of more segments, put in `order`: `count` of them take a time of their own."""
        any_ = np.full(count, NO_CAP)
        columns = ((self.jerk, any_), (self.calm, any_), (self.push, any_))
        return Softness(*(np.concatenate(pair)[order] for pair in columns))


@frozen(kw_only=False, eq=False)
class Caps:
    """Caps on k segments of pieces, in the order of motion.

    A segment runs `piece` from `begin` over `length`; `speed` and
    `acceleration` hold all along it, `junction` at its end; with `soft` jerk is bounded too. A piece may be cut
    into many segments, as where joints of an arm have limits that change along it.
    """

    piece: NDArray[np.int64]
    begin: Array
    length: Array
    speed: Array
    acceleration: Array
    junction: Array
    soft: Softness | None = None

    @staticmethod
    def of(pieces: Pieces) -> Caps:
        """One segment for each piece, with the caps that blending found."""
        n = len(pieces)
        return Caps(np.arange(n), np.zeros(n), pieces.length, pieces.speed, pieces.acceleration, pieces.junction)


def time_law(
    pieces: Pieces,
    caps: Caps | None = None,
    duration_of: Callable[[PathEvent], float] | None = None,
    look_ahead: LookAhead | None = None,
) -> Trajectory:
    """The fastest run of `pieces` under `caps` (default: those of the pieces), from rest to rest.

    Speeds change along trapezoids: one backward and one forward pass over all segments. At the end of each piece the
    control must be able to come to rest over those that it knows by `look_ahead`; None: it knows them all. Events that
    last (`duration_of` [s]; default: dwells only) make the machine stand between rows.
    """
    caps = caps or Caps.of(pieces)
    if look_ahead is not None:
        caps = _within_sight(caps, pieces, look_ahead)
    duration_of = duration_of or Standstill()
    moving = _softly(caps, pieces.fixed[caps.piece]) if caps.soft is not None else _quickly(caps, pieces)
    rests = [(e.row, duration_of(e)) for e in pieces.path.events]
    phases, rest_start = _with_rests(moving, pieces, rests)
    row_start, row_end = _row_times(phases, pieces)
    times = _event_times(pieces, rest_start, row_start)
    events = tuple(
        TimedEvent(time=time, duration=seconds, row=e.row, event=e.event)
        for e, time, (_, seconds) in zip(pieces.path.events, times, rests, strict=True)
    )
    return Trajectory(pieces, phases, events, row_start[:-1], row_end)


def _within_sight(caps: Caps, pieces: Pieces, look_ahead: LookAhead) -> Caps:
    """`caps` for a control that knows no more than some pieces of the way ahead."""
    count = len(pieces)
    if look_ahead.corners_count and caps.soft is None and count > 1:
        pieces_before, most = known_of_last(
            pieces, caps.piece, 2.0 * np.minimum(caps.acceleration, NO_CAP) * caps.length
        )
        at = np.searchsorted(caps.piece, pieces_before, side="right") - 1
        lowered = caps.junction.copy()
        lowered[at] = np.minimum(lowered[at], most)
        caps = replace(caps, junction=lowered)
    if count <= look_ahead.blocks + 1:
        return caps
    last = np.searchsorted(caps.piece, np.arange(count), side="right") - 1
    queue = queue_of(pieces, last, caps.junction[last], look_ahead)
    jerk = np.zeros(len(caps.piece)) if caps.soft is None else caps.soft.jerk
    seen = (caps.length, caps.speed, caps.acceleration, jerk, caps.junction)
    columns = SeenCaps(*(np.ascontiguousarray(np.minimum(column, NO_CAP)) for column in seen))
    junction = within_sight(columns, queue, look_ahead.blocks)
    return replace(caps, junction=np.where(junction < NO_CAP, junction, caps.junction))


def _quickly(caps: Caps, pieces: Pieces) -> Phases:
    """Trapezoids of speed."""
    count = len(caps.piece)
    last = np.append(caps.piece[1:] != caps.piece[:-1], True)[:count]
    ratio = np.where(last, pieces.ratio[caps.piece], 1.0)
    fixed = pieces.fixed[caps.piece]
    ramped = pieces.ramped if count == len(pieces) else np.zeros(count, dtype=bool)
    start, end = end_speeds(caps.length, caps.speed, caps.acceleration, caps.junction, ratio, fixed)
    segment, duration, place, speed, acceleration = trapezoids(
        caps.length, caps.speed, caps.acceleration, start, end, fixed, ramped
    )
    return Phases(
        time=np.zeros(len(segment)),
        duration=duration,
        piece=caps.piece[segment],
        s=caps.begin[segment] + place,
        speed=speed,
        acceleration=acceleration,
        jerk=np.zeros(len(segment)),
        event=np.full(len(segment), -1, dtype=np.int64),
    )


def _softly(caps: Caps, fixed: NDArray[np.bool_]) -> Phases:
    """Speeds that change with bounded jerk. The pieces go over into each other at the same ds/dt."""
    from gcodesim.motion.soft_kernels import CHANGE, DURATION, JERK, PIECE, PLACE, SPEED, SoftCaps, soft_law

    assert caps.soft is not None

    def column(values: Array) -> Array:
        return np.ascontiguousarray(np.minimum(values, NO_CAP))

    table = soft_law(
        SoftCaps(
            piece=np.ascontiguousarray(caps.piece),
            begin=column(caps.begin),
            length=column(caps.length),
            speed=column(caps.speed),
            acceleration=column(caps.acceleration),
            jerk=column(caps.soft.jerk),
            calm=column(caps.soft.calm),
            push=column(caps.soft.push),
            junction=column(caps.junction),
            fixed=np.ascontiguousarray(fixed),
        ),
        CYCLE,
    )
    return Phases(
        time=np.zeros(len(table)),
        duration=table[:, DURATION].copy(),
        piece=table[:, PIECE].astype(np.int64),
        s=table[:, PLACE].copy(),
        speed=table[:, SPEED].copy(),
        acceleration=table[:, CHANGE].copy(),
        jerk=table[:, JERK].copy(),
        event=np.full(len(table), -1, dtype=np.int64),
    )


def _event_times(pieces: Pieces, rest_start: list[float], row_start: Array) -> list[float]:
    """When each event happens: at its own rest, at the next rest of the same row, or when its row starts."""
    times = [0.0] * len(rest_start)
    row, next_rest = -1, -1.0
    for i in range(len(rest_start) - 1, -1, -1):
        if pieces.path.events[i].row != row:
            row, next_rest = pieces.path.events[i].row, -1.0
        if rest_start[i] >= 0.0:
            next_rest = rest_start[i]
        times[i] = next_rest if next_rest >= 0.0 else float(row_start[row])
    return times


def _with_rests(moving: Phases, pieces: Pieces, rests: list[tuple[int, float]]) -> tuple[Phases, list[float]]:
    """Put phases of rest where events last, and run the clock; also the start of each rest, -1 where there is none."""
    lasting = [i for i, (_, seconds) in enumerate(rests) if seconds > 0.0]
    before_piece = np.searchsorted(pieces.row_first, [rests[i][0] for i in lasting])
    before = np.searchsorted(moving.piece, before_piece)
    held = np.maximum(before_piece - 1, 0)
    s_held = np.where(before_piece > 0, pieces.length[held], 0.0) if len(pieces) else np.zeros(len(lasting))
    count = len(lasting)
    still = Phases(
        time=np.zeros(count),
        duration=np.array([rests[i][1] for i in lasting], dtype=float),
        piece=held.astype(np.int64),
        s=s_held,
        speed=np.zeros(count),
        acceleration=np.zeros(count),
        jerk=np.zeros(count),
        event=np.array(lasting, dtype=np.int64),
    )
    phases = moving.insert(before, still)
    clock = np.cumsum(phases.duration)
    phases.time[:] = clock - phases.duration
    phases.time[1:] = clock[:-1]  # telescopes without rounding
    starts = [-1.0] * len(rests)
    for p in np.flatnonzero(phases.event >= 0):
        starts[phases.event[p]] = float(phases.time[p])
    return phases, starts


def _row_times(phases: Phases, pieces: Pieces) -> tuple[Array, Array]:
    """When each row starts (n + 1: then the end of all) and ends (n,); joints count half to each of their rows."""
    n = len(pieces.path)
    piece, s, row = _row_ends(pieces)
    moving = phases.event < 0
    ends = np.full(n, -1.0)
    if len(piece) and moving.any():
        ends[row] = times_at(
            piece,
            s,
            PhaseColumns(*(getattr(phases, name)[moving] for name in PhaseColumns._fields)),
        )
    # a row that does not move ends together with the row before it
    ends = np.maximum.accumulate(np.concatenate([[0.0], ends]))[1:]
    starts = np.concatenate([[0.0], ends])
    for p in np.flatnonzero(~moving):  # rests stand between the end of one row and the start of the next that moves
        at = pieces.path.events[int(phases.event[p])].row
        piece_after = int(np.searchsorted(pieces.row_first, at))
        row_after = int(pieces.row_first[piece_after]) if piece_after < len(pieces) else n
        until = phases.time[p] + phases.duration[p]
        starts[at : row_after + 1] = np.maximum(starts[at : row_after + 1], until)
        ends[at:row_after] = np.maximum(ends[at:row_after], until)
    return starts, ends


def _row_ends(pieces: Pieces) -> tuple[NDArray[np.int64], Array, NDArray[np.int64]]:
    """Where rows end: piece, s (infinite: at its end) and row, in the order of motion."""
    count = len(pieces)
    if not count:
        return np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0, dtype=np.int64)
    first, last = pieces.row_first.astype(np.int64), pieces.row_last.astype(np.int64)
    # ends within merged chords, in proportion to the programmed lengths
    inner_piece, inner_s, inner_row = pieces.inner_ends()
    joints = np.flatnonzero(pieces.joint)
    # pieces that end with their row: no joint piece follows
    plain = np.flatnonzero(~pieces.joint & np.append(~pieces.joint[1:], True))
    piece = np.concatenate([inner_piece, joints, plain])
    s = np.concatenate([inner_s, 0.5 * pieces.length[joints], np.full(len(plain), np.inf)])
    row = np.concatenate([inner_row, first[joints], last[plain]])
    order = np.argsort(row, kind="stable")
    return piece[order], s[order], row[order]
