"""`Trajectory`: pieces with a time law, and the events that happen between them."""

from __future__ import annotations

from dataclasses import fields
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import Event, ToolChange
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.course import Course
from gcodesim.motion.filament import Filament
from gcodesim.motion.pieces import Pieces
from gcodesim.motion.tool_path import HOME, RAPID, ToolPath


@frozen(kw_only=False, eq=False)
class Phases:
    """p stretches of constant jerk, one after the other; without jerk, of constant acceleration.

    From `time` on for `duration` [s], at place `s` of `piece`, ds/dt starts at
    `speed` and changes by `acceleration`, and that by `jerk`. `event` is -1 while the machine moves,
    else the index of the event for which it stands.
    """

    time: Array
    duration: Array
    piece: NDArray[np.int64]
    s: Array
    speed: Array
    acceleration: Array
    jerk: Array
    event: NDArray[np.int64]

    def insert(self, before: NDArray[np.intp], other: Phases) -> Phases:
        """A copy with rows of `other` put in front of rows `before`."""
        return Phases(*(np.insert(getattr(self, name), before, getattr(other, name)) for name in Phases.names()))

    @staticmethod
    def names() -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(column.name for column in fields(Phases))


@frozen
class TimedEvent:
    """`event` happens at `time` [s], before row `row` begins, and takes `duration` [s]."""

    time: float
    duration: float
    row: int
    event: Event


@frozen
class Totals:
    """Where the time [s] goes and how far [m] the control point is programmed to move; times add up to the duration."""

    feed: float
    rapid: float
    dwell: float
    tool_change: float
    feed_distance: float
    rapid_distance: float


@frozen(eq=False)
class Samples:
    """The trajectory at n times.

    `position`, `velocity` (n, 6) of the controlled point in M [m, rad, and per
    s]; `piece`, and `s` and `fraction` in 0…1 along it; `row` of the path that
    is run; `speed` ds/dt [m/s, of pieces of rotary axes alone rad/s]; `event`
    for which the machine stands, -1 while it moves.
    """

    time: Array
    position: Array
    velocity: Array
    piece: NDArray[np.int64]
    s: Array
    fraction: Array
    row: NDArray[np.int64]
    speed: Array
    event: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.time)

    def at(self, which: NDArray[np.int64]) -> Samples:
        """Those with the numbers `which` (k,)."""
        return Samples(**{column.name: getattr(self, column.name)[which] for column in fields(Samples)})


class Rates(NamedTuple):
    """What is known of a trajectory at n times without its places: see `Samples`."""

    row: NDArray[np.int64]
    event: NDArray[np.int64]
    speed: Array


@frozen(slots=False, kw_only=False, eq=False)
class Trajectory:
    """Where the control point is at any time; `row_start`, `row_end` (n,) [s] are the times of every row of the path.

    Between the end of a row and the start of the next one the machine stands
    for events. Rows and rests together make up the duration.
    """

    pieces: Pieces
    phases: Phases
    events: tuple[TimedEvent, ...]
    row_start: Array
    row_end: Array

    @property
    def path(self) -> ToolPath:
        return self.pieces.path

    @cached_property
    def duration(self) -> float:
        """Seconds from the start to the end of the last move or event."""
        return float(self.phases.time[-1] + self.phases.duration[-1]) if len(self.phases.time) else 0.0

    @property
    def duration_ns(self) -> int:
        """Duration in whole nanoseconds."""
        return round(self.duration * 1e9)

    @cached_property
    def row_ns(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Start and end of every row in whole nanoseconds: durations of rows and rests add up exactly."""
        return np.rint(self.row_start * 1e9).astype(np.int64), np.rint(self.row_end * 1e9).astype(np.int64)

    @property
    def row_time(self) -> Array:
        """Seconds that each row takes (n,)."""
        return self.row_end - self.row_start

    @property
    def totals(self) -> Totals:
        """Time and distance by kind; every stop that is not a tool change counts as a dwell."""
        rapid = np.isin(self.path.kind, (RAPID, HOME))
        time, way = self.row_time, self.path.length
        changes = sum(e.duration for e in self.events if isinstance(e.event, ToolChange))
        return Totals(
            feed=float(time[~rapid].sum()),
            rapid=float(time[rapid].sum()),
            dwell=sum(e.duration for e in self.events) - changes,
            tool_change=changes,
            feed_distance=float(way[~rapid].sum()),
            rapid_distance=float(way[rapid].sum()),
        )

    @cached_property
    def filament(self) -> Filament | None:
        """What leaves the nozzles of a printer; None where no E word moves any."""
        return Filament.of(self.path, self.events)

    def filament_between(self, samples: Samples) -> Array | None:
        """How much (n - 1,) [m] of it does so between consecutive samples (n,)."""
        return None if self.filament is None or not len(samples) else self.filament.between(samples, self.pieces)

    def sample(self, t: Array) -> Samples:
        """The trajectory at times `t` (n,) [s], in any order; times outside are held at the ends."""
        t = np.ascontiguousarray(t, dtype=float)
        if not len(self.phases.time):
            return self._nothing(t)
        from gcodesim.motion.piece_kernels import sample
        from gcodesim.motion.timing_kernels import PhaseColumns

        p, phase = self.phases, self._phases_at(t)
        pieces = self._pieces_or_rest
        position, velocity, s, speed = sample(
            t,
            phase,
            PhaseColumns(p.time, p.duration, p.piece, p.s, p.speed, p.acceleration, p.jerk),
            pieces.arrays,
            pieces.curves.arrays,
        )
        piece = p.piece[phase]
        outside = (t < 0.0) | (t > self.duration)
        velocity[outside] = 0.0
        speed[outside] = 0.0
        event = p.event[phase]
        return Samples(
            time=t,
            position=position,
            velocity=velocity,
            piece=piece,
            s=s,
            fraction=s / np.maximum(pieces.length[piece], 1e-300),
            row=self._rows_at(t, event),
            speed=speed,
            event=event,
        )

    def rows_at(self, t: Array) -> NDArray[np.int64]:
        """The rows of `sample(t)`, without the rest of it."""
        if not len(self.phases.time):
            return np.zeros(len(t), dtype=np.int64)
        return self._rows_at(t, self.phases.event[self._phases_at(t)])

    def rates(self, t: Array) -> Rates:
        """Row, event and speed of `sample(t)`, to the same bits, without the places."""
        if not len(self.phases.time):
            none = np.zeros(len(t), dtype=np.int64)
            return Rates(row=none, event=none - 1, speed=np.zeros(len(t)))
        p, phase = self.phases, self._phases_at(t)
        tau = np.minimum(np.maximum(t - p.time[phase], 0.0), p.duration[phase])
        speed = np.maximum(p.speed[phase] + p.acceleration[phase] * tau + 0.5 * p.jerk[phase] * tau * tau, 0.0)
        speed[(t < 0.0) | (t > self.duration)] = 0.0
        event = p.event[phase]
        return Rates(row=self._rows_at(t, event), event=event, speed=speed)

    def _phases_at(self, t: Array) -> NDArray[np.int64]:
        """The phases that last at times `t` (n,)."""
        time = self.phases.time
        phases: NDArray[np.int64] = np.clip(np.searchsorted(time, t, side="right") - 1, 0, len(time) - 1)
        return phases

    def _rows_at(self, t: Array, event: NDArray[np.int64]) -> NDArray[np.int64]:
        """Rows run at times `t` (n,); while the machine stands, the row that the event (n,) comes before."""
        last = max(len(self.row_end) - 1, 0)
        row = np.minimum(np.searchsorted(self.row_end, t, side="right"), last)
        if self.events and (event >= 0).any():
            row = np.where(event >= 0, np.minimum(self._event_rows[event], last), row)
        return row.astype(np.int64)

    @cached_property
    def _event_rows(self) -> NDArray[np.int64]:
        return np.array([event.row for event in self.events], dtype=np.int64)

    def boundaries(self, t0: float, t1: float) -> Array:
        """Times strictly between `t0` and `t1` at which a piece ends or a rest begins or ends."""
        times = self._piece_ends
        return times[np.searchsorted(times, t0, side="right") : np.searchsorted(times, t1, side="left")]

    @cached_property
    def _piece_ends(self) -> Array:
        p = self.phases
        change = (p.piece[1:] != p.piece[:-1]) | (p.event[1:] != p.event[:-1])
        ends: Array = p.time[1:][change]
        return ends

    def along_lines(self, times: Array) -> NDArray[np.bool_]:
        """Whether it goes along lines alone between consecutive `times` (n + 1,): (n,)."""
        if not len(self.phases.time):
            return np.ones(len(times) - 1, dtype=bool)
        piece = self.phases.piece[self._phases_at(times)]
        count = self._others_than_lines
        line: NDArray[np.bool_] = count[piece[1:] + 1] == count[piece[:-1]]
        return line

    @cached_property
    def _others_than_lines(self) -> NDArray[np.int64]:
        """How many pieces before each, and in all, are no parts of lines."""
        return np.concatenate([[0], np.cumsum(~self._pieces_or_rest.are_lines)])

    @cached_property
    def _pieces_or_rest(self) -> Pieces:
        """The pieces; for a path that only waits, one piece at its start."""
        return self.pieces if len(self.pieces) else self.pieces.resting()

    @cached_property
    def course(self) -> Course:
        """Which way its path goes."""
        return Course(self._pieces_or_rest)

    def _nothing(self, t: Array) -> Samples:
        n = len(t)
        start = self.path.start[0] if len(self.path) else np.zeros(6)
        zeros, none = np.zeros(n), np.zeros(n, dtype=np.int64)
        return Samples(
            time=t,
            position=np.tile(start, (n, 1)),
            velocity=np.zeros((n, 6)),
            piece=none,
            s=zeros,
            fraction=zeros,
            row=none,
            speed=zeros,
            event=none - 1,
        )
