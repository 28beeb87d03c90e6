"""The surface of three fields of columns along x, y and z: a closed mesh with a point on each edge that it crosses.

Columns of the three fields meet in nodes, the corners of cells. An edge between a node in material and one outside
carries a point, exactly where the column along it ends. In each cell the points are joined to loops by the table of
`loops` (after Lorensen and Cline 1987; nodes in material that only face each other across a side are kept apart, see
Nielson and Hamann 1991), so the mesh is closed.
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


class ThreeWays(NamedTuple):
    """Columns along x at (y, z), along y at (z, x), and along z at (x, y)."""

    x: Columns
    y: Columns
    z: Columns


class LatticeNodes(NamedTuple):
    """Numbers of the columns that are used, and where the nodes are [m]: one more at both ends, outside."""

    ix: Ints
    iy: Ints
    iz: Ints
    x: Array
    y: Array
    z: Array


class CellSpan(NamedTuple):
    """Cells i0 … i1 - 1 and so on; cell 0 begins at the first node, which is outside."""

    i0: int
    i1: int
    j0: int
    j1: int
    k0: int
    k1: int


class LatticeMesh(NamedTuple):
    """Points (v, 3) [m], whether a cut made each (v,), faces (f, 3), and a node in material at each face (f, 3)."""

    points: Array
    cut: Bytes
    faces: Ints
    nodes: Ints


class Layers(NamedTuple):
    """Room for two layers of nodes (2, ny, nz): in material or not; numbers of points on edges along x, y, z."""

    inside: Bytes
    on_x: Ints
    on_y: Ints
    on_z: Ints


@kernel(lean=True)
def find_inside(columns: Columns, nodes: LatticeNodes, span: CellSpan, i: int, inside: Bytes) -> None:
    """Which nodes (ny, nz) of layer `i` are in material, by the columns along z; only those of the span's cells."""
    lo, hi, count = columns
    inside[span.j0 : span.j1 + 1, span.k0 : span.k1 + 1] = 0
    if i == 0 or i > len(nodes.ix):
        return
    a = nodes.ix[i - 1]
    z = nodes.z
    last = min(len(nodes.iz), span.k1)
    for j in range(max(span.j0, 1), min(span.j1, len(nodes.iy)) + 1):
        b = nodes.iy[j - 1]
        k = max(1, span.k0)
        for n in range(count[a, b]):
            while k <= last and z[k] < lo[a, b, n]:
                k += 1
            while k <= last and z[k] <= hi[a, b, n]:
                inside[j, k] = 1
                k += 1


@kernel(lean=True)
def crossing(columns: Columns, a: int, b: int, low: float, high: float, enters: bool) -> float:
    """Where the column (a, b) begins (or ends) material between two nodes at `low` and `high` [m]."""
    lo, hi, count = columns
    best, nearest = 0.5 * (low + high), np.inf
    for n in range(count[a, b]):
        at = lo[a, b, n] if enters else hi[a, b, n]
        beside = max(low - at, at - high, 0.0)
        if beside < nearest:
            nearest, best = beside, at
    return min(max(best, low), high)


@kernel(lean=True)
def is_original(columns: Columns, a: int, b: int, at: float) -> bool:
    """Whether material of the column (a, b), which may stand for all, began or ended at `at` at the start."""
    lo, hi, count = columns
    a, b = min(a, count.shape[0] - 1), min(b, count.shape[1] - 1)
    same = False
    for n in range(count[a, b]):
        same |= lo[a, b, n] == at or hi[a, b, n] == at
    return same


@kernel
def new_layers(nodes: LatticeNodes) -> Layers:
    """Room for the nodes of two layers."""
    shape = (2, len(nodes.y), len(nodes.z))
    return Layers(
        np.zeros(shape, np.uint8), np.zeros(shape, np.int32), np.zeros(shape, np.int32), np.zeros(shape, np.int32)
    )


@kernel(lean=True)
def put_point(mesh: LatticeMesh, number: int, x: float, y: float, z: float, cut: bool) -> None:
    """Write point `number`, if there is room for points at all."""
    if len(mesh.points) > 0:
        mesh.points[number, 0], mesh.points[number, 1], mesh.points[number, 2] = x, y, z
        mesh.cut[number] = 1 if cut else 0


@kernel(lean=True)
def points_of_layer(
    now: ThreeWays,
    start: ThreeWays,
    nodes: LatticeNodes,
    span: CellSpan,
    i: int,
    layers: Layers,
    number: int,
    mesh: LatticeMesh,
) -> int:
    """Points on edges along y and z in the layer of nodes `i`; returns the number of points so far."""
    here = i & 1
    inside = layers.inside[here]
    x, y, z = nodes.x[i], nodes.y, nodes.z
    if i == 0 or i > len(nodes.ix):
        return number
    a = nodes.ix[i - 1]
    for j in range(span.j0, span.j1 + 1):
        for k in range(span.k0, span.k1 + 1):
            if j < span.j1 and 0 < k <= len(nodes.iz) and inside[j, k] != inside[j + 1, k]:
                c = nodes.iz[k - 1]
                at = crossing(now.y, c, a, y[j], y[j + 1], inside[j, k] == 0)
                put_point(mesh, number, x, at, z[k], not is_original(start.y, c, a, at))
                layers.on_y[here, j, k] = number
                number += 1
            if k < span.k1 and 0 < j <= len(nodes.iy) and inside[j, k] != inside[j, k + 1]:
                b = nodes.iy[j - 1]
                at = crossing(now.z, a, b, z[k], z[k + 1], inside[j, k] == 0)
                put_point(mesh, number, x, y[j], at, not is_original(start.z, a, b, at))
                layers.on_z[here, j, k] = number
                number += 1
    return number


@kernel(lean=True)
def points_between(
    now: ThreeWays,
    start: ThreeWays,
    nodes: LatticeNodes,
    span: CellSpan,
    i: int,
    layers: Layers,
    number: int,
    mesh: LatticeMesh,
) -> int:
    """Points on edges along x between the layers of nodes `i` and `i + 1`."""
    here, there = layers.inside[i & 1], layers.inside[(i + 1) & 1]
    for j in range(max(span.j0, 1), min(span.j1, len(nodes.iy)) + 1):
        for k in range(max(span.k0, 1), min(span.k1, len(nodes.iz)) + 1):
            if here[j, k] != there[j, k]:
                b, c = nodes.iy[j - 1], nodes.iz[k - 1]
                at = crossing(now.x, b, c, nodes.x[i], nodes.x[i + 1], here[j, k] == 0)
                put_point(mesh, number, at, nodes.y[j], nodes.z[k], not is_original(start.x, b, c, at))
                layers.on_x[0, j, k] = number
                number += 1
    return number


@kernel(lean=True)
def point_on(layers: Layers, edge: int, i: int, j: int, k: int) -> int:
    """The number of the point on edge 0 … 11 of cell (i, j, k)."""
    one, other = edge & 1, (edge >> 1) & 1
    if edge < 4:
        return int(layers.on_x[0, j + one, k + other])
    if edge < 8:
        return int(layers.on_y[(i + one) & 1, j, k + other])
    return int(layers.on_z[(i + one) & 1, j + other, k])


@kernel(lean=True)
def faces_between(
    layers: Layers, span: CellSpan, i: int, loops: NDArray[np.int8], count: int, mesh: LatticeMesh
) -> int:
    """Faces in the cells between the layers of nodes `i` and `i + 1`; returns the number of faces so far."""
    here, there = layers.inside[i & 1], layers.inside[(i + 1) & 1]
    for j in range(span.j0, span.j1):
        for k in range(span.k0, span.k1):
            corners = (
                here[j, k] | there[j, k] << 1 | here[j + 1, k] << 2 | there[j + 1, k] << 3 | here[j, k + 1] << 4
                | there[j, k + 1] << 5 | here[j + 1, k + 1] << 6 | there[j + 1, k + 1] << 7
            )  # fmt: skip
            if corners == 0 or corners == 255:
                continue
            for loop in range(loops.shape[1]):
                size = loops[corners, loop, 0]
                if size == 0:
                    break
                if len(mesh.faces) > 0:
                    corner = loops[corners, loop, 1]  # one of the nodes in material around which the loop goes
                    first = point_on(layers, loops[corners, loop, 2], i, j, k)
                    for n in range(1, size - 1):
                        mesh.faces[count + n - 1, 0] = first
                        mesh.faces[count + n - 1, 1] = point_on(layers, loops[corners, loop, 2 + n], i, j, k)
                        mesh.faces[count + n - 1, 2] = point_on(layers, loops[corners, loop, 3 + n], i, j, k)
                        mesh.nodes[count + n - 1, 0] = i + (corner & 1)
                        mesh.nodes[count + n - 1, 1] = j + ((corner >> 1) & 1)
                        mesh.nodes[count + n - 1, 2] = k + ((corner >> 2) & 1)
                count += size - 2
    return count


@kernel
def march(
    now: ThreeWays, start: ThreeWays, nodes: LatticeNodes, span: CellSpan, loops: NDArray[np.int8], mesh: LatticeMesh
) -> tuple[int, int]:
    """The surface in the cells of a span: (points, faces). Without room in `mesh` they are only counted."""
    layers = new_layers(nodes)
    points, faces = 0, 0
    find_inside(now.z, nodes, span, span.i0, layers.inside[span.i0 & 1])
    points = points_of_layer(now, start, nodes, span, span.i0, layers, points, mesh)
    for i in range(span.i0, span.i1):
        find_inside(now.z, nodes, span, i + 1, layers.inside[(i + 1) & 1])
        points = points_of_layer(now, start, nodes, span, i + 1, layers, points, mesh)
        points = points_between(now, start, nodes, span, i, layers, points, mesh)
        faces = faces_between(layers, span, i, loops, faces, mesh)
    return points, faces


@kernel(lean=True)
def enclosed(points: Array, faces: Ints, piece: Ints, volumes: Array) -> None:
    """Add the volume [m³] between the origin and each face (f, 3) to that of its piece (f,); the divergence theorem."""
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        nx = points[b, 1] * points[c, 2] - points[b, 2] * points[c, 1]
        ny = points[b, 2] * points[c, 0] - points[b, 0] * points[c, 2]
        nz = points[b, 0] * points[c, 1] - points[b, 1] * points[c, 0]
        volumes[piece[f]] += (points[a, 0] * nx + points[a, 1] * ny + points[a, 2] * nz) / 6.0


@kernel(lean=True)
def label_pieces(inside: Bytes, label: Ints, waiting: Ints) -> int:
    """Number the pieces in which nodes (nx, ny, nz) in material hang together, from 1 on; returns how many there are.

    The outermost nodes are outside. `waiting` has room for all nodes.
    """
    _, ny, nz = inside.shape
    flat, mark = inside.reshape(inside.size), label.reshape(label.size)
    pieces = 0
    for first in range(flat.shape[0]):
        if flat[first] == 0 or mark[first] > 0:
            continue
        pieces += 1
        mark[first] = pieces
        waiting[0] = first
        number = 1
        while number > 0:
            number -= 1
            at = waiting[number]
            for step in (1, -1, nz, -nz, ny * nz, -ny * nz):
                to = at + step
                if flat[to] > 0 and mark[to] == 0:
                    mark[to] = pieces
                    waiting[number] = to
                    number += 1
    return pieces
