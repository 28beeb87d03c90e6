"""Shapes as triangles: what files of meshes and pages take."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import rotation_from_quaternion
from gcodesim.log import Box, Cone, Cylinder, Mesh, Shape, Sphere
from gcodesim.log.shapes import Color

Array = NDArray[np.float64]

ROUND = 32  # flat sides of a round body


class Solid(NamedTuple):
    """Points (n, 3) [m] and triangles (m, 3) of point indices, in the frame of the entity."""

    points: Array
    triangles: NDArray[np.int64]
    color: Color


def solid_of(shape: Shape) -> Solid:
    """The triangles of a shape, in the frame of its entity."""
    points, triangles = _own(shape)
    moved = points @ rotation_from_quaternion(shape.q).T + shape.p
    return Solid(moved, np.asarray(triangles, dtype=np.int64), shape.color)


def _own(shape: Shape) -> tuple[Array, NDArray[np.integer]]:
    from trimesh import creation

    match shape:
        case Mesh():
            return shape.points, shape.triangles
        case Box():
            mesh = creation.box(extents=shape.size)
        case Sphere():
            mesh = creation.icosphere(subdivisions=3, radius=shape.radius)
        case Cylinder():
            return _frustum(shape.radius, shape.radius, shape.length)
        case Cone():
            return _frustum(shape.bottom_radius, shape.top_radius, shape.length)
        case _:
            raise TypeError(f"no triangles for {type(shape).__name__}")
    return np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)


def _frustum(bottom: float, top: float, length: float) -> tuple[Array, NDArray[np.integer]]:
    """Along z, centred, closed by two fans; an end of radius 0 is a point of coincident corners."""
    angle = 2.0 * np.pi * np.arange(ROUND) / ROUND
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(ROUND)], axis=1)
    low, high = np.array([0.0, 0.0, -0.5 * length]), np.array([0.0, 0.0, 0.5 * length])
    points = np.concatenate([bottom * ring + low, top * ring + high, [low, high]])
    a = np.arange(ROUND)
    b = (a + 1) % ROUND
    sides = np.concatenate([np.stack([a, b, b + ROUND], axis=1), np.stack([a, b + ROUND, a + ROUND], axis=1)])
    lower = np.stack([b, a, np.full(ROUND, 2 * ROUND)], axis=1)
    upper = np.stack([a + ROUND, b + ROUND, np.full(ROUND, 2 * ROUND + 1)], axis=1)
    return points, np.concatenate([sides, lower, upper])


def merged(solids: list[Solid]) -> tuple[Array, NDArray[np.int64]]:
    """All triangles of several solids as one: points (n, 3), triangles (m, 3)."""
    if not solids:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    counts = np.array([len(solid.points) for solid in solids])
    first = np.cumsum(counts) - counts
    triangles = [solid.triangles + start for solid, start in zip(solids, first, strict=True)]
    return np.concatenate([solid.points for solid in solids]), np.concatenate(triangles)
