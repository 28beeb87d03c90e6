"""The volume inside of a closed mesh, and how much its points move it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]


@kernel(lean=True)
def six_volumes(vertices: Array, faces: Ints, volumes: Array) -> None:
    """Six times the volume (f,) [m³] between each triangle and the first point; their sum is that of the mesh."""
    for f in range(len(faces)):
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        ax, ay, az = vertices[i, 0] - vertices[0, 0], vertices[i, 1] - vertices[0, 1], vertices[i, 2] - vertices[0, 2]
        bx, by, bz = vertices[j, 0] - vertices[0, 0], vertices[j, 1] - vertices[0, 1], vertices[j, 2] - vertices[0, 2]
        cx, cy, cz = vertices[k, 0] - vertices[0, 0], vertices[k, 1] - vertices[0, 1], vertices[k, 2] - vertices[0, 2]
        volumes[f] = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)


@kernel(lean=True)
def level_shares(
    points: Array, faces: Ints, cut: Bytes, upright: float, corner_sum: Array, share: Array, free: Bytes
) -> None:
    """What a level shift of each point (n,) changes of the volume, and which points are free to shift.

    `share` (n, 2) is a third of the area vectors of the triangles around a point, `corner_sum` (n, 2) is room to add
    them up. Points of `cut` triangles are free (1), unless a side of the stock, whose normal has at most `upright` of
    its length along Z, holds them (0). Both arrays begin as zeros.
    """
    for f in range(len(faces)):
        if cut[f] != 0:
            free[faces[f, 0]] = free[faces[f, 1]] = free[faces[f, 2]] = 1
    for corner in range(3):  # one after the other, so that sums keep their order
        for f in range(len(faces)):
            i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
            ax, ay, az = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]
            bx, by, bz = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1], points[k, 2] - points[i, 2]
            nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            corner_sum[faces[f, corner], 0] += nx / 6.0
            corner_sum[faces[f, corner], 1] += ny / 6.0
            if cut[f] == 0 and abs(nz) <= upright * math.sqrt(nx * nx + ny * ny + nz * nz):
                free[faces[f, corner]] = 0
        for p in range(len(points)):
            share[p, 0] += corner_sum[p, 0]
            share[p, 1] += corner_sum[p, 1]
            corner_sum[p, 0], corner_sum[p, 1] = 0.0, 0.0
