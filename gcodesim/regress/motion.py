"""The motion of a program, reduced to what counts: steps in the order in which they act.

A step is an act (a move, a dwell, a tool change, an output), or a state that changes before an act. States that repeat
what is in force, or are overruled before any act, are not steps, nor are messages. So numbering, comments,
spelling and the order of words on a line do not matter. Numbers are those of the canonical listing: mm, deg, mm/min.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from itertools import pairwise
from typing import Any, Final

from gcodesim.arithmetic.elementary import cos_sin
from gcodesim.canon import AXIS_LETTERS
from gcodesim.canon import events as ev
from gcodesim.canon.listing import as_json
from gcodesim.frozen import frozen

Point = tuple[float, float, float]
Axes = tuple[float, float, float, float, float, float]

MOVES: Final = ("rapid", "line", "arc", "spline", "probe", "tap")
NO_AXES: Final[Axes] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

_SILENT: Final = (ev.Message, ev.Print, ev.Log)
# states in the order in which they precede an act, with what is in force before the program says anything
_STATES: Final[Mapping[str, Mapping[str, Any] | None]] = {
    "tool_select": None,
    "tool_number": None,
    "tool_offset": {"offset": [0] * 6},
    "path_mode": None,
    "spindle": {"dir": "off", "speed": 0, "unit": "rpm", "max_rpm": None},
    "coolant": {"flood": False, "mist": False},
    "override": {"feed": True, "speed": True, "adaptive": False, "hold": True},
}
_COUNTED: Final = ("tool", "index", "turns", "m", "direction")  # numbers that name something
_SAMPLES: Final = (0.25, 0.5, 0.75)  # along a spline


@frozen
class System:
    """A work system: ``machine = axes turned(program + g92) + offset`` [mm, deg]; `axes` are rows of a rotation."""

    offset: Axes = NO_AXES
    g92: Axes = NO_AXES
    rotation: float = 0.0
    axes: tuple[ev.Point, ev.Point, ev.Point] | None = None

    def to_machine(self, program: Sequence[float]) -> tuple[float, ...]:
        moved = [p + g for p, g in zip(program, self.g92, strict=False)]
        moved[:2] = _turn(moved[0], moved[1], self.rotation)
        if self.axes is not None:
            moved[:3] = [_dot(row, moved) for row in self.axes]
        return tuple(m + o for m, o in zip(moved, self.offset, strict=False))

    def to_program(self, machine: Sequence[float]) -> tuple[float, ...]:
        moved = [m - o for m, o in zip(machine, self.offset, strict=False)]
        if self.axes is not None:
            moved[:3] = [_dot(column, moved) for column in zip(*self.axes, strict=True)]
        moved[:2] = _turn(moved[0], moved[1], -self.rotation)
        return tuple(m - g for m, g in zip(moved, self.g92, strict=False))


def _dot(row: Sequence[float], point: Sequence[float]) -> float:
    return row[0] * point[0] + row[1] * point[1] + row[2] * point[2]


def _turn(x: float, y: float, angle: float) -> tuple[float, float]:
    if angle == 0.0:
        return x, y
    c, s = cos_sin(math.radians(angle))
    return c * x - s * y, s * x + c * y


@frozen
class ArcMove:
    """Centre [mm], normal and signed sweep [deg] of an arc in the machine frame."""

    center: Point
    normal: Point
    sweep: float


@frozen
class MotionStep:
    """One step. `words` have to be equal, `numbers` alike; `end` of a move stands in the machine frame [mm, deg].

    `through` are points on the path that shape a curved move: the middle of an arc, three points of a spline.
    `stops`: exact stop is in force. `system` turns machine positions into those of the program.
    """

    kind: str
    file: str
    line: int
    words: tuple[tuple[str, str], ...] = ()
    numbers: tuple[tuple[str, float], ...] = ()
    start: Axes = NO_AXES
    end: Axes | None = None
    arc: ArcMove | None = None
    through: tuple[Point, ...] = ()
    stops: bool = False
    system: System = field(default=System(), compare=False)

    @property
    def length(self) -> float:
        """Length of a move [mm]."""
        if self.end is None:
            return 0.0
        if self.arc is not None:
            rise = sum(n * (e - s) for n, e, s in zip(self.arc.normal, self.end, self.start, strict=False))
            radius = math.dist(_in_plane(self.arc, self.start), self.arc.center)
            return math.hypot(math.radians(abs(self.arc.sweep)) * radius, rise)
        points = (self.start[:3], *self.through, self.end[:3])
        return sum(math.dist(a, b) for a, b in pairwise(points))

    def point(self, part: float) -> Point:
        """Where a move is after `part` (0 to 1) of its path [mm]."""
        assert self.end is not None
        if self.arc is not None:
            return arc_point(self.arc, self.start, self.end, part)
        x, y, z = (s + (e - s) * part for s, e in zip(self.start[:3], self.end[:3], strict=True))
        return x, y, z


def _in_plane(arc: ArcMove, point: Sequence[float]) -> Point:
    """`point` at the height of the centre along the normal."""
    rise = sum(n * (p - c) for n, p, c in zip(arc.normal, point, arc.center, strict=False))
    x, y, z = (p - n * rise for p, n in zip(point, arc.normal, strict=False))
    return x, y, z


def arc_point(arc: ArcMove, start: Sequence[float], end: Sequence[float], part: float) -> Point:
    """The point after `part` of an arc or helix (Rodrigues' rotation about the normal, rise in proportion)."""
    n = arc.normal
    rise = sum(k * (e - s) for k, e, s in zip(n, end, start, strict=False))
    r = [p - c for p, c in zip(start, arc.center, strict=False)]
    height = sum(a * b for a, b in zip(n, r, strict=True))
    r = [a - height * b for a, b in zip(r, n, strict=True)]
    across = (n[1] * r[2] - n[2] * r[1], n[2] * r[0] - n[0] * r[2], n[0] * r[1] - n[1] * r[0])
    angle = math.radians(arc.sweep * part)
    c, s = cos_sin(angle)
    x, y, z = (
        m + c * a + s * b + k * (height + part * rise) for m, a, b, k in zip(arc.center, r, across, n, strict=True)
    )
    return x, y, z


def steps_of(events: Iterable[ev.Event]) -> list[MotionStep]:
    """The steps of a program's canonical events."""
    return list(_Reducer().run(events))


class _Reducer:
    """Follows states and position through the events."""

    def __init__(self) -> None:
        self.position: Axes = NO_AXES
        self.system = System()
        self.in_force: dict[str, Mapping[str, Any] | None] = dict(_STATES)
        self.wanted: dict[str, tuple[dict[str, Any], ev.Event]] = {}

    def run(self, events: Iterable[ev.Event]) -> Iterator[MotionStep]:
        for event in events:
            if isinstance(event, _SILENT):
                continue
            fields = as_json(event)
            fields.pop("line", None)
            kind = fields.pop("kind")
            if isinstance(event, ev.WorkSystem):
                self.system = System(
                    offset=_axes(event.offset), g92=_axes(event.g92), rotation=fields["rotation"], axes=event.axes
                )
            elif kind in _STATES:
                self.wanted[kind] = (fields, event)
            else:
                yield from self._states()
                yield self._step(kind, fields, event)
        yield from self._states()

    def _states(self) -> Iterator[MotionStep]:
        for kind in _STATES:
            if kind in self.wanted:
                fields, event = self.wanted.pop(kind)
                if fields != self.in_force[kind]:
                    self.in_force[kind] = fields
                    yield self._step(kind, fields, event)

    def _step(self, kind: str, fields: dict[str, Any], event: ev.Event) -> MotionStep:
        start = self.position
        end: Axes | None = None
        arc: ArcMove | None = None
        through: tuple[Point, ...] = ()
        words: list[tuple[str, str]] = []
        if "end" in fields:
            a, b, c, d, e, f = (float(v) for v in fields.pop("end"))
            self.position = end = (a, b, c, d, e, f)
        if kind == "arc":
            assert end is not None
            arc = ArcMove(
                center=_point(fields.pop("center")), normal=_point(fields.pop("normal")), sweep=fields["sweep"]
            )
            del fields["sweep"]
            through = (arc_point(arc, start, end, 0.5),)
        elif kind == "spline":
            through = _along([start[:3], *(_point(p) for p in fields.pop("points"))])
            del fields["control_points"]
        elif isinstance(event, ev.ProbeMove):
            words.append(("word", event.word))
        numbers: list[tuple[str, float]] = []
        for name, value in _flat(fields):
            if isinstance(value, (str, bool)) or value is None or name in _COUNTED:
                words.append((name, _word(value)))
            else:
                numbers.append((name, float(value)))
        mode = self.in_force["path_mode"]
        return MotionStep(
            kind=kind,
            file=event.span.file,
            line=event.span.line,
            words=tuple(words),
            numbers=tuple(numbers),
            start=start,
            end=end,
            arc=arc,
            through=through,
            stops=mode is not None and mode["mode"] == "exact_stop",
            system=self.system,
        )


def _flat(fields: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in fields.items():
        if isinstance(value, list):
            yield from zip(AXIS_LETTERS, value, strict=False)
        else:
            yield name, value


def _word(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "none" if value is None else str(value)


def _axes(values: ev.Axes) -> Axes:
    from gcodesim.units import DEG, MM

    a, b, c = (v / MM for v in values[:3])
    d, e, f = (v / DEG for v in values[3:])
    return a, b, c, d, e, f


def _point(values: Sequence[float]) -> Point:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _along(points: Sequence[Sequence[float]]) -> tuple[Point, ...]:
    """Points at `_SAMPLES` of the length of a polyline."""
    ways = [math.dist(a, b) for a, b in pairwise(points)]
    found = []
    for part in _SAMPLES:
        left = part * sum(ways)
        at = points[0]
        for way, a, b in zip(ways, points, points[1:], strict=False):
            if left <= way:
                at = [p + (q - p) * (left / way if way else 0.0) for p, q in zip(a, b, strict=True)]
                break
            left -= way
            at = b
        found.append(_point(at))
    return tuple(found)
