"""Shapes as triangles, for mesh files and pages."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import applied
from gcodesim.frames import rotation_from_quaternion
from gcodesim.log import DrawnMesh, DrawnShape
from gcodesim.log.shapes import Color
from gcodesim.solids import Box, Cone, Cylinder, Sphere

Array = NDArray[np.float64]

ROUND = 32  # flat sides of a round body


class EntitySkin(NamedTuple):
    """Points (n, 3) [m] and triangles (m, 3) of point indices, in the frame of the entity."""

    points: Array
    triangles: NDArray[np.int64]
    color: Color


def skin_of(shape: DrawnShape) -> EntitySkin:
    """The triangles of a shape, in the frame of its entity."""
    points, triangles = _own(shape)
    moved = applied(rotation_from_quaternion(shape.q), points) + shape.p
    return EntitySkin(moved, np.asarray(triangles, dtype=np.int64), shape.color)


def _own(shape: DrawnShape) -> tuple[Array, NDArray[np.integer]]:
    from trimesh import creation

    if isinstance(shape, DrawnMesh):
        return shape.points, shape.triangles
    match shape.solid:
        case Box(size=size):
            mesh = creation.box(extents=size)
        case Sphere(radius=radius):
            mesh = creation.icosphere(subdivisions=3, radius=radius)
        case Cylinder(radius=radius, length=length):
            return _frustum(radius, radius, length)
        case Cone(bottom_radius=bottom, top_radius=top, length=length):
            return _frustum(bottom, top, length)
    return np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)


def _frustum(bottom: float, top: float, length: float) -> tuple[Array, NDArray[np.integer]]:
    """Along z, centred, closed by two fans; an end of radius 0 is a point of coincident corners."""
    angle = 2.0 * np.pi * np.arange(ROUND) / ROUND
    ring = np.stack([cos(angle), sin(angle), np.zeros(ROUND)], axis=1)
    low, high = np.array([0.0, 0.0, -0.5 * length]), np.array([0.0, 0.0, 0.5 * length])
    points = np.concatenate([bottom * ring + low, top * ring + high, [low, high]])
    a = np.arange(ROUND)
    b = (a + 1) % ROUND
    sides = np.concatenate([np.stack([a, b, b + ROUND], axis=1), np.stack([a, b + ROUND, a + ROUND], axis=1)])
    lower = np.stack([b, a, np.full(ROUND, 2 * ROUND)], axis=1)
    upper = np.stack([a + ROUND, b + ROUND, np.full(ROUND, 2 * ROUND + 1)], axis=1)
    return points, np.concatenate([sides, lower, upper])


def merged(skins: list[EntitySkin]) -> tuple[Array, NDArray[np.int64]]:
    """The triangles of several skins as one skin: points (n, 3), triangles (m, 3)."""
    if not skins:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    counts = np.array([len(skin.points) for skin in skins])
    first = np.cumsum(counts) - counts
    triangles = [skin.triangles + start for skin, start in zip(skins, first, strict=True)]
    return np.concatenate([skin.points for skin in skins]), np.concatenate(triangles)
