"""Cutting with a tilted tool: the line of each column against the turned body, at poses half a cell apart.

The body is a stack of frusta along its axis (a convex profile), the line meets it in one interval, and what lies
between two poses is taken as the hull of their intervals.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH_SHIFT, Field
from gcodesim.material.removal_kernels import subtract
from gcodesim.material.sweep_kernels import columns_across_x, columns_across_y, x_of, y_of
from gcodesim.material.wall_kernels import shorten_walls

Array = NDArray[np.float64]


class TiltedWay(NamedTuple):
    """Pieces of a tip's way with an axis that turns, each (c, 3): tips [m], and unit vectors to the holder."""

    starts: Array
    ends: Array
    axes_start: Array
    axes_end: Array


class Profile(NamedTuple):
    """A body of revolution as a stack of frusta: radii (m,) at heights (m,) above the tip [m]."""

    radii: Array
    heights: Array


@kernel
def line_through_body(px: float, py: float, ax: float, ay: float, az: float, body: Profile) -> tuple[float, float]:
    """Interval (low, high) [m] above the tip in which the upright line at (px, py) from it is inside; (1, 0): never.

    (ax, ay, az): unit axis from tip to holder.
    """
    radii, heights = body
    least, most = np.inf, -np.inf
    level = px * ax + py * ay
    apart2 = px * px + py * py
    for s in range(radii.shape[0] - 1):
        h0, h1 = heights[s], heights[s + 1]
        if h1 <= h0:
            continue
        if abs(az) > 1.0e-12:
            a, b = (h0 - level) / az, (h1 - level) / az
            low, high = min(a, b), max(a, b)
        elif h0 <= level <= h1:
            low, high = -np.inf, np.inf
        else:
            continue
        growth = (radii[s + 1] - radii[s]) / (h1 - h0)
        radius = radii[s] + growth * (level - h0)  # at the level of the line's foot
        qa = 1.0 - az * az * (1.0 + growth * growth)
        qb = -az * (level + growth * radius)
        qc = apart2 - level * level - radius * radius
        if abs(qa) < 1.0e-12:
            # parallel to the mantle (an upright cylinder, or a cone's own line)
            if abs(qb) < 1.0e-12:
                if qc > 0.0:
                    continue
            elif qb > 0.0:
                high = min(high, -0.5 * qc / qb)
            else:
                low = max(low, -0.5 * qc / qb)
        else:
            root2 = qb * qb - qa * qc
            if root2 < 0.0:
                if qa > 0.0:
                    continue
            else:
                root = np.sqrt(root2)
                if qa > 0.0:
                    low, high = max(low, (-qb - root) / qa), min(high, (-qb + root) / qa)
                else:
                    # inside beyond either root: one of the two is the other half of the double cone
                    near, far = (-qb + root) / qa, (-qb - root) / qa
                    if low < near:
                        high = min(high, near)
                    else:
                        low = max(low, far)
        if low < high:
            least, most = min(least, low), max(most, high)
    if least < most:
        return least, most
    return 1.0, 0.0


@kernel
def remove_tilted(field: Field, way: TiltedWay, body: Profile, first: int, volume: Array) -> int:
    """Remove pieces `first`... of a tool whose axis turns; returns the index that found no room, or their number.

    `volume` (c,) is added to [m^3].
    """
    columns, grid, walls, dirty, _ = field
    _, hi, count = columns
    starts, ends, axes_start, axes_end = way
    radii, heights = body
    nx, ny = count.shape
    pieces = len(starts)
    tall = heights[-1]
    wide = np.max(radii)
    cell = min(grid.dx, grid.dy)
    for p in range(first, pieces):
        move, turn = 0.0, 0.0
        for d in range(3):
            move += np.square(ends[p, d] - starts[p, d])
            turn += np.square(axes_end[p, d] - axes_start[p, d])
        poses = int(np.ceil(2.0 * (np.sqrt(move) + np.sqrt(turn) * tall) / cell)) + 1
        # bounding box of tips and upper ends, widened by the radius
        xa = min(starts[p, 0], ends[p, 0]) + min(0.0, axes_start[p, 0] * tall, axes_end[p, 0] * tall) - wide
        xb = max(starts[p, 0], ends[p, 0]) + max(0.0, axes_start[p, 0] * tall, axes_end[p, 0] * tall) + wide
        ya = min(starts[p, 1], ends[p, 1]) + min(0.0, axes_start[p, 1] * tall, axes_end[p, 1] * tall) - wide
        yb = max(starts[p, 1], ends[p, 1]) + max(0.0, axes_start[p, 1] * tall, axes_end[p, 1] * tall) + wide
        lowest = min(starts[p, 2], ends[p, 2]) + min(0.0, axes_start[p, 2] * tall, axes_end[p, 2] * tall) - wide
        first_i, last_i = columns_across_x(grid, nx, xa, xb)
        first_j, last_j = columns_across_y(grid, ny, ya, yb)
        total = 0.0
        for i in range(first_i, last_i):
            x = x_of(grid, i)
            for j in range(first_j, last_j):
                n = count[i, j]
                if n == 0 or hi[i, j, n - 1] <= lowest:
                    continue
                y = y_of(grid, j)
                held_low, held_high = 1.0, 0.0  # hull that still grows
                changed = False
                for pose in range(poses):
                    t = pose / max(poses - 1, 1)
                    ax = axes_start[p, 0] + t * (axes_end[p, 0] - axes_start[p, 0])
                    ay = axes_start[p, 1] + t * (axes_end[p, 1] - axes_start[p, 1])
                    az = axes_start[p, 2] + t * (axes_end[p, 2] - axes_start[p, 2])
                    norm = np.sqrt(ax * ax + ay * ay + az * az)
                    tip_x = starts[p, 0] + t * (ends[p, 0] - starts[p, 0])
                    tip_y = starts[p, 1] + t * (ends[p, 1] - starts[p, 1])
                    tip_z = starts[p, 2] + t * (ends[p, 2] - starts[p, 2])
                    low, high = line_through_body(x - tip_x, y - tip_y, ax / norm, ay / norm, az / norm, body)
                    if low < high:
                        low, high = low + tip_z, high + tip_z
                        # bodies of neighbouring poses overlap, so what they sweep is the hull of the run
                        if held_low < held_high:
                            held_low, held_high = min(held_low, low), max(held_high, high)
                        else:
                            held_low, held_high = low, high
                    if held_low < held_high and (low >= high or pose == poses - 1):
                        gone = subtract(columns, i, j, held_low, held_high)
                        if gone < 0.0:
                            volume[p] += total * grid.dx * grid.dy
                            return p
                        if gone > 0.0:
                            total += gone + shorten_walls(walls, i, j, gone)
                            changed = True
                        held_low, held_high = 1.0, 0.0
                if changed:
                    dirty[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = 1
        volume[p] += total * grid.dx * grid.dy
    return pieces
