"""Solids as triangles, for callers that need the skin of a body."""

from __future__ import annotations

from itertools import product
from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.frames import Array
from gcodesim.solids.mesh_file import Faces, Triangles
from gcodesim.solids.outline import outline_of
from gcodesim.solids.solid import Box, Cylinder, Hulls, Mesh, Solid

SIDES: Final = 64
"""Sides of the prism that represents a round body."""

MANY_SIDES: Final = 256
"""Sides of the prism for the room that a round body takes."""

# corners of a box in the order of `product`: x slowest, z fastest
_BOX: Final = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def triangles_of(solid: Solid) -> Triangles:
    """The skin of a solid, counter-clockwise from outside, in its own frame; ValueError if it has none."""
    match solid:
        case Box(lower=lower, upper=upper):
            return Triangles(points=np.array(list(product(*zip(lower, upper, strict=True)))), faces=_fans(_BOX))
        case Mesh():
            return solid.triangles
        case Cylinder():
            return _prism(solid, solid.radius, SIDES)
        case Hulls():
            raise ValueError("convex bodies have no one skin")
    return _turned(outline_of(solid)[::-1])


def room_of(solid: Solid) -> Triangles:
    """The skin of a solid that encloses its volume; a cylinder becomes a prism of many sides with its volume."""
    if not isinstance(solid, Cylinder):
        return triangles_of(solid)
    turn = np.array([2.0 * np.pi / MANY_SIDES])
    return _prism(solid, solid.radius * float(np.sqrt(turn / sin(turn))[0]), MANY_SIDES)


def _prism(solid: Cylinder, radius: float, sides: int) -> Triangles:
    return _turned(np.array([(radius, solid.bottom), (radius, solid.top)]), sides)


def _turned(outline: Array, sides: int = SIDES) -> Triangles:
    """The skin of an outline (k, 2), the lowest point first, with a disc at either end."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    around = np.stack([cos(angle), sin(angle)], axis=1)
    points = np.concatenate([np.column_stack([radius * around, np.full(sides, z)]) for radius, z in outline])
    last = sides * (len(outline) - 1)
    ends = [tuple(range(sides - 1, -1, -1)), tuple(range(last, last + sides))]
    walls = [
        (at + i, at + (i + 1) % sides, at + sides + (i + 1) % sides, at + sides + i)
        for at in range(0, last, sides)
        for i in range(sides)
    ]
    return Triangles(points=points, faces=_fans([*ends, *walls]))


def _fans(polygons: list[tuple[int, ...]] | tuple[tuple[int, ...], ...]) -> Faces:
    """Convex polygons as triangles (t, 3)."""
    fans = [(face[0], face[i], face[i + 1]) for face in polygons for i in range(1, len(face) - 1)]
    return np.array(fans, dtype=np.int32)
