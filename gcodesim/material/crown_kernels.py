"""Molten beads: a parabola of a given width over whatever lies below."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.bead_kernels import unite
from gcodesim.material.field_kernels import PATCH_SHIFT, Field
from gcodesim.material.strand_kernels import top_below
from gcodesim.material.sweep_kernels import x_of, y_of

Array = NDArray[np.float64]

FUSE = 1.0e-9  # [m] up to which added material fuses with what is there


class Crown(NamedTuple):
    """c pieces of a molten bead: `ways` (c, 6), where the tip begins and ends [m]; `volumes` (c,) [m³], `widths` (c,)
    [m]; what lies deeper below the tip than `reach`, or higher above it, is not met [m]."""

    ways: Array
    volumes: Array
    widths: Array
    reach: float


class Molten(NamedTuple):
    """What became of c pieces: `volume` in the stock and `lost`, where nothing is below [m³]."""

    volume: Array
    lost: Array


@kernel
def parabola_to(u: float) -> float:
    """The share of a parabola's section that lies between its left end and u, from -1 at that end to 1."""
    inside = min(max(u, -1.0), 1.0)
    return 0.5 + 0.75 * (inside - inside * inside * inside / 3.0)


@kernel
def melt_on(field: Field, crown: Crown, p: int) -> tuple[float, float]:
    """Lay one piece; what is in the stock, -1 if a column has no interval left, and what is lost [m³]."""
    columns, grid = field.columns, field.grid
    lo, _, count = columns
    nx, ny = count.shape
    x0, y0, z0, x1, y1, z1 = crown.ways[p]
    length = math.sqrt((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0))
    ux, uy = ((x1 - x0) / length, (y1 - y0) / length) if length > 0.0 else (1.0, 0.0)
    half = 0.5 * crown.widths[p]
    across_cell = abs(uy) * grid.dx + abs(ux) * grid.dy
    along_cell = abs(ux) * grid.dx + abs(uy) * grid.dy
    far = half + 0.5 * (across_cell + along_cell)
    first_i = math.floor((min(x0, x1) - far - grid.x) / grid.dx)
    last_i = math.floor((max(x0, x1) + far - grid.x) / grid.dx) + 1
    first_j = math.floor((min(y0, y1) - far - grid.y) / grid.dy)
    last_j = math.floor((max(y0, y1) + far - grid.y) / grid.dy) + 1
    total, inside, lost = 0.0, 0.0, 0.0
    for lay in range(2):  # once to weigh the columns, once to lay
        for i in range(first_i, last_i):
            x = x_of(grid, i) - x0
            for j in range(first_j, last_j):
                y = y_of(grid, j) - y0
                along, across = x * ux + y * uy, y * ux - x * uy
                part = min(along + 0.5 * along_cell, length) - max(along - 0.5 * along_cell, 0.0)
                if length <= 0.0:
                    part = along_cell if abs(along) <= 0.5 * along_cell else 0.0
                if part <= 0.0:
                    continue
                share = parabola_to((across + 0.5 * across_cell) / half)
                share = part * (share - parabola_to((across - 0.5 * across_cell) / half))
                if share <= 0.0:
                    continue
                if lay == 0:
                    total += share
                    if 0 <= i < nx and 0 <= j < ny and count[i, j] >= lo.shape[2]:
                        return -1.0, 0.0
                    continue
                volume = crown.volumes[p] * share / total
                if i < 0 or j < 0 or i >= nx or j >= ny:
                    lost += volume
                    continue
                tip = z0 + (z1 - z0) * (min(max(along / length, 0.0), 1.0) if length > 0.0 else 1.0)
                top = top_below(columns, i, j, tip + crown.reach, FUSE)
                if tip - top > crown.reach:
                    lost += volume
                    continue
                thickness = volume / (grid.dx * grid.dy)
                inside += unite(columns, i, j, top, top + thickness, FUSE) * grid.dx * grid.dy
                pi, pj = i >> PATCH_SHIFT, j >> PATCH_SHIFT
                field.dirty[pi, pj] = 1
                field.tops[pi, pj] = max(field.tops[pi, pj], top + thickness)
    if total <= 0.0:
        lost = crown.volumes[p]
    return inside, lost


@kernel
def melt(field: Field, crown: Crown, first: int, molten: Molten) -> int:
    """Lay pieces `first`… in order; the index of the one with a column that has no interval left, or their number."""
    for p in range(first, len(crown.volumes)):
        if crown.volumes[p] <= 0.0:
            continue
        inside, lost = melt_on(field, crown, p)
        if inside < 0.0:
            return p
        molten.volume[p], molten.lost[p] = inside, lost
    return len(crown.volumes)
