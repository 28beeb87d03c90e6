"""Joints between curves: which are passed, rounded or overlapped; arrays and scalars in and out."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.atan_kernels import acos, atan2
from gcodesim.arithmetic.sin_kernels import cos, cos_sin, sin, tan
from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.motion.corner_kernels import corner_center, corner_radius, part_for_corner, way_from_corner
from gcodesim.motion.curve_kernels import ACCELERATION, ROUND, SPEED, STRAIGHT, CurveColumns

# Constants of the motion planner. They are those of LinuxCNC 2.9, measured on its own planner.
# The two shares on arcs belong to any planner that reserves acceleration in curves; the others are specific to it
# and make the difference between 5 % and 1 % of time.

# Share of the acceleration that bends the path on arcs and corner arcs: sqrt(3)/2, so half of it is left along it.
NORMAL_SHARE: Final = math.sqrt(3.0) / 2.0
# Share along the path where the normal share is used up.
TANGENTIAL_SHARE: Final = 0.5
# A step of direction is passed at the speed where it asks for this share of the acceleration within one cycle;
# the blocks on both sides then have to make do with the rest. The cycle may also speed up in the next block by all that
# it has, and beside an arc only `TANGENTIAL_SHARE` of the acceleration is there for it (`tpSetupTangent` in tp.c).
KINK_SHARE: Final = 0.1
CYCLE: Final = 1e-3  # [s]
# The last block before the queue runs empty in G64, and blocks that overlap, use this share, in both their ramps.
OPEN_END_SHARE: Final = 0.5
# G64 rounds corners within this share of the shorter block, with P too.
TOLERANCE_SHARE: Final = 0.25
# A corner takes at most this share of an arc that ends there, and of one that begins there.
ENDING_SHARE: Final = 2.0 / 3.0
BEGINNING_SHARE: Final = 1.0 / 3.0
# Two arcs whose tangents, or secants, meet under less than twice this angle [rad] overlap.
NARROWEST_OF_ARCS: Final = math.pi / 12.0
ROUNDING: Final = 1e-6  # by which a corner may miss its point, and take of its curves, more than it may
# Where a path turns back to within this angle [rad] the machine stands at the end of the block, also in G64:
# `tpSetupTangent` in tp.c calls it a sharp corner. The cosine from there on, of that angle by the sum of the tangents.
TURNED_BACK: Final = math.radians(2.0)
REVERSAL: Final = 0.5 * TURNED_BACK * TURNED_BACK - 1.0
# Chords that are merged into one line.
LONGEST_CHAIN: Final = 100

# [m] by which an arc may rise or widen and still be rounded like a plane one: rounding of a program's last digit
FLAT: Final = 2e-6

# what happens at the end of a curve
STAND = 0
PASS = 1
ROUNDED = 2
OVERLAPPED = 3


class Tangents(NamedTuple):
    """Derivatives by s (c, 6) at the start and at the end of each curve."""

    first: Column
    last: Column


class JointColumns(NamedTuple):
    """What happens at the end of each of c curves, one row a curve.

    `kind` STAND, PASS, ROUNDED or OVERLAPPED. The joint begins `trim_end` before the end of the curve and ends
    `trim_start`, in the next curve's row, behind its start. `cap` is the greatest speed there [m/s] and `reduction` the
    share of a curve's acceleration that a kink takes. Of a corner arc: what its plane allows as `acceleration`, and
    `arc` (c, 10), its centre, the radius vectors at its start and a quarter turn on, and its angle. Of an overlap: its
    `duration` [s], the `ratio` of the speeds behind and before, and the `rise`, the share of the time after which the
    curve behind has that speed.
    """

    kind: Column
    trim_end: Column
    trim_start: Column
    cap: Column
    reduction: Column
    acceleration: Column
    arc: Column
    ratio: Column
    rise: Column
    duration: Column


@kernel(inlined=True)
def off_chord(point: Column, begin: Column, m0: float, m1: float, m2: float, square: float) -> float:
    """Square of the distance of `point` (3,) from the line that leads from `begin` (3,) by m, of that `square`."""
    p0, p1, p2 = point[0] - begin[0], point[1] - begin[1], point[2] - begin[2]
    t = min(max((m0 * p0 + m1 * p1 + m2 * p2) / square, 0.0), 1.0)
    d0, d1, d2 = p0 - t * m0, p1 - t * m1, p2 - t * m2
    off: float = d0 * d0 + d1 * d1 + d2 * d2
    return off


@kernel(short=True)
def merge_chords(start: Column, end: Column, joined: Column, tolerance: Column, flat: Column, middle: Column) -> Column:
    """For each row (n,) the first row of the chain it belongs to.

    Row i may continue the chain when `joined[i]`; it does while all points
    passed by lie within `tolerance` [m] of the straight line from the chain's
    start to the new end: ends of rows, and the `middle` (n, 3) of arcs, which are `flat`.
    """
    n = len(joined)
    first = np.arange(n)
    for i in range(1, n):
        head = first[i - 1]
        if not joined[i] or i - head > LONGEST_CHAIN:
            continue
        m0 = end[i, 0] - start[head, 0]
        m1 = end[i, 1] - start[head, 1]
        m2 = end[i, 2] - start[head, 2]
        square = m0 * m0 + m1 * m1 + m2 * m2
        if square == 0.0:
            continue
        limit = tolerance[i] * tolerance[i]
        fits = True
        for j in range(i, head - 1, -1):
            if (j < i and off_chord(end[j], start[head], m0, m1, m2, square) > limit) or (
                flat[j] and off_chord(middle[j], start[head], m0, m1, m2, square) > limit
            ):
                fits = False
                break
        if fits:
            first[i] = head
    return first


@kernel(short=True)
def along_axes(step: Column, length: Column, axis_limits: Column) -> tuple[Column, Column]:
    """Speed and acceleration (c,) that the axes allow where they go by `step` (c, 6) evenly over `length` (c,)."""
    n = len(length)
    speed, acceleration = np.empty(n), np.empty(n)
    for i in range(n):
        way = length[i] if length[i] > 0.0 else 1.0
        v, a = np.inf, np.inf
        for k in range(6):
            share = abs(step[i, k]) / way
            if share > 1e-12:
                v = min(v, axis_limits[SPEED, k] / share)
                a = min(a, axis_limits[ACCELERATION, k] / share)
        speed[i], acceleration[i] = v, a
    return speed, acceleration


@kernel
def in_plane(n0: float, n1: float, n2: float, limits: Column) -> float:
    """The greatest length that a vector of any direction in the plane with unit normal n may have.

    The circle inscribed in the box of `limits` cut by the plane: a direction in
    the plane has at most sqrt(1 - n_i²) of its length along axis i.
    """
    best = 1e30
    for limit, n in ((limits[0], n0), (limits[1], n1), (limits[2], n2)):
        share = math.sqrt(max(1.0 - n * n, 0.0))
        if share > 1e-6:
            best = min(best, limit / share)
    return best


@kernel
def turned_speed(first: Column, turned: Column, angle: float, limits: Column) -> float:
    """The greatest speed in all directions cos(w) first + sin(w) turned (3,), unit vectors, w from 0 to `angle`."""
    best = 1e30
    for k in range(3):
        share = max(abs(first[k]), abs(cos(angle) * first[k] + sin(angle) * turned[k]))
        peak = atan2(turned[k], first[k])  # where the component is greatest; or least, half a turn away
        if peak < 0.0:
            peak += math.pi
        if peak < angle:
            share = math.sqrt(first[k] * first[k] + turned[k] * turned[k])
        if share > 1e-12:
            best = min(best, limits[k] / share)
    return best


@kernel
def length_of(v: Column) -> float:
    """Length of the vector (3,)."""
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def bend_of(i: int, n: Column, at_end: bool, curves: CurveColumns) -> tuple[float, float]:
    """Radius (0: a line) and side about `n` (3,) of curve `i` at one of its ends; radius -1 when not in that plane."""
    if curves.kind[i] == STRAIGHT:
        return 0.0, 1.0
    if curves.kind[i] != ROUND:
        return -1.0, 1.0
    radial, sideways, growth = curves.radial, curves.sideways, curves.growth
    r = length_of(radial[i])
    rise = length_of(curves.lift[i])
    if rise > FLAT or abs(growth[i]) * r > FLAT:
        return -1.0, 1.0
    m0 = radial[i, 1] * sideways[i, 2] - radial[i, 2] * sideways[i, 1]
    m1 = radial[i, 2] * sideways[i, 0] - radial[i, 0] * sideways[i, 2]
    m2 = radial[i, 0] * sideways[i, 1] - radial[i, 1] * sideways[i, 0]
    cosine = (m0 * n[0] + m1 * n[1] + m2 * n[2]) / (r * r)
    if abs(cosine) < 1.0 - 1e-9:
        return -1.0, 1.0
    side = 1.0 if cosine * curves.sweep[i] > 0.0 else -1.0
    return (r * (1.0 + growth[i]) if at_end else r), side


@kernel(inlined=True)
def step_of_direction(i: int, tangents: Tangents, axis_limits: Column) -> tuple[float, float]:
    """Share of the acceleration that each m/s takes at the end of curve `i`, and the cosine of the turn there."""
    first, last = tangents
    kink = 0.0
    cosine = 0.0
    for k in range(3):
        kink = max(kink, abs(first[i + 1, k] - last[i, k]) / axis_limits[ACCELERATION, k])
        cosine += last[i, k] * first[i + 1, k]
    return kink / CYCLE, cosine


@kernel(inlined=True)
def axes_of_corner(i: int, cosine: float, tangents: Tangents, across: Column, normal: Column) -> None:
    """The unit vectors to the side to which the path turns behind curve `i`, and of the corner's plane, both (3,)."""
    first, last = tangents
    size = 0.0
    for k in range(3):
        across[k] = first[i + 1, k] - cosine * last[i, k]
        size += across[k] * across[k]
    size = math.sqrt(size)
    for k in range(3):
        across[k] /= size
    normal[0] = last[i, 1] * across[2] - last[i, 2] * across[1]
    normal[1] = last[i, 2] * across[0] - last[i, 0] * across[2]
    normal[2] = last[i, 0] * across[1] - last[i, 1] * across[0]


@kernel(inlined=True)
def round_corner(
    i: int,
    cosine: float,
    reach: float,
    kink_speed: float,
    tolerance: Column,
    tangents: Tangents,
    axis_limits: Column,
    curves: CurveColumns,
    joints: JointColumns,
    room: Column,
) -> int:
    """What becomes of the corner behind curve `i`: ROUNDED, with its arc; PASS if that is no faster; or OVERLAPPED."""
    last = tangents.last
    across, normal = room[0], room[1]
    turn = acos(min(max(cosine, -1.0), 1.0))
    axes_of_corner(i, cosine, tangents, across, normal)
    r1, side1 = bend_of(i, normal, True, curves)
    r2, side2 = bend_of(i + 1, normal, False, curves)
    if r1 < 0.0 or r2 < 0.0:
        return OVERLAPPED
    # half of the angle between the curves, and the ways to both sides of the corner
    half = 0.5 * (math.pi - turn)
    length1, length2 = curves.length[i], curves.length[i + 1]
    left = length1 - joints.trim_start[i]
    way1, most1, narrower1 = min(left, 0.5 * length1), left, 0.0
    if r1 > 0.0:
        most1, way1, narrower1 = part_for_corner(r1, side1, ENDING_SHARE * left / r1, half)
        most1 *= r1
    way2, most2, narrower2 = 0.5 * length2, length2, 0.0
    if r2 > 0.0:
        most2, way2, narrower2 = part_for_corner(r2, side2, BEGINNING_SHARE * length2 / r2, half)
        most2 *= r2
    half -= max(narrower1, narrower2)
    if r1 > 0.0 and r2 > 0.0 and half < NARROWEST_OF_ARCS:
        return OVERLAPPED
    missed = TOLERANCE_SHARE * min(length1, length2)
    for j in (i, i + 1):
        if tolerance[j] > 0.0:
            missed = min(missed, tolerance[j])
    most = in_plane(normal[0], normal[1], normal[2], axis_limits[ACCELERATION])
    a_n = NORMAL_SHARE * most
    space = corner_radius(half, missed, way1, way2)
    v = min(reach, turned_speed(last[i], across, turn, axis_limits[SPEED]))
    v = min(v, math.sqrt(a_n * space))
    if v <= kink_speed:
        return PASS
    # not larger than the speed needs, but as long as two ramps to rest at half the acceleration would be
    ramp = TANGENTIAL_SHARE * most
    slowed = min(v, math.sqrt(2.0 * ramp * space / tan(half)))
    radius = max(v * v / a_n, min(space, v * slowed / (ramp * (math.pi - 2.0 * half))))
    x, y = corner_center(turn, r1, side1, r2, side2, radius)
    trim1, trim2 = -way_from_corner(x, y, 0.0, r1, side1), way_from_corner(x, y, turn, r2, side2)
    more = 1.0 + ROUNDING
    near = math.sqrt(x * x + y * y) - radius <= missed * more  # false where there is no such circle
    if not (near and 0.0 <= trim1 <= most1 * more and 0.0 <= trim2 <= most2 * more):
        return OVERLAPPED
    trim1, trim2 = min(trim1, most1), min(trim2, most2)
    joints.cap[i] = v
    joints.acceleration[i] = most
    joints.trim_end[i], joints.trim_start[i + 1] = trim1, trim2
    # directions of the path, as angles from X, where the arc begins and ends
    begin = 0.0 if r1 == 0.0 else -side1 * joints.trim_end[i] / r1
    leave = turn if r2 == 0.0 else turn + side2 * joints.trim_start[i + 1] / r2
    c, s = cos_sin(begin)
    end, arc = curves.end, joints.arc
    for k in range(3):
        arc[i, k] = end[i, k] + x * last[i, k] + y * across[k]
        arc[i, 3 + k] = radius * (s * last[i, k] - c * across[k])
        arc[i, 6 + k] = radius * (c * last[i, k] + s * across[k])
    arc[i, 9] = leave - begin
    return ROUNDED


@kernel(short=True)
def corners(
    stop: Column,
    blended: Column,
    turning: Column,
    speed: Column,
    acceleration: Column,
    tolerance: Column,
    tangents: Tangents,
    axis_limits: Column,
    curves: CurveColumns,
    joints: JointColumns,
) -> None:
    """Decide what happens at the end of every curve but the last; results go into `joints`.

    `turning` is set where a rotary axis moves, `speed` and `acceleration` are what each curve may reach.
    """
    room = np.empty((2, 3))
    for i in range(len(stop) - 1):
        joints.kind[i] = STAND
        if stop[i]:
            continue
        if turning[i] or turning[i + 1]:
            if blended[i]:
                joints.kind[i] = OVERLAPPED
            continue
        kink, cosine = step_of_direction(i, tangents, axis_limits)
        if cosine < REVERSAL:
            continue  # a stop of the program's own: it takes nothing of the acceleration
        slower = min(speed[i], speed[i + 1])
        share = kink * (slower + acceleration[i + 1] * CYCLE)
        if curves.kind[i] == ROUND or curves.kind[i + 1] == ROUND:
            share /= TANGENTIAL_SHARE
        reduction = joints.reduction
        if share <= KINK_SHARE:
            joints.kind[i] = PASS
            joints.cap[i] = 1e30
            reduction[i] = max(reduction[i], share)
            reduction[i + 1] = max(reduction[i + 1], share)
            continue
        reach = max(speed[i], speed[i + 1])
        kink_speed = slower * KINK_SHARE / share
        kind = STAND  # G61 passes only what is as good as tangent
        if blended[i]:
            kind = round_corner(i, cosine, reach, kink_speed, tolerance, tangents, axis_limits, curves, joints, room)
        joints.kind[i] = kind
        if kind in (STAND, PASS):
            joints.cap[i] = kink_speed if kind == PASS else 0.0
            reduction[i] = KINK_SHARE
            reduction[i + 1] = KINK_SHARE


@kernel(short=True)
def overlaps(
    left: Column,
    speed: Column,
    acceleration: Column,
    tolerance: Column,
    even: bool,
    early: bool,
    tangents: Tangents,
    axis_limits: Column,
    joints: JointColumns,
) -> None:
    """Fill in the joints where the end of a curve overlaps with the start of the next; `even`: both equally fast.

    `left` is what corner arcs leave of each curve, `acceleration` already the
    share that such blocks have. Both ramps last T; the corner is missed by
    v² cos t / (4 a), with half included angle t, which P limits. Where the tip stands in one of the two curves and only
    rotary axes turn, no corner is missed. If it goes `early`, the curve behind has all of its acceleration, whatever P
    says, and goes on at its speed as soon as it has that (`tpUpdateBlend` in tp.c: it sets what only blocks that wait
    for the spindle look at).
    """
    first, last = tangents
    for i in range(len(left) - 1):
        if joints.kind[i] != OVERLAPPED:
            continue
        a1, a2 = acceleration[i], acceleration[i + 1]
        v1 = min(speed[i], math.sqrt(a1 * left[i]))
        v2 = min(speed[i + 1], math.sqrt(a2 * left[i + 1]))
        ramp = min(min(left[i] / v1, left[i + 1] / v2), max(v1 / a1, v2 / a2))
        v1, v2 = min(v1, ramp * a1), min(v2, ramp * a2)
        if tolerance[i] > 0.0:
            cosine, before, behind = 0.0, 0.0, 0.0
            for k in range(3):
                cosine += last[i, k] * first[i + 1, k]
                before += last[i, k] * last[i, k]
                behind += first[i + 1, k] * first[i + 1, k]
            sharp = math.sqrt(max(0.5 * (1.0 - cosine), 0.0))  # cosine of half the included angle
            if sharp > 1e-3 and before > 0.0 and behind > 0.0:
                most = 2.0 * math.sqrt(a1 * tolerance[i] / sharp)
                v1, v2 = min(v1, most), min(v2, most)
        ramp = v1 / a1
        if early:
            v2 = min(speed[i + 1], math.sqrt(a2 * left[i + 1]))
        v2 = min(v2, a2 * ramp)
        if even:
            v1 = min(v1, v2)
            v2 = v1
            ramp = v1 / min(a1, a2)
        joints.duration[i] = ramp
        joints.cap[i] = v1
        joints.ratio[i] = v2 / v1
        joints.trim_end[i] = 0.5 * v1 * ramp
        joints.rise[i] = v2 / (a2 * ramp) if early else 1.0
        for k in range(6):  # an axis that goes on in its direction must not have more than its speed by both
            before, behind = abs(last[i, k]) * v1, abs(first[i + 1, k]) * v2
            if last[i, k] * first[i + 1, k] > 0.0 and before > 1e-12:
                joints.rise[i] = min(max(joints.rise[i], 1.0 - (axis_limits[SPEED, k] - behind) / before), 1.0)
        joints.trim_start[i + 1] = v2 * ramp * (1.0 - 0.5 * joints.rise[i])
