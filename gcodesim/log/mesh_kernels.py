"""Removes points from a mesh that none of its triangles uses, and writes the others."""

from __future__ import annotations

from typing import Any

import numpy as np

from gcodesim.compiled import kernel


@kernel(lean=True)
def number_used(triangles: Any, number: Any) -> int:
    """Number in `number` (n,) the points that `triangles` (m, 3) use, in order, others −1; returns how many are used.

    Returns −1 if an index is out of range.
    """
    for i in range(len(number)):
        number[i] = -1
    for i in range(triangles.shape[0]):
        for c in range(3):
            point = triangles[i, c]
            if not 0 <= point < len(number):
                return -1
            number[point] = 0
    count = 0
    for i in range(len(number)):
        if number[i] == 0:
            number[i] = count
            count += 1
    return count


@kernel(lean=True)
def take_used(points: Any, triangles: Any, number: Any, kept: Any, renumbered: Any) -> None:
    """Copy the points with a `number` (n,) into `kept`, and the triangles in new numbers into `renumbered`."""
    for i in range(len(number)):
        if number[i] >= 0:
            for c in range(3):
                kept[number[i], c] = points[i, c]
    for i in range(triangles.shape[0]):
        for c in range(3):
            renumbered[i, c] = number[triangles[i, c]]


@kernel(lean=True)
def round_points(points: Any, grid: float, out: Any) -> bool:
    """Whole multiples of `grid` nearest to `points` (n, 3), into `out` (n, 3). False if a number is not finite."""
    wild = 0
    for i in range(points.shape[0]):
        for d in range(3):
            value = np.rint(points[i, d] * (1.0 / grid)) * grid + 0.0  # + 0.0 turns -0.0 into 0.0
            wild += not abs(value) < np.inf
            out[i, d] = value
    return wild == 0


@kernel(lean=True)
def put_points(points: Any, tag: int, data: Any) -> None:
    """Write points, given as the bytes (n, 24) of their numbers, as messages of fields x, y, z in a repeated field.

    `tag` is that field's; `data` (29 n,) takes the bytes.
    """
    for i in range(points.shape[0]):
        point, given = data[29 * i : 29 * (i + 1)], points[i]
        point[0], point[1] = tag, 27
        for d in range(3):
            point[2 + 9 * d] = (d + 1) << 3 | 1
            for byte in range(8):
                point[3 + 9 * d + byte] = given[8 * d + byte]
