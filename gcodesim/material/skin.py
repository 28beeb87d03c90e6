"""The skin of a finished part as it is painted: fine triangles, how far each is from the target, and who made it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]
Faces = NDArray[np.int32]

MOST_COLUMNS: Final = 60_000
"""Columns of a stock that are drawn at most; a finer stock is painted with what its own skin has nearest to a face."""

EDGES: Final = (8, 12, 20, 30, 45, 60)
"""So many of the longest edges that are left lie along the part: the last number that stays below the next bound."""

MOST_FACES: Final = 150_000
"""Faces that a skin may get by splitting long edges."""

LOOK: Final = 0.25
"""How far beside a face one looks which way the target lies, in distances from it."""

DECISIVE: Final = 0.2
"""Share of twice that way by which one side has to be nearer to the target."""

COLUMNS: Final = 400
"""Columns of the target along X and Y where they decide."""


@frozen(eq=False)
class Maker:
    """A program line with the tool that it moved."""

    file: str
    line: int
    tool: int


@frozen(eq=False)
class PaintedSkin:
    """The closed skin: vertices (v, 3) [m] in the frame of the stock's columns, faces (f, 3) seen from outside.

    `deviation` (f,) [m] is positive where material stands out of the target; `maker` (f,) is an index into `makers`,
    -1 where no tool was. `turn` takes vertices into the part's own frame; deviations beyond `tolerance` are faults.
    `spots` (k, 2, 3) [m] are boxes around the places out of tolerance, in the order of the results.
    """

    vertices: Array
    faces: Faces
    deviation: Array
    maker: Faces
    makers: Sequence[Maker]
    turn: Array
    tolerance: float
    spots: Array


def skin_to_paint(stock: Stock) -> tuple[Array, Faces, Array, Array]:
    """Vertices and faces to draw, and for each face a point of the stock's own skin (f, 3) with its normal."""
    own = stock.surface()
    spacing = stock.spacing_for(MOST_COLUMNS)
    drawn = own if spacing <= stock.cell * 1.001 else stock.surface(spacing)
    vertices, faces = _split_enough(drawn.vertices, drawn.faces)
    middle, normal = middles(vertices, faces)
    if drawn is not own:
        from scipy.spatial import cKDTree

        fine, across = middles(*_split_enough(own.vertices, own.faces))
        near = cKDTree(fine).query(middle)[1]
        middle, normal = fine[near], across[near]
    return vertices, faces, middle, normal


def _split_enough(vertices: Array, faces: Faces) -> tuple[Array, Faces]:
    """The same surface with edges as short as the number of faces allows."""
    whole = float((vertices.max(axis=0) - vertices.min(axis=0)).max())
    found = vertices, faces
    for edges in EDGES:
        if len(found[1]) > MOST_FACES // 2:
            break
        finer = evenly_split(vertices, faces, whole / edges)
        if len(finer[1]) > MOST_FACES:
            break
        found = finer
    return found


def deviations(target: tuple[Array, NDArray[Any]], points: Array, normals: Array) -> Array:
    """Distances (n,) [m] of points of a skin from that of the target, negative inside of it.

    `target` is a closed mesh: vertices (v, 3) [m], faces (f, 3). Beside a face the target lies to the side on which it
    is nearer; where both are alike, as at the wall of a dip in a floor, a point is inside if its column is.
    """
    from gcodesim.material.deviation_kernels import FAR
    from gcodesim.material.distance_kernels import skin_distances
    from gcodesim.material.distance_tree import skin_tree
    from gcodesim.material.mesh import outward

    vertices, faces = outward(*target)
    tree = skin_tree(vertices, faces)

    def asked(places: Array) -> Array:
        found = np.zeros(len(places))
        skin_distances(tree, np.ascontiguousarray(places), FAR, found)
        return found

    distance = asked(points)
    step = np.maximum(LOOK * distance, 1e-7)
    outside = asked(points + step[:, None] * normals) - asked(points - step[:, None] * normals)
    inside = np.where(np.abs(outside) > DECISIVE * step, outside < 0.0, _inside(vertices, faces, points))
    signed: Array = np.where(inside, -distance, distance)
    return signed


def _inside(vertices: Array, faces: Faces, points: Array) -> NDArray[np.bool_]:
    """Which points (n, 3) lie in a closed mesh, as far as columns along Z tell."""
    from gcodesim.material.field_kernels import Grid
    from gcodesim.material.mesh import columns_of_mesh

    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = (high - low)[:2] / COLUMNS
    columns, _ = columns_of_mesh(vertices, faces, Grid(low[0], low[1], size[0], size[1]), (COLUMNS, COLUMNS))
    at = np.floor((points[:, :2] - low[:2]) / size).astype(np.int64)
    there = ((at >= 0) & (at < COLUMNS)).all(axis=1)
    i, j = np.clip(at, 0, COLUMNS - 1).T
    used = np.arange(columns.lo.shape[2]) < columns.number[i, j][:, None]
    z = points[:, 2:]
    found: NDArray[np.bool_] = there & (used & (columns.lo[i, j] < z) & (z < columns.hi[i, j])).any(axis=1)
    return found


def middles(vertices: Array, faces: NDArray[Any]) -> tuple[Array, Array]:
    """Middles (f, 3) and unit normals (f, 3) of triangles."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return (a + b + c) / 3.0, normal / np.maximum(norms(normal), 1e-300)[:, None]


def evenly_split(vertices: Array, faces: NDArray[Any], size: float) -> tuple[Array, Faces]:
    """The same closed surface with no edge longer than `size` [m]: long edges are halved for both of their triangles.

    So neighbours go on sharing corners, and what was closed stays so.
    """
    faces = faces.astype(np.int64)
    while True:
        ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)  # (f, 3, 2)
        way = vertices[ends[..., 1]] - vertices[ends[..., 0]]
        long = dots(way.reshape(-1, 3), way.reshape(-1, 3)).reshape(-1, 3) > size * size
        if not long.any():
            return vertices, faces.astype(np.int32)
        pairs = np.sort(ends, axis=-1)
        number = pairs[..., 0] * len(vertices) + pairs[..., 1]
        split, which = np.unique(number[long], return_inverse=True)
        middle = np.full(faces.shape, -1, dtype=np.int64)
        middle[long] = which.reshape(-1) + len(vertices)
        a, b = split // len(vertices), split % len(vertices)
        vertices = np.concatenate([vertices, 0.5 * (vertices[a] + vertices[b])])
        faces = _cut(faces, middle)


def _cut(faces: NDArray[np.int64], middle: NDArray[np.int64]) -> NDArray[np.int64]:
    """Triangles (f, 3) of which the edge from corner k on is halved at `middle` (f, 3), -1 where it stays."""
    count = (middle >= 0).sum(axis=1)
    found = [faces[count == 0]]
    for halved in (1, 2):
        chosen = count == halved
        cut = middle[chosen] >= 0
        first = np.argmax(cut, axis=1) if halved == 1 else np.argmin(cut, axis=1) + 1
        turn = (first[:, None] + np.arange(3)) % 3
        (a, b, c), (p, q, _) = (np.take_along_axis(v[chosen], turn, axis=1).T for v in (faces, middle))
        if halved == 1:  # the edge from a to b at p
            found += [np.stack([a, p, c], axis=1), np.stack([p, b, c], axis=1)]
        else:  # the edges from a to b and from b to c
            found += [np.stack(corners, axis=1) for corners in ((p, b, q), (a, p, q), (a, q, c))]
    chosen = count == 3
    (a, b, c), (p, q, r) = faces[chosen].T, middle[chosen].T
    found += [np.stack(corners, axis=1) for corners in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))]
    return np.concatenate(found)
