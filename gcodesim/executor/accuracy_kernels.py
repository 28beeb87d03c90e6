"""How far points are from the way that was commanded, in one compiled loop."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]


@kernel(lean=True)
def to_chords(points: Array, way: Array, first: int, behind: int, nearest: Array) -> None:
    """Fill `nearest` (n,) with the distance [m] of each point from the last chords of a way before its own end.

    points (n, 3); way (first + n, 3): point k is at way[first + k] in time; behind: how many chords are looked at.
    A chord is passed over where even its beginning is farther away than the chord is long and the best found.
    """
    for k in range(points.shape[0]):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        dx, dy, dz = x - way[first + k, 0], y - way[first + k, 1], z - way[first + k, 2]
        best = np.sqrt(dx * dx + dy * dy + dz * dz)
        for j in range(first + k - 1, max(first + k - 1 - behind, -1), -1):
            fx, fy, fz = x - way[j, 0], y - way[j, 1], z - way[j, 2]
            cx, cy, cz = way[j + 1, 0] - way[j, 0], way[j + 1, 1] - way[j, 1], way[j + 1, 2] - way[j, 2]
            length = cx * cx + cy * cy + cz * cz
            # (best + chord)**2 is at most twice the sum of both squares
            if fx * fx + fy * fy + fz * fz > 2.0 * (best * best + length):
                continue
            share = (fx * cx + fy * cy + fz * cz) / length if length > 0.0 else 0.0
            share = min(max(share, 0.0), 1.0)
            ox, oy, oz = fx - share * cx, fy - share * cy, fz - share * cz
            best = min(best, np.sqrt(ox * ox + oy * oy + oz * oz))
        nearest[k] = best
