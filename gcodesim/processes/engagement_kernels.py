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

from gcodesim.compiled import kernel
from gcodesim.material.column_kernels import is_of_one_layer
from gcodesim.material.kernels import (
    ELSEWHERE,
    Field,
    Places,
    ToColumns,
    ask_places,
    share_between,
    surface_around,
    to_columns,
)
from gcodesim.processes.edge_kernels import (
    ANGLES,
    COS_KAPPA,
    FROM,
    HEIGHT,
    HIGH,
    LEAST_ADVANCE,
    LOW,
    OUTER,
    RADIUS,
    SIN_KAPPA,
    THIN,
    TO,
    UPRIGHT,
    Circle,
    Clearance,
    Heading,
    clearance_of,
    off_way,
    on_way,
    plunge_way,
    probe,
)
from gcodesim.processes.falling_kernels import end_at_wall, is_beside_row, leave_wall
from gcodesim.processes.limit_kernels import (
    NO_LIMIT,
    SAME_SHARE,
    ContactLimit,
    EdgeBand,
    Walls,
    at_row,
    beside,
    end_of_side,
    no_limit,
    of_radius,
    spot_beyond,
)
from gcodesim.processes.rim_kernels import (
    DEEPEST,
    FRONT,
    SLOPE_LEFT,
    SLOPE_RIGHT,
    UNSEEN,
    RimRow,
    may_have_rim,
    profile_of,
    rim_limit,
)
from gcodesim.processes.seam_kernels import (
    Seams,
    Steps,
    mark_steps,
    note_limit,
    note_seams,
    reach_of,
    settle_seams,
    share_at,
    span_of,
)

Array = NDArray[np.float64]

NOWHERE = -1  # there is no contact
AT_LEFT, AT_RIGHT = 1, 2  # sides of which a wall has told the limit
WALL = 4.0  # [cells] by which columns side by side differ in height where a wall stands between them
UNKNOWN_LEAN = -1.0
SAME_LIMIT = 1.0e-3  # [angles] by which two limits of one row have to differ


class Room(NamedTuple):
    """Room to work in, made once for each cutter.

    rows (n, COLUMNS) of the edge; of each the share of it that is in material, weights (n, ANGLES); sums (SUMS, ANGLES)
    over rows; unit (4, ANGLES): force per width along u, l, z and the cut; line, share and places (ANGLES,): what is
    asked of the stock; leans (ANGLES,), see `leans_of`; seams; for peaks, see `peak_kernels`: stretches (m, STRETCHES),
    borders (2, BORDERS), gaps (GAPS, GAP) and load (4,). For `arrival_kernels`: the step (STEP,) of the tip, NaN where
    that is not known, and arrivals (ARRIVALS, n, ANGLES / 2).
    """

    rows: Array
    weights: Array
    sums: Array
    unit: Array
    line: Array
    share: Array
    places: Places
    leans: Array
    seams: Seams
    stretches: Array
    borders: Array
    gaps: Array
    load: Array
    step: Array
    arrivals: Array


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
    _, _, level, climb, turn = heading
    i0, j0, i_u, i_l, j_u, j_l, _, _, _, _ = columns
    us, vs, ups = places
    square = radius * radius
    for k in range(us.shape[0]):
        ups[k] = min(max(radius * cosines[k], -inside), inside)
    if turn != 0.0:
        for k in range(us.shape[0]):
            wide = min(max(off_way(square, radius * cosines[k], turn), -inside), inside)
            ups[k] = min(max(on_way(outer * outer, wide, turn), -outer), outer)
    for k in range(us.shape[0]):
        px, py, wide = radius * sines[k], radius * cosines[k], ups[k]
        front = sines[k] > 0.0
        way = np.sqrt(outer * outer - wide * wide) - px if front else ahead
        py = py + level * (wide - py) if front else py
        px += level * way
        us[k] = i0 + i_u * px + i_l * py
        vs[k] = j0 + j_u * px + j_l * py
        ups[k] = climb * max(way, least_way)


@kernel(lean=True, inlined=True)
def surface_ahead(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, px: float, py: float
) -> tuple[float, bool]:
    """Height [m] of the surface at the place (px, py) in K; whether no wall stands between the columns around it."""
    ux, uy = heading.ux, heading.uy
    height, step = surface_around(field, tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py)
    return height, step <= WALL * clearance.cell


@kernel(lean=True)
def leans_of(
    field: Field, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, ring: Ring, leans: Array
) -> None:
    """What part of the climb of a rising tool the surface in front has, leans (ANGLES,), each from 0 to 1.

    Material is asked for ahead of the edge. There a floor that an earlier pass has left stands higher by the climb, but
    the top of a raw block does not: so it is asked as much higher as the surface rises on from there. What is at a wall
    says nothing of that: there the angle beside it tells, or all of the climb counts where none does.
    """
    leans[ANGLES // 2 :] = 0.0
    for k in range(ANGLES // 2):
        px, py, _ = probe(ring.radius, ring.outer - ring.ahead, circle.sines[k], circle.cosines[k], ring.ahead,
                          clearance.aside, heading.level, heading.turn)  # fmt: skip
        near, near_known = surface_ahead(field, tip, heading, clearance, px, py)
        far, far_known = surface_ahead(field, tip, heading, clearance, px + ring.ahead, py)
        rise = max(far - near, 0.0) * heading.level
        leans[k] = min(rise / (heading.climb * ring.ahead), 1.0) if near_known and far_known else UNKNOWN_LEAN
    for k in range(1, ANGLES // 2):
        if leans[k] == UNKNOWN_LEAN:
            leans[k] = leans[k - 1]
    for j in range(ANGLES // 2):
        k = ANGLES // 2 - 1 - j
        if leans[k] == UNKNOWN_LEAN:
            leans[k] = leans[k + 1] if j > 0 else 1.0


@kernel(lean=True, inlined=True)
def leaning(heading: Heading, leans: Array, k: int) -> Heading:
    """The heading with as much of its climb as the surface in front of angle k has."""
    ux, uy, level, climb, turn = heading
    return Heading(ux, uy, level, climb * leans[k] if climb > 0.0 else climb, turn)


@kernel(lean=True, inlined=True)
def least_leaning(heading: Heading, leans: Array) -> Heading:
    """The same for the least of all angles in front."""
    ux, uy, level, climb, turn = heading
    if climb > 0.0:
        least = 1.0
        for k in range(ANGLES // 2):
            least = min(least, leans[k])
        climb *= least
    return Heading(ux, uy, level, climb, turn)


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
def ask_elsewhere(
    field: Field, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, rows: Array, i: int, leans: Array,
    line: Array,
) -> None:  # fmt: skip
    """Ask for the shares (n,) of row i that are not known, one by one: most are at the border of the stock."""
    for k in range(line.shape[0]):
        if line[k] == ELSEWHERE:
            own = leaning(heading, leans, k)
            line[k] = share_at(field, tip, own, clearance, rows, i, circle.sines[k], circle.cosines[k])


class RowShares(NamedTuple):
    """What `Room` has of rows, and of one of them the shares (n,) at the angles in front and where they change."""

    rows: Array
    weights: Array
    known: Array
    steps: Array
    seams: Seams


@kernel(lean=True, inlined=True)
def shares_in(room: Room) -> RowShares:
    """Where the shares of a row are, once its places are no longer needed."""
    return RowShares(room.rows, room.weights, room.places.us[: ANGLES // 2], room.places.vs[: ANGLES // 2], room.seams)


@kernel(lean=True)
def note_side(
    circle: Circle, clearance: Clearance, shares: RowShares, i: int, limit: ContactLimit, beyond: float, at_left: bool,
    number: int,
) -> int:  # fmt: skip
    """Add to the first `number` seams that at the limit of row i just inside its rim; how many there are then.

    `beyond`: share of the row that is in material outside the limit. What `mark_steps` has found of the row then says
    nothing of that wall.
    """
    n, (rows, weights, known, steps, seams) = ANGLES // 2, shares
    radius, outer = rows[i, RADIUS], 0 if at_left else n - 1
    inside = max(radius - clearance.aside, 0.0) / radius
    inner = end_of_side(circle, inside, known, at_left)
    inner = max(inner, min(int(limit.angle), n - 1)) if at_left else min(inner, int(limit.angle))
    step = 1 if at_left else -1
    while 0 < inner < n - 1 and abs(known[inner + step] - known[inner]) > SAME_SHARE:
        inner += step
    first, last = (0, inner) if at_left else (inner, n - 1)
    weights[i, outer] = beyond
    for k in range(first, last + 1):
        known[k], steps[k] = known[inner], 0.0
    rows[i, FROM], rows[i, TO] = min(rows[i, FROM], first), max(rows[i, TO], last + 1)
    note_limit(seams, number, i, first, last, limit.angle)
    return number + 1


@kernel(lean=True, inlined=True)
def rim_of(
    field: Field, pieces: Array, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, room: Room, i: int,
    at_left: bool,
) -> tuple[ContactLimit, bool]:  # fmt: skip
    """`rim_limit` of row i on one side: just inside its rim, and farther inside if its shares differ there."""
    radius, n, front = room.rows[i, RADIUS], ANGLES // 2, room.line[FRONT]
    row = RimRow(radius, tip[2], tip[2] + room.rows[i, HEIGHT], 1.0 if at_left else -1.0)
    limit, full, about = no_limit(), False, radius
    known, outermost = room.places.us[:n], 0 if at_left else n - 1
    for deeper in (False, True):
        if deeper:
            about = radius - DEEPEST * clearance.aside
            if about <= clearance.aside:
                break
            inside = (about - (DEEPEST + 1.0) * clearance.aside) / radius
            k, step = outermost, 1 if at_left else -1
            while abs(circle.cosines[k]) >= inside and abs(k - n // 2) > 1:
                k += step
            if abs(known[k] - known[outermost]) <= SAME_SHARE:
                break
        if may_have_rim(field, tip, heading, clearance, row, front, about, profile_of(room.line).heights):
            limit, full = rim_limit(field, pieces, tip, heading, clearance, row, front, about, room.line)
        if limit.angle != NO_LIMIT:
            break
    return limit, full


@kernel(lean=True, inlined=True)
def note_rims(
    field: Field, pieces: Array, circle: Circle, tip: Array, heading: Heading, clearance: Clearance, room: Room, i: int,
    told: int, number: int,
) -> int:  # fmt: skip
    """Add to the first `number` seams those of row i at surfaces inside its rim; how many there are then.

    told: the sides of which walls have told the limit.
    """
    n, rows = ANGLES // 2, room.rows
    left, left_full, right, right_full = no_limit(), False, no_limit(), False
    for at_left in (True, False):
        if told & (AT_LEFT if at_left else AT_RIGHT) != 0:
            continue
        limit, full = rim_of(field, pieces, circle, tip, heading, clearance, room, i, at_left)
        if at_left:
            left, left_full = limit, full
        else:
            right, right_full = limit, full
    if left.angle != NO_LIMIT and right.angle != NO_LIMIT and right.angle <= left.angle + SAME_LIMIT:
        known, steps = room.places.us[:n], room.places.vs  # one surface, seen from both sides
        for k in range(n):
            known[k], steps[k] = known[0], 0.0
        room.weights[i, 0], room.weights[i, n - 1] = 1.0 if left_full else 0.0, 1.0 if right_full else 0.0
        rows[i, FROM], rows[i, TO] = 0, max(int(rows[i, TO]), n)
        note_limit(room.seams, number, i, 0, n - 1, left.angle)
        return number + 1
    if left.angle != NO_LIMIT:
        number = note_side(circle, clearance, shares_in(room), i, left, 1.0 if left_full else 0.0, True, number)
    if right.angle != NO_LIMIT:
        number = note_side(circle, clearance, shares_in(room), i, right, 1.0 if right_full else 0.0, False, number)
    return number


@kernel(lean=True)
def share_beyond(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, span: EdgeBand, limit: ContactLimit, at_left: bool
) -> float:
    """Share [-] of a row that is in material outside the wall of a limit."""
    spot = spot_beyond(tip, heading, span, clearance, limit, at_left)
    return float(share_between(field, spot.x, spot.y, spot.bottom, spot.top))


@kernel(lean=True, inlined=True)
def contact_of_rows(
    field: Field, pieces: Array, circle: Circle, tip: Array, heading: Heading, room: Room, first: int, number: int,
    last: int, widest: float,
) -> int:  # fmt: skip
    """Fill weights[first:first + number, :last]: share of each element in material at each angle at which it advances.

    0 where it does not advance. Returns the number of seams, or NOWHERE if there is no contact, and keeps the range of
    those angles in each row.

    An element is asked where it will be a way d further along the feed; falling, half a cell more is asked for
    below, so that contact grows gradually.
    Where contact begins or ends between two angles, the limit is found by halving and the weight is shared out.
    """
    ux, uy, level, climb, _ = heading
    clearance = clearance_of(field, heading)
    cell, ahead, aside = clearance
    columns = to_columns(field, tip, ux, uy)
    sines, rows, weights = circle.sines, room.rows, room.weights
    found, waiting = False, 0
    if climb > 0.0:
        outermost = first + number - 1
        ring = Ring(rows[outermost, RADIUS], rows[outermost, OUTER] + ahead, ahead, 0.0, 0.0)
        leans_of(field, circle, tip, heading, clearance, ring, room.leans)
    beside_way = least_leaning(heading, room.leans)
    span = span_of(tip, heading, clearance, rows, first + number - 1)
    rimmed = is_of_one_layer(field)
    room.line[SLOPE_LEFT], room.line[SLOPE_RIGHT], room.line[FRONT] = UNSEEN, UNSEEN, widest + ahead
    at_left = beside(field, columns, tip, beside_way, clearance, span, 1.0, room.load)
    at_right = beside(field, columns, tip, beside_way, clearance, span, -1.0, room.load)
    outermost_radius = rows[first + number - 1, RADIUS]
    falls_straight = climb < 0.0 and heading.turn == 0.0
    walled = at_left.angle != NO_LIMIT or at_right.angle != NO_LIMIT
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
            if begin == end:
                continue
            places = places_at(room, begin, end)
            lay_places(part_of(circle, begin, end), ring, heading, columns, places)
            if climb > 0.0:
                for k in range(end - begin):
                    places.ups[k] *= room.leans[begin + k]
            ask_places(columns, places, bottom, top, line[begin:end])
        ended_left, ended_right = NO_LIMIT, NO_LIMIT
        if walled and falls_straight and sin_kappa <= UPRIGHT:
            band = EdgeBand(rows[i, RADIUS], bottom, top, least_way)
            for at_left_side in (True, False):
                wall = at_left if at_left_side else at_right
                if wall.angle != NO_LIMIT and is_beside_row(wall, clearance, band, outermost_radius, at_left_side):
                    limit = of_radius(wall, band.radius, 0.0)
                    beyond = share_beyond(field, tip, beside_way, clearance, band, limit, at_left_side)
                    if end_at_wall(circle, clearance, limit.angle, beyond, band.radius, at_left_side, line):
                        ended_left = limit.angle if at_left_side else ended_left
                        ended_right = ended_right if at_left_side else limit.angle
        if leave_advancing(sines, level, sin_kappa, fall, line):
            ask_elsewhere(field, circle, tip, heading, clearance, rows, i, room.leans, line)
        known, steps = room.places.us[:last], room.places.vs[:last]  # the places are no longer needed
        left = mark_steps(sines, level, sin_kappa, fall, line, known, steps)
        for limit_angle in (ended_left, ended_right):
            if limit_angle != NO_LIMIT:
                left -= leave_wall(limit_angle, steps)
        rows[i, FROM], rows[i, TO] = reach_of(known, steps)
        told = 0
        # of a tool that falls on an arc, what is ahead stands lower and turned: only the search for seams knows it
        sides_known = behind == 0 or heading.turn == 0.0
        if walled and sides_known and sin_kappa > UPRIGHT:
            span = span_of(tip, heading, clearance, rows, i)
            limit = at_row(at_left, tip, beside_way, clearance, span, known[0], True)
            if limit.angle != NO_LIMIT:
                told += AT_LEFT
                beyond = share_beyond(field, tip, beside_way, clearance, span, limit, True)
                waiting = note_side(circle, clearance, shares_in(room), i, limit, beyond, True, waiting)
            limit = at_row(at_right, tip, beside_way, clearance, span, known[ANGLES // 2 - 1], False)
            if limit.angle != NO_LIMIT:
                told += AT_RIGHT
                beyond = share_beyond(field, tip, beside_way, clearance, span, limit, False)
                waiting = note_side(circle, clearance, shares_in(room), i, limit, beyond, False, waiting)
        if rimmed and sides_known and sin_kappa > UPRIGHT:
            waiting = note_rims(field, pieces, circle, tip, beside_way, clearance, room, i, told, waiting)
        if left > 0:
            found_steps = Steps(known, steps, room.leans)
            waiting = note_seams(circle, tip, heading, clearance, rows, i, found_steps, left, room.seams, waiting)
        found = found or rows[i, TO] > rows[i, FROM]
    if waiting > 0:
        walls = Walls(at_left, at_right)
        settle_seams(field, tip, heading, clearance, rows, waiting, room.seams, weights, walls)
    return waiting if found else NOWHERE
