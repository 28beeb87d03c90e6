"""LinuxCNC's G70, G71 and G72: cycles along a contour that stands in a subroutine.

`G71 Q100 X22 Z2 D0.4 I1.5 R0.5`: from X22 Z2 passes of depth I with an escape R, and along what is D beside the contour
of O100. `G70 Q100 X22 Z2 D0.5 E0 P2`: along the contour in P passes, the last of which is E beside it.
"""

from __future__ import annotations

import math

from gcodesim.frozen import frozen
from gcodesim.rs274.arcs import arc
from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.lathe_outline import CLOSE, OutlinePart, Point, beside, goes_ahead
from gcodesim.rs274.lathe_passes import RoughingPasses
from gcodesim.rs274.roughing import ContourMove
from gcodesim.rs274.words import Words

_UNITS = {700: "inches are G20", 710: "millimetres are G21"}
_MOTIONS = {0: 0, 10: 0, 20: -1, 30: 1}


@frozen(kw_only=False)
class HalfPlane:
    """The half plane of a cycle: passes go ahead in `a`, and `b` points out of the work; seen from (z, x)."""

    swap: bool  # a = x, b = z
    a_sign: float
    b_sign: float

    def seen(self, point: Point) -> Point:
        """(z, x) as (a, b)."""
        z, x = point
        return (self.a_sign * x, self.b_sign * z) if self.swap else (self.a_sign * z, self.b_sign * x)

    def back(self, point: Point) -> Point:
        """(a, b) as (z, x)."""
        a, b = point
        return (self.b_sign * b, self.a_sign * a) if self.swap else (self.a_sign * a, self.b_sign * b)

    @property
    def turn(self) -> int:
        """-1 where it sees arcs the other way round."""
        return round(self.a_sign * self.b_sign) * (-1 if self.swap else 1)


def contour_cycle(words: Words, control: Control, code: int) -> None:
    """Execute G70, G71.n or G72.n; `control.contours` gives the blocks of the subroutine."""
    state, values, who = control.state, words.values, f"G{code // 10}"
    if "q" not in words.values:
        at = who.lower() if who.lower() in words.names else None
        if code in _UNITS and {"x", "z"}.isdisjoint(words.values):  # on other controls they choose the unit
            raise Fault("GS915", f"{who} is not simulated without Q: a cycle of lathes ({_UNITS[code]})", at=at)
        raise Fault("GS105", f"{who} needs the word Q, the number of the subroutine with the contour", at=at)
    if state.plane != 180:
        raise Fault("GS106", f"{who} works in the XZ plane only", hint="say G18 before")
    depth, escape, aside = values.get("i", 1.0), values.get("r", 0.5), values.get("d", 0.0)
    if depth <= 0.0:
        raise Fault("GS106", f"the depth I{depth:g} of {who} must be more than 0", at="i")
    x, z = values.get("x", state.current[0]), values.get("z", state.current[2])
    incremental, absolute = state.incremental, state.centre_absolute
    if incremental:
        x, z = (now + values.get(letter, 0.0) for now, letter in ((state.current[0], "x"), (state.current[2], "z")))
    _go(control, (z, x), rapid=True)
    moves = _contour(control, round(words.values["q"]), (z, x), who)
    state.incremental, state.centre_absolute = False, False
    try:
        if code == 700:
            _finish(words, control, (z, x), moves, aside)
        else:
            shift = (values.get("w", 0.0), values.get("u", 0.0) * (0.5 if state.diameter else 1.0))
            plane, start, outline = _outline(moves, (z, x), who, shift, swap=code // 10 == 72)
            _go(control, plane.back(start), rapid=True)
            left = beside(outline, aside)
            if not left:
                raise Fault("GS106", f"D{aside:g} leaves nothing of the contour of {who}", at="d")
            for move in RoughingPasses(depth, escape, code % 10).along(start, left):
                _follow(words, control, plane, move)
    finally:
        state.incremental, state.centre_absolute = incremental, absolute


def _contour(control: Control, number: int, start: Point, who: str) -> list[ContourMove]:
    state = control.state
    here, motion, kept = start, 0, state.current
    moves: list[ContourMove] = []
    for words in control.contours(number):
        values = words.values
        motion = words.g.get(1, motion)
        end = (
            values.get("z", 0.0 if state.incremental else here[0]) + (here[0] if state.incremental else 0.0),
            values.get("x", 0.0 if state.incremental else here[1]) + (here[1] if state.incremental else 0.0),
        )
        if {"x", "z"}.isdisjoint(values):
            continue
        if motion not in _MOTIONS:
            raise Fault("GS106", f"the contour of {who} has a block that is no G0 to G3")
        sense = _MOTIONS[motion]
        if not sense:
            moves.append(ContourMove(end, rapid=motion == 0))
        else:
            moves.append(ContourMove(end, centre=_centre(control, here, end, values, sense), sense=sense))
        here = end
        state.current = (here[1], kept[1], here[0], *kept[3:])  # what #<_x> reads in the contour
    state.current = kept
    if len(moves) < 2:
        raise Fault("GS106", f"O{number} holds no contour for {who}: it has fewer than two moves", at="q")
    return moves


def _centre(control: Control, start: Point, end: Point, values: dict[str, float], sense: int) -> Point:
    if "r" in values:
        half = 0.5 * math.hypot(end[0] - start[0], end[1] - start[1])
        radius = values["r"]
        if half == 0.0 or half > abs(radius) * (1.0 + 1e-3):
            raise Fault("GS106", f"no arc of radius R{radius:g} joins these points")
        high = math.sqrt(max(radius * radius - half * half, 0.0)) * (1.0 if radius > 0.0 else -1.0) * sense
        return (
            0.5 * (start[0] + end[0]) - high * (end[1] - start[1]) / (2.0 * half),
            0.5 * (start[1] + end[1]) + high * (end[0] - start[0]) / (2.0 * half),
        )
    if control.state.centre_absolute:
        return values.get("k", start[0]), values.get("i", start[1])
    return start[0] + values.get("k", 0.0), start[1] + values.get("i", 0.0)


def _outline(
    moves: list[ContourMove], start: Point, who: str, shift: Point, *, swap: bool
) -> tuple[HalfPlane, Point, list[OutlinePart]]:
    """The half plane of a cycle; in it the point from which it starts, and the contour, which goes ahead.

    The contour goes out of the work, from its first point to its last; for G70 the start is outside. A start that is
    not before the contour moves there.
    """
    points = [(move.end[0] + shift[0], move.end[1] + shift[1]) for move in moves]
    a, b = (1, 0) if swap else (0, 1)
    far, near = points[-1][b] - points[0][b], start[b] - points[0][b]
    first, second = (near, far) if who == "G70" else (far, near)
    up = first if abs(first) > CLOSE else second
    plane = HalfPlane(swap, math.copysign(1.0, points[-1][a] - points[0][a]), math.copysign(1.0, up))
    seen = [plane.seen(point) for point in points]
    outline = [
        OutlinePart(
            begin,
            end,
            False,
            plane.seen((move.centre[0] + shift[0], move.centre[1] + shift[1])),
            move.sense * plane.turn,
        )
        for begin, end, move in zip(seen, seen[1:], moves[1:], strict=False)
    ]
    for stretch in outline:
        if not goes_ahead(stretch):
            raise Fault(
                "GS106",
                f"the contour of {who} turns back in {'X' if swap else 'Z'}",
                hint="it has to go on in one direction, from its first point to its last",
            )
    begin = plane.seen(start)
    return plane, (min(begin[0], seen[0][0]), begin[1]), outline


def _finish(words: Words, control: Control, start: Point, moves: list[ContourMove], first: float) -> None:
    last = words.values.get("e", 0.0)
    passes = words.whole("p", "G70")
    count = 1 if passes is None else passes
    plane, begin, outline = _outline(moves, start, "G70", (0.0, 0.0), swap=False)
    for k in range(count, 0, -1):
        _go(control, plane.back(begin), rapid=True)
        around = beside(outline, last + (first - last) * (k - 1) / count)
        if around:
            _go(control, plane.back(around[0].begin), rapid=True)
        for move in around:
            _follow(words, control, plane, move)


def _follow(words: Words, control: Control, plane: HalfPlane, move: OutlinePart) -> None:
    end = plane.back(move.end)
    if not move.sense:
        _go(control, end, rapid=move.rapid)
        return
    now, (z, x) = control.state.current, plane.back(move.centre)
    block = Words(words.block)
    block.values = {"x": end[1], "z": end[0], "i": x - now[0], "k": z - now[2]}
    arc(block, control, 30 if move.sense * plane.turn > 0 else 20)


def _go(control: Control, end: Point, *, rapid: bool) -> None:
    now = control.state.current
    target = (end[1], now[1], end[0], *now[3:])
    if rapid:
        control.rapid(target)
    else:
        control.line(target)
