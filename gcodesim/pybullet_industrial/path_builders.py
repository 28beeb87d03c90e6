"""Paths of a shape."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from gcodesim.pybullet_industrial.interpolation import circular_interpolation, linear_interpolation
from gcodesim.pybullet_industrial.toolpath import ToolPath


def build_box_path(
    center_position: ArrayLike, dimensions: ArrayLike, radius: float, orientation: ArrayLike, samples: int
) -> ToolPath:
    """A rectangle of `dimensions` (2,) [m] with corners of `radius` [m], clockwise from its left side.

    `orientation` x y z w turns the rectangle and the tool, then its middle goes to `center_position` (3,). Each of the
    four sides and each corner gets its share of a quarter of `samples`, rounded down, so there are mostly fewer.
    """
    x, y = (0.5 * float(size) for size in np.asarray(dimensions)[:2])
    inner_x, inner_y = x - radius, y - radius
    corners = [  # where each side begins and ends
        ((-x, -inner_y), (-x, inner_y)),
        ((-inner_x, y), (inner_x, y)),
        ((x, inner_y), (x, -inner_y)),
        ((inner_x, -y), (-inner_x, -y)),
    ]
    sides = [(np.array([*begin, 0.0]), np.array([*end, 0.0])) for begin, end in corners]
    straight = 4.0 * (abs(inner_x) + abs(inner_y))
    round_length = 2.0 * math.pi * radius
    on_side = int(0.25 * straight / (straight + round_length) * samples)
    on_corner = int(0.25 * round_length / (straight + round_length) * samples)
    path: ToolPath | None = None
    for number, (begin, end) in enumerate(sides):
        side = linear_interpolation(begin, end, on_side)
        if path is None:
            path = side
        else:
            path.append(side)
        path.append(circular_interpolation(end, sides[(number + 1) % 4][0], radius, on_corner))
    assert path is not None
    path.rotate(orientation)
    path.translate(np.asarray(center_position, dtype=float))
    return path
