"""From canonical events to a `ToolPath`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from math import copysign, pi

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied
from gcodesim.canon import (
    Action,
    ArcFeed,
    Axes,
    Coolant,
    Dwell,
    Event,
    Extrude,
    LinearFeed,
    Log,
    Message,
    Move,
    Output,
    Override,
    PathMode,
    PlannerLimits,
    PointControl,
    Print,
    ProbeMove,
    Rapid,
    SectionStart,
    Spindle,
    SplineFeed,
    Tap,
    ToolChange,
    ToolNumber,
    ToolOffset,
    ToolSelect,
    WorkSystem,
)
from gcodesim.canon.batch import EXACT, S_WORD, MoveBatch
from gcodesim.canon.batch import RAPID as RAPID_MOVE
from gcodesim.diagnostics import Span
from gcodesim.frames import Pose
from gcodesim.motion import pace
from gcodesim.motion.rows import PathRows, Tags
from gcodesim.motion.tool_path import (
    ARC,
    BLEND,
    EXACT_PATH,
    EXACT_STOP,
    HOME,
    LINE,
    RAPID,
    ZERO,
    Commanded,
    PathEvent,
    ToolPath,
    ToolState,
)

_SIGNS = {"cw": 1.0, "ccw": -1.0, "off": 0.0}
_MODES = {"exact_stop": EXACT_STOP, "exact_path": EXACT_PATH, "blend": BLEND}

# Events for which the machine does not stop; all others wait for the end of motion, as in LinuxCNC's task.
_PASSED = (Message, Print, Log, Override, PathMode, ToolSelect, PlannerLimits, SectionStart)


def build_tool_path(
    events: Iterable[Event | MoveBatch],
    start: Axes = ZERO,
    *,
    path_control: PathMode | None = None,
    tilts: Mapping[int, Pose] | None = None,
    rapids_stand: bool = False,
    only_changes_stop: bool = False,
) -> ToolPath:
    """The moves of `events` as columns.

    `start` is where the controlled point is at first [m, rad]; `path_control`
    holds until the program's own (default: blend without tolerance). `tilts`
    maps a work system to a pose whose R tilts it about its p: a point q of that
    system becomes p + R (q - p), as on an arm whose G54 is not upright. Moves
    in machine coordinates (G53, G28, G30) are not tilted. `rapids_stand` and `only_changes_stop` as of a dialect.
    """
    builder = PathBuilder(start, path_control, tilts, rapids_stand=rapids_stand, only_changes_stop=only_changes_stop)
    for event in events:
        builder.add(event)
    return builder.leg()


class PathBuilder:
    """Builds a path event by event, or leg by leg: each leg goes on in the state in which the one before ended."""

    def __init__(
        self,
        start: Axes = ZERO,
        path_control: PathMode | None = None,
        tilts: Mapping[int, Pose] | None = None,
        *,
        fastest: float | None = None,
        centre: float = 0.0,
        length_leans: bool = False,
        rapids_stand: bool = False,
        power_goes_along: bool = False,
        only_changes_stop: bool = False,
    ) -> None:
        """`fastest` [rad/s] is the greatest speed of a lathe's spindle, where the work turns about the X `centre` [m].

        `fastest` is None on other machines.

        `length_leans`: length offsets are along the axes of a work system that leans, as an arm holds its tool.
        `power_goes_along`: an S beside a move does not stop the machine, as in the laser mode of grbl 1.1.
        `only_changes_stop`: see `Dialect`.
        """
        self.power_goes_along = power_goes_along
        self.only_changes_stop = only_changes_stop
        self._asked: Span | None = None  # where an S stands that stops the machine, unless its block makes a move
        self._direction = "off"
        self.fastest = fastest
        self.centre = centre
        self.length_leans = length_leans
        self.rapids_stand = rapids_stand
        self.at: Axes = start
        self.first = start
        self.tilts = tilts or {}
        self.tags = Tags(BLEND, 0.0, 0.0, False)
        if path_control is not None:
            self._path_mode(path_control)
        self.spindle_speed = 0.0  # |S| [rad/s], kept while the spindle stands
        self.current = ToolState()
        self.states: dict[ToolState, int] = {}
        self.state = -1  # -1: not yet in `states`
        self.events: list[PathEvent] = []
        self.rows = PathRows()
        self.legs = 0

    def add(self, event: Event | MoveBatch) -> None:
        if self._asked is not None:
            self._settle_stop(event)
        if type(event) is LinearFeed:
            self._linear(event)
        elif type(event) is MoveBatch:
            self._batch(event)
        elif isinstance(event, Move):
            self._motion(event)
        elif isinstance(event, Event):
            self._other(event)

    def _settle_stop(self, event: Event | MoveBatch) -> None:
        """Stop for an S, now that its block is seen to make no move."""
        if isinstance(event, MoveBatch) or event.span != self._asked:
            self._stand()
            self._asked = None
        elif isinstance(event, Move):
            self._asked = None

    def _batch(self, batch: MoveBatch) -> None:
        if self.tilts or (self.fastest is not None and self.current.surface_speed > 0.0):
            for event in batch.events():
                self.add(event)
            return
        first, tags = len(self.rows), self.tags
        state: int | NDArray[np.int32]
        turns: Iterator[tuple[float, float]] = iter(())
        if batch.speed is not None:
            state, turns = self._states_at_speeds(batch)
        else:
            state = self._states_between(batch) if batch.between else self._states_of(batch.word)
        feed = batch.feed * self._revolutions() if batch.per_revolution else batch.feed
        if not batch.kind.all():
            feed = np.where(batch.kind == RAPID_MOVE, np.inf, feed)
        exact = None
        if len(batch.acts):
            exact = np.zeros(len(batch) + 1, dtype=np.int8)
            for row, what in batch.acts.tolist():
                event = batch.act(row, what)
                turn = next(turns) if what == S_WORD else None
                if isinstance(event, PathMode):
                    exact[row] += 1 if what == EXACT else -1
                elif self._stands_for(event, turn):
                    self.rows.stop_at(first + row - 1)
                self.events.append(PathEvent(first + row, event, turn))
            exact = np.cumsum(exact[:-1], dtype=np.int8).astype(bool)
            if exact.any():
                self._path_mode(batch.path)
                within = self.tags
                tags = Tags(
                    np.where(exact, EXACT_PATH, tags.mode),
                    np.where(exact, 0.0, tags.tolerance),
                    np.where(exact, 0.0, tags.naive),
                    within.active,
                )
        self.rows.add_batch(batch, feed=feed, state=state, tags=tags)
        if self.rapids_stand:
            self.rows.stop_at(*(first + np.flatnonzero(batch.kind == RAPID_MOVE)).tolist())
        self.at = tuple(batch.end[-1].tolist())

    def _stands_for(self, event: Dwell | Spindle, turn: tuple[float, float] | None) -> bool:
        """Whether the machine stops for what happens between two moves of a batch; `turn` as of its `PathEvent`."""
        if isinstance(event, Dwell):
            return event.seconds > 0.0
        repeats = self.only_changes_stop and turn is not None and turn[0] == turn[1]
        return not (self.power_goes_along or repeats)

    def _repeats(self, event: Event) -> bool:
        """Whether a word for spindle or coolant says what holds already, and the control goes on for that."""
        if not self.only_changes_stop:
            return False
        if isinstance(event, Spindle):
            off = event.direction == "off"
            return event.direction == self._direction and (off or event.speed == self.spindle_speed)
        return isinstance(event, Coolant) and (event.flood, event.mist) == (self.current.flood, self.current.mist)

    def _states_of(self, words: NDArray[np.int32]) -> int | NDArray[np.int32]:
        """The index of the tool state of each row, or of all, by the numbers of their motion words."""
        numbers, first = np.unique(words, return_index=True) if (words != words[0]).any() else (words[:1], [0])
        if len(numbers) == 1:
            return self._state_with(f"G{words[0]}")
        states = np.zeros(int(numbers[-1]) + 1, dtype=np.int32)
        for number in numbers[np.argsort(first)].tolist():
            states[number] = self._state_with(f"G{number}")
        self._state_with(f"G{words[-1]}")
        return states[words]

    def _states_at_speeds(self, batch: MoveBatch) -> tuple[NDArray[np.int32], Iterator[tuple[float, float]]]:
        """The states of the rows of a batch with S words, and what the spindle turns at before and after each."""
        assert batch.speed is not None
        said = batch.acts[batch.acts[:, 1] == S_WORD, 0]
        spindle = np.append(self.current.spindle, _SIGNS[batch.direction] * batch.speed[said] + 0.0)
        stretch = np.searchsorted(said, np.arange(len(batch)), side="right")
        _, alike = np.unique(spindle, return_inverse=True)
        kinds = alike[stretch] * (int(batch.word.max()) + 1) + batch.word
        _, first, which = np.unique(kinds, return_index=True, return_inverse=True)
        states = np.empty(len(first), dtype=np.int32)
        for kind in [*np.argsort(first).tolist(), which[-1]]:
            row = first[kind]
            self._set(replace(self.current, spindle=float(spindle[stretch[row]])))
            states[kind] = self._state_with(f"G{batch.word[row]}")
        self.spindle_speed = abs(float(spindle[-1]))
        turning = np.copysign(2.0 * pi * (np.abs(spindle) / (2.0 * pi)), spindle).tolist()
        return states[which], pairwise(turning)

    def _states_between(self, batch: MoveBatch) -> NDArray[np.int32]:
        """The states of the rows of a batch in which sections begin and filament moves alone."""
        first, begin = len(self.rows), 0
        states = np.empty(len(batch), dtype=np.int32)
        for row, event in batch.between:
            if row > begin:
                states[begin:row] = self._states_of(batch.word[begin:row])
                begin = row
            if isinstance(event, SectionStart):
                self._set(replace(self.current, section=event.section))
            elif isinstance(event, Extrude):
                self.rows.stop_at(first + row - 1)
                self.events.append(PathEvent(first + row, event))
        if begin < len(batch):
            states[begin:] = self._states_of(batch.word[begin:])
        return states

    def _linear(self, event: LinearFeed) -> None:
        if event.pitch is not None:
            self._stand()  # waits for the spindle's angle
            self._row(LINE, event, event.end, event.pitch * self._revolutions(), False)
        else:
            if self._paced(event):
                for end, feed in pace.along_line(self.at, event.end, event.feed, self._pace()):
                    self._row(LINE, event, end, feed, False)
                return
            self._row(
                LINE,
                event,
                event.end,
                self._speed(event.feed, event.feed_unit),
                event.feed_unit[0] == "r",
                event.extrude,
            )

    def _paced(self, event: LinearFeed | ArcFeed) -> bool:
        """Whether the feed changes on the way, since it is per turn of a spindle that keeps the cutting speed."""
        return (
            self.fastest is not None
            and self.current.surface_speed > 0.0
            and event.feed_unit == "m/rev"
            and event.end[0] != self.at[0]
        )

    def _pace(self) -> pace.Pace:
        return pace.Pace(surface=self.current.surface_speed, cap=abs(self.current.spindle), centre=self.centre)

    def _motion(self, event: Move) -> None:
        if isinstance(event, Rapid):
            self._row(HOME if event.home else RAPID, event, event.end, np.inf, False)
            if self.rapids_stand:
                self._stand()
        elif isinstance(event, ArcFeed) and self._paced(event) and not self.tilts:
            for end, sweep, feed in pace.along_arc(self.at, event, self._pace()):
                self.rows.shape(event.center, event.normal, sweep)
                self._row(ARC, event, end, feed, False)
        elif isinstance(event, ArcFeed):
            center, normal = event.center, event.normal
            tilt = self._tilt(event)
            if tilt is not None:
                center = tuple(tilt.p + applied(tilt.R, np.array(center) - tilt.p))
                normal = tuple(applied(tilt.R, np.array(normal)))
            self.rows.shape(center, normal, event.sweep)
            feed = self._speed(event.feed, event.feed_unit)
            self._row(ARC, event, event.end, feed, event.feed_unit[0] == "r", event.extrude)
        elif isinstance(event, SplineFeed):
            feed = self._speed(event.feed, event.feed_unit)
            for point in event.points:
                if point != self.at[:3]:
                    self._row(LINE, event, (*point, *event.end[3:]), feed, False)
        elif isinstance(event, ProbeMove):
            self._stand()
            self.events.append(PathEvent(len(self.rows), event))
            self._row(LINE, event, event.end, self._speed(event.feed, event.feed_unit), event.feed_unit[0] == "r")
            self._stand()
        elif isinstance(event, Tap):
            self._tap(event)

    def _tap(self, event: Tap) -> None:
        top, feed, cutting = self._untilted, event.pitch * self._revolutions(), self.current
        self._stand()
        self._row(LINE, event, event.end, feed, False)
        self._stand()
        self._set(replace(cutting, spindle=-cutting.spindle))
        self._row(LINE, event, top, feed, False)
        self._stand()
        self._set(cutting)

    def _other(self, event: Event) -> None:
        now, turns, goes_along, repeats = self.current, None, False, self._repeats(event)
        if isinstance(event, PathMode):
            self._path_mode(event)
        elif isinstance(event, Spindle):
            before = self._turning()
            sign = _SIGNS[event.direction]
            surface = event.unit == "m/s"
            most = self.fastest or 0.0
            cap = min(event.max_speed or most, most or event.max_speed or 0.0)
            self.spindle_speed = cap if surface else event.speed
            surface_speed = event.speed if surface and sign else 0.0
            self._set(replace(now, spindle=sign * self.spindle_speed + 0.0, surface_speed=surface_speed))  # no -0
            turns = (before, self._turning())
            goes_along = self.power_goes_along and event.direction == self._direction
            self._direction = event.direction
        elif isinstance(event, Coolant):
            self._set(replace(now, flood=event.flood, mist=event.mist))
        elif isinstance(event, ToolChange | ToolNumber):
            self._set(replace(now, tool=event.tool))
        elif isinstance(event, ToolOffset):
            self._offset(event.offset)
        elif isinstance(event, PointControl):
            self._set(replace(now, control=Commanded.POINT if event.on else Commanded.AXES))
            if event.at != self.at:
                self.at = event.at
                self.rows.jump(self.at)
        elif isinstance(event, WorkSystem):
            self._set(
                replace(
                    now,
                    system=event.index,
                    system_offset=event.offset,
                    g92=event.g92,
                    rotation=event.rotation,
                    axes=event.axes,
                )
            )
        elif isinstance(event, PlannerLimits):
            self._set(replace(now, limits=event.limits))
        elif isinstance(event, SectionStart):
            self._set(replace(now, section=event.section))
            return
        elif isinstance(event, Action) and event.target == "tool":
            self.tags = self.tags._replace(active=event.verb == "activate")
        passed = repeats or isinstance(event, _PASSED) or (isinstance(event, Output) and event.with_motion)
        if goes_along and not repeats:
            self._asked = event.span
        elif not passed and not (isinstance(event, Dwell) and event.seconds <= 0.0):
            self._stand()
        self.events.append(PathEvent(len(self.rows), event, turns))

    def _turning(self) -> float:
        """What the spindle turns at here [rad/s], signed."""
        return copysign(2.0 * pi * self._revolutions(), self.current.spindle)

    def _path_mode(self, event: PathMode) -> None:
        # P alone also merges; without P nothing is merged unless Q says so
        naive = event.naive or event.tolerance
        self.tags = Tags(_MODES[event.mode], event.tolerance, naive, self.tags.active)

    def _offset(self, offset: Axes) -> None:
        """The axes stay where they are, so the controlled point jumps against the change of offset."""
        old = self.current.offset
        step = np.array(old) - np.array(offset)
        self._set(replace(self.current, offset=offset))
        if not step.any():
            return
        tilt = self.tilts.get(self.current.system)
        if tilt is not None:
            step[:3] = applied(tilt.R, step[:3])
        if self.length_leans and self.current.axes is not None:
            step[:3] = applied(np.array(self.current.axes), step[:3])
        self.at = tuple(float(v) for v in np.array(self.at) + step)  # type: ignore[assignment]
        self.rows.jump(self.at)

    def _set(self, state: ToolState) -> None:
        if state != self.current:
            self.current, self.state = state, -1

    def _stand(self) -> None:
        self.rows.stop()

    def _revolutions(self) -> float:
        """Spindle speed [rev/s]; 0 when it stands. On a lathe that keeps the cutting speed, the one at this radius."""
        if self.fastest is not None and self.current.surface_speed > 0.0:
            return self._pace().turns(abs(self.at[0] - self.centre))
        return abs(self.current.spindle) / (2.0 * pi)

    def _speed(self, feed: float, unit: str) -> float:
        return feed * self._revolutions() if unit.endswith("rev") else feed

    def _tilt(self, event: Move) -> Pose | None:
        if not self.tilts or event.word.startswith(("G53", "G28", "G30")):
            return None
        return self.tilts.get(self.current.system)

    @property
    def _untilted(self) -> Axes:
        """The present point in coordinates of M before the tilt of the active system."""
        tilt = self.tilts.get(self.current.system)
        if tilt is None:
            return self.at
        p = tilt.p + applied(tilt.R.T, np.array(self.at[:3]) - tilt.p)
        return (float(p[0]), float(p[1]), float(p[2]), *self.at[3:])

    def _row(self, kind: int, event: Move, end: Axes, feed: float, rotary: bool, extrude: float = 0.0) -> None:
        if self.tilts:
            tilt = self._tilt(event)
            if tilt is not None and kind != HOME:
                p = tilt.p + applied(tilt.R, np.array(end[:3]) - tilt.p)
                end = (float(p[0]), float(p[1]), float(p[2]), *end[3:])
        self.rows.add(
            kind,
            end,
            feed,
            rotary=rotary,
            block=event.block,
            state=self._state_with(event.word),
            span=event.span,
            tags=self.tags,
            extrude=extrude,
        )
        self.at = end

    def _state_with(self, word: str) -> int:
        """The index of the tool state in force, with `word` as its motion word."""
        if word != self.current.word:
            self._set(replace(self.current, word=word))
        if self.state < 0:
            self.state = self.states.setdefault(self.current, len(self.states))
        return self.state

    def leg(self) -> ToolPath:
        """The moves since the last leg; they end at rest."""
        states = tuple(self.states)
        if self.legs and not states:
            states = (self.current,)
        path = self.rows.path(self.first, states, tuple(self.events))
        self.legs += 1
        self.first, self.rows, self.events = self.at, PathRows(), []
        self.states, self.state = {}, -1
        return path

    def stand_at(self, at: Axes) -> None:
        """The last leg ended at `at` [m, rad], not where it was meant to end."""
        self.at = self.first = at
