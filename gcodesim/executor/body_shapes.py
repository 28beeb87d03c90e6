"""Shapes of the cell as triangles, for processes that act on bodies."""

from __future__ import annotations

from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.cell.stock import Box, Cylinder, Mesh, Shape
from gcodesim.frames import Array

SIDES: Final = 64
"""Of the prism that stands for a cylinder."""

# corners of a box in the order of `product`: x slowest, z fastest
_BOX: Final = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def triangles_of(shape: Shape) -> tuple[Array, NDArray[np.int32]]:
    """Points (v, 3) [m] and triangles (t, 3), outside counter-clockwise, in the shape's own frame."""
    if isinstance(shape, Box):
        points = np.array(list(product(*zip(shape.lower, shape.upper, strict=True))))
        return points, _fans(_BOX)
    if isinstance(shape, Cylinder):
        angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
        ring = shape.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        points = np.concatenate([np.column_stack([ring, np.full(SIDES, z)]) for z in (shape.bottom, shape.top)])
        sides = [(i, (i + 1) % SIDES, SIDES + (i + 1) % SIDES, SIDES + i) for i in range(SIDES)]
        return points, _fans([tuple(range(SIDES - 1, -1, -1)), tuple(range(SIDES, 2 * SIDES)), *sides])
    if isinstance(shape, Mesh):
        from gcodesim.material.mesh import read_mesh

        return read_mesh(shape.path, shape.scale)
    return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32)


def _fans(polygons: list[tuple[int, ...]] | tuple[tuple[int, ...], ...]) -> NDArray[np.int32]:
    """Convex polygons as triangles (t, 3)."""
    fans = [(face[0], face[i], face[i + 1]) for face in polygons for i in range(1, len(face) - 1)]
    return np.array(fans, dtype=np.int32)
