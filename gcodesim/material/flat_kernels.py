"""Flat parts of a surface, drawn with few triangles: patches of columns that all begin or end at one height.

A flat patch is a fan around a point inside it. Towards another flat patch its side is one edge, towards anything else
it keeps all points of the lattice, so that no gap opens between fine and coarse.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]

FLAT_SIDE = 16  # columns along one side of a patch


class ColumnSpan(NamedTuple):
    """The columns [i0, i1) x [j0, j1) that a tile draws, out of those that it knows."""

    i0: int
    i1: int
    j0: int
    j1: int


class PatchTriangles(NamedTuple):
    """Triangles (f, 3) of points, counter-clockwise from outside, and whether each is changed surface (f,): 0 or 1."""

    faces: Ints
    cut: Bytes


class Chains(NamedTuple):
    """Vertices of the prisms between columns, see `surface_kernels`; prism by prism of p, group by group of g.

    `start` (p + 1,) of its groups, and `plain` (p,): the first of two vertices where all four columns begin in one
    group and end in the next, and nothing else is, or -1. Of each group: `bits` of the columns that change, whether
    they are `rising`, the mask `below`, its first `vertex`, and in `extra` the vertex in the middle of the second
    strand above it (-1: none). And the vertices, `points` (v, 3) [m].
    """

    start: Ints
    plain: Ints
    bits: Bytes
    rising: Bytes
    below: Bytes
    vertex: Ints
    extra: Ints
    points: Array


@kernel(lean=True)
def end_of(columns: Columns, i: int, j: int, top: int) -> float:
    """Where column (i, j) ends for good (top 1) or begins (top 0) [m]; NaN when it is empty."""
    lo, hi, count = columns
    n = count[i, j]
    if n == 0:
        return np.nan
    return float(hi[i, j, n - 1]) if top == 1 else float(lo[i, j, 0])


@kernel
def find_flat(columns: Columns, before: Columns, span: ColumnSpan) -> Bytes:
    """Patches (p, q, 2) of a tile, undersides and tops: 0 not flat, 1 flat, 2 flat and changed.

    A patch is flat if its columns, and those around it, have the same end.
    """
    i0, i1, j0, j1 = span
    mx, my = columns.number.shape
    one_x, one_y = before.number.shape[0] == 1, before.number.shape[1] == 1
    flat = np.zeros(((i1 - i0 + FLAT_SIDE - 1) // FLAT_SIDE, (j1 - j0 + FLAT_SIDE - 1) // FLAT_SIDE, 2), np.uint8)
    for pi in range(flat.shape[0]):
        a0, a1 = i0 + pi * FLAT_SIDE, min(i0 + (pi + 1) * FLAT_SIDE, i1)
        for pj in range(flat.shape[1]):
            b0, b1 = j0 + pj * FLAT_SIDE, min(j0 + (pj + 1) * FLAT_SIDE, j1)
            if a1 - a0 < 2 or b1 - b0 < 2:
                continue
            for top in range(2):
                z = end_of(columns, a0, b0, top)
                even = True
                given = 0
                for i in range(max(a0 - 1, 0), min(a1 + 1, mx)):
                    for j in range(max(b0 - 1, 0), min(b1 + 1, my)):
                        even = even and end_of(columns, i, j, top) == z
                        if not even:
                            break
                        if a0 <= i < a1 and b0 <= j < b1:
                            before_i, before_j = 0 if one_x else i, 0 if one_y else j
                            if end_of(before, before_i, before_j, top) == z:
                                given += 1
                    if not even:
                        break
                if even and (given == 0 or given == (a1 - a0) * (b1 - b0)):
                    flat[pi, pj, top] = 1 if given > 0 else 2
    return flat


@kernel(lean=True)
def lattice_vertex(chains: Chains, columns: int, a: int, b: int, top: int) -> int:
    """The first (top 0) or last (top 1) vertex over a point of the tile's lattice."""
    place = a * columns + b
    group = chains.start[place + 1] - 1 if top == 1 else chains.start[place]
    return int(chains.vertex[group])


@kernel(lean=True)
def outline(flat: Bytes, pi: int, pj: int, top: int, span: ColumnSpan, chains: Chains, out: Ints) -> int:
    """Vertices around a flat patch, counter-clockwise from above, into `out`; their number."""
    i0, i1, j0, j1 = span
    columns = j1 - j0 + 1
    a0, a1 = pi * FLAT_SIDE, min((pi + 1) * FLAT_SIDE, i1 - i0)
    b0, b1 = pj * FLAT_SIDE, min((pj + 1) * FLAT_SIDE, j1 - j0)
    n = 0
    for side in range(4):
        length = a1 - a0 if side % 2 == 0 else b1 - b0
        qi = pi + (1 if side == 1 else -1 if side == 3 else 0)
        qj = pj + (1 if side == 2 else -1 if side == 0 else 0)
        inside = 0 <= qi < flat.shape[0] and 0 <= qj < flat.shape[1]
        step = length if inside and flat[qi, qj, top] != 0 else 1
        for s in range(0, length, step):
            if side == 0:
                a, b = a0 + s, b0
            elif side == 1:
                a, b = a1, b0 + s
            elif side == 2:
                a, b = a1 - s, b1
            else:
                a, b = a0, b1 - s
            out[n] = lattice_vertex(chains, columns, a, b, top)
            n += 1
    return n


@kernel
def flat_faces(flat: Bytes, span: ColumnSpan, chains: Chains) -> PatchTriangles:
    """The triangles of all flat patches."""
    i0, i1, j0, j1 = span
    columns = j1 - j0 + 1
    room = flat.shape[0] * flat.shape[1] * 8 * FLAT_SIDE
    faces = np.empty((room, 3), np.int32)
    cut = np.empty(room, np.uint8)
    ring = np.empty(4 * FLAT_SIDE, np.int32)
    used = 0
    for pi in range(flat.shape[0]):
        for pj in range(flat.shape[1]):
            for top in range(2):
                if flat[pi, pj, top] == 0:
                    continue
                n = outline(flat, pi, pj, top, span, chains, ring)
                a = (pi * FLAT_SIDE + min((pi + 1) * FLAT_SIDE, i1 - i0)) // 2
                b = (pj * FLAT_SIDE + min((pj + 1) * FLAT_SIDE, j1 - j0)) // 2
                centre = lattice_vertex(chains, columns, a, b, top)
                first, fans = 0, n
                if n == 4:  # two triangles from a corner
                    centre, first, fans = ring[0], 1, 2
                for s in range(first, first + fans):
                    u, v = ring[s], ring[(s + 1) % n]
                    faces[used, 0] = centre
                    faces[used, 1] = u if top == 1 else v
                    faces[used, 2] = v if top == 1 else u
                    cut[used] = flat[pi, pj, top] - 1
                    used += 1
    return PatchTriangles(faces[:used], cut[:used])
