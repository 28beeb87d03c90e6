"""The triangles of the surface around columns, between the vertices that `surface_kernels.build_chains` has found.

Every end of a column gives a quadrilateral between its four prisms, every stretch in which one of two neighbours is
material a wall between their two prisms.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns
from gcodesim.material.flat_kernels import FLAT_SIDE, Chains, ColumnSpan, PatchTriangles
from gcodesim.material.surface_kernels import is_diagonal

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]


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
def put_ends(
    columns: Columns, before: Columns, span: ColumnSpan, chains: Chains, flat: Bytes, into: PatchTriangles
) -> tuple[PatchTriangles, int]:
    """A quadrilateral for each end of a column that is not `flat`: the faces, in more room if need be; how many."""
    lo, hi, count = columns
    i0, i1, j0, j1 = span
    start, plain, bits, points = chains.start, chains.plain, chains.bits, chains.points
    across = j1 - j0 + 1
    faces, cut = into
    used = 0
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
    return PatchTriangles(faces, cut), used


class Border(NamedTuple):
    """A border between two columns: (ai, aj) on its lower side, -1 outside, and (bi, bj) on its upper one.

    `turn` 0: in line along x, 1: along y. `p` and `q` are the first groups of the prisms at its ends.
    """

    turn: int
    ai: int
    aj: int
    bi: int
    bj: int
    p: int
    q: int


@kernel
def stretch_is_new(before: Columns, count: Ints, border: Border, a_solid: bool, bottom: float, top: float) -> int:
    """Whether the wall of one column, the other being empty from `bottom` to `top`, was not there from the start."""
    _, ai, aj, bi, bj, _, _ = border
    si, sj, ei, ej = (ai, aj, bi, bj) if a_solid else (bi, bj, ai, aj)
    changed = 0
    full = (top - bottom) * (1.0 - 1.0e-9)
    if was_there(before, si, sj, bottom, top) < full:
        changed = 1
    inside = 0 <= ei < count.shape[0] and 0 <= ej < count.shape[1]
    if inside and was_there(before, ei, ej, bottom, top):
        changed = 1
    return changed


@kernel
def put_border(
    columns: Columns, before: Columns, border: Border, chains: Chains, room: Ints, into: PatchTriangles, used: int
) -> tuple[PatchTriangles, int]:
    """The walls on a border, wherever one of its columns is material and the other is not; faces as in `put_ends`.

    `room` (2, r) takes the two chains of a wall.
    """
    lo, hi, count = columns
    faces, cut = into
    chain_p, chain_q = room[0], room[1]
    turn, ai, aj, i, j, p, q = border
    n_a = 2 * count[ai, aj] if ai >= 0 and aj >= 0 else 0
    n_b = 2 * count[i, j] if i < count.shape[0] and j < count.shape[1] else 0
    # corners of the prisms p and q at which the columns a and b stand
    corner_pa, corner_pb, corner_qa, corner_qb = (3, 2, 0, 1) if turn == 0 else (1, 2, 0, 3)
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
            g0p = find_group(chains.bits, p, corner_pa if open_column == 0 else corner_pb, open_change)
            g1p = find_group(chains.bits, p, corner_pa if take_a else corner_pb, change)
            g0q = find_group(chains.bits, q, corner_qa if open_column == 0 else corner_qb, open_change)
            g1q = find_group(chains.bits, q, corner_qa if take_a else corner_qb, change)
            if g0p != g1p or g0q != g1q:
                changed = stretch_is_new(before, count, border, a_solid, open_z, z)
                m = collect_chain(chains, g0p, g1p, corner_pa if a_solid else corner_pb, chain_p)
                n = collect_chain(chains, g0q, g1q, corner_qa if a_solid else corner_qb, chain_q)
                while used + m + n > faces.shape[0]:
                    faces, cut = more_room(faces, cut, used)
                flip = a_solid == (turn == 1)
                into = PatchTriangles(faces, cut)
                used = build_wall(chains.points, chain_p[:m], chain_q[:n], flip, changed, into, used)
        if take_a:
            open_column, open_change, open_z = 0, ta, za
            ta += 1
        else:
            open_column, open_change, open_z = 1, tb, zb
            tb += 1
    return PatchTriangles(faces, cut), used


@kernel
def build_faces(columns: Columns, before: Columns, span: ColumnSpan, chains: Chains, flat: Bytes) -> PatchTriangles:
    """The triangles of a tile.

    What `flat` (of flat_kernels) says is flat is left out.
    A tile owns its columns, and the borders at the lower side of each (at the grid's end also the upper one).
    """
    i0, i1, j0, j1 = span
    start, plain = chains.start, chains.plain
    mx, my = columns.number.shape
    across = j1 - j0 + 1
    length = 4 * (i1 - i0) * (j1 - j0) + 64
    made = PatchTriangles(np.empty((length, 3), np.int32), np.empty(length, np.uint8))
    made, used = put_ends(columns, before, span, chains, flat, made)
    room = np.empty((2, 16 * columns.lo.shape[2] + 16), np.int32)
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
                border = Border(turn, ai, aj, i, j, start[here], start[there])
                made, used = put_border(columns, before, border, chains, room, made, used)
    faces, cut = made
    return PatchTriangles(faces[:used], cut[:used])
