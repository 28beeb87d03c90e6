"""Finds where contact of a row begins or ends between two angles: its seams.

A share that jumps from one angle to the next is looked at more closely: the place between them is found by halving,
and the weight of both is shared out there. The rows of a piece of the edge are searched together, since nothing that
one finds concerns another, so that several are sampled at a time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.kernels import ELSEWHERE, Field, Spots, ask_spots, share_between
from gcodesim.processes.edge_kernels import (
    ANGLES,
    FROM,
    HEIGHT,
    HIGH,
    LEAST_ADVANCE,
    LOW,
    OUTER,
    RADIUS,
    SLICES,
    THIN,
    TO,
    Circle,
    Clearance,
    Heading,
    off_way,
    on_way,
    plunge_way,
    probe,
    turned,
)
from gcodesim.processes.limit_kernels import (
    NO_LIMIT,
    SAME_SHARE,
    EdgeBand,
    EdgeSpot,
    Walls,
    is_at,
    of_radius,
)

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

HALVINGS = 4
SEAMS = SLICES * ANGLES + 8  # for which there is room: more than a piece can have, and no power of two apart in memory


# Rows of `Seams.places`: the row of the edge, and what `ramp_at` says.
ROW, FIRST, LAST, AFTER = 0, 1, 2, 3
PLACES = 4
# Rows of `Seams.numbers`: half of the change, and whether it rises (1 or 0); sine and cosine of the angle before
# `after`; radius, largest radius, lowest and highest place of the row, and the least way to ask ahead [m]; the parts of
# an angle between which the search goes on, and the shares there; where to ask next [m], and the share there; the limit
# that was found [angles], what the row has before it less what it has behind it, and that times its height [m]; the
# limit if a wall has told it before, or NO_LIMIT; how much higher to ask for each way ahead [-].
(
    HALF, RISES, SINE, COSINE, RADII, OUTERS, LOWS, HIGHS, WAYS, LEAST, MOST, SHARE_LEAST, SHARE_MOST,
    X, Y, BOTTOM, TOP, SHARE, LIMIT, DROP, LEVER, TOLD, CLIMBS,
) = range(23)  # fmt: skip
NUMBERS = 23


class Seams(NamedTuple):
    """Seams of a piece of the edge: places (PLACES, SEAMS) and numbers (NUMBERS, SEAMS)."""

    places: Indices
    numbers: Array


class Steps(NamedTuple):
    """Shares (n,) of a row at all angles, and where they change by more than half: see `mark_steps`.

    For a tool that rises also how much of its climb the surface has there.
    """

    known: Array
    marks: Array
    leans: Array


class SeamRows(NamedTuple):
    """Of seams (n,): sine and cosine of the angle before, and of the row there what `Seams.numbers` says [m]."""

    sines: Array
    cosines: Array
    radii: Array
    outers: Array
    lows: Array
    highs: Array
    ways: Array
    climbs: Array


@kernel(lean=True)
def share_at(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, rows: Array, i: int, sine: float, cosine: float
) -> float:
    """Share [-] of row i that is in material at one angle; see `contact_of_rows`."""
    ux, uy, level, climb, turn = heading
    cell, ahead, aside = clearance
    px, py, way = probe(rows[i, RADIUS], rows[i, OUTER], sine, cosine, ahead, aside, level, turn)
    x, y = tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py
    rise = climb * max(way, plunge_way(rows, i, cell, level) if climb < 0.0 else 0.0)
    low = tip[2] + rows[i, LOW] + rise + min(0.5 * (1.0 - level) * cell * climb, 0.0)
    high = max(tip[2] + rows[i, HIGH] + rise, low + THIN)
    return share_between(field, x, y, low, high)


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
def set_limit(weights: Array, i: int, first: int, last: int, limit: float) -> float:
    """Share out row i between what it has at the angles `first` and `last`: the one up to `limit` [angles], the other.

    Angle k stands for all from k to k + 1. Returns what it has before the limit less what it has behind it.
    """
    before, behind = weights[i, first], weights[i, last]
    for k in range(first, last + 1):
        part = min(max(limit - k, 0.0), 1.0)
        weights[i, k] = part * before + (1.0 - part) * behind
    return float(before - behind)


@kernel(lean=True)
def note_seams(
    circle: Circle, tip: Array, heading: Heading, clearance: Clearance, rows: Array, i: int, found: Steps, left: int,
    seams: Seams, number: int,
) -> int:  # fmt: skip
    """Add those of row i to the first `number` seams; how many there are then. Widens the row's range of angles.

    `mark_steps` has found `left` steps. There has to be room for as many.
    """
    known, steps, leans = found
    places, numbers = seams
    sines, cosines = circle
    begin, end, done = rows[i, FROM], rows[i, TO], 0
    for k in range(known.shape[0]):
        if left == 0:
            break
        if steps[k] == 0.0:
            continue
        left -= 1
        if k < done:
            continue
        first, last, after = ramp_at(known, k)
        places[ROW, number], places[FIRST, number], places[LAST, number], places[AFTER, number] = i, first, last, after
        numbers[HALF, number] = 0.5 * (known[first] + known[last])
        numbers[RISES, number] = 1.0 if known[last] > known[first] else 0.0
        numbers[SINE, number], numbers[COSINE, number] = sines[after - 1], cosines[after - 1]
        numbers[RADII, number], numbers[OUTERS, number] = rows[i, RADIUS], rows[i, OUTER]
        numbers[LOWS, number], numbers[HIGHS, number] = tip[2] + rows[i, LOW], tip[2] + rows[i, HIGH]
        falling = heading.climb < 0.0
        numbers[CLIMBS, number] = heading.climb * leans[after - 1] if heading.climb > 0.0 else heading.climb
        numbers[WAYS, number] = plunge_way(rows, i, clearance.cell, heading.level) if falling else 0.0
        numbers[LEAST, number], numbers[MOST, number], numbers[TOLD, number] = 0.0, 1.0, NO_LIMIT
        numbers[SHARE_LEAST, number], numbers[SHARE_MOST, number] = known[after - 1], known[after]
        begin, end, done = min(begin, first), max(end, last + 1), last + 1
        number += 1
    rows[i, FROM], rows[i, TO] = begin, end
    return number


@kernel(lean=True)
def lay_spots(
    tip: Array, heading: Heading, clearance: Clearance, rows: SeamRows, least: Array, most: Array, spots: Spots
) -> None:
    """Where to ask half-way of each search (n,), as `share_at` does for one angle.

    The loop has no branches and no dependence between its iterations.
    """
    ux, uy, level, climb, turn = heading
    cell, ahead, aside = clearance
    sines, cosines, radii, outers, lows, highs, ways, climbs = rows
    xs, ys, bottoms, tops = spots
    tip_x, tip_y, dip = tip[0], tip[1], min(0.5 * (1.0 - level) * cell * climb, 0.0)
    for k in range(xs.shape[0]):
        sine, cosine = turned(sines[k], cosines[k], 0.5 * (least[k] + most[k]) * (2.0 * np.pi / ANGLES))
        x, y = radii[k] * sine, radii[k] * cosine
        inside = max(radii[k] - aside, 0.0)
        outer = outers[k] + ahead
        wide = min(max(off_way(radii[k] * radii[k], y, turn), -inside), inside)
        wide = min(max(on_way(outer * outer, wide, turn), -outer), outer)
        front = sine > 0.0
        way = np.sqrt(outer * outer - wide * wide) - x if front else ahead
        px, py = x + level * way, y + level * (wide - y) if front else y
        rise = climbs[k] * max(way, ways[k])
        low = lows[k] + rise + dip
        xs[k], ys[k] = tip_x + ux * px - uy * py, tip_y + uy * px + ux * py
        bottoms[k], tops[k] = low, max(highs[k] + rise, low + THIN)


@kernel(lean=True)
def narrow(
    share: Array, half: Array, rises: Array, least: Array, most: Array, share_least: Array, share_most: Array
) -> None:
    """Half each search (n,), by the share that was found in its middle."""
    for k in range(share.shape[0]):
        middle, beyond = 0.5 * (least[k] + most[k]), (share[k] > half[k]) == (rises[k] > 0.0)
        least[k], most[k] = least[k] if beyond else middle, middle if beyond else most[k]
        share_least[k] = share_least[k] if beyond else share[k]
        share_most[k] = share[k] if beyond else share_most[k]


@kernel(lean=True)
def span_of(tip: Array, heading: Heading, clearance: Clearance, rows: Array, i: int) -> EdgeBand:
    """Row i as it meets a wall."""
    least_way = plunge_way(rows, i, clearance.cell, heading.level) if heading.climb < 0.0 else 0.0
    bottom = tip[2] + rows[i, LOW] + min(0.5 * (1.0 - heading.level) * clearance.cell * heading.climb, 0.0)
    return EdgeBand(rows[i, RADIUS], bottom, max(tip[2] + rows[i, HIGH], bottom + THIN), least_way)


@kernel(lean=True)
def tell_limits(
    tip: Array, heading: Heading, clearance: Clearance, spots: Spots, seams: Seams, walls: Walls
) -> bool:  # fmt: skip
    """Which of the first n seams, at the spots (n,), are at one of the walls; whether any is at neither."""
    places, numbers = seams
    rest = False
    for k in range(spots.xs.shape[0]):
        if numbers[TOLD, k] != NO_LIMIT:
            continue
        spot = EdgeSpot(spots.xs[k], spots.ys[k], spots.bottoms[k], spots.tops[k])
        if is_at(walls.left, tip, heading, clearance, spot):
            angle = of_radius(walls.left, numbers[RADII, k], heading.turn).angle
        elif is_at(walls.right, tip, heading, clearance, spot):
            angle = of_radius(walls.right, numbers[RADII, k], heading.turn).angle
        else:
            rest = True
            continue
        numbers[TOLD, k] = angle if places[AFTER, k] < ANGLES // 2 else ANGLES - angle  # met in front and behind
    return rest


@kernel(lean=True, inlined=True)
def is_any_untold(told: Array) -> bool:
    """Whether no wall and no surface has told one of the limits (n,) yet."""
    untold = False
    for k in range(told.shape[0]):
        untold |= told[k] == NO_LIMIT
    return untold


@kernel(lean=True)
def note_limit(seams: Seams, number: int, i: int, first: int, last: int, limit: float) -> None:
    """Make seam `number` one of row i whose limit is known, between the angles `first` and `last`."""
    places, numbers = seams
    places[ROW, number], places[FIRST, number], places[LAST, number], places[AFTER, number] = i, first, last, last
    for what in range(NUMBERS):
        numbers[what, number] = 0.0
    numbers[TOLD, number] = limit


@kernel(lean=True)
def settle_seams(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, rows: Array, number: int, seams: Seams,
    weights: Array, walls: Walls,
) -> None:  # fmt: skip
    """Find the first `number` seams, and share out the weights (rows, ANGLES) there; by halving where no wall is."""
    places, numbers = seams.places, seams.numbers[:, :number]
    least, most, half, share = numbers[LEAST], numbers[MOST], numbers[HALF], numbers[SHARE]
    share_least, share_most = numbers[SHARE_LEAST], numbers[SHARE_MOST]
    spots = Spots(numbers[X], numbers[Y], numbers[BOTTOM], numbers[TOP])
    at_seams = SeamRows(
        numbers[SINE], numbers[COSINE], numbers[RADII], numbers[OUTERS], numbers[LOWS], numbers[HIGHS], numbers[WAYS],
        numbers[CLIMBS],
    )  # fmt: skip
    known = walls.left.angle != NO_LIMIT or walls.right.angle != NO_LIMIT
    for halving in range(HALVINGS if is_any_untold(numbers[TOLD]) else 0):
        lay_spots(tip, heading, clearance, at_seams, least, most, spots)
        if halving == 0 and known and not tell_limits(tip, heading, clearance, spots, seams, walls):
            break
        if ask_spots(field, spots, share):
            for k in range(number):
                if share[k] == ELSEWHERE:
                    angle = 0.5 * (least[k] + most[k]) * (2.0 * np.pi / ANGLES)
                    sine, cosine = turned(numbers[SINE, k], numbers[COSINE, k], angle)
                    own = Heading(heading.ux, heading.uy, heading.level, numbers[CLIMBS, k], heading.turn)
                    share[k] = share_at(field, tip, own, clearance, rows, places[ROW, k], sine, cosine)
        narrow(share, half, numbers[RISES], least, most, share_least, share_most)
    for k in range(number):
        i, where = places[ROW, k], crossing(least[k], most[k], share_least[k], share_most[k], half[k])
        limit = places[AFTER, k] - 0.5 + where if numbers[TOLD, k] == NO_LIMIT else numbers[TOLD, k]
        drop = set_limit(weights, i, places[FIRST, k], places[LAST, k], limit)
        numbers[LIMIT, k], numbers[DROP, k], numbers[LEVER, k] = limit, drop, drop * rows[i, HEIGHT]
