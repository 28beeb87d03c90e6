"""What a straight line of sight meets first among triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]

EDGE = 1.0e-9
"""Share of a triangle's side by which a line may pass beside it and still counts as meeting it: no gap at edges."""


@kernel(lean=True)
def first_met(triangles: Array, starts: Array, ways: Array, shares: Array) -> None:
    """The share (n,) of each way at which a line meets one of `triangles` (t, 3, 3) first; infinite where it does not.

    Lines begin at `starts` (n, 3) and go along `ways` (n, 3) up to their end. Triangles count from either side
    (Möller and Trumbore 1997).
    """
    for line in range(len(starts)):
        shares[line] = np.inf
        ox, oy, oz = starts[line, 0], starts[line, 1], starts[line, 2]
        dx, dy, dz = ways[line, 0], ways[line, 1], ways[line, 2]
        for t in range(len(triangles)):
            ax, ay, az = triangles[t, 0, 0], triangles[t, 0, 1], triangles[t, 0, 2]
            e1x, e1y, e1z = triangles[t, 1, 0] - ax, triangles[t, 1, 1] - ay, triangles[t, 1, 2] - az
            e2x, e2y, e2z = triangles[t, 2, 0] - ax, triangles[t, 2, 1] - ay, triangles[t, 2, 2] - az
            px, py, pz = dy * e2z - dz * e2y, dz * e2x - dx * e2z, dx * e2y - dy * e2x
            det = e1x * px + e1y * py + e1z * pz
            if det == 0.0:
                continue
            sx, sy, sz = ox - ax, oy - ay, oz - az
            u = (sx * px + sy * py + sz * pz) / det
            if u < -EDGE or u > 1.0 + EDGE:
                continue
            qx, qy, qz = sy * e1z - sz * e1y, sz * e1x - sx * e1z, sx * e1y - sy * e1x
            v = (dx * qx + dy * qy + dz * qz) / det
            if v < -EDGE or u + v > 1.0 + EDGE:
                continue
            share = (e2x * qx + e2y * qy + e2z * qz) / det
            if 0.0 <= share <= 1.0 and share < shares[line]:
                shares[line] = share
