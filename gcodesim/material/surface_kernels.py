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
from gcodesim.material.flat_kernels import FLAT_SIDE, Chains, ColumnSpan, PatchTriangles

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]

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


@kernel
def build_chains(columns: Columns, walls: Singles, corners: Corners, span: ColumnSpan, limit: float) -> Chains:
    """Groups and vertices of the prisms around a span of columns (mx, my).

    walls (4, mx + 1, my + 1), or (4, 0, 0) where they are not known; limit [m]: the greatest height of a group.
    Prisms come with a from i0 to i1 and b from j0 to j1.
    """
    lo, hi, count = columns
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
    cursor = np.empty(4, np.int64)
    ends = np.empty(4, np.int64)
    heights = np.empty(4)
    place_i = np.empty(4, np.int64)
    place_j = np.empty(4, np.int64)
    shifts = np.zeros(4)
    for a in range(i0, i1 + 1):
        for b in range(j0, j1 + 1):
            prism = (a - i0) * across + b - j0
            start[prism], plain[prism] = groups, -1
            rim_a, rim_b = a == 0 or a == mx, b == 0 or b == my
            rim = rim_a or rim_b
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
            for corner in range(4):
                i, j = corner_column(a, b, corner)
                cursor[corner], ends[corner] = 0, 0
                if 0 <= i < mx and 0 <= j < my:
                    place_i[corner], place_j[corner] = i, j
                    ends[corner] = 2 * count[i, j]
            mask = 0
            group_bits, group_rising, group_below = 0, 0, 0
            group_z = 0.0
            first_of_prism = groups
            while True:
                # the next change of any column: lowest first, ends before beginnings
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
                if group_bits != 0 and (best < 0 or best_rising != group_rising or best_z - group_z > limit):
                    # close the group: its vertex, or one for each of two opposite columns
                    bits[groups], rising[groups], below[groups] = group_bits, group_rising, group_below
                    vertex[groups], extra[groups] = made, -1
                    wider = mask if group_rising else group_below
                    if is_diagonal(wider):
                        for corner in range(4):
                            if (group_bits >> corner) & 1:
                                dx, dy, _ = strand_shift(wider, corner, shifts)
                                points[made, 0], points[made, 1] = xs[a], ys[b]
                                if not rim:
                                    points[made, 0] += 0.25 * dx * (xs[a + 1] - xs[a - 1])
                                    points[made, 1] += 0.25 * dy * (ys[b + 1] - ys[b - 1])
                                points[made, 2] = heights[corner]
                                made += 1
                    else:
                        total, number = 0.0, 0
                        for corner in range(4):
                            if (group_bits >> corner) & 1:
                                total += heights[corner]
                                number += 1
                        x, y = xs[a], ys[b]
                        if not rim:
                            x_below, y_below, n_below = strand_shift(group_below, -1, shifts)
                            x_above, y_above, n_above = strand_shift(mask, -1, shifts)
                            borders = n_below + n_above
                            if borders > 0:
                                x += 0.5 * (x_below + x_above) / borders * (xs[a + 1] - xs[a - 1])
                                y += 0.5 * (y_below + y_above) / borders * (ys[b + 1] - ys[b - 1])
                        elif rim_b and not rim_a:
                            x += 0.5 * rim_shift(group_below, mask, shifts, 0, 2) * (xs[a + 1] - xs[a - 1])
                        elif rim_a and not rim_b:
                            y += 0.5 * rim_shift(group_below, mask, shifts, 1, 3) * (ys[b + 1] - ys[b - 1])
                        points[made, 0], points[made, 1], points[made, 2] = x, y, total / number
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
                cursor[best] += 1
    start[rows * across] = groups
    return Chains(
        start, plain, bits[:groups], rising[:groups], below[:groups], vertex[:groups], extra[:groups], points[:made]
    )


@kernel(lean=True)
def seen_vertex(chains: Chains, group: int, corner: int) -> int:
    """The vertex of a group on the strand around a material corner; -1 if that strand passes by."""
    bits, rising, below, vertex = chains.bits, chains.rising, chains.below, chains.vertex
    mask = below[group]
    if rising[group]:
        mask = mask | bits[group]
    if not is_diagonal(mask):
        return int(vertex[group])
    if (bits[group] >> corner) & 1 == 0:
        return -1
    lower = bits[group] & ((1 << corner) - 1)
    return int(vertex[group]) + (1 if lower != 0 else 0)


@kernel(lean=True)
def find_group(bits: Bytes, begin: int, corner: int, change: int) -> int:
    """The group, from `begin` on, in which a corner's column makes its `change`-th change (even: rise, odd: fall)."""
    left = change
    group = begin
    while True:
        if (bits[group] >> corner) & 1:
            if left == 0:
                return group
            left -= 1
        group += 1


@kernel(lean=True)
def collect_chain(chains: Chains, first: int, last: int, corner: int, out: Ints) -> int:
    """Vertices of the strand around `corner` from group `first` to `last`, upwards, into `out`; their number."""
    n = 0
    for group in range(first, last + 1):
        v = seen_vertex(chains, group, corner)
        if v >= 0:
            out[n] = v
            n += 1
        # the added vertex is on the strand of the upper one of the two corners
        if chains.extra[group] >= 0 and group < last and corner >= 2:
            out[n] = chains.extra[group]
            n += 1
    return n


@kernel(lean=True)
def was_there(before: Columns, i: int, j: int, bottom: float, top: float) -> float:
    """Length [m] of [bottom, top] that was material in column (i, j); there may be one column for all."""
    lo, hi, count = before
    if count.shape[0] == 1:
        i = 0
    if count.shape[1] == 1:
        j = 0
    total = 0.0
    for k in range(count[i, j]):
        low, high = max(lo[i, j, k], bottom), min(hi[i, j, k], top)
        if high > low:
            total += high - low
    return total


@kernel(lean=True)
def was_end(before: Columns, i: int, j: int, z: float, rises: bool) -> bool:
    """Whether column (i, j) began (`rises`) or ended at z from the start."""
    lo, hi, count = before
    if count.shape[0] == 1:
        i = 0
    if count.shape[1] == 1:
        j = 0
    found = False
    for k in range(count[i, j]):
        found |= (lo[i, j, k] if rises else hi[i, j, k]) == z
    return found


@kernel(lean=True)
def build_wall(
    points: Array, chain_p: Ints, chain_q: Ints, flip: bool, changed: int, into: PatchTriangles, used: int
) -> int:
    """Triangles between two chains of vertices, upwards, whichever is lower next; the new number of faces."""
    faces, cut = into
    m, n = len(chain_p), len(chain_q)
    s, t = 0, 0
    while s + 1 < m or t + 1 < n:
        up_p = t + 1 >= n
        if s + 1 < m and t + 1 < n:
            up_p = points[chain_p[s + 1], 2] <= points[chain_q[t + 1], 2]
        faces[used, 0] = chain_q[t] if flip else chain_p[s]
        faces[used, 1] = chain_p[s] if flip else chain_q[t]
        faces[used, 2] = chain_p[s + 1] if up_p else chain_q[t + 1]
        cut[used] = changed
        used += 1
        if up_p:
            s += 1
        else:
            t += 1
    return used


@kernel
def more_room(faces: Ints, cut: Bytes, used: int) -> tuple[Ints, Bytes]:
    """Both arrays at twice their length, the first `used` rows kept."""
    wide_faces = np.empty((2 * faces.shape[0], 3), np.int32)
    wide_cut = np.empty(2 * faces.shape[0], np.uint8)
    wide_faces[:used] = faces[:used]
    wide_cut[:used] = cut[:used]
    return wide_faces, wide_cut


@kernel
def build_faces(columns: Columns, before: Columns, span: ColumnSpan, chains: Chains, flat: Bytes) -> PatchTriangles:
    """The triangles of a tile.

    What `flat` (of flat_kernels) says is flat is left out.
    A tile owns its columns, and the borders at the lower side of each (at the grid's end also the upper one).
    """
    lo, hi, count = columns
    i0, i1, j0, j1 = span
    start, plain, bits, points = chains.start, chains.plain, chains.bits, chains.points
    mx, my = count.shape
    across = j1 - j0 + 1
    faces = np.empty((4 * (i1 - i0) * (j1 - j0) + 64, 3), np.int32)
    cut = np.empty(faces.shape[0], np.uint8)
    used = 0
    chain_p = np.empty(16 * lo.shape[2] + 16, np.int32)
    chain_q = np.empty(16 * lo.shape[2] + 16, np.int32)
    for i in range(i0, i1):
        for j in range(j0, j1):
            changes = 2 * count[i, j]
            if used + 2 * changes > faces.shape[0]:
                faces, cut = more_room(faces, cut, used)
            near = (i - i0) * across + j - j0
            far = near + across
            p0, p1, p2, p3 = plain[near], plain[far], plain[far + 1], plain[near + 1]
            all_plain = p0 | p1 | p2 | p3 >= 0
            if not all_plain:
                p0, p1, p2, p3 = start[near], start[far], start[far + 1], start[near + 1]
            pi, pj = (i - i0) // FLAT_SIDE, (j - j0) // FLAT_SIDE
            for t in range(changes):
                if (t == 0 and flat[pi, pj, 0] != 0) or (t == changes - 1 and flat[pi, pj, 1] != 0):
                    continue
                if all_plain:
                    v0, v1, v2, v3 = p0 + t, p1 + t, p2 + t, p3 + t
                else:
                    v0 = seen_vertex(chains, find_group(bits, p0, 2, t), 2)
                    v1 = seen_vertex(chains, find_group(bits, p1, 3, t), 3)
                    v2 = seen_vertex(chains, find_group(bits, p2, 0, t), 0)
                    v3 = seen_vertex(chains, find_group(bits, p3, 1, t), 1)
                rises = t & 1 == 0
                z = lo[i, j, t >> 1] if rises else hi[i, j, t >> 1]
                changed = 0 if was_end(before, i, j, z, rises) else 1
                if rises:
                    v1, v3 = v3, v1
                # along the diagonal that bends less
                if abs(points[v0, 2] - points[v2, 2]) > abs(points[v1, 2] - points[v3, 2]):
                    v0, v1, v2, v3 = v1, v2, v3, v0
                faces[used, 0], faces[used, 1], faces[used, 2] = v0, v1, v2
                faces[used + 1, 0], faces[used + 1, 1], faces[used + 1, 2] = v0, v2, v3
                cut[used], cut[used + 1] = changed, changed
                used += 2
    for turn in range(2):
        # borders between columns in line along x (turn 0), then along y
        last_i = i1 + 1 if turn == 0 and i1 == mx else i1
        last_j = j1 + 1 if turn == 1 and j1 == my else j1
        for i in range(i0, last_i):
            for j in range(j0, last_j):
                here = (i - i0) * across + j - j0
                there = here + 1 if turn == 0 else here + across
                if plain[here] | plain[there] >= 0:
                    continue  # the columns begin and end together: no wall
                ai, aj = (i - 1, j) if turn == 0 else (i, j - 1)
                n_a = 2 * count[ai, aj] if ai >= 0 and aj >= 0 else 0
                n_b = 2 * count[i, j] if i < mx and j < my else 0
                if n_a == 0 and n_b == 0:
                    continue
                p, q = start[here], start[there]
                if turn == 0:
                    corner_pa, corner_pb, corner_qa, corner_qb = 3, 2, 0, 1
                else:
                    corner_pa, corner_pb, corner_qa, corner_qb = 1, 2, 0, 3
                ta, tb = 0, 0
                open_column, open_change, open_z = 0, 0, 0.0
                while ta < n_a or tb < n_b:
                    # the next change of either column, ends before beginnings
                    take_a = tb >= n_b
                    za, zb = 0.0, 0.0
                    if ta < n_a:
                        za = hi[ai, aj, ta >> 1] if ta & 1 else lo[ai, aj, ta >> 1]
                    if tb < n_b:
                        zb = hi[i, j, tb >> 1] if tb & 1 else lo[i, j, tb >> 1]
                    if ta < n_a and tb < n_b:
                        take_a = za < zb or (za == zb and (ta & 1) >= (tb & 1))
                    one_before = (ta ^ tb) & 1 == 1
                    if one_before:
                        a_solid = ta & 1 == 1
                        change = ta if take_a else tb
                        z = za if take_a else zb
                        open_p = corner_pa if open_column == 0 else corner_pb
                        open_q = corner_qa if open_column == 0 else corner_qb
                        close_p = corner_pa if take_a else corner_pb
                        close_q = corner_qa if take_a else corner_qb
                        g0p = find_group(bits, p, open_p, open_change)
                        g1p = find_group(bits, p, close_p, change)
                        g0q = find_group(bits, q, open_q, open_change)
                        g1q = find_group(bits, q, close_q, change)
                        if g0p != g1p or g0q != g1q:
                            si, sj, ei, ej = (ai, aj, i, j) if a_solid else (i, j, ai, aj)
                            changed = 0
                            full = (z - open_z) * (1.0 - 1.0e-9)
                            if was_there(before, si, sj, open_z, z) < full:
                                changed = 1
                            inside = 0 <= ei < mx and 0 <= ej < my
                            if inside and was_there(before, ei, ej, open_z, z):
                                changed = 1
                            corner_p = corner_pa if a_solid else corner_pb
                            corner_q = corner_qa if a_solid else corner_qb
                            m = collect_chain(chains, g0p, g1p, corner_p, chain_p)
                            n = collect_chain(chains, g0q, g1q, corner_q, chain_q)
                            while used + m + n > faces.shape[0]:
                                faces, cut = more_room(faces, cut, used)
                            flip = a_solid == (turn == 1)
                            into = PatchTriangles(faces, cut)
                            used = build_wall(points, chain_p[:m], chain_q[:n], flip, changed, into, used)
                    if take_a:
                        open_column, open_change, open_z = 0, ta, za
                        ta += 1
                    else:
                        open_column, open_change, open_z = 1, tb, zb
                        tb += 1
    return PatchTriangles(faces[:used], cut[:used])
