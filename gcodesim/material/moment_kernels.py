"""Volume and moments of what stands in columns: sums over their intervals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Grid

Array = NDArray[np.float64]


@kernel
def moments_of_columns(columns: Columns, grid: Grid, middle: Array, sums: Array) -> None:
    """Add up `sums` (10,) about `middle` (3,) [m]: volume, x, y, z, then xx, yy, zz, xy, yz, zx over the volume."""
    lo, hi, count = columns
    area = grid.dx * grid.dy
    for i in range(count.shape[0]):
        x = grid.x + (i + 0.5) * grid.dx - middle[0]
        for j in range(count.shape[1]):
            y = grid.y + (j + 0.5) * grid.dy - middle[1]
            for k in range(count[i, j]):
                a, b = lo[i, j, k] - middle[2], hi[i, j, k] - middle[2]
                v = (b - a) * area
                z, zz = 0.5 * (a + b), (a * a + a * b + b * b) / 3.0
                sums[0] += v
                sums[1] += v * x
                sums[2] += v * y
                sums[3] += v * z
                sums[4] += v * (x * x + grid.dx * grid.dx / 12.0)
                sums[5] += v * (y * y + grid.dy * grid.dy / 12.0)
                sums[6] += v * zz
                sums[7] += v * x * y
                sums[8] += v * y * z
                sums[9] += v * z * x
