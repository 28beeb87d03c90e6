"""Finds which part of the edge of an upright cylinder is in material: all its rows at once, since they stand above
each other.

Rows that see the same material make a layer, and share its seams: below a floor that an earlier level has left, an edge
may meet another wall than above.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.material.kernels import (
    ELSEWHERE,
    Field,
    ask_places,
    fill_slices,
    occupancy,
    to_columns,
)
from gcodesim.processes.arrival_kernels import keep_arrived
from gcodesim.processes.edge_kernels import (
    ANGLES,
    FROM,
    HEIGHT,
    HIGH,
    LEAST_ADVANCE,
    LOW,
    OUTER,
    RADIUS,
    TO,
    Circle,
    Clearance,
    Heading,
    clearance_of,
    probe,
    turned,
)
from gcodesim.processes.engagement_kernels import (
    NOWHERE,
    Ring,
    Room,
    lay_places,
    leaning,
    leans_of,
    least_leaning,
    part_of,
    places_at,
)
from gcodesim.processes.limit_kernels import (
    FULL,
    NO_LIMIT,
    PER_ANGLE,
    ContactLimit,
    EdgeBand,
    end_of_side,
    limit_at,
    side_limit,
    spot_at,
    spot_beyond,
)
from gcodesim.processes.seam_kernels import (
    AFTER,
    DROP,
    FIRST,
    LAST,
    LEVER,
    LIMIT,
    ROW,
    crossing,
    goes_on,
    ramp_at,
    set_limit,
)

Array = NDArray[np.float64]

HALF = ANGLES // 2
SAME_LAYER = 0.5  # [angles] by which the contact of rows of one layer may differ
LANDING = 0.5  # by which the shares of two angles at one wall differ at most
TURNS = 4  # in which a limit is found that no wall tells


class EdgeCylinder(NamedTuple):
    """A cylinder of the edge: its radius, and the largest of the edge [m]; its first row; bottom and height of it [m].

    In S; all rows are as high.
    """

    radius: float
    widest: float
    first: int
    bottom: float
    height: float


class EdgeLayer(NamedTuple):
    """Rows begin..end of a cylinder."""

    begin: int
    end: int


@kernel(lean=True, inlined=True)
def span_of_layer(cylinder: EdgeCylinder, layer: EdgeLayer) -> EdgeBand:
    """The layer as it meets a wall."""
    bottom = cylinder.bottom + layer.begin * cylinder.height
    return EdgeBand(cylinder.radius, bottom, cylinder.bottom + layer.end * cylinder.height, 0.0)


@kernel(lean=True, inlined=True)
def sample_cylinder(
    field: Field, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, room: Room,
    cylinder: EdgeCylinder, measure: Array, most: Array,
) -> bool:  # fmt: skip
    """Fill weights of its rows (number, HALF) and their mean, share (HALF,), at all angles; ELSEWHERE: no advance.

    Returns whether rows may differ; then `measure` (number,) says how many angles each is in material where most of it
    is. That and `most` (number,) have the room of places.
    """
    ux, uy, level, climb, turn = heading
    _, ahead, aside = clearance
    radius, widest, first, bottom, height = cylinder
    number, weights, line, share = measure.shape[0], room.weights, room.line, room.share
    ring, places = Ring(radius, widest + ahead, ahead, max(radius - aside, 0.0), 0.0), places_at(room, 0, HALF)
    columns = to_columns(field, tip, ux, uy)
    lay_places(part_of(circle, 0, HALF), ring, heading, columns, places)
    if climb > 0.0:
        leans_of(field, circle, tip, heading, clearance, ring, room.leans)
        for k in range(HALF):
            places.ups[k] *= room.leans[k]
    ask_places(columns, places, bottom, bottom + number * height, share[:HALF])
    measure[:], most[:] = 0.0, 0.0
    whole = 0
    differ = False
    for k in range(HALF):
        sine, cosine = circle.sines[k], circle.cosines[k]
        if level * sine <= LEAST_ADVANCE:
            weights[first : first + number, k] = 0.0
            share[k] = ELSEWHERE
        elif share[k] == 0.0 or share[k] >= FULL:  # all of it, or nothing
            share[k] = 0.0 if share[k] == 0.0 else 1.0
            whole += 1 if share[k] > 0.0 else 0
            for i in range(number):
                weights[first + i, k] = share[k]
        else:
            px, py, way = probe(radius, widest, sine, cosine, ahead, aside, level, turn)
            x, y = tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py
            share[k] = fill_slices(
                field, x, y, bottom + leaning(heading, room.leans, k).climb * way, height, line[:number]
            )
            share[k] /= number
            for i in range(number):
                weights[first + i, k] = line[i]
                measure[i] += line[i]
                most[i] = max(most[i], line[i])
            differ = True
    for i in range(number):
        highest = 1.0 if whole > 0 else most[i]
        measure[i] = (measure[i] + whole) / highest if highest > 0.0 else 0.0
    return differ


@kernel(lean=True, inlined=True)
def next_layer(measures: Array, begin: int) -> EdgeLayer:
    """The layer of rows (n,) with like measures that begins with one."""
    end = begin + 1
    while end < measures.shape[0] and abs(measures[end] - measures[begin]) <= SAME_LAYER:
        end += 1
    return EdgeLayer(begin, end)


@kernel(lean=True)
def share_of_layer(room: Room, cylinder: EdgeCylinder, layer: EdgeLayer, share: Array) -> None:
    """The mean of the rows of a layer, into share (HALF,); ELSEWHERE stays."""
    begin, end = cylinder.first + layer.begin, cylinder.first + layer.end
    for k in range(HALF):
        share[k] = room.share[k]
        if share[k] >= 0.0:
            total = 0.0
            for i in range(begin, end):
                total += room.weights[i, k]
            share[k] = total / (end - begin)


@kernel(lean=True, inlined=True)
def note_layer(
    room: Room, cylinder: EdgeCylinder, layer: EdgeLayer, from_k: int, to_k: int, limit: float, seam: int, told: bool
) -> None:
    """Let contact of a layer end at a limit [angles] between two angles, and note it as a seam.

    ROW..AFTER of the seam are rows of which a wall has told the limit.
    """
    drop, lever = 0.0, 0.0
    for i in range(cylinder.first + layer.begin, cylinder.first + layer.end):
        own = set_limit(room.weights, i, from_k, to_k, limit)
        drop += own
        lever += own * room.rows[i, HEIGHT]
    places, numbers = room.seams
    places[FIRST, seam], places[LAST, seam] = from_k, to_k
    places[ROW, seam] = cylinder.first + layer.begin
    places[AFTER, seam] = cylinder.first + (layer.end if told else layer.begin)
    numbers[LIMIT, seam], numbers[DROP, seam], numbers[LEVER, seam] = limit, drop, lever


@kernel(lean=True, inlined=True)
def above_foot(cylinder: EdgeCylinder, layer: EdgeLayer, limit: ContactLimit) -> EdgeLayer:
    """Those rows of a layer that are above the foot of a wall, at least the highest one."""
    begin = int(np.ceil(min((limit.foot - cylinder.bottom) / cylinder.height - 0.5, layer.end - 1.0)))
    return EdgeLayer(max(begin, layer.begin), layer.end)


@kernel(lean=True)
def fill_outermost(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, room: Room, cylinder: EdgeCylinder,
    layer: EdgeLayer, limit: ContactLimit, at_left: bool,
) -> None:  # fmt: skip
    """Set the outermost angle on one side to what is a cell outside the wall of a limit, for all rows of a layer."""
    number, outer = layer.end - layer.begin, 0 if at_left else HALF - 1
    spot = spot_beyond(tip, heading, span_of_layer(cylinder, layer), clearance, limit, at_left)
    fill_slices(field, spot.x, spot.y, spot.bottom, cylinder.height, room.line[:number])
    for i in range(number):
        room.weights[cylinder.first + layer.begin + i, outer] = room.line[i]


@kernel(lean=True, inlined=True)
def sides_of_layer(
    field: Field, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, room: Room,
    cylinder: EdgeCylinder, layer: EdgeLayer, share: Array, seam: int,
) -> tuple[int, int, int]:  # fmt: skip
    """Note the limits of a layer just inside its rim on both sides, from seam number `seam` on.

    Returns how many seams there are then, and the angles (first, end) between which other seams may be. share (HALF,)
    is that of the layer.
    """
    inside = max(cylinder.radius - clearance.aside, 0.0) / cylinder.radius
    first, end = 1, HALF
    for at_left in (True, False):
        outer = 0 if at_left else HALF - 1
        inner = end_of_side(circle, inside, share, at_left)
        from_k, to_k = (0, inner) if at_left else (inner, HALF - 1)
        rest, found = layer, False
        while rest.end > rest.begin:
            span = span_of_layer(cylinder, rest)
            limit = side_limit(field, tip, heading, clearance, span, share[outer], at_left, room.load)
            if limit.angle == NO_LIMIT:
                break
            upper = above_foot(cylinder, rest, limit)
            fill_outermost(field, tip, heading, clearance, room, cylinder, upper, limit, at_left)
            note_layer(room, cylinder, upper, from_k, to_k, limit.angle, seam, True)
            rest, seam, found = EdgeLayer(rest.begin, upper.begin), seam + 1, True
        if found and at_left:
            first = to_k + 1
        elif found:
            end = from_k + 1
    return seam, first, end


@kernel(lean=True, inlined=True)
def limit_between(
    field: Field, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, room: Room,
    cylinder: EdgeCylinder, span: EdgeBand, share: Array, ramp: tuple[int, int, int],
) -> tuple[ContactLimit, bool]:  # fmt: skip
    """The limit of a layer in the middle of a ramp of its share (HALF,): by its wall, else by halving.

    Also whether a wall has told it.
    """
    _, ahead, aside = clearance
    first, last, after = ramp
    own = leaning(heading, room.leans, after - 1)
    middle_share, rises = 0.5 * (share[first] + share[last]), share[after] > share[after - 1]
    least, most, low, high = 0.0, 1.0, share[after - 1], share[after]
    for _ in range(TURNS):
        middle = 0.5 * (least + most)
        sine, cosine = turned(circle.sines[after - 1], circle.cosines[after - 1], middle * (2.0 * np.pi / ANGLES))
        px, py, way = probe(cylinder.radius, cylinder.widest, sine, cosine, ahead, aside, heading.level, heading.turn)
        spot = spot_at(tip, own, span, px, py, way)
        wall = limit_at(field, tip, heading, clearance, cylinder.radius, spot, room.load)
        if wall.angle != NO_LIMIT:
            return wall, True
        between = occupancy(field, spot.x, spot.y, spot.bottom, spot.top)
        if (between > middle_share) == rises:
            most, high = middle, between
        else:
            least, low = middle, between
    angle = after - 0.5 + crossing(least, most, low, high, middle_share)
    return ContactLimit(angle, 0.0, 0.0, 0.0, 0.0), False


class RampWall(NamedTuple):
    """A wall at a limit [angles] of a cylinder of this radius, and how near to it columns are soft [m].

    rises: whether the share is greater behind it.
    """

    limit: float
    radius: float
    near: float
    rises: bool


@kernel(lean=True, inlined=True)
def is_soft(circle: Circle, share: Array, wall: RampWall, at: int, after: int) -> bool:
    """Whether what the columns say at one angle is still that of a wall, so that the ramp goes on beside it.

    Its share (HALF,) still changes from angle after - 1 to `after`; or the angle is as near to the wall as a cell is
    wide, where a stair of columns may have a landing.
    """
    if goes_on(share, after, wall.rises):
        return True
    inside = max(wall.radius - wall.near, 0.0)
    asked = min(max(wall.radius * circle.cosines[at], -inside), inside)
    if abs(asked - wall.radius * cos_sin(wall.limit / PER_ANGLE)[0]) >= wall.near:
        return False
    return bool(min(share[after - 1], share[after]) >= 0.0 and abs(share[after] - share[after - 1]) <= LANDING)


@kernel(lean=True, inlined=True)
def seams_of_layer(
    field: Field, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, room: Room,
    cylinder: EdgeCylinder, layer: EdgeLayer, share: Array, seam: int,
) -> int:  # fmt: skip
    """Find where contact of a layer begins and ends, and note it from seam number `seam` on; how many there are then.

    share (HALF,) is that of the layer.
    """
    beside = least_leaning(heading, room.leans)
    seam, done, free = sides_of_layer(field, circle, tip, beside, clearance, room, cylinder, layer, share, seam)
    span = span_of_layer(cylinder, layer)
    for k in range(1, free):
        earlier, total = share[k - 1], share[k]
        if k < done or earlier < 0.0 or total < 0.0 or abs(total - earlier) <= 0.5 * max(total, earlier):
            continue
        from_k, to_k, after = ramp_at(share, k)
        ramp = (from_k, to_k, after)
        limit, seen = limit_between(field, circle, tip, heading, clearance, room, cylinder, span, share, ramp)
        if seen:
            at = RampWall(
                limit.angle, cylinder.radius, clearance.aside if heading.turn == 0.0 else 0.0, total > earlier
            )
            while from_k > 0 and is_soft(circle, share, at, from_k, from_k):
                from_k -= 1
            while to_k + 1 < HALF and is_soft(circle, share, at, to_k, to_k + 1):
                to_k += 1
            own = leaning(heading, room.leans, after - 1)
            for at_left in (True, False):  # soft up to the rim: no angle there says what is outside the wall
                if (from_k == 0 and limit.aside > 0.0) if at_left else (to_k == HALF - 1 and limit.aside < 0.0):
                    fill_outermost(field, tip, own, clearance, room, cylinder, layer, limit, at_left)
        note_layer(room, cylinder, layer, from_k, to_k, limit.angle, seam, seen)
        seam, done = seam + 1, to_k + 1
    return seam


@kernel(lean=True, inlined=True)
def reach_of_seams(room: Room, seams: int) -> tuple[int, int]:
    """The range of angles at which any row is in material, or may get part of a neighbour's at one of the seams."""
    share, places = room.share, room.seams.places
    begin, end = 0, HALF
    while begin < HALF and share[begin] <= 0.0:
        begin += 1
    while end > begin and share[end - 1] <= 0.0:
        end -= 1
    for seam in range(seams):
        begin, end = min(begin, places[FIRST, seam]), max(end, places[LAST, seam] + 1)
    return begin, end


@kernel(lean=True, inlined=True)
def contact_of_cylinder(
    field: Field, circle: Circle, tip: Array, heading: Heading, room: Room, first: int, number: int
) -> int:
    """Fill weights[first:first + number] as `contact_of_rows` does, for the rows of a cylinder: the number of seams."""
    clearance, rows = clearance_of(field, heading), room.rows
    bottom, top = tip[2] + rows[first, LOW], tip[2] + rows[first + number - 1, HIGH]
    cylinder = EdgeCylinder(rows[first, RADIUS], rows[first, OUTER], first, bottom, (top - bottom) / number)
    measures, most = room.places.us[:number], room.places.ups[:number]
    differ = sample_cylinder(field, circle, tip, heading, clearance, room, cylinder, measures, most)
    share, layer, seams = room.share[:HALF], EdgeLayer(0, 0), 0
    while layer.end < number:
        layer = next_layer(measures, layer.end) if differ else EdgeLayer(0, number)
        if layer.end - layer.begin < number:
            share = room.places.vs[:HALF]
            share_of_layer(room, cylinder, layer, share)
        seams = seams_of_layer(field, circle, tip, heading, clearance, room, cylinder, layer, share, seams)
    room.weights[first : first + number, HALF:] = 0.0
    begin, end = reach_of_seams(room, seams)
    rows[first : first + number, FROM] = begin
    rows[first : first + number, TO] = end
    if end <= begin:
        return NOWHERE
    keep_arrived(field, circle, tip, heading, room, first, number, seams)
    return seams
