"""The moves of Fanuc's turning cycles; lengths in program units, X as a radius."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from gcodesim.arithmetic.scalars import tan
from gcodesim.rs274.block import Block
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.roughing import ContourMove, Point, chords, passes
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.rs274.fanuc.lathe import FanucLatheExecutor

_MOST = 10_000
_ESCAPE = 0.5 * MM  # of G71 and G72 where the program says none: a parameter on the machine


def single(lathe: FanucLatheExecutor, block: Block, index: int, code: float, values: dict[str, float]) -> None:
    """G90 (along Z), G94 (along X) and G92 (thread): out to the cut, along it, back."""
    z0, x0 = lathe.here()
    z, x = lathe.end_of(values, (z0, x0))
    taper, feed = values.get("r", 0.0), values.get("f")
    if code == 94.0:
        lathe.move(block, index, True, z + taper, x0)
        lathe.move(block, index, False, z, x, feed)
        lathe.move(block, index, False, z0, x)
        lathe.move(block, index, True, z0, x0)
        return
    lathe.move(block, index, True, z0, x + taper)
    if code == 92.0:
        _thread_to(lathe, block, index, z, x, feed)
        lathe.move(block, index, True, z, x0)
    else:
        lathe.move(block, index, False, z, x, feed)
        lathe.move(block, index, False, z, x0)
    lathe.move(block, index, True, z0, x0)


def _thread_to(lathe: FanucLatheExecutor, block: Block, index: int, z: float, x: float, pitch: float | None) -> None:
    if pitch is None:
        raise Fault("GS105", "a thread needs its lead F")
    lathe.say(block, index, [("g", 33.0), ("x", x), ("z", z), ("k", pitch)])


def in_one_block(code: float, values: dict[str, float]) -> tuple[dict[str, float], dict[str, float]] | None:
    """The words of a cycle's two blocks, where it is written in one; None where it is not.

    D is the depth of a cut in G71 and G72 and the number of cuts in G73, of which I and K are the way aside; in G76 it
    is the first cut, K the height, A the angle, I the taper. In G74 and G75 I and K are the steps along X and Z.
    """
    if code in (74.0, 75.0):
        if values.keys().isdisjoint("ik"):
            return None
        along, aside = ("k", "i") if code == 74.0 else ("i", "k")
        steps = {"q_fine" if code == 74.0 else "p_fine": values.get(along, 0.0)}
        return {}, values | steps | {"p_fine" if code == 74.0 else "q_fine": values.get(aside, 0.0)}
    if "d" not in values:
        return None
    if code == 73.0:
        return {"r": values["d"], "u": values.get("i", 0.0), "w": values.get("k", 0.0)}, values
    if code == 76.0:
        one = {"p_fine": values.get("k", 0.0), "q_fine": values["d_fine"], "r": values.get("i", 0.0)}
        return {"finishing": 0.0, "angle": values.get("a", 0.0)}, values | one
    return {"u" if code == 71.0 else "w": values["d_fine"]}, values


def rough(
    lathe: FanucLatheExecutor,
    block: Block,
    index: int,
    code: float,
    first: dict[str, float],
    values: dict[str, float],
    contour: Sequence[ContourMove],
    *,
    pockets: bool,
) -> None:
    """G71, G72: passes above the contour, then along it with the allowance; G73: the contour again and again."""
    start = lathe.here()
    shift = (values.get("w", 0.0), 0.5 * values.get("u", 0.0))
    if code == 73.0:
        count = max(1, round(first.get("r", 1.0)))
        for k in range(count):
            share = 1.0 - k / (count - 1) if count > 1 else 0.0
            off = (shift[0] + share * first.get("w", 0.0), shift[1] + share * first.get("u", 0.0))
            lathe.move(block, index, True, start[0] + off[0], start[1] + off[1])
            follow(lathe, block, index, contour, off)
            lathe.move(block, index, True, start[0] + off[0], start[1] + off[1])
        lathe.move(block, index, True, *start)
        return
    depth = first.get("u" if code == 71.0 else "w", 0.0)
    if depth <= 0.0:
        letter = "U" if code == 71.0 else "W"
        message = f"G{code:g} needs the depth of a cut: {letter} in a line before, G{code:g} {letter}2. R0.5, or D"
        raise Fault("GS105", message)
    points = [(z + shift[0], x + shift[1]) for z, x in chords(start, contour)[1:]]
    swap = code == 72.0
    inside = not swap and max(x for _, x in points) > start[1] + 1e-9 and min(x for _, x in points) >= start[1] - 1e-9
    if not swap and not inside:
        inside = points[-1][1] < points[0][1] and start[1] <= points[-1][1] + 1e-9

    def turned(point: Point) -> Point:
        z, x = point
        return (x, z) if swap else (z, -x if inside else x)

    escape = first.get("r", _ESCAPE / lathe.control.state.unit)
    for rapid, a, b in passes([turned(p) for p in points], turned(start), depth, escape, pockets=pockets):
        z, x = (b, a) if swap else (a, -b if inside else b)
        lathe.move(block, index, rapid, z, x)
    lathe.move(block, index, True, *start)
    follow(lathe, block, index, contour, shift)
    lathe.move(block, index, True, *start)


def follow(lathe: FanucLatheExecutor, block: Block, index: int, contour: Sequence[ContourMove], shift: Point) -> None:
    """Along a contour, shifted."""
    for move in contour:
        z, x = move.end[0] + shift[0], move.end[1] + shift[1]
        if not move.sense:
            lathe.move(block, index, move.rapid, z, x)
            continue
        here = lathe.here()
        centre = (move.centre[0] + shift[0] - here[0], move.centre[1] + shift[1] - here[1])
        code = 3.0 if move.sense > 0 else 2.0
        lathe.say(block, index, [("g", code), ("x", x), ("z", z), ("i", centre[1]), ("k", centre[0])])


def pecks(
    lathe: FanucLatheExecutor,
    block: Block,
    index: int,
    code: float,
    first: dict[str, float],
    values: dict[str, float],
) -> None:
    """G74 (along Z) and G75 (along X): cuts in steps with short ways back, side by side."""
    start = lathe.here()
    z, x = lathe.end_of(values, start)
    along_z = code == 74.0
    (deep0, deep1), (side0, side1) = ((start[0], z), (start[1], x)) if along_z else ((start[1], x), (start[0], z))
    step = values.get("q_fine" if along_z else "p_fine") or abs(deep1 - deep0)
    aside = values.get("p_fine" if along_z else "q_fine") or abs(side1 - side0)
    back = first.get("r", 0.0)
    down, over = math.copysign(1.0, deep1 - deep0), math.copysign(1.0, side1 - side0)
    if step <= 0.0 or abs(deep1 - deep0) / step > _MOST:
        raise Fault("GS106", f"G{code:g} with steps of {step:g} never ends", at="q" if along_z else "p")

    def to(deep: float, side: float, *, rapid: bool) -> None:
        lathe.move(block, index, rapid, *((deep, side) if along_z else (side, deep)))

    side = side0
    for _ in range(_MOST):
        to(deep0, side, rapid=True)
        depth = deep0
        while (deep1 - depth) * down > 1e-9:
            depth = depth + down * min(step, abs(deep1 - depth))
            to(depth, side, rapid=False)
            if back > 0.0 and depth != deep1:
                to(depth - down * back, side, rapid=True)
        to(deep0, side, rapid=True)
        if abs(side1 - side) < 1e-9 or aside <= 0.0:
            break
        side = side + over * min(aside, abs(side1 - side))
    to(deep0, side0, rapid=True)


def thread(
    lathe: FanucLatheExecutor, block: Block, index: int, first: dict[str, float], values: dict[str, float]
) -> None:
    """G76: passes of even section, depth q sqrt(n) but at least the least cut, moved along the flank."""
    z0, x0 = lathe.here()
    z, x = lathe.end_of(values, (z0, x0))
    code = round(first.get("p", 10060.0))
    finishing, angle = round(first.get("finishing", max(1, code // 10000))), first.get("angle", float(code % 100))
    height, cut, pitch = values.get("p_fine", 0.0), values.get("q_fine", 0.0), values.get("f")
    least, allowance, taper = first.get("q_fine", 0.0), first.get("r", 0.0), values.get("r", 0.0)
    if height <= 0.0 or cut <= 0.0 or pitch is None:
        raise Fault("GS105", "G76 needs the height P, the first cut Q and the lead F, or K, D and F in one block")
    sign = 1.0 if x0 >= x else -1.0
    peak = x + sign * height
    slope = tan(math.radians(0.5 * angle)) * (1.0 if z <= z0 else -1.0)
    depth, number = 0.0, 0
    while depth < height - allowance - 1e-9:
        number += 1
        if number > _MOST:
            raise Fault("GS106", "G76 never reaches its depth", at="q")
        depth = min(max(cut * math.sqrt(number), depth + least), height - allowance)
        _thread_pass(lathe, block, index, (z0 - depth * slope, x0), (z, peak - sign * depth), taper, pitch)
    for _ in range(finishing):
        depth = height
        _thread_pass(lathe, block, index, (z0 - depth * slope, x0), (z, x), taper, pitch)
    lathe.move(block, index, True, z0, x0)


def _thread_pass(
    lathe: FanucLatheExecutor, block: Block, index: int, begin: Point, end: Point, taper: float, pitch: float
) -> None:
    lathe.move(block, index, True, *begin)
    lathe.move(block, index, True, begin[0], end[1] + taper)
    _thread_to(lathe, block, index, end[0], end[1], pitch)
    lathe.move(block, index, True, end[0], begin[1])
