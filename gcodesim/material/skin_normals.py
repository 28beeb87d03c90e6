"""The direction in which a skin faces beside any point, without the facets of its triangles."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.frozen import frozen
from gcodesim.material.distance_kernels import SkinTree, skin_normals
from gcodesim.material.distance_tree import in_leaves, skin_tree

Array = NDArray[np.float64]
Faces = NDArray[np.int32]

_CREASE: Final = math.sqrt(0.75)
"""The cosine of 30 deg: triangles that lean more meet at an edge, others are facets of something round."""


@frozen(eq=False)
class SkinNormals:
    """Triangles in a `tree`, with the normals (f, 9) at their corners."""

    tree: SkinTree
    normals: Array

    @staticmethod
    def of(vertices: Array, faces: Faces) -> SkinNormals:
        """Of a mesh: vertices (v, 3) [m], faces (f, 3) counter-clockwise from outside, f > 0."""
        corners = np.ascontiguousarray(vertices[faces], dtype=np.float64)
        normals = _at_corners(corners, _numbered(vertices)[faces])
        return SkinNormals(tree=skin_tree(vertices, faces), normals=normals[in_leaves(corners)].reshape(-1, 9))

    def nearest(self, points: Array) -> tuple[Array, Array]:
        """Distances (n,) [m] of `points` (n, 3), and the normals (n, 3) where the skin is nearest to them."""
        distance, normal = np.empty(len(points)), np.empty((len(points), 3))
        skin_normals(self.tree, self.normals, np.ascontiguousarray(points), distance, normal)
        return distance, normal / np.maximum(norms(normal), 1e-300)[:, None]


def _numbered(vertices: Array) -> NDArray[np.intp]:
    """One number (v,) for all vertices at one place, as in files that say each corner anew."""
    order = np.lexsort(vertices.T)
    differs = np.any(vertices[order][1:] != vertices[order][:-1], axis=1)
    numbers = np.empty(len(vertices), dtype=np.intp)
    numbers[order] = np.concatenate([[0], np.cumsum(differs)])
    return numbers


def _at_corners(corners: Array, places: NDArray[np.intp]) -> Array:
    """Normals (f, 3, 3) at the `corners` (f, 3, 3) of triangles, which stand at numbered `places` (f, 3).

    Each is the mean of the triangles that meet there and lean little against this one, by their angles at the corner
    (Thuermer and Wuethrich 1998).
    """
    before, after = np.roll(corners, 1, axis=1) - corners, np.roll(corners, -1, axis=1) - corners
    facing = np.cross(after[:, 0], before[:, 0])
    facing = facing / np.maximum(norms(facing), 1e-300)[:, None]
    sizes = np.maximum(norms(before.reshape(-1, 3)) * norms(after.reshape(-1, 3)), 1e-300)
    angles = acos(np.clip(dots(before.reshape(-1, 3), after.reshape(-1, 3)) / sizes, -1.0, 1.0))
    face = np.repeat(np.arange(len(corners)), 3)
    place = places.reshape(-1)
    order = np.argsort(place, kind="stable")
    begin = np.searchsorted(place[order], place, side="left")
    count = np.searchsorted(place[order], place, side="right") - begin
    normals = np.zeros((len(place), 3))
    for turn in range(int(count.max())):  # the triangle that is the turn-th at the place of each corner
        here = np.flatnonzero(count > turn)
        other = order[begin[here] + turn]
        beside = dots(facing[face[here]], facing[face[other]]) > _CREASE
        here, other = here[beside], other[beside]
        normals[here] += angles[other, None] * facing[face[other]]
    return normals.reshape(-1, 3, 3)
