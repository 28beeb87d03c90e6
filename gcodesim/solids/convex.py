"""Solids as convex bodies that enclose them, for collision checks."""

from __future__ import annotations

import math
from itertools import pairwise, product
from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.frames import Array
from gcodesim.solids.hull import Hull
from gcodesim.solids.outline import outline_of
from gcodesim.solids.solid import Box, Cylinder, Hulls, Mesh, Placed

SIDES: Final = 64
"""Of the prism that holds a round body."""


def hulls_of(placed: Placed, sides: int = SIDES) -> tuple[Hull, ...]:
    """A solid as convex bodies that enclose it, in the frame in which it is placed.

    Round bodies become prisms of `sides`. A mesh gives none: every triangle is a body of its own (see `facets_of`).
    """
    solid, X = placed.solid, placed.X
    match solid:
        case Box(lower=lower, upper=upper):
            corners = np.array(list(product(*zip(lower, upper, strict=True))))
            return (Hull(corners, np.eye(3)).at(X),)
        case Cylinder(radius=radius, bottom=bottom, top=top):
            return (_prism([(radius, bottom), (radius, top)], sides).at(X),)
        case Mesh():
            return ()
        case Hulls(hulls=hulls):
            return tuple(hull.at(X) for hull in hulls)
    outline = [(float(r), float(z)) for r, z in outline_of(solid)[::-1]]
    return tuple(_prism(list(piece), sides).at(X) for piece in pairwise(outline))


def facets_of(placed: Placed) -> Array:
    """Corners (t, 3, 3) of the triangles of a mesh, which may be hollow: crossing it is found; (0, 3, 3) of others."""
    if not isinstance(placed.solid, Mesh):
        return np.zeros((0, 3, 3))
    triangles = placed.solid.triangles
    corners: Array = placed.X.apply(triangles.points)[triangles.faces]
    return corners


def _prism(ends: list[tuple[float, float]], sides: int) -> Hull:
    """Hull of two circles (radius, height), the lower first, as polygons of `sides` that enclose them."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    corners = []
    for radius, height in ends:
        outer = radius / cos(np.pi / sides)
        ring = np.stack([outer * cos(angle), outer * sin(angle)], axis=1)
        corners += [[x, y, height] for x, y in ring]
    (lower, bottom), (upper, top) = ends
    straight = lower == upper  # then opposite sides have one normal
    middle = angle[: sides // 2 if straight else sides] + np.pi / sides
    size = math.hypot(top - bottom, lower - upper)
    across, along = ((top - bottom) / size, (lower - upper) / size) if size > 0.0 else (1.0, 0.0)
    around = np.stack([cos(middle), sin(middle), 0.0 * middle], axis=1)
    if not straight:
        around = np.stack([across * cos(middle), across * sin(middle), along + 0.0 * middle], axis=1)
    return Hull(np.array(corners), np.vstack([around, [[0.0, 0.0, 1.0]]]))
