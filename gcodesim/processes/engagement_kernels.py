"""Finds which part of an upright cutter's edge is in material, angle by angle.

The stock is sampled where the edge will be next: a point of the cutter's surface at
height z and angle phi is moved ahead, onto a circle that is larger by the
diagonal of a cell, and kept inside the width that the tool sweeps. So none of
the four columns that are sampled is one that the tool has cut already: a slot
counts as full from wall to wall wherever it lies on the grid, and force does
not ripple from cell to cell. A tool that follows its own finished wall touches
nothing.

Frame K: X (u) along the horizontal feed, Y (l) to its left, Z up to the holder; phi runs clockwise from Y
(spindle M3). The edge is cut into rows, each at one height; most loops run over the angles of one row.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.atan_kernels import acos
from gcodesim.arithmetic.sin_kernels import cos, sin
from gcodesim.compiled import kernel
from gcodesim.material.kernels import (
    ELSEWHERE,
    Field,
    Places,
    ToColumns,
    ask_places,
    breadth_along,
    coarsest,
    diagonal,
    fill_slices,
    occupancy,
    share_between,
    to_columns,
)

Array = NDArray[np.float64]

ANGLES = 64
SLICES = 16  # elements along the engaged part of one piece of the edge, at most
LEAST_SLICES = 4  # of a cylinder, whose elements are SLICE_CELLS high between these two limits
SLICE_CELLS = 2.0
UPRIGHT = 1.0e-12  # cosine of kappa below which a straight piece is part of a cylinder
LEAST_PIECES = 4  # of an edge for which there is room

# Columns of `Teeth.pieces`, the outline of an edge: see `Cutter.edge`.
ARC, AT_R, AT_Z, KAPPA, KAPPA_END, LENGTH, FOOT, HEAD = 0, 1, 2, 3, 4, 5, 6, 7

# Columns of `Room.rows`: radius and height of a row in its middle, kappa there, width, lowest and highest place,
# largest radius. Nearly all rows touch material at few angles, so each keeps the range of those; nothing else is worked
# on.
RADIUS, HEIGHT, SIN_KAPPA, COS_KAPPA, EDGE_WIDTH, LOW, HIGH, OUTER, FROM, TO = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
COLUMNS = 10

# An edge that moves into material at less than this share of its speed slides on it without cutting, as the flat bottom
# of an end mill in a horizontal cut, whose commanded height is never exactly constant.
LEAST_ADVANCE = 1.0e-4

# Up to this tangent of kappa an element of a falling tool is sampled so deep that its wall counts as full.
STEEPEST = 4.0

SAME_SHARE = 0.02  # up to which the shares of two angles are the same but for what earlier cuts have left

THIN = 1.0e-7  # [m] least height over which material is sampled


class Circle(NamedTuple):
    """Sine and cosine of phi at the angles (ANGLES,) at which a revolution is sampled."""

    sines: Array
    cosines: Array


class Heading(NamedTuple):
    """The direction of feed: horizontal (ux, uy), and how level and how steep it is; both are unit vectors."""

    ux: float
    uy: float
    level: float
    climb: float


class Room(NamedTuple):
    """Room to work in, made once for each cutter.

    rows (n, COLUMNS) of the edge; of each the share of it that is in material, weights (n, ANGLES), and the
    force (4, n, ANGLES) on one tooth along u, l, z [N] and its torque [N·m], within FROM..TO; sums (SUMS, ANGLES)
    over rows; unit (3, ANGLES): force per width; line, share and places (ANGLES,): what is asked of the stock; turning
    (4, 3 ANGLES + 1): force and torque of one tooth over its angle at the tip, twice, then those of all teeth.
    """

    rows: Array
    weights: Array
    force: Array
    sums: Array
    unit: Array
    line: Array
    share: Array
    places: Places
    turning: Array


@kernel(lean=True)
def lay_rows(pieces: Array, piece: int, height: float, cell: float, rows: Array) -> int:
    """Cut the part of a piece of the edge that is below `height` [m] into rows; returns their number."""
    radius, kappa0, kappa1 = pieces[piece, ARC], pieces[piece, KAPPA], pieces[piece, KAPPA_END]
    length, z0, z1 = pieces[piece, LENGTH], pieces[piece, FOOT], pieces[piece, HEAD]
    if z0 >= height or length <= 0.0:
        return 0
    if radius > 0.0:
        if z1 > height:
            kappa1 = acos(max((pieces[piece, AT_Z] - height) / radius, -1.0))
        step = (kappa1 - kappa0) / SLICES
        for i in range(SLICES):
            a = kappa0 + i * step
            kappa = a + 0.5 * step
            rows[i, RADIUS] = pieces[piece, AT_R] + radius * sin(kappa)
            rows[i, HEIGHT] = pieces[piece, AT_Z] - radius * cos(kappa)
            rows[i, SIN_KAPPA], rows[i, COS_KAPPA] = sin(kappa), cos(kappa)
            rows[i, EDGE_WIDTH] = radius * step
            rows[i, LOW] = pieces[piece, AT_Z] - radius * cos(a)
            rows[i, HIGH] = pieces[piece, AT_Z] - radius * cos(a + step)
            rows[i, OUTER] = pieces[piece, AT_R] + radius * max(sin(a), sin(a + step))  # undercut: the lower end
        return SLICES
    sine, cosine = sin(kappa0), cos(kappa0)
    if z1 > height:
        length = (height - z0) / sine
    number = SLICES
    if abs(cosine) < UPRIGHT:  # all at one radius, so that only their number over the height matters
        number = min(max(int(np.ceil(length / (SLICE_CELLS * cell))), LEAST_SLICES), SLICES)
    step = length / number
    for i in range(number):
        s = (i + 0.5) * step
        rows[i, RADIUS], rows[i, HEIGHT] = pieces[piece, AT_R] + s * cosine, z0 + s * sine
        rows[i, SIN_KAPPA], rows[i, COS_KAPPA] = sine, cosine
        rows[i, EDGE_WIDTH] = step
        rows[i, LOW], rows[i, HIGH] = z0 + i * step * sine, z0 + (i + 1) * step * sine
        rows[i, OUTER] = rows[i, RADIUS] + 0.5 * step * abs(cosine)
    return number


class Clearance(NamedTuple):
    """How far from the cutter to sample, so that no column around such a place is under it, all [m]."""

    cell: float  # width of the widest
    ahead: float  # of the cutter: the diagonal of a cell, for any direction
    aside: float  # inside its width: a cell seen along the feed


@kernel(lean=True, inlined=True)
def clearance_of(field: Field, heading: Heading) -> Clearance:
    """The clearances for a direction of feed."""
    return Clearance(coarsest(field), diagonal(field), breadth_along(field, heading.ux, heading.uy))


@kernel(lean=True)
def probe(
    r: float, outer: float, sine: float, cosine: float, ahead: float, aside: float, level: float
) -> tuple[float, float, float]:
    """Where to ask for material ahead of the point at radius r and angle phi: (u, l), and the way d there [m].

    outer: largest radius of the element; ahead, aside: see `Clearance`; level: share of the feed that is horizontal.
    d is the way along the feed.
    """
    x, y = r * sine, r * cosine
    if sine <= 0.0:
        return x + level * ahead, y, ahead
    inside = max(r - aside, 0.0)
    wide = min(max(y, -inside), inside)
    way = np.sqrt((outer + ahead) * (outer + ahead) - wide * wide) - x
    return x + level * way, y + level * (wide - y), way


@kernel(lean=True)
def turned(sine: float, cosine: float, angle: float) -> tuple[float, float]:
    """Sine and cosine a small `angle` (up to 0.1 rad) further on; series, exact to the last digits."""
    b = angle * angle
    s = angle * (1.0 - b / 6.0 * (1.0 - b / 20.0 * (1.0 - b / 42.0)))
    c = 1.0 - b / 2.0 * (1.0 - b / 12.0 * (1.0 - b / 30.0 * (1.0 - b / 56.0)))
    return sine * c + cosine * s, cosine * c - sine * s


@kernel(lean=True)
def plunge_way(rows: Array, i: int, cell: float, level: float) -> float:
    """Least way d [m] for row i: in a fall, enough to fill columns a cell nearer to the axis, whose floor is lower."""
    steep = STEEPEST if rows[i, SIN_KAPPA] > STEEPEST * rows[i, COS_KAPPA] else rows[i, SIN_KAPPA] / rows[i, COS_KAPPA]
    return float((1.0 - level) * (0.5 * (rows[i, HIGH] - rows[i, LOW]) + cell * steep))


@kernel(lean=True)
def share_at(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, rows: Array, i: int, sine: float, cosine: float
) -> float:
    """Share [-] of row i that is in material at one angle; see `contact_of_rows`."""
    ux, uy, level, climb = heading
    cell, ahead, aside = clearance
    px, py, way = probe(rows[i, RADIUS], rows[i, OUTER], sine, cosine, ahead, aside, level)
    x, y = tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py
    rise = climb * max(way, plunge_way(rows, i, cell, level) if climb < 0.0 else 0.0)
    low = tip[2] + rows[i, LOW] + rise + min(0.5 * (1.0 - level) * cell * climb, 0.0)
    high = max(tip[2] + rows[i, HIGH] + rise, low + THIN)
    return share_between(field, x, y, low, high)


@kernel(lean=True)
def behind_range(sines: Array, gain: float, fall: float) -> int:
    """How many angles from either side of the tool backwards an element may advance, up to a quarter of the circle.

    It does where gain sin(phi) > fall; sines (ANGLES,) of the angles.
    """
    for k in range(ANGLES // 4):
        if gain * sines[k] >= -fall:
            return k
    return ANGLES // 4


class Ring(NamedTuple):
    """A row of the edge as `lay_places` sees it, all [m]."""

    radius: float
    outer: float  # its largest radius and `ahead` together
    ahead: float
    inside: float  # greatest distance to the side
    least_way: float  # the shortest way along the feed


@kernel(lean=True, inlined=True)
def part_of(circle: Circle, begin: int, end: int) -> Circle:
    """Some of the angles."""
    return Circle(circle.sines[begin:end], circle.cosines[begin:end])


@kernel(lean=True, inlined=True)
def places_at(room: Room, begin: int, end: int) -> Places:
    """Room for the places of some angles."""
    us, vs, ups = room.places
    return Places(us[begin:end], vs[begin:end], ups[begin:end])


@kernel(lean=True, inlined=True)
def lay_places(circle: Circle, ring: Ring, heading: Heading, columns: ToColumns, places: Places) -> None:
    """Where to ask for material at many angles at once, as `probe` does for one.

    The loop has no branches and no dependence between its iterations.
    """
    sines, cosines = circle
    radius, outer, ahead, inside, least_way = ring
    _, _, level, climb = heading
    i0, j0, i_u, i_l, j_u, j_l, _, _, _, _ = columns
    us, vs, ups = places
    for k in range(us.shape[0]):
        px, py = radius * sines[k], radius * cosines[k]
        wide = min(max(py, -inside), inside)
        front = sines[k] > 0.0
        way = np.sqrt(outer * outer - wide * wide) - px if front else ahead
        py = py + level * (wide - py) if front else py
        px += level * way
        us[k] = i0 + i_u * px + i_l * py
        vs[k] = j0 + j_u * px + j_l * py
        ups[k] = climb * max(way, least_way)


@kernel(lean=True)
def leave_advancing(sines: Array, level: float, sin_kappa: float, fall: float, line: Array) -> bool:
    """Set the share (n,) to 0 where an element does not advance; returns whether any is left that is not known."""
    unknown = np.uint8(0)
    for k in range(line.shape[0]):
        share = line[k] if level * sines[k] * sin_kappa - fall > LEAST_ADVANCE else 0.0
        unknown |= np.uint8(share == ELSEWHERE)
        line[k] = share
    return bool(unknown > 0)


@kernel(lean=True)
def mark_steps(
    sines: Array, level: float, sin_kappa: float, fall: float, line: Array, copy: Array, steps: Array
) -> int:
    """Copy `line` (n,) and mark in `steps` (n,) where it changes by more than half from angle to angle, both advancing.

    Returns how many there are.
    """
    number = 0
    for k in range(line.shape[0]):
        copy[k] = line[k]
    steps[0] = 0.0
    # slices, because with an index that might be negative for all it knows the compiler takes one angle at a time
    before, after, step_after, sines_before, sines_after = line[:-1], line[1:], steps[1:], sines[:-1], sines[1:]
    for k in range(step_after.shape[0]):
        advancing = np.uint8(level * sines_after[k] * sin_kappa - fall > LEAST_ADVANCE)
        advancing &= np.uint8(level * sines_before[k] * sin_kappa - fall > LEAST_ADVANCE)
        step = advancing & np.uint8(abs(after[k] - before[k]) > 0.5)
        step_after[k] = 1.0 if step else 0.0
        number += 1 if step else 0
    return number


@kernel(lean=True)
def reach_of(share: Array, steps: Array) -> tuple[int, int]:
    """The range of angles whose `share` (n,) is not 0, or may get part of a neighbour's across a step."""
    n = share.shape[0]
    begin, end = 0, n
    while begin < n and share[begin] <= 0.0:
        begin += 1
    if begin == n:
        return n, 0
    while share[end - 1] <= 0.0:
        end -= 1
    if steps[begin] > 0.0:
        begin -= 1
    if end < n and steps[end] > 0.0:
        end += 1
    return begin, end


@kernel(lean=True)
def goes_on(known: Array, k: int, rises: bool) -> bool:
    """Whether the share still changes from angle k - 1 to k, in the same direction; less than 0 is no share."""
    if known[k - 1] < 0.0 or known[k] < 0.0:
        return False
    change = known[k] - known[k - 1]
    return bool(change > SAME_SHARE if rises else change < -SAME_SHARE)


@kernel(lean=True)
def ramp_at(known: Array, k: int) -> tuple[int, int, int]:
    """The angles (first, last) between which the share changes where it does so most, from k - 1 to k.

    A wall is as soft as a column is wide, so that its neighbours may lie on the same ramp. Also the angle `after`: half
    of the change is between it and the one before.
    """
    first, last, rises = k - 1, k, known[k] > known[k - 1]
    if first > 0 and goes_on(known, first, rises):
        first -= 1
    if last + 1 < known.shape[0] and goes_on(known, last + 1, rises):
        last += 1
    half, after = 0.5 * (known[first] + known[last]), first + 1
    while after < last and (known[after] < half if rises else known[after] > half):
        after += 1
    return first, last, after


@kernel(lean=True)
def crossing(least: float, most: float, low: float, high: float, half: float) -> float:
    """Where the share is `half`, between two places with `low` and `high`."""
    return least + (most - least) * min(max((half - low) / (high - low), 0.0), 1.0) if high != low else least


@kernel(lean=True)
def set_limit(weights: Array, i: int, first: int, last: int, limit: float) -> None:
    """Share out row i between what it has at the angles `first` and `last`: the one up to `limit` [angles], the other.

    Angle k stands for all from k to k + 1.
    """
    before, behind = weights[i, first], weights[i, last]
    for k in range(first, last + 1):
        part = min(max(limit - k, 0.0), 1.0)
        weights[i, k] = part * before + (1.0 - part) * behind


@kernel(lean=True)
def contact_of_rows(
    field: Field, circle: Circle, tip: Array, heading: Heading, room: Room, first: int, number: int, last: int
) -> bool:
    """Fill weights[first:first + number, :last]: share of each element in material at each angle at which it advances.

    0 where it does not advance. Returns whether there is any, and keeps the range of those angles in each row.

    An element is asked where it will be a way d further along the feed; falling, half a cell more is asked for
    below, so that contact grows gradually.
    Where contact begins or ends between two angles, the limit is found by halving and the weight is shared out.
    """
    ux, uy, level, climb = heading
    clearance = clearance_of(field, heading)
    cell, ahead, aside = clearance
    columns = to_columns(field, tip, ux, uy)
    sines, rows, weights = circle.sines, room.rows, room.weights
    found = False
    for i in range(first, first + number):
        sin_kappa, fall = rows[i, SIN_KAPPA], climb * rows[i, COS_KAPPA]
        least_way = plunge_way(rows, i, cell, level) if climb < 0.0 else 0.0
        ring = Ring(rows[i, RADIUS], rows[i, OUTER] + ahead, ahead, max(rows[i, RADIUS] - aside, 0.0), least_way)
        bottom, top = tip[2] + rows[i, LOW] + min(0.5 * (1.0 - level) * cell * climb, 0.0), tip[2] + rows[i, HIGH]
        top = max(top, bottom + THIN)
        line = weights[i, :last]
        behind = behind_range(sines, level * sin_kappa, LEAST_ADVANCE + fall) if last == ANGLES else 0
        front_end, back_begin = min(ANGLES // 2 + behind, last), last - behind
        line[front_end:back_begin] = ELSEWHERE  # nothing advances there; rounding may leave one to be sampled
        for begin, end in ((0, front_end), (back_begin, last)):
            places = places_at(room, begin, end)
            lay_places(part_of(circle, begin, end), ring, heading, columns, places)
            ask_places(columns, places, bottom, top, line[begin:end])
        if leave_advancing(sines, level, sin_kappa, fall, line):
            for k in range(last):
                if line[k] == ELSEWHERE:
                    line[k] = share_at(field, tip, heading, clearance, rows, i, sines[k], circle.cosines[k])
        begin, end = share_out_steps(field, circle, tip, heading, clearance, room, i, last)
        rows[i, FROM], rows[i, TO] = begin, end
        found = found or end > begin
    return found


@kernel(lean=True, inlined=True)
def share_out_steps(
    field: Field, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, room: Room, i: int, last: int
) -> tuple[int, int]:  # fmt: skip
    """Find where contact of row i begins or ends between two angles, and share that out; the range of its angles."""
    sines, cosines, rows, weights = circle.sines, circle.cosines, room.rows, room.weights
    fall = heading.climb * rows[i, COS_KAPPA]
    known, steps = room.places.us[:last], room.places.vs[:last]  # the places are no longer needed
    left = mark_steps(sines, heading.level, rows[i, SIN_KAPPA], fall, weights[i, :last], known, steps)
    begin, end = reach_of(known, steps)
    done = 0
    for k in range(last):
        if left == 0:
            break
        if steps[k] == 0.0:
            continue
        left -= 1
        if k < done:
            continue
        first, last_one, after = ramp_at(known, k)
        half, rises = 0.5 * (known[first] + known[last_one]), known[last_one] > known[first]
        least, most, low, high = 0.0, 1.0, known[after - 1], known[after]
        for _ in range(4):
            middle = 0.5 * (least + most)
            sine, cosine = turned(sines[after - 1], cosines[after - 1], middle * (2.0 * np.pi / ANGLES))
            between = share_at(field, tip, heading, clearance, rows, i, sine, cosine)
            if (between > half) == rises:
                most, high = middle, between
            else:
                least, low = middle, between
        set_limit(weights, i, first, last_one, after - 0.5 + crossing(least, most, low, high, half))
        begin, end, done = min(begin, first), max(end, last_one + 1), last_one + 1
    return begin, end


@kernel(lean=True)
def contact_of_cylinder(
    field: Field, circle: Circle, tip: Array, heading: Heading, room: Room, first: int, number: int
) -> bool:
    """The same for all rows of a cylinder at once, first..first+number: they stand above each other."""
    ux, uy, level, climb = heading
    _, ahead, aside = clearance_of(field, heading)
    half = ANGLES // 2
    rows, weights, line, share = room.rows, room.weights, room.line, room.share[:half]
    radius, widest = rows[first, RADIUS], rows[first, OUTER]
    bottom, top = tip[2] + rows[first, LOW], tip[2] + rows[first + number - 1, HIGH]
    height = (top - bottom) / number
    ring, places = Ring(radius, widest + ahead, ahead, max(radius - aside, 0.0), 0.0), places_at(room, 0, half)
    columns = to_columns(field, tip, ux, uy)
    lay_places(part_of(circle, 0, half), ring, heading, columns, places)
    ask_places(columns, places, bottom, top, share)
    begin, end = half, 0
    for k in range(half):
        sine, cosine = circle.sines[k], circle.cosines[k]
        if level * sine <= LEAST_ADVANCE:
            weights[first : first + number, k] = 0.0
            share[k] = ELSEWHERE
            continue
        if share[k] == 0.0 or share[k] >= 1.0 - 1.0e-9:  # all of it, or nothing
            total = 0.0 if share[k] == 0.0 else 1.0
            for i in range(number):
                weights[first + i, k] = total
        else:
            px, py, way = probe(radius, widest, sine, cosine, ahead, aside, level)
            x, y = tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py
            z0 = bottom + climb * way
            total = fill_slices(field, x, y, z0, height, line[:number]) / number
            for i in range(number):
                weights[first + i, k] = line[i]
        share[k] = total
        if total > 0.0:
            begin = min(begin, k)
            end = k + 1
    done = 1
    for k in range(1, half):
        earlier, total = share[k - 1], share[k]
        if k < done or earlier < 0.0 or total < 0.0 or abs(total - earlier) <= 0.5 * max(total, earlier):
            continue
        from_k, to_k, after = ramp_at(share, k)
        middle_share, rises = 0.5 * (share[from_k] + share[to_k]), total > earlier
        least, most, low, high = 0.0, 1.0, share[after - 1], share[after]
        for _ in range(4):
            middle = 0.5 * (least + most)
            sine, cosine = turned(circle.sines[after - 1], circle.cosines[after - 1], middle * (2.0 * np.pi / ANGLES))
            px, py, way = probe(radius, widest, sine, cosine, ahead, aside, level)
            z0, z1 = bottom + climb * way, top + climb * way
            x, y = tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py
            between = occupancy(field, x, y, z0, z1)
            if (between > middle_share) == rises:
                most, high = middle, between
            else:
                least, low = middle, between
        limit = after - 0.5 + crossing(least, most, low, high, middle_share)
        for i in range(first, first + number):
            set_limit(weights, i, from_k, to_k, limit)
        begin, end, done = min(begin, from_k), max(end, to_k + 1), to_k + 1
    weights[first : first + number, half:] = 0.0
    rows[first : first + number, FROM] = begin
    rows[first : first + number, TO] = end
    return end > begin
