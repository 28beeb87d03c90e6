"""Leaving points out of a mesh that none of its triangles uses."""

from __future__ import annotations

from typing import Any

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
