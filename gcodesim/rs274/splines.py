"""G5, G5.1 and the block G5.2 … G5.3: curves in the XY plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from gcodesim import canon
from gcodesim.rs274.control import Control
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.feeds import check_feed
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words

Point = tuple[float, float]
Weighted = tuple[float, float, float]

_FLATNESS = 1e-6  # [m] the polyline of an event stays this near to the curve
_FEWEST, _MOST = 16, 4096  # pieces of the polyline for one span of the curve


def cubic_spline(words: Words, control: Control, code: int) -> None:
    """G5: a cubic through I J (from the start) and P Q (from the end)."""
    del code
    _check(words, control, "G5")
    values, state = words.values, control.state
    _need_pair(words, "p", "q", "G5")
    if "i" in values or "j" in values:
        _need_pair(words, "i", "j", "G5", hint="I and J go together; without both the curve before carries on")
        tangent = (values["i"], values["j"])
    elif state.spline_tangent is not None:
        tangent = state.spline_tangent
    else:
        tangent = (0.0, 0.0)
        control.warn("GS192", "the first G5 of a chain has no I and J: it starts without a direction", "add I and J")
    end = _end(words, control, "G5")
    start = state.current
    controls = [
        (start[0], start[1]),
        (start[0] + tangent[0], start[1] + tangent[1]),
        (end[0] + values["p"], end[1] + values["q"]),
        (end[0], end[1]),
    ]
    _emit(control, _with_left_over(control, controls), 4, end, "G5")
    state.spline_tangent = (-values["p"], -values["q"])


def quadratic_spline(words: Words, control: Control, code: int) -> None:
    """G5.1: a parabola whose control point is I J from the start."""
    del code
    _check(words, control, "G5.1")
    values, state = words.values, control.state
    _need_pair(words, "i", "j", "G5.1")
    tangent = (values["i"], values["j"])
    end = _end(words, control, "G5.1")
    start = state.current
    controls = [(start[0], start[1]), (start[0] + tangent[0], start[1] + tangent[1]), (end[0], end[1])]
    _emit(control, _with_left_over(control, controls), 3, end, "G5.1")


def nurbs_start(words: Words, control: Control, code: int) -> None:
    """G5.2 and the blocks after it: control points with weight P; L is the order."""
    del code
    _check(words, control, "G5.2")
    state = control.state
    at = "g5.2" if "g5.2" in words.names else None
    opening = not state.nurbs_points  # as on the control, even points that are about to be dropped count here
    has_end = "x" in words.values or "y" in words.values
    if opening and not has_end and words.values.get("p", 0.0) <= 0.0:
        words.values["p"] = 1.0  # of the start, where P may be missing
    weight = words.need("p", "GS170", "G5.2", "P is the weight of the control point")
    if weight < 0.0 or (weight == 0.0 and not opening):
        raise Fault("GS170", f"the weight P{weight:g} must be positive", at="p")
    if has_end:
        _need_pair(words, "x", "y", "G5.2")
    elif not opening:
        raise Fault("GS170", "a control point needs X and Y", at=at)
    if state.motion != 52:
        _drop_points(control)
    if not state.nurbs_points:
        now = state.current
        state.nurbs_order = 3
        state.nurbs_points = ((now[0], now[1], 1.0 if has_end else weight),)
    order = words.whole("l", "G5.2")
    if order is not None and order > 3:
        state.nurbs_order = order  # a smaller one counts as 3, as on the control
    for letter in "zabcuvw":
        if letter in words.values:
            control.warn("GS170", f"G5.2 moves X and Y only: the word {letter.upper()} is not used")
    if has_end:
        end = end_point(words, control)
        state.nurbs_points = (*state.nurbs_points, (end[0], end[1], weight))


def nurbs_end(_: Words, control: Control) -> None:
    """G5.3: the curve through the control points collected since G5.2."""
    state = control.state
    order, points = state.nurbs_order, state.nurbs_points
    if state.motion != 52:
        raise Fault("GS170", "G5.3 without a G5.2 before it", at="g5.3")
    if len(points) < order:
        raise Fault(
            "GS170",
            f"{len(points)} control points are too few for the order L{order}",
            at="g5.3",
            hint=f"give at least {order}, the start included",
            value=len(points),
            limit=order,
        )
    last = points[-1]
    end: Vector = (last[0], last[1], *state.current[2:])
    _emit(control, points, order, end, "G5.2")
    state.nurbs_order, state.nurbs_points = 0, ()
    state.motion = -1


def _with_left_over(control: Control, controls: Sequence[Point]) -> list[Weighted]:
    """The control points of a curve; as on the control, those of a G5.2 that no G5.3 ended come first."""
    state = control.state
    points = [*state.nurbs_points, *((x, y, 1.0) for x, y in controls)]
    if state.nurbs_points:
        control.warn("GS170", "the control points of the last G5.2 join this curve: no G5.3 ended them", "add G5.3")
        state.nurbs_points = ()
    return points


def _drop_points(control: Control) -> None:
    if control.state.nurbs_points:
        control.warn("GS170", "the control points of the last G5.2 are lost: no G5.3 ended them", "add G5.3")
        control.state.nurbs_points = ()


def _check(words: Words, control: Control, who: str) -> None:
    state = control.state
    at = who.lower() if who.lower() in words.names else None
    if state.plane != 170:
        raise Fault("GS170", f"{who} works in the XY plane only", at=at, hint="say G17")
    if state.side:
        raise Fault("GS150", f"{who} is refused while cutter compensation is on", at=at, hint="say G40 first")
    check_feed(words, control, who)
    if state.feed_mode == 930:
        raise Fault("GS170", f"{who} cannot be used under G93", at=at, hint="say G94 and F before")


def _need_pair(words: Words, first: str, second: str, who: str, hint: str = "") -> None:
    for letter in (first, second):
        if letter not in words.values:
            raise Fault("GS170", f"{who} needs both {first.upper()} and {second.upper()}", at=None, hint=hint)


def _only_plane(words: Words, who: str) -> None:
    for letter in "zabcuvw":
        if letter in words.values:
            raise Fault("GS170", f"{who} moves X and Y only, not {letter.upper()}", at=letter)


def _end(words: Words, control: Control, who: str) -> Vector:
    _only_plane(words, who)
    return end_point(words, control)


def _emit(control: Control, points: Sequence[Weighted], order: int, end: Vector, word: str) -> None:
    """The event of the curve; its polyline is as fine as `_FLATNESS` asks."""
    state = control.state
    unit = state.unit
    z = state.current[2]
    tail = state.current[3:]
    spans = len(points) - order + 1
    knots = [0.0] * order + [float(n) for n in range(1, spans)] + [float(spans)] * order
    controls, weights = [(x, y) for x, y, _ in points], [weight for _, _, weight in points]
    polyline = flatten(controls, weights, knots, order - 1, _FLATNESS / unit)
    feed, feed_unit = control.feed(linear=True)
    control.out.append(
        canon.SplineFeed(
            span=control.span,
            end=control.si_axes(control.tip(end)),
            block=control.block_number,
            word=word,
            points=tuple(control.si_point((x, y, z, *tail)) for x, y in polyline),
            control_points=tuple(control.si_point((x, y, z, *tail)) for x, y in controls),
            feed=feed,
            feed_unit=feed_unit,
        )
    )
    state.current = end


def flatten(
    controls: Sequence[Point], weights: Sequence[float], knots: Sequence[float], degree: int, flatness: float
) -> list[Point]:
    """Points on a rational B-spline such that chords stay within `flatness` of it.

    Each knot span is cut into equal parts; their number comes from the longest
    second difference of the control polygon, then is doubled while a midpoint
    is still too far from its chord.
    """
    spans = sorted(set(knots[degree : len(knots) - degree]))
    out = [_on_curve(controls, weights, knots, degree, spans[0])]
    for low, high in pairwise(spans):
        count = _FEWEST
        while True:
            points = [
                _on_curve(controls, weights, knots, degree, low + (high - low) * n / count)
                for n in range(2 * count + 1)
                if n <= count
            ]
            middles = [
                _on_curve(controls, weights, knots, degree, low + (high - low) * (n + 0.5) / count)
                for n in range(count)
            ]
            miss = max(_from_chord(m, a, b) for m, a, b in zip(middles, points, points[1:], strict=False))
            if miss <= flatness or count >= _MOST:
                break
            count *= 2
        out += points[1:]
    return out


def _from_chord(point: Point, a: Point, b: Point) -> float:
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = math.hypot(dx, dy)
    if length == 0.0:
        return math.dist(point, a)
    return abs((point[0] - a[0]) * dy - (point[1] - a[1]) * dx) / length


def _on_curve(
    controls: Sequence[Point], weights: Sequence[float], knots: Sequence[float], degree: int, at: float
) -> Point:
    """The curve's point at parameter `at`: de Boor's algorithm in homogeneous coordinates (de Boor 1972)."""
    span = degree
    while span < len(controls) - 1 and at >= knots[span + 1]:
        span += 1
    points = []
    for n in range(span - degree, span + 1):
        w = weights[n]
        points.append([controls[n][0] * w, controls[n][1] * w, w])
    for level in range(1, degree + 1):
        for n in range(degree, level - 1, -1):
            low, high = knots[n + span - degree], knots[n + 1 + span - level]
            part = (at - low) / (high - low)
            points[n] = [a + part * (b - a) for a, b in zip(points[n - 1], points[n], strict=True)]
    x, y, w = points[degree]
    return x / w, y / w
