"""In which part of a step the rows of an edge are at the walls in front of them.

Material is looked for a diagonal of a cell ahead of the edge, so that a front is seen as full wherever it lies on the
grid. What stands there may be the front that the tool has just cut, which its teeth meet at once, or the wall at which
earlier levels have ended, or the side of a block, which they meet later, or never where the way ends before. Where
walls are known to be, by less than a cell, tells which: a row whose wall is farther away than it advances in a step has
no contact in it, and one that comes there within the step has contact in the rest of it.

So contact grows with the place to which a tip comes, from nothing: what a wall does to a machine that bends, and how
far the machine bends, can be solved together.

A tip that bends springs back from the front that it has cut, and to it, in steps that are too long to tell when its
teeth lose it. What it has met it therefore still meets as long as it may be so far away by springing: its `SLACK`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.compiled import kernel
from gcodesim.material.column_kernels import is_of_one_layer
from gcodesim.material.kernels import AT_RIM, LINES, NOTHING, Field, Rim, coarsest, first_away, gap_outside
from gcodesim.processes.edge_kernels import (
    ANGLES,
    FROM,
    HEIGHT,
    HIGH,
    LEAST_ADVANCE,
    LOW,
    RADIUS,
    TO,
    Array,
    Circle,
    Heading,
)
from gcodesim.processes.engagement_kernels import Room
from gcodesim.processes.seam_kernels import AFTER, DROP, FIRST, LAST, LEVER, LIMIT, ROW

HALF = ANGLES // 2
# Places in `State.felt`: by how much the tip may spring [m]; then up to which height [m] it was in contact in the step
# before, for each of ANGLES directions in S, from X on to the left.
SPRING, UP_TO = 0, 1
FELT = UP_TO + ANGLES
# Places in `Room.step`: where the tip really was before the step, x and y, and its level way in it [m], in S; then what
# `State.felt` has.
FROM_X, FROM_Y, WAY_X, WAY_Y, SLACK, MET = 0, 1, 2, 3, 4, 5
STEP = MET + ANGLES
NOT_MET = -1.0e9  # [m]
NOT_ASKED = -2.0e9  # [m] of a gap where nothing is in contact anyway
NEVER = 1.0e3  # steps until a wall is met that is out of reach
LEAST_CONTACT = 1.0e-6  # share of a row that is not rounding
# planes of `Room.arrivals`
GAP, ABOVE, REST = 0, 1, 2
ARRIVALS = 3


@kernel(lean=True)
def note_step(step: Array, begin: Array, way_x: float, way_y: float, felt: Array) -> None:
    """Note in `step` (STEP,) that the tip goes from `begin` (3,) on, by that way [m], and has `felt` (FELT,) so far."""
    step[FROM_X], step[FROM_Y], step[WAY_X], step[WAY_Y] = begin[0], begin[1], way_x, way_y
    step[SLACK] = felt[SPRING]
    if felt[SPRING] > 0.0:
        for i in range(ANGLES):
            step[MET + i] = felt[UP_TO + i]


@kernel(lean=True, inlined=True)
def first_direction(heading: Heading) -> int:
    """The direction of S in which angle 0 of a heading lies: that of angle k is so many less k, modulo ANGLES."""
    turns = atan2(heading.uy, heading.ux) / (2.0 * np.pi) + 0.25
    return int(np.floor(turns * ANGLES - 0.5)) + 2 * ANGLES


@kernel(lean=True, inlined=True)
def met_near(step: Array, direction: int) -> float:
    """Up to which height [m] the edge was in contact in a direction of S, or beside it: a tip also turns a little."""
    highest = NOT_MET
    for at in range(direction - 1, direction + 2):
        highest = max(highest, step[MET + at % ANGLES])
    return float(highest)


@kernel(lean=True)
def remember(room: Room, heading: Heading, tip: Array, used: int, felt: Array) -> None:
    """Keep in `felt` (FELT,) up to which height the first `used` rows are in contact in each direction."""
    for i in range(ANGLES):
        felt[UP_TO + i] = NOT_MET
    if felt[SPRING] == 0.0:
        return
    zero = first_direction(heading)
    for i in range(used):
        top = tip[2] + room.rows[i, HIGH]
        for k in range(int(room.rows[i, FROM]), int(room.rows[i, TO])):
            if room.weights[i, k] > LEAST_CONTACT:
                at = UP_TO + (zero - k) % ANGLES
                felt[at] = max(felt[at], top)


class Front(NamedTuple):
    """What the rim looks at in one direction of S, the unit vector (x, y).

    near: gaps [m] that are none; far: those that are not known; slack: by how much the tip may have sprung away from
    what it has met, up to the height `met` there and `beside` it or there; rises: the tool climbs. All [m].
    """

    x: float
    y: float
    near: float
    far: float
    slack: float
    met: float
    beside: float
    rises: bool


@kernel(lean=True, inlined=True)
def counted(gap: float, middle: float, front: Front) -> float:
    """A gap [m] at a height [m] as it counts: 0 if it is none, also to what the tip has sprung away from."""
    if gap == NOTHING and front.rises:
        return 0.0  # it was asked for higher ahead, where a floor or a top rises with the tool
    if gap == NOTHING:
        return 0.0 if front.far <= front.slack and middle < front.met else gap
    if abs(gap) <= front.near or (0.0 < gap <= front.slack and middle < front.beside):
        return 0.0
    return gap


@kernel(lean=True)
def gaps_in(field: Field, rim: Rim, front: Front, room: Room, lowest: float, span: tuple[int, int], k: int) -> bool:
    """Fill `room.arrivals` at angle k for the rows first..end of a `span`, of which the first begins at a height [m].

    What is in material of a row is its lower part. Where it is not all of the row, the rest may be at a wall that is
    farther away than what is below its foot. Returns whether any row is not at its wall yet.
    """
    first, end = span
    height = room.rows[first, HIGH] - room.rows[first, LOW]
    size, foot, waits = NOTHING, np.inf, False
    for i in range(end - 1, first - 1, -1):
        room.arrivals[GAP, i, k], room.arrivals[ABOVE, i, k] = NOT_ASKED, 1.0
        weight = room.weights[i, k]
        if weight == 0.0:
            continue
        room.arrivals[GAP, i, k] = 0.0
        if size <= front.near:
            continue
        low, part = lowest + (i - first) * height, weight * height
        middle = low + 0.5 * part
        if weight < 1.0 and low + 0.5 * (part + height) < foot:
            gap = gap_outside(field, rim, front.x, front.y, low + 0.5 * (part + height))
            size, foot = gap.size, gap.foot if gap.size != NOTHING else low + part
        if middle < foot and (weight == 1.0 or foot >= low + part):
            gap = gap_outside(field, rim, front.x, front.y, middle)
            size, foot = gap.size, gap.foot if gap.size != NOTHING else low
        own = counted(size, middle, front)
        room.arrivals[GAP, i, k] = own
        room.arrivals[ABOVE, i, k] = min(max((low + part - foot) / part, 0.0), 1.0)
        waits = waits or own > 0.0
        if low < foot < low + part:
            gap = gap_outside(field, rim, front.x, front.y, 0.5 * (low + foot))
            size, foot = gap.size, gap.foot if gap.size != NOTHING else low
    return waits


@kernel(lean=True, inlined=True)
def all_at_front(field: Field, circle: Circle, tip: Array, room: Room, rim: Rim, first: int, end: int) -> bool:
    """Whether all that is in contact of rows first..end is right at the rim: nearly always, and quickly seen.

    Walls are farther away the higher up, so that the highest row in contact at each angle tells.
    """
    rows, lower, upper = room.rows, room.places.us, room.places.vs
    begin, last = int(rows[first, FROM]), int(rows[first, TO])
    for k in range(begin, last):
        i = end - 1
        while i >= first and room.weights[i, k] == 0.0:
            i -= 1
        lower[k] = np.nan
        if i >= first:
            low, height, weight = tip[2] + rows[i, LOW], rows[i, HIGH] - rows[i, LOW], room.weights[i, k]
            lower[k] = low + 0.5 * weight * height
            upper[k] = low + 0.5 * (1.0 + weight) * height if weight < 1.0 else lower[k]
    directions = (circle.sines[begin:last], circle.cosines[begin:last])
    asked = (lower[begin:last], upper[begin:last])
    return first_away(field, rim, directions, asked) == last - begin


@kernel(lean=True)
def find_gaps(field: Field, circle: Circle, tip: Array, heading: Heading, room: Room, first: int, end: int) -> bool:
    """Fill `room.arrivals` (ARRIVALS, n, HALF) for rows first..end of a cylinder; whether any is not at its wall yet.

    In [GAP] how far each is from its wall at each angle [m], below 0 where it is in it; in [ABOVE] how much of it
    stands above the foot of that wall: what is below meets what the row below meets. Upper rows have their walls
    farther away, if any. `room.places.us` is how far the rim advances in the step at each angle [m].
    """
    ux, uy, rows, step, advances = heading.ux, heading.uy, room.rows, room.step, room.places.us
    rim, cell = Rim(step[FROM_X], step[FROM_Y], rows[first, RADIUS], ux, uy), coarsest(field)
    if all_at_front(field, circle, tip, room, rim, first, end):
        return False
    lowest, slack = tip[2] + rows[first, LOW], step[SLACK]
    waits, zero = False, first_direction(heading) if slack > 0.0 else 0
    for k in range(int(rows[first, FROM]), int(rows[first, TO])):
        nx, ny = ux * circle.sines[k] - uy * circle.cosines[k], uy * circle.sines[k] + ux * circle.cosines[k]
        advances[k] = nx * step[WAY_X] + ny * step[WAY_Y]
        met = step[MET + (zero - k) % ANGLES] if slack > 0.0 else NOT_MET
        beside = met_near(step, zero - k) if slack > 0.0 else NOT_MET
        front = Front(nx, ny, AT_RIM * cell, (LINES - 1) * cell, slack, met, beside, heading.climb > LEAST_ADVANCE)
        waits = gaps_in(field, rim, front, room, lowest, (first, end), k) or waits
    return waits


@kernel(lean=True, inlined=True)
def held(t: float) -> float:
    """Integral of what is t, but at least 0 and at most 1, from 0 to t."""
    return 0.5 * t * t if 0.0 < t < 1.0 else max(t - 0.5, 0.0)


@kernel(lean=True, inlined=True)
def inside_front(gap: float, farther: float, arc: float) -> float:
    """The gap [m], below 0, at an angle at the front of the tool, beside one with a `gap`, and one that is `farther`.

    The wall goes on as between those two; along the rim a gap changes by no more than the `arc` [m] between them. Where
    that does not reach the front, contact ends half-way.
    """
    if gap >= arc:
        return -gap
    return gap - (min(farther - gap, arc) if farther > gap else arc)


@kernel(lean=True, inlined=True)
def mean_of_rest(here: float, beside: float, advance: float, arc: float) -> float:
    """Mean share of a step that is left between an angle and half-way to the next, from the gaps [m] at both.

    The rim advances so far [m] in the step.
    """
    beside = min(max(beside, here - arc), here + arc)
    least = max(advance, arc / NEVER)
    a, b = 1.0 - here / least, 1.0 - 0.5 * (here + beside) / least
    if abs(b - a) < 1.0e-9:
        return float(min(max(a, 0.0), 1.0))
    return float((held(b) - held(a)) / (b - a))


@kernel(lean=True, inlined=True)
def rest_towards(gaps: Array, advance: float, k: int, step: int, angles: tuple[int, int], arc: float) -> float:
    """Mean share of a step that is left between angle k and half-way to the next one on a side, `step` 1 or -1."""
    begin, end = angles
    here = gaps[k]
    if not begin <= k + step < end or gaps[k + step] == NOT_ASKED:
        return mean_of_rest(here, here, advance, arc)
    beside = gaps[k + step]
    if here == 0.0 and beside > 0.0:
        farther = gaps[k + 2 * step] if begin <= k + 2 * step < end else NOTHING
        here = inside_front(beside, farther, arc)
    elif beside == 0.0 and here > 0.0:
        farther = gaps[k - step] if begin <= k - step < end else NOTHING
        beside = inside_front(here, farther, arc)
    if here >= arc and beside <= -arc:  # half-way
        here, beside = 0.5 * arc, -0.5 * arc
    elif beside >= arc and here <= -arc:
        here, beside = -0.5 * arc, 0.5 * arc
    return mean_of_rest(here, beside, advance, arc)


@kernel(lean=True)
def rest_at(gaps: Array, advance: float, k: int, angles: tuple[int, int], arc: float) -> float:
    """The share of the step in which angle k, of begin..end, is in contact; it advances so far [m] in it."""
    return 0.5 * (rest_towards(gaps, advance, k, -1, angles, arc) + rest_towards(gaps, advance, k, 1, angles, arc))


@kernel(lean=True)
def rest_of_row(room: Room, i: int, first: int, k: int) -> float:
    """The same for row i of a cylinder whose lowest one is `first`; part of it may stand below the foot of a wall."""
    rows, arrivals, advance = room.rows, room.arrivals, room.places.us[k]
    angles, arc = (int(rows[first, FROM]), int(rows[first, TO])), rows[first, RADIUS] * 2.0 * np.pi / ANGLES
    above, rest = arrivals[ABOVE, i, k], rest_at(arrivals[GAP, i], advance, k, angles, arc)
    if above >= 1.0 - LEAST_CONTACT:
        return rest
    below = rest_at(arrivals[GAP, i - 1], advance, k, angles, arc) if i > first else 1.0
    return float(above * rest + (1.0 - above) * below)


@kernel(lean=True)
def carry_over(room: Room, seams: int) -> None:
    """Let the angle in which a wall ends the contact of a row arrive with the one beside it that is all in contact.

    What is beyond that limit meets another wall, or none.
    """
    arrivals, (places, numbers) = room.arrivals, room.seams
    for seam in range(seams):
        step = 1 if numbers[DROP, seam] > 0.0 else -1  # away from the contact
        at = min(int(numbers[LIMIT, seam]), HALF - 1)
        beside = at - step
        if beside < places[FIRST, seam] or beside > places[LAST, seam]:
            continue
        for i in range(places[ROW, seam], places[AFTER, seam]):
            if room.weights[i, beside] > 0.0:
                arrivals[GAP, i, at], arrivals[ABOVE, i, at] = arrivals[GAP, i, beside], arrivals[ABOVE, i, beside]


@kernel(lean=True)
def fill_rests(room: Room, first: int, number: int, seams: int) -> None:
    """Put into `room.arrivals` [REST] what share of each row's contact is left in the step.

    At a seam of which a wall has told the limit, both seam and gaps tell where contact ends: the less counts.
    """
    rows, weights, arrivals, places = room.rows, room.weights, room.arrivals, room.seams.places
    begin, end = int(rows[first, FROM]), int(rows[first, TO])
    for i in range(first, first + number):
        for k in range(begin, end):
            arrivals[REST, i, k] = rest_of_row(room, i, first, k) if weights[i, k] > 0.0 else 0.0
    for seam in range(seams):
        begin, end = places[FIRST, seam], places[LAST, seam]
        for i in range(places[ROW, seam], places[AFTER, seam]):
            most = max(weights[i, begin], weights[i, end])
            for k in range(begin, end + 1):
                if 0.0 < weights[i, k] < most:
                    arrivals[REST, i, k] = min(arrivals[REST, i, k] * most / weights[i, k], 1.0)


@kernel(lean=True)
def shorten_seams(room: Room, first: int, number: int, seams: int) -> None:
    """Let the seams of a cylinder stand for what is in contact in the step: before its weights change."""
    rows, weights, (places, numbers) = room.rows, room.weights, room.seams
    begin, end = int(rows[first, FROM]), int(rows[first, TO])
    for seam in range(seams):
        at = min(max(int(numbers[LIMIT, seam]), begin), end - 1)
        drop, lever, rest, rest_lever = 0.0, 0.0, 0.0, 0.0
        for i in range(first, first + number):
            own = weights[i, places[FIRST, seam]] - weights[i, places[LAST, seam]]
            share = own * room.arrivals[REST, i, at]
            drop, lever = drop + own, lever + own * rows[i, HEIGHT]
            rest, rest_lever = rest + share, rest_lever + share * rows[i, HEIGHT]
        numbers[DROP, seam] *= rest / drop if drop != 0.0 else 1.0
        numbers[LEVER, seam] *= rest_lever / lever if lever != 0.0 else 1.0


@kernel(lean=True)
def keep_arrived(
    field: Field, circle: Circle, tip: Array, heading: Heading, room: Room, first: int, number: int, seams: int
) -> None:
    """Leave of the contact of a cylinder's rows first..first + number what there is in the step that `room.step` tells.

    Nothing is known of stocks with several intervals in a column, and of a step that is NaN.
    """
    end = first + number
    if np.isnan(room.step[FROM_X]) or not is_of_one_layer(field):
        return
    if not find_gaps(field, circle, tip, heading, room, first, end):
        return
    carry_over(room, seams)
    fill_rests(room, first, number, seams)
    shorten_seams(room, first, number, seams)
    begin, last = int(room.rows[first, FROM]), int(room.rows[first, TO])
    for i in range(first, end):
        for k in range(begin, last):
            room.weights[i, k] *= room.arrivals[REST, i, k]
