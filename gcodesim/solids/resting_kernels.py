"""Where vertical lines meet triangles, which are sorted into squares of the ground for that."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_UPRIGHT = 1e-18  # [m²] of twice the area seen from above: a line that meets less of a triangle meets its neighbours
_LEAST_SQUARE = 1e-12  # [m] of its side, where all lines are one
_MOST_SQUARES = 64  # that a triangle is in, on the average
_BESIDE = 1e-9  # share of a triangle by which a line may be beside it


@kernel
def _square_of(at: float, low: float, size: float, side: int) -> int:
    return int(min(max((at - low) / size, 0.0), side - 1.0))


@kernel
def _squares(points: Array, face: Ints, low: Array, size: Array, side: int, out: Ints) -> None:
    """The first and last square along X and Y (4,) that a triangle may be met in."""
    for k in range(2):
        a, b, c = points[face[0], k], points[face[1], k], points[face[2], k]
        least, most = min(a, b, c), max(a, b, c)
        beside = 2.0 * _BESIDE * (most - least)
        out[2 * k] = _square_of(least - beside, low[k], size[k], side)
        out[2 * k + 1] = _square_of(most + beside, low[k], size[k], side)


@kernel
def _first_of_squares(points: Array, faces: Ints, lines: Array, side: int, low: Array, size: Array) -> Ints:
    """Where the triangles of each of `side` by `side` squares begin in a list of them all, and how many there are.

    Where the squares begin and how wide they are goes to `low` and `size` (2,) [m].
    """
    for k in range(2):
        low[k] = lines[:, k].min()
        size[k] = max((lines[:, k].max() - low[k]) / side, _LEAST_SQUARE)
    box = np.empty(4, np.int64)
    starts = np.zeros(side * side + 1, np.int64)
    for t in range(len(faces)):
        _squares(points, faces[t], low, size, side, box)
        for i in range(box[0], box[1] + 1):
            for j in range(box[2], box[3] + 1):
                starts[i * side + j + 1] += 1
    for cell in range(side * side):
        starts[cell + 1] += starts[cell]
    return starts


@kernel
def extreme_heights(points: Array, faces: Ints, lines: Array, below: Array, highest: bool, out: Array) -> None:
    """Heights (n,) in `out` at which lines (n, 2) meet triangles: the highest up to `below` (n,), or the lowest.

    Lines that meet none have -inf or inf. `points` (m, 3), `faces` (t, 3).
    """
    out[:] = -np.inf if highest else np.inf
    if len(lines) == 0 or len(faces) == 0:
        return
    low, size = np.empty(2), np.empty(2)
    side = max(int(np.sqrt(float(min(len(faces), len(lines))))), 1)
    starts = _first_of_squares(points, faces, lines, side, low, size)
    while side > 1 and starts[-1] > _MOST_SQUARES * len(faces):  # large or slanting triangles are in many
        side = side // 2
        starts = _first_of_squares(points, faces, lines, side, low, size)
    box = np.empty(4, np.int64)
    free, sorted_faces = starts[:-1].copy(), np.empty(starts[-1], np.int64)
    for t in range(len(faces)):
        _squares(points, faces[t], low, size, side, box)
        for i in range(box[0], box[1] + 1):
            for j in range(box[2], box[3] + 1):
                cell = i * side + j
                sorted_faces[free[cell]] = t
                free[cell] += 1
    for n in range(len(lines)):
        i = _square_of(lines[n, 0], low[0], size[0], side)
        j = _square_of(lines[n, 1], low[1], size[1], side)
        cell = i * side + j
        for entry in range(starts[cell], starts[cell + 1]):
            t = sorted_faces[entry]
            a, b, c = points[faces[t, 0]], points[faces[t, 1]], points[faces[t, 2]]
            ex, ey, ez = b[0] - a[0], b[1] - a[1], b[2] - a[2]
            fx, fy, fz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
            area = ex * fy - ey * fx
            if abs(area) <= _UPRIGHT:
                continue
            dx, dy = lines[n, 0] - a[0], lines[n, 1] - a[1]
            u = (dx * fy - dy * fx) / area
            v = (ex * dy - ey * dx) / area
            if u < -_BESIDE or v < -_BESIDE or u + v > 1.0 + _BESIDE:
                continue
            z = a[2] + u * ez + v * fz
            if highest:
                if z <= below[n]:
                    out[n] = max(out[n], z)
            else:
                out[n] = min(out[n], z)
