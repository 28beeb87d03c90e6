"""A closed surface around columns: dual to the columns, with exact heights and no levels in z.

Between four neighbouring columns stands a prism; its corner columns are numbered counter-clockwise

    3 2      (a-1, b)   (a, b)
    0 1      (a-1, b-1) (a, b-1)

around the lattice point (a, b). Going up in a prism, columns begin (rise) and end (fall); which of the four are
material is the mask, four bits. Neighbouring changes of one direction within a small height are one group, and a
group is one vertex: at the mean height and the lattice point, moved to where the stock's walls really stand. So in
each prism runs a chain of vertices, with walls between them where the mask is neither empty nor full.

Every end of a column gives a quadrilateral between its four prisms, every stretch in which one of two neighbours is
material gives a wall between their two prisms. Where only two opposite columns are material the chain has two
strands, one around each, so that every edge belongs to exactly two triangles: the surface is closed by construction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns
from gcodesim.material.flat_kernels import Chains, ColumnSpan

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Longs = NDArray[np.int64]

DIAGONAL_02 = 0b0101
DIAGONAL_13 = 0b1010


class Corners(NamedTuple):
    """Where the corners between columns lie: along x (mx + 1,) and along y (my + 1,) [m]."""

    xs: Array
    ys: Array


@kernel(lean=True)
def corner_column(a: int, b: int, corner: int) -> tuple[int, int]:
    """Column (i, j) at a corner of the prism around lattice point (a, b)."""
    i = a if corner in (1, 2) else a - 1
    j = b if corner in (2, 3) else b - 1
    return i, j


@kernel(lean=True)
def wall_shifts(walls: Singles, a: int, b: int, shifts: Array) -> None:
    """Fill `shifts` (4,): how far [cells] the wall at each border of a prism stands from it, in x (0, 2) or y (1, 3).

    Border c lies between corners c and c + 1.
    """
    _, wide, deep = walls.shape
    for corner in range(4):
        axis = corner & 1
        i = a - 1 if corner == 3 else a
        j = b - 1 if corner == 0 else b
        place = float(walls[axis, i, j]) if 0 <= i < wide and 0 <= j < deep else 0.0
        if place > 0.0:
            shifts[corner] = 2.0 - place
        elif place < 0.0:
            shifts[corner] = -place - 2.0
        else:
            shifts[corner] = 0.0


@kernel(lean=True)
def strand_shift(mask: int, only: int, shifts: Array) -> tuple[float, float, int]:
    """Sum of the places (in cells, from the lattice point) of the walls in a mask, and their number.

    `only` >= 0: the borders around that corner alone.
    """
    x, y, borders = 0.0, 0.0, 0
    for corner in range(4):
        following = (corner + 1) & 3
        if ((mask >> corner) ^ (mask >> following)) & 1 == 0:
            continue
        if only >= 0 and corner != only and following != only:
            continue
        if corner == 0:
            x += shifts[0]
            y -= 0.5
        elif corner == 1:
            x += 0.5
            y += shifts[1]
        elif corner == 2:
            x += shifts[2]
            y += 0.5
        else:
            x -= 0.5
            y += shifts[3]
        borders += 1
    return x, y, borders


@kernel(lean=True)
def is_diagonal(mask: int) -> bool:
    """Whether exactly two opposite corners are material."""
    return mask in (DIAGONAL_02, DIAGONAL_13)


@kernel(lean=True)
def rim_shift(below: int, above: int, shifts: Array, first: int, second: int) -> float:
    """Shift [cells] along the stock's side of a wall that runs out there, at one of two borders; 0 without a wall."""
    for corner in (first, second):
        following = (corner + 1) & 3
        if ((below >> corner) ^ (below >> following) | (above >> corner) ^ (above >> following)) & 1:
            return float(shifts[corner])
    return 0.0


@kernel(lean=True)
def plain_prism(columns: Columns, a: int, b: int, limit: float, heights: Array) -> bool:
    """Whether the prism around (a, b) has four columns of one piece each, which begin and end together.

    Then `heights` (of length 4) begins with the mean height of their bottoms and that of their tops.
    """
    lo, hi, count = columns
    if count[a - 1, b - 1] != 1 or count[a, b - 1] != 1 or count[a, b] != 1 or count[a - 1, b] != 1:
        return False
    low_0, low_1, low_2, low_3 = lo[a - 1, b - 1, 0], lo[a, b - 1, 0], lo[a, b, 0], lo[a - 1, b, 0]
    high_0, high_1, high_2, high_3 = hi[a - 1, b - 1, 0], hi[a, b - 1, 0], hi[a, b, 0], hi[a - 1, b, 0]
    least_lo, most_lo = min(min(low_0, low_1), min(low_2, low_3)), max(max(low_0, low_1), max(low_2, low_3))
    least_hi, most_hi = min(min(high_0, high_1), min(high_2, high_3)), max(max(high_0, high_1), max(high_2, high_3))
    if most_lo >= least_hi or most_lo - least_lo > limit or most_hi - least_hi > limit:
        return False
    heights[0], heights[1] = (low_0 + low_1 + low_2 + low_3) / 4, (high_0 + high_1 + high_2 + high_3) / 4
    return True


class Climb(NamedTuple):
    """Where the way up a prism is in its four columns: changes passed (4,), how many there are, and which columns."""

    cursor: Longs
    ends: Longs
    place_i: Longs
    place_j: Longs


@kernel(inlined=True)
def begin_climb(columns: Columns, a: int, b: int, climb: Climb) -> None:
    """Start below the prism around (a, b)."""
    count = columns.number
    for corner in range(4):
        i, j = corner_column(a, b, corner)
        climb.cursor[corner], climb.ends[corner] = 0, 0
        if 0 <= i < count.shape[0] and 0 <= j < count.shape[1]:
            climb.place_i[corner], climb.place_j[corner] = i, j
            climb.ends[corner] = 2 * count[i, j]


@kernel(inlined=True)
def next_change(columns: Columns, climb: Climb) -> tuple[int, float, int]:
    """The next change of any column, ends before beginnings: corner (-1: none left), height, whether it rises."""
    lo, hi, _ = columns
    cursor, ends, place_i, place_j = climb
    best, best_z, best_rising = -1, 0.0, 0
    for corner in range(4):
        t = cursor[corner]
        if t >= ends[corner]:
            continue
        rises = 1 - (t & 1)
        if rises:
            z = lo[place_i[corner], place_j[corner], t >> 1]
        else:
            z = hi[place_i[corner], place_j[corner], t >> 1]
        if best < 0 or z < best_z or (z == best_z and rises < best_rising):
            best, best_z, best_rising = corner, z, rises
    return best, best_z, best_rising


@kernel
def on_rim(corners: Corners, a: int, b: int) -> tuple[bool, bool]:
    """Whether lattice point (a, b) is on a side of the grid across x, and across y."""
    return a == 0 or a == len(corners.xs) - 1, b == 0 or b == len(corners.ys) - 1


@kernel(inlined=True)
def put_strands(
    corners: Corners,
    a: int,
    b: int,
    group_bits: int,
    wider: int,
    shifts: Array,
    heights: Array,
    points: Array,
    made: int,
) -> int:
    """A vertex for each column of a group of two opposite ones; the new number of vertices."""
    xs, ys = corners
    rim_a, rim_b = on_rim(corners, a, b)
    for corner in range(4):
        if (group_bits >> corner) & 1:
            dx, dy, _ = strand_shift(wider, corner, shifts)
            points[made, 0], points[made, 1] = xs[a], ys[b]
            if not rim_a and not rim_b:
                points[made, 0] += 0.25 * dx * (xs[a + 1] - xs[a - 1])
                points[made, 1] += 0.25 * dy * (ys[b + 1] - ys[b - 1])
            points[made, 2] = heights[corner]
            made += 1
    return made


@kernel(inlined=True)
def vertex_place(corners: Corners, a: int, b: int, below: int, above: int, shifts: Array) -> tuple[float, float]:
    """Where the vertex of a group between the masks `below` and `above` stands: where the walls are."""
    xs, ys = corners
    rim_a, rim_b = on_rim(corners, a, b)
    x, y = xs[a], ys[b]
    if not rim_a and not rim_b:
        x_below, y_below, n_below = strand_shift(below, -1, shifts)
        x_above, y_above, n_above = strand_shift(above, -1, shifts)
        borders = n_below + n_above
        if borders > 0:
            x += 0.5 * (x_below + x_above) / borders * (xs[a + 1] - xs[a - 1])
            y += 0.5 * (y_below + y_above) / borders * (ys[b + 1] - ys[b - 1])
    elif rim_b and not rim_a:
        x += 0.5 * rim_shift(below, above, shifts, 0, 2) * (xs[a + 1] - xs[a - 1])
    elif rim_a and not rim_b:
        y += 0.5 * rim_shift(below, above, shifts, 1, 3) * (ys[b + 1] - ys[b - 1])
    return x, y


@kernel(inlined=True)
def mean_height(group_bits: int, heights: Array) -> float:
    """Mean of the heights (4,) of the columns in a group."""
    total, number = 0.0, 0
    for corner in range(4):
        if (group_bits >> corner) & 1:
            total += heights[corner]
            number += 1
    return total / number


@kernel
def build_chains(columns: Columns, walls: Singles, corners: Corners, span: ColumnSpan, limit: float) -> Chains:
    """Groups and vertices of the prisms around a span of columns (mx, my).

    walls (4, mx + 1, my + 1), or (4, 0, 0) where they are not known; limit [m]: the greatest height of a group.
    Prisms come with a from i0 to i1 and b from j0 to j1.
    """
    count = columns.number
    xs, ys = corners
    i0, i1, j0, j1 = span
    mx, my = count.shape
    rows, across = i1 - i0 + 1, j1 - j0 + 1
    room = 0
    for i in range(max(i0 - 1, 0), min(i1 + 1, mx)):
        for j in range(max(j0 - 1, 0), min(j1 + 1, my)):
            room += 8 * count[i, j]
    start = np.empty(rows * across + 1, np.int32)
    plain = np.empty(rows * across, np.int32)
    bits = np.empty(room, np.uint8)
    rising = np.empty(room, np.uint8)
    below = np.empty(room, np.uint8)
    vertex = np.empty(room, np.int32)
    extra = np.empty(room, np.int32)
    points = np.empty((2 * room, 3))
    groups, made = 0, 0
    climb = Climb(np.empty(4, np.int64), np.empty(4, np.int64), np.empty(4, np.int64), np.empty(4, np.int64))
    heights = np.empty(4)
    shifts = np.zeros(4)
    for a in range(i0, i1 + 1):
        for b in range(j0, j1 + 1):
            prism = (a - i0) * across + b - j0
            start[prism], plain[prism] = groups, -1
            rim = a == 0 or a == mx or b == 0 or b == my
            if not rim and plain_prism(columns, a, b, limit, heights):
                plain[prism] = made
                # the usual case: four columns of one piece each, a vertex below and one above
                for turn in range(2):
                    bits[groups], rising[groups], below[groups] = 15, 1 - turn, 15 * turn
                    vertex[groups], extra[groups] = made, -1
                    points[made, 0], points[made, 1], points[made, 2] = xs[a], ys[b], heights[turn]
                    groups += 1
                    made += 1
                continue
            wall_shifts(walls, a, b, shifts)
            begin_climb(columns, a, b, climb)
            mask = 0
            group_bits, group_rising, group_below = 0, 0, 0
            group_z = 0.0
            first_of_prism = groups
            while True:
                best, best_z, best_rising = next_change(columns, climb)
                if group_bits != 0 and (best < 0 or best_rising != group_rising or best_z - group_z > limit):
                    # close the group: its vertex, or one for each of two opposite columns
                    bits[groups], rising[groups], below[groups] = group_bits, group_rising, group_below
                    vertex[groups], extra[groups] = made, -1
                    wider = mask if group_rising else group_below
                    if is_diagonal(wider):
                        made = put_strands(corners, a, b, group_bits, wider, shifts, heights, points, made)
                    else:
                        points[made, 0], points[made, 1] = vertex_place(corners, a, b, group_below, mask, shifts)
                        points[made, 2] = mean_height(group_bits, heights)
                        made += 1
                        before = groups - 1
                        if group_rising == 1 and before >= first_of_prism and is_diagonal(group_below):
                            # both strands from the group before end here: keep their edges apart by a vertex more
                            wider_before = group_below if rising[before] else below[before]
                            if not is_diagonal(wider_before):
                                v, w = vertex[before], vertex[groups]
                                for d in range(3):
                                    points[made, d] = 0.5 * (points[v, d] + points[w, d])
                                extra[before] = made
                                made += 1
                    groups += 1
                    group_bits = 0
                if best < 0:
                    break
                if group_bits == 0:
                    group_below, group_rising, group_z = mask, best_rising, best_z
                group_bits |= 1 << best
                heights[best] = best_z
                mask ^= 1 << best
                climb.cursor[best] += 1
    start[rows * across] = groups
    return Chains(
        start, plain, bits[:groups], rising[:groups], below[:groups], vertex[:groups], extra[:groups], points[:made]
    )
