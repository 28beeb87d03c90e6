"""A surface whose volume is that of its stock: on coarse grids, slopes that stand for steps enclose something else."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.material.surface import Surface

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]

CLOSE: Final = 1e-4
"""Share of the volume by which a surface may be off and is left as it is."""

MOST_SHIFT: Final = 0.5
"""By how much [cells] walls are moved at most: so much of their place the grid leaves open."""

UPRIGHT: Final = 0.01
"""Greatest vertical share of the normal of a side of the stock, which stays where it is."""

TURNS: Final = 3  # of Newton's method: the volume is a cubic of the shift


def surface_for_files(stock: Stock) -> Surface:
    """The surface of a stock, in the part's own frame on whichever side it lies, with the volume of the stock."""
    surface = with_volume(stock.surface(), stock.volume, stock.cell)
    return replace(surface, vertices=stock.in_part(surface.vertices))


def with_volume(surface: Surface, volume: float, cell: float) -> Surface:
    """`surface` with walls and slopes that were cut moved evenly until it encloses `volume` [m³]; still closed.

    Points move level, across the surface; so floors and tops stay at their heights, and sides of the stock stay where
    they are. `cell` [m] is that of the stock's columns. A point moved by d along the level part of its share of areas
    (a third of the vector of each triangle around it) changes the volume by d times the length of that part.
    """
    from gcodesim.material.mesh_volume_kernels import level_shares

    if not len(surface.faces) or abs(surface.volume - volume) <= CLOSE * abs(volume):
        return surface
    faces, points = surface.faces, surface.vertices
    share, free = np.zeros((len(points), 2)), np.zeros(len(points), dtype=np.uint8)
    level_shares(points, faces, surface.cut, UPRIGHT, np.zeros_like(share), share, free)
    share[free == 0] = 0.0  # points of cut triangles are free with the columns beside them, which lean at a slope
    area = norms(share)
    way = np.zeros_like(points)
    way[:, :2] = np.divide(share, area[:, None], out=np.zeros_like(share), where=area[:, None] > 0.0)
    return moved_to_volume(surface, way, float(area.sum()), volume, MOST_SHIFT * cell, 1e-2 * CLOSE)


def moved_to_volume(surface: Surface, way: Array, slope: float, volume: float, most: float, close: float) -> Surface:
    """`surface` with its points moved along `way` (v, 3), at most by `most` [m], all as far, until it has this volume.

    A move by d adds `slope` [m²] times d to first order. `close` is the share of the volume that may be missing.
    """
    shift, best = 0.0, surface
    for _ in range(TURNS):
        missing = volume - best.volume
        if slope <= 0.0 or abs(missing) <= close * abs(volume):
            break
        shift = float(np.clip(shift + missing / slope, -most, most))
        best = replace(surface, vertices=surface.vertices + shift * way)
    return best
