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
from gcodesim.material.kernels import (
    ELSEWHERE,
    Field,
    Places,
    ToColumns,
    ask_places,
    fill_slices,
    occupancy,
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
    Circle,
    Heading,
    clearance_of,
    plunge_way,
    probe,
    turned,
)
from gcodesim.processes.seam_kernels import (
    DROP,
    LEVER,
    LIMIT,
    Seams,
    Steps,
    crossing,
    mark_steps,
    note_seams,
    ramp_at,
    reach_of,
    set_limit,
    settle_seams,
    share_at,
)

Array = NDArray[np.float64]

NOWHERE = -1  # there is no contact


class Room(NamedTuple):
    """Room to work in, made once for each cutter.

    rows (n, COLUMNS) of the edge; of each the share of it that is in material, weights (n, ANGLES); sums (SUMS, ANGLES)
    over rows; unit (4, ANGLES): force per width along u, l, z and the cut; line, share and places (ANGLES,): what is
    asked of the stock; seams; for peaks, see `peak_kernels`: stretches (m, STRETCHES), borders (2, BORDERS), gaps
    (GAPS, GAP) and load (4,).
    """

    rows: Array
    weights: Array
    sums: Array
    unit: Array
    line: Array
    share: Array
    places: Places
    seams: Seams
    stretches: Array
    borders: Array
    gaps: Array
    load: Array


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


@kernel(lean=True, inlined=True)
def contact_of_rows(
    field: Field, circle: Circle, tip: Array, heading: Heading, room: Room, first: int, number: int, last: int
) -> int:
    """Fill weights[first:first + number, :last]: share of each element in material at each angle at which it advances.

    0 where it does not advance. Returns the number of seams, or NOWHERE if there is no contact, and keeps the range of
    those angles in each row.

    An element is asked where it will be a way d further along the feed; falling, half a cell more is asked for
    below, so that contact grows gradually.
    Where contact begins or ends between two angles, the limit is found by halving and the weight is shared out.
    """
    ux, uy, level, climb = heading
    clearance = clearance_of(field, heading)
    cell, ahead, aside = clearance
    columns = to_columns(field, tip, ux, uy)
    sines, rows, weights = circle.sines, room.rows, room.weights
    found, waiting = False, 0
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
        known, steps = room.places.us[:last], room.places.vs[:last]  # the places are no longer needed
        left = mark_steps(sines, level, sin_kappa, fall, line, known, steps)
        rows[i, FROM], rows[i, TO] = reach_of(known, steps)
        if left > 0:
            waiting = note_seams(
                circle, tip, heading, clearance, rows, i, Steps(known, steps), left, room.seams, waiting
            )
        found = found or rows[i, TO] > rows[i, FROM]
    if waiting > 0:
        settle_seams(field, tip, heading, clearance, rows, waiting, room.seams, weights)
    return waiting if found else NOWHERE


@kernel(lean=True, inlined=True)
def contact_of_cylinder(
    field: Field, circle: Circle, tip: Array, heading: Heading, room: Room, first: int, number: int
) -> int:
    """The same for all rows of a cylinder at once, first..first+number: they stand above each other and share seams."""
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
    done, seams, numbers = 1, 0, room.seams.numbers
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
        drop, lever = 0.0, 0.0
        for i in range(first, first + number):
            own = set_limit(weights, i, from_k, to_k, limit)
            drop += own
            lever += own * rows[i, HEIGHT]
        numbers[LIMIT, seams], numbers[DROP, seams], numbers[LEVER, seams] = limit, drop, lever
        seams += 1
        begin, end, done = min(begin, from_k), max(end, to_k + 1), to_k + 1
    weights[first : first + number, half:] = 0.0
    rows[first : first + number, FROM] = begin
    rows[first : first + number, TO] = end
    return seams if end > begin else NOWHERE
