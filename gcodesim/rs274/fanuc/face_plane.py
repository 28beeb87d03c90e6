"""Polar coordinate interpolation (G12.1, G112): a contour in a plane of X and C, milled on the face of the work.

Between G12.1 and G13.1 X is the first axis of the plane (a diameter) and C the second, a length: a virtual axis. Arcs
and cutter compensation work in this plane as in X and Y. The control goes along it with X as the distance from the axis
of the spindle, never below zero, and C as the turn; F is the speed along the contour. As in the operator's manual of
the 0i-TF ("polar coordinate interpolation"), known by memory: the codes that are allowed, C counted from where it
stands, the plane of before that comes back.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from gcodesim import canon
from gcodesim.arithmetic.scalars import atan2, cos, sin
from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.units import DEG

ON: Final = frozenset((12.1, 112.0))
OFF: Final = frozenset((13.1, 113.0))
ALLOWED: Final = frozenset((1.0, 2.0, 3.0, 4.0, 40.0, 41.0, 42.0, 65.0, 66.0, 67.0, 94.0, 95.0, 98.0, 99.0))
"""G codes between G12.1 and G13.1; 94 and 95 are 98 and 99 as the milling control has them."""

TOLERANCE: Final = 1e-6
"""How far [m] a move of X and C may be from the contour."""

_SHORTEST: Final = 1e-6
"""Shortest move [m]: nearer to the axis C may turn by half a turn within one."""

_STILL: Final = 1e-9
"""A move of X and Z shorter than this [m] is one of C alone."""

_MOST_TURN: Final = math.radians(30.0)  # of one move

Spot = tuple[float, float, float]


@dataclass(slots=True)
class FacePlane:
    """The plane while it is in force: where its zero lies in M [m], `turn` of C there and now [rad], the `spot` [m].

    `sense`: which way round the work the tool goes where C grows, 1 counterclockwise. `plane` is the G17 to G19 of
    before.
    """

    zero: tuple[float, float]
    first_turn: float
    sense: float
    plane: int
    spot: Spot
    angle: float = 0.0

    @staticmethod
    def begin(control: Control) -> FacePlane:
        """G12.1 where the tool stands; the point of the program is that of the plane from then on."""
        state = control.state
        x, y = state.current[:2]
        if state.side:
            raise Fault("GS150", "G12.1 is refused in cutter compensation", at="g12.1", hint="say G40 first")
        if x < 0.0 or abs(y) * state.unit > TOLERANCE:
            where = f"X{2.0 * x:g}" if x < 0.0 else f"Y{y:g}"
            raise Fault("GS106", f"G12.1 at {where}: the plane begins at Y0 and X from 0 on", at="g12.1")
        zero = control.si_axes(control.tip((0.0, 0.0, *state.current[2:])))
        here = control.si_axes(control.tip(state.current))
        plane = FacePlane(
            zero=(zero[0], zero[1]),
            first_turn=here[5],
            sense=control.settings.c_goes_round,
            plane=state.plane,
            spot=(here[0] - zero[0], 0.0, here[2]),
        )
        state.plane = 170
        return plane

    def end(self, control: Control) -> None:
        """G13.1: the point of the program is that of the axes again."""
        state = control.state
        if state.side:
            raise Fault("GS150", "G13.1 is refused in cutter compensation", at="g13.1", hint="say G40 first")
        x, y, z, a, b, _, *rest = state.current
        turn = self._turn() - control.si_axes(control.tip((0.0,) * 9))[5]
        state.current = (math.hypot(x, y), 0.0, z, a, b, turn / DEG, *rest)  # type: ignore[assignment]
        state.plane = self.plane

    def moves(self, events: Sequence[canon.Event]) -> Iterator[canon.Event]:
        """Moves in the plane as moves of X, Z and C; other events as they are."""
        for event in events:
            if isinstance(event, canon.ArcFeed):
                yield from self._along(event, self._arc(event), event.feed, event.feed_unit)
            elif isinstance(event, canon.LinearFeed):
                yield from self._along(event, self._line(event), event.feed, event.feed_unit)
            else:
                yield event

    def _here(self, end: canon.Axes) -> Spot:
        return end[0] - self.zero[0], end[1] - self.zero[1], end[2]

    def _line(self, move: canon.Move) -> tuple[Callable[[float], Spot], float]:
        """Points of a line by the share of the way, and its length."""
        start, end = self.spot, self._here(move.end)

        def at(share: float) -> Spot:
            return tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))  # type: ignore[return-value]

        return at, math.dist(start, end)

    def _arc(self, move: canon.ArcFeed) -> tuple[Callable[[float], Spot], float]:
        x0, y0, z0 = self.spot
        cx, cy, _ = self._here((*move.center, 0.0, 0.0, 0.0))
        end, sweep = self._here(move.end), move.sweep * (1.0 if move.normal[2] >= 0.0 else -1.0)

        def at(share: float) -> Spot:
            if share == 1.0:
                return end
            c, s = cos(share * sweep), sin(share * sweep)
            return cx + c * (x0 - cx) - s * (y0 - cy), cy + s * (x0 - cx) + c * (y0 - cy), z0 + share * (end[2] - z0)

        return at, math.hypot(sweep * math.hypot(x0 - cx, y0 - cy), end[2] - z0)

    def _along(
        self, move: canon.Move, way: tuple[Callable[[float], Spot], float], feed: float, unit: canon.FeedUnit
    ) -> Iterator[canon.LinearFeed]:
        """The moves of X, Z and C along a way in the plane, each within `TOLERANCE` of it."""
        at, length = way
        begin, stack = 0.0, [1.0]
        while stack:
            end = stack[-1]
            to, angle = at(end), self._angle(at(end))
            if length * (end - begin) > _SHORTEST and self._strays(at(0.5 * (begin + end)), to, angle):
                stack.append(0.5 * (begin + end))
                continue
            yield self._move(move, to, angle, (feed, unit), length * (end - begin))
            begin = stack.pop()

    def _angle(self, spot: Spot) -> float:
        """The angle of a point, by the shorter turn from the last one; on the axis that of the last one."""
        if math.hypot(spot[0], spot[1]) < _STILL:
            return self.angle
        angle = atan2(spot[1], spot[0])
        return float(angle + math.tau * round((self.angle - angle) / math.tau))

    def _strays(self, middle: Spot, to: Spot, angle: float) -> bool:
        """Whether X and C, both going evenly to an end, leave the way by too much half way there."""
        if abs(angle - self.angle) > _MOST_TURN:
            return True
        radius = 0.5 * (math.hypot(self.spot[0], self.spot[1]) + math.hypot(to[0], to[1]))
        half = 0.5 * (self.angle + angle)
        return math.hypot(radius * cos(half) - middle[0], radius * sin(half) - middle[1]) > TOLERANCE

    def _move(
        self, move: canon.Move, to: Spot, angle: float, speed: tuple[float, canon.FeedUnit], length: float
    ) -> canon.LinearFeed:
        radius = math.hypot(to[0], to[1])
        straight = math.hypot(radius - math.hypot(self.spot[0], self.spot[1]), to[2] - self.spot[2])
        turned = abs(angle - self.angle)
        self.spot, self.angle = to, angle
        feed, unit = speed
        if straight > _STILL:
            feed *= straight / length
        elif turned > 0.0:
            feed, unit = feed * turned / length, "rad/rev" if unit == "m/rev" else "rad/s"
        end = (self.zero[0] + radius, self.zero[1], to[2], *move.end[3:5], self._turn())
        return canon.LinearFeed(span=move.span, end=end, block=move.block, word=move.word, feed=feed, feed_unit=unit)

    def _turn(self) -> float:
        return self.first_turn + self.sense * self.angle


def in_plane(words: Sequence[tuple[str, float]], control: Control) -> list[tuple[str, float]]:
    """The words of a block between G12.1 and G13.1 as those of a plane of X and Y: X a radius, C the second axis."""
    x, y, z = control.state.current[:3] if not control.state.side else control.state.comp_programmed[:3]
    found: list[tuple[str, float]] = []
    dwells = ("g", 4.0) in words
    for letter, value in words:
        if letter == "g" and value not in ALLOWED:
            raise Fault(
                "GS106",
                f"G{value:g} is refused in polar coordinate interpolation",
                at=f"g{value:g}",
                hint="say G13.1 before; between G12.1 and G13.1 are G1 to G4, G40 to G42, G65 to G67, G98 and G99",
            )
        if letter in "taby":
            name = "a tool change" if letter == "t" else f"the word {letter.upper()}"
            raise Fault(
                "GS106", f"{name} is refused in polar coordinate interpolation", at=letter, hint="say G13.1 before"
            )
        if dwells:
            found.append((letter, value))
        elif letter in "xu":
            found.append(("x", 0.5 * value + (x if letter == "u" else 0.0)))
        elif letter in "ch":
            found.append(("y", value + (y if letter == "h" else 0.0)))
        elif letter in "zw":
            found.append(("z", value + (z if letter == "w" else 0.0)))
        else:
            found.append((letter, value))
    return found
