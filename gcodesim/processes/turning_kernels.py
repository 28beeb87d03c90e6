"""What a tool of a lathe takes along its way, and the force of that, piece by piece."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.power_kernels import power
from gcodesim.compiled import kernel
from gcodesim.material.kernels import discs_across, ring_at, swept_outline, take_ring

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Flags = NDArray[np.bool_]

(
    REMOVED,
    FX,
    FY,
    FZ,
    TORQUE,
    POWER,
    CHIP,
    MAIN,
    FEEDING,
    PASSIVE,
    SHANK,
    GUARD,
    BACK,
    RAPID,
    STILL,
    THREADED,
    BUSY,
    INSIDE,
) = range(18)
OUTPUTS = 18

TURN, LAST, PLACED = range(3)
STATE = 3
"""What is carried from piece to piece: turns of the spindle in this thread, whether the last piece was one;
0 for a tool that was just put in, 1 while it is in material since then, 2 after that."""

LEANING = 0.05
"""A feed counts as one along z from this share of it on: less is a cut on a face, which back edges may do."""

LEAST = 1.0e-11
"""What a tool may touch where it is put in [m³]; pi times as much is a hundredth of a cubic millimetre."""

NEAR = 1.0e-6
"""How far [m] before an edge it is asked whether there is material."""


class Discs(NamedTuple):
    """The stock: discs of the profile and of the section with threads; scratch arrays (n,)."""

    lo: Array
    hi: Array
    number: Ints
    thread_lo: Array
    thread_hi: Array
    thread_number: Ints
    z: float
    dz: float
    low: Array
    high: Array
    threaded: bool


class Blade(NamedTuple):
    """The tool: outlines (m, 2) of what cuts and what holds it, and elements of its edges.

    element (e, 8): z, r of its middle, outward normal z and r, width [m], 1 where it may cut, how many times the force
    of a sharp edge it bears, and by what it is pressed into the material [N/m], however thin the chip. `teeth` share
    the feed of a turn; the forces of two and more balance across the spindle. `law` (3, 3) as in `laws`, `feels`
    whether it holds. `behind` is the side along z (1, -1, or 0) to which the tip leaves the contour that it has made:
    a back edge that cuts there while the tip moves on gouges.
    guards (g, 8, 2) are outlines of what may not be touched, with `corners` (g,) points each.
    """

    outline: Array
    shank: Array
    elements: Array
    teeth: float
    law: Array
    feels: bool
    outward: float
    behind: float
    guards: Array
    corners: Ints


class BladeWay(NamedTuple):
    """c pieces: start and end (c, 2) in (z, r) [m], step (c,), share (c,) of its time, speed (c,) [m/s].

    Columns (n,) of the steps:

    spindle [rev/s], pitch [m/turn] of a thread or 0, rapid.
    """

    start: Array
    end: Array
    step: Ints
    share: Array
    speed: Array
    spindle: Array
    pitch: Array
    rapid: Flags


@kernel(lean=True)
def _cut(
    lo: Array, hi: Array, number: Ints, z: float, dz: float, hull: Array, count: int, low: Array, high: Array
) -> tuple[float, bool]:
    """Take an outline of `count` points out of discs: volume over pi [m³], and whether rings came or went.

    There is room for one ring more in every disc.
    """
    first, last = discs_across(hull, count, z, dz, low, high)
    total, news = 0.0, False
    for j in range(first, last):
        before = number[j]
        if before == 0:
            continue
        a, b = _ring(low[j], high[j])
        taken = take_ring(lo, hi, number, j, a, b)
        if taken > 0.0:
            total += taken * dz
            news = news or number[j] != before
    return total, news


@kernel(lean=True, inlined=True)
def _ring(low: float, high: float) -> tuple[float, float]:
    """The radii that a cut from `low` to `high` passes: what is beyond the axis takes nothing."""
    return max(0.0, low), max(0.0, high)


@kernel(lean=True)
def _would_take(lathe: Discs, hull: Array, count: int) -> tuple[float, float]:
    """Volume over pi [m³] that an outline would take, and the middle of its least and greatest radius [m]."""
    first, last = discs_across(hull, count, lathe.z, lathe.dz, lathe.low, lathe.high)
    total, inner, outer = 0.0, np.inf, 0.0
    for j in range(first, last):
        a, b = _ring(lathe.low[j], lathe.high[j])
        for i in range(lathe.number[j]):
            near, far = max(a, lathe.lo[j, i]), min(b, lathe.hi[j, i])
            if far > near:
                total += (far * far - near * near) * lathe.dz
                inner, outer = min(inner, near), max(outer, far)
    return total, 0.5 * (inner + outer) if outer > 0.0 else 0.0


@kernel(lean=True)
def _depth_in(lathe: Discs, hull: Array, count: int) -> float:
    """How deep [m] along r an outline is in material."""
    first, last = discs_across(hull, count, lathe.z, lathe.dz, lathe.low, lathe.high)
    deepest = 0.0
    for j in range(first, last):
        a, b = _ring(lathe.low[j], lathe.high[j])
        b = max(b, -lathe.low[j])  # what reaches beyond the axis meets the other side
        for i in range(lathe.number[j]):
            deepest = max(deepest, min(b, lathe.hi[j, i]) - max(a, lathe.lo[j, i]))
    return deepest


@kernel(lean=True)
def _apart(one: Array, count: int, other: Array, corners: int) -> float:
    """The widest gap between two convex outlines across any of their edges; below 0, how deep they overlap."""
    widest = -np.inf
    for which in range(2):
        a, n = (one, count) if which == 0 else (other, corners)
        b, m = (other, corners) if which == 0 else (one, count)
        for i in range(n):
            k = i + 1 if i + 1 < n else 0
            ez, er = a[k, 0] - a[i, 0], a[k, 1] - a[i, 1]
            length = np.sqrt(ez * ez + er * er)
            if length <= 0.0:
                continue
            nearest = np.inf
            for s in range(m):
                nearest = min(nearest, ((b[s, 0] - a[i, 0]) * er - (b[s, 1] - a[i, 1]) * ez) / length)
            widest = max(widest, nearest)
    return widest


@kernel(lean=True)
def _is_in_work(lathe: Discs, element: Array, at: Array) -> bool:
    """Whether there is material before an element of a tool at `at` (2,).

    A disc has the section in its middle, so it is asked half a disc farther: else half of all places at a slope would
    lie between the slope and the stair of discs that stands for it.
    """
    half = 0.5 * lathe.dz if element[2] > 0.0 else -0.5 * lathe.dz if element[2] < 0.0 else 0.0
    z, r = at[0] + element[0] + NEAR * element[2] + half, at[1] + element[1] + NEAR * element[3]
    return ring_at(lathe.lo, lathe.hi, lathe.number, lathe.z, lathe.dz, z, r)


@kernel(lean=True)
def _forces(
    lathe: Discs,
    blade: Blade,
    at: Array,
    uz: float,
    ur: float,
    turn_feed: float,
    section: float,
    part: float,
    out: Array,
) -> float:
    """Forces on the elements that are in material at `at` (2,), scaled so that their chips have the `section` [m²].

    (uz, ur) is the unit vector along the feed. Adds `part` of them to out: FX, FY, FZ, TORQUE, MAIN, FEEDING, PASSIVE;
    CHIP becomes the thickest chip. Returns the share of the volume that edges take which should not: a chip farther
    from the axis is a longer one.
    """
    chips, volume, wrong, feed = 0.0, 0.0, 0.0, turn_feed / blade.teeth
    for e in range(len(blade.elements)):
        element = blade.elements[e]
        h = feed * (element[2] * uz + element[3] * ur)
        if h <= 1.0e-9:
            continue
        if _is_in_work(lathe, element, at):
            chips += h * element[4]
            round_once = h * element[4] * abs(at[1] + element[1])
            volume += round_once
            if element[5] == 0.0 and (blade.behind == 0.0 or uz * blade.behind < -LEANING):
                wrong += round_once
    if chips <= 0.0:
        return 0.0
    scale = section / blade.teeth / chips
    for e in range(len(blade.elements)):
        element = blade.elements[e]
        h = feed * (element[2] * uz + element[3] * ur)
        if h <= 1.0e-9:
            continue
        if not _is_in_work(lathe, element, at):
            continue
        out[CHIP] = max(out[CHIP], h)
        if not blade.feels:
            continue
        b, press = element[4] * element[6] * scale, element[4] * element[7] * scale
        law = blade.law
        tangential = b * (law[0, 0] * power(h, law[0, 1]) + law[0, 2])
        normal = b * (law[1, 0] * power(h, law[1, 1]) + law[1, 2])
        along = b * (law[2, 0] * power(h, law[2, 1]) + law[2, 2])
        tz, tr = -element[3], element[2]  # along the edge, away from the work
        if tr * blade.outward < 0.0:
            tz, tr = -tz, -tr
        fz, fr = -normal * element[2] + along * tz, -normal * element[3] + along * tr
        fz += press if element[2] < 0.0 else -press
        out[TORQUE] += part * blade.teeth * tangential * abs(at[1] + element[1])
        out[MAIN] += part * blade.teeth * tangential
        out[FEEDING] -= part * blade.teeth * (fz * uz + fr * ur)
        out[FZ] += part * blade.teeth * fz
        if blade.teeth < 2.0:
            out[FY] -= part * tangential
            out[FX] += part * fr
            out[PASSIVE] += part * (fr * uz - fz * ur)
    return wrong / volume if volume > 0.0 else 0.0


@kernel(lean=True)
def _placed(outline: Array, z: float, r: float, out: Array) -> int:
    """`outline` moved by (z, r) into `out`; the number of its points."""
    for p in range(len(outline)):
        out[p, 0], out[p, 1] = outline[p, 0] + z, outline[p, 1] + r
    return len(outline)


@kernel(lean=True)
def _guarded(blade: Blade, hull: Array, count: int) -> float:
    """How deep [m] an outline is in something that may not be touched."""
    deepest = 0.0
    for g in range(len(blade.corners)):
        deepest = max(deepest, -_apart(hull, count, blade.guards[g], blade.corners[g]))
    return deepest


@kernel(lean=True)
def _thread(lathe: Discs, blade: Blade, start: Array, end: Array, pitch: float, state: Array, hull: Array) -> float:
    """Cut the section with threads where the spindle passes its zero mark between two places: volume over pi [m³]."""
    dz, dr = end[0] - start[0], end[1] - start[1]
    turns = np.sqrt(dz * dz + dr * dr) / pitch
    if state[LAST] == 0.0:
        state[TURN] = 0.0
    state[LAST] = 1.0
    total, reached = 0.0, np.ceil(state[TURN] - 1.0e-9)
    while turns > 0.0 and reached < state[TURN] + turns - 1.0e-9:
        part = (reached - state[TURN]) / turns
        count = _placed(blade.outline, start[0] + part * dz, start[1] + part * dr, hull)
        taken, _ = _cut(
            lathe.thread_lo,
            lathe.thread_hi,
            lathe.thread_number,
            lathe.z,
            lathe.dz,
            hull,
            count,
            lathe.low,
            lathe.high,
        )
        total += taken
        reached += 1.0
    state[TURN] += turns
    return total


@kernel(lean=True)
def turn(
    lathe: Discs, blade: Blade, way: BladeWay, done: int, state: Array, hull: Array, scratch: Array, out: Array
) -> tuple[int, bool]:
    """Cut along the pieces from `done` on; out (n, OUTPUTS).

    Returns how many pieces are done, and whether rings came or went: then the stock has to look for loose pieces and
    make room before the next one. `hull` and `scratch` have room for all outlines.
    """
    for c in range(done, len(way.step)):
        k = way.step[c]
        start, end = way.start[c], way.end[c]
        dz, dr = end[0] - start[0], end[1] - start[1]
        length = np.sqrt(dz * dz + dr * dr)
        if state[PLACED] < 2.0:
            count = _placed(blade.outline, start[0], start[1], hull)
            here, _ = _would_take(lathe, hull, count)
            state[PLACED] = 1.0 if here > LEAST else 2.0
        if state[PLACED] == 1.0:
            out[k, INSIDE] = 1.0
            continue
        if way.pitch[k] > 0.0:
            taken = _thread(lathe, blade, start, end, way.pitch[k], state, hull)
            out[k, THREADED] += np.pi * taken
            if taken > 0.0:
                out[k, BUSY] = 1.0
            continue
        if state[LAST] > 0.0:  # where a thread ends the work turns on before the tool is out: it has cut a groove there
            state[LAST] = 0.0
            count = _placed(blade.outline, start[0], start[1], hull)
            taken, news = _cut(lathe.lo, lathe.hi, lathe.number, lathe.z, lathe.dz, hull, count, lathe.low, lathe.high)
            out[k, REMOVED] += np.pi * taken
            if news:
                return c, True
        points = _placed(blade.outline, start[0], start[1], scratch)
        count = swept_outline(scratch[:points], dz, dr, hull)
        out[k, GUARD] = max(out[k, GUARD], _guarded(blade, hull, count))
        expected, radius = _would_take(lathe, hull, count)
        if expected > 0.0:
            if length > 0.0 and way.spindle[k] > 0.0 and radius > 0.0 and not way.rapid[k]:
                feed = way.speed[c] / way.spindle[k]
                section = expected / (2.0 * radius * length) * feed
                wrong = _forces(lathe, blade, start, dz / length, dr / length, feed, section, way.share[c], out[k])
                out[k, BACK] += wrong * np.pi * expected
            taken, news = _cut(lathe.lo, lathe.hi, lathe.number, lathe.z, lathe.dz, hull, count, lathe.low, lathe.high)
            out[k, REMOVED] += np.pi * taken
            out[k, BUSY] = 1.0
            if way.rapid[k]:
                out[k, RAPID] += np.pi * taken
            elif way.spindle[k] <= 0.0:
                out[k, STILL] += np.pi * taken
            if lathe.threaded:
                _cut(
                    lathe.thread_lo,
                    lathe.thread_hi,
                    lathe.thread_number,
                    lathe.z,
                    lathe.dz,
                    hull,
                    count,
                    lathe.low,
                    lathe.high,
                )
        else:
            news = False
        if len(blade.shank) > 0:
            points = _placed(blade.shank, end[0], end[1], scratch)
            out[k, SHANK] = max(out[k, SHANK], _depth_in(lathe, scratch, points))
            out[k, GUARD] = max(out[k, GUARD], _guarded(blade, scratch, points))
        if news:
            return c + 1, True
    return len(way.step), False
