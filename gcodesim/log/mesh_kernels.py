"""Leaving points out of a mesh that none of its triangles uses, and writing the rest."""

from __future__ import annotations

from typing import Any

import numpy as np

from gcodesim.compiled import kernel


@kernel(lean=True)
def number_used(triangles: Any, number: Any) -> int:
    """Number the points that `triangles` (m, 3) use in `number` (n,), in their order, the others −1; how many are used.

    −1 when a triangle points outside.
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
    """The points with a `number` (n,) into `kept`, and the triangles of their numbers into `renumbered`."""
    for i in range(len(number)):
        if number[i] >= 0:
            for c in range(3):
                kept[number[i], c] = points[i, c]
    for i in range(triangles.shape[0]):
        for c in range(3):
            renumbered[i, c] = number[triangles[i, c]]


@kernel
def put_points(points: Any, grid: float, tag: int, data: Any, words: Any) -> bool:
    """Write `points` (n, 3), rounded to whole multiples of `grid`, as fields x, y, z of messages in a repeated field.

    `tag` is the field's; `data` (29 n,) takes the bytes, and is looked at as a float64 at every byte in `words`
    (29 n - 7,). False, and an end, where a number is not finite.
    """
    at = 0
    for i in range(points.shape[0]):
        data[at], data[at + 1] = tag, 27
        at += 2
        for d in range(3):
            value = np.rint(points[i, d] * (1.0 / grid)) * grid + 0.0  # + 0.0 turns -0.0 into 0.0
            if not np.isfinite(value):
                return False
            data[at] = (d + 1) << 3 | 1
            words[at + 1] = value
            at += 9
    return True
