"""LinuxCNC's G70, G71 and G72: cycles along a contour that stands in a subroutine.

`G71 Q100 X22 Z2 D0.4 I1.5 R0.5`: from X22 Z2 passes of depth I with an escape R, and along what is D beside the contour
of O100. `G70 Q100 X22 Z2 D0.5 E0 P2`: along the contour in P passes, the last of which is E beside it. In a contour U
and W count from the point before, and A rounds the corner at the end of a block, C breaks it.
"""

from __future__ import annotations

import math
from itertools import pairwise

from gcodesim.frozen import frozen
from gcodesim.rs274.arcs import arc
from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.lathe_corners import ContourCorner, NoRoomError, finished
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


@frozen(kw_only=False)
class LatheContour:
    """The moves of a contour in (z, x), and how the corner at the end of each is finished."""

    moves: list[ContourMove]
    corners: list[ContourCorner | None]

    def closed(self, start: Point, *, swap: bool) -> LatheContour:
        """With a way out of the work, from which the passes come, where the contour does not lead there itself."""
        a, b = (1, 0) if swap else (0, 1)
        before, last = self.moves[-2].end, self.moves[-1].end
        into, out = self.moves[0].end[b] - start[b], start[b] - last[b]
        if last[a] == before[a] or into * out >= 0.0:
            return self
        end = (start[0], last[1]) if swap else (last[0], start[1])
        return LatheContour([*self.moves, ContourMove(end)], [*self.corners, None])

    @property
    def turns_back(self) -> bool:
        """Whether it goes both ways along Z."""
        ways = [after.end[0] - before.end[0] for before, after in pairwise(self.moves)]
        return min(ways) < -CLOSE and max(ways) > CLOSE


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
    contour = _contour(control, round(words.values["q"]), (z, x), who)
    state.incremental, state.centre_absolute = False, False
    try:
        if code == 700:
            _finish(words, control, (z, x), contour, aside)
        else:
            swap = code // 10 == 72
            shift = (values.get("w", 0.0), values.get("u", 0.0) * (0.5 if state.diameter else 1.0))
            plane, start, outline = _outline(contour.closed((z, x), swap=swap), (z, x), who, shift, swap=swap)
            _go(control, plane.back(start), rapid=True)
            left = beside(outline, aside)
            if not left:
                raise Fault("GS106", f"D{aside:g} leaves nothing of the contour of {who}", at="d")
            for move in RoughingPasses(depth, escape, code % 10).along(start, left):
                _follow(words, control, plane, move)
    finally:
        state.incremental, state.centre_absolute = incremental, absolute


def _contour(control: Control, number: int, start: Point, who: str) -> LatheContour:
    state = control.state
    here, motion, kept = start, 0, state.current
    moves: list[ContourMove] = []
    corners: list[ContourCorner | None] = []
    for words in control.contours(number):
        values = words.values
        motion = words.g.get(1, motion)
        if {"x", "z", "u", "w"}.isdisjoint(values):
            continue
        end = (_coordinate(control, here[0], values, "z", "w"), _coordinate(control, here[1], values, "x", "u"))
        if motion not in _MOTIONS:
            raise Fault("GS106", f"the contour of {who} has a block that is no G0 to G3")
        sense = _MOTIONS[motion]
        if not sense:
            moves.append(ContourMove(end, rapid=motion == 0))
        else:
            moves.append(ContourMove(end, centre=_centre(control, here, end, values, sense), sense=sense))
        corners.append(_corner(values))
        here = end
        state.current = (here[1], kept[1], here[0], *kept[3:])  # what #<_x> reads in the contour
    state.current = kept
    if len(moves) < 2:
        raise Fault("GS106", f"O{number} holds no contour for {who}: it has fewer than two moves", at="q")
    return LatheContour(moves, corners)


def _coordinate(control: Control, here: float, values: dict[str, float], letter: str, step: str) -> float:
    """Where a block of a contour ends in Z or X: at the word of that letter, or a step away, W or U."""
    incremental = control.state.incremental
    if step not in values:
        return values.get(letter, 0.0 if incremental else here) + (here if incremental else 0.0)
    if incremental:
        raise Fault("GS104", f"a contour takes no {step.upper()} under G91", at=step)
    if letter in values:
        raise Fault("GS104", f"a block of a contour has {letter.upper()} or {step.upper()}, not both", at=step)
    return here + values[step] * (0.5 if step == "u" and control.state.diameter else 1.0)


def _corner(values: dict[str, float]) -> ContourCorner | None:
    if "a" in values and "c" in values:
        raise Fault("GS104", "a corner of a contour is rounded by A or broken by C, not both", at="c")
    size = values.get("a", values.get("c", 0.0))
    return ContourCorner(abs(size), "c" in values) if size else None


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
    contour: LatheContour, start: Point, who: str, shift: Point, *, swap: bool
) -> tuple[HalfPlane, Point, list[OutlinePart]]:
    """The half plane of a cycle; in it the point from which it starts, and the contour, which goes ahead.

    The contour goes out of the work, from its first point to its last; for G70 the start is outside. A start that is
    not before the contour moves there.
    """
    moves = contour.moves
    points = [(move.end[0] + shift[0], move.end[1] + shift[1]) for move in moves]
    a, b = (1, 0) if swap else (0, 1)
    far, near = points[-1][b] - points[0][b], start[b] - points[0][b]
    first, second = (near, far) if who == "G70" else (far, near)
    up = first if abs(first) > CLOSE else second
    plane = HalfPlane(swap, math.copysign(1.0, points[-1][a] - points[0][a]), math.copysign(1.0, up))
    seen = [plane.seen(point) for point in points]
    begin = plane.seen(start)
    stretches = [OutlinePart(begin, seen[0])] + [
        OutlinePart(
            begin,
            end,
            False,
            plane.seen((move.centre[0] + shift[0], move.centre[1] + shift[1])),
            move.sense * plane.turn,
        )
        for begin, end, move in zip(seen, seen[1:], moves[1:], strict=False)
    ]
    try:
        outline = finished(stretches, contour.corners)[1:]
    except NoRoomError as problem:
        corner = contour.corners[problem.corner]
        assert corner is not None
        word = f"{'C' if corner.straight else 'A'}{corner.radius:g}"
        raise Fault(
            "GS106",
            f"{word} does not fit into the corner at the end of move {problem.corner + 1} of the contour of {who}",
            hint="the sides of a corner must be longer than what is rounded or broken, and must not go straight on",
        ) from None
    for stretch in outline:
        if not goes_ahead(stretch):
            raise Fault(
                "GS106",
                f"the contour of {who} turns back in {'X' if swap else 'Z'}",
                hint="it has to go on in one direction, from its first point to its last",
            )
    return plane, (min(begin[0], outline[0].begin[0]), begin[1]), outline


def _finish(words: Words, control: Control, start: Point, contour: LatheContour, first: float) -> None:
    last = words.values.get("e", 0.0)
    passes = words.whole("p", "G70")
    count = 1 if passes is None else passes
    plane, begin, outline = _outline(contour, start, "G70", (0.0, 0.0), swap=contour.turns_back)
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
