"""Boxes whose top is not level: as high as probed points say."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.stock import Stock, Vector

Array = NDArray[np.float64]


def warped_box(minimum: Vector, maximum: Vector, tops: Tops, resolution: float, material: str = "") -> Stock:
    """A box [m] whose top is where `tops` says, at most at `maximum`; columns that it leaves nothing of are empty."""
    stock = Stock.box(minimum, maximum, resolution, material)
    lo, hi, number = stock.field.columns
    (x, y), (dx, dy) = stock.origin, stock.spacing
    heights = tops.at(x + dx * (np.arange(lo.shape[0]) + 0.5), y + dy * (np.arange(lo.shape[1]) + 0.5))
    hi[:, :, 0] = np.clip(heights, lo[:, :, 0], hi[:, :, 0])
    number[:] = hi[:, :, 0] > lo[:, :, 0]
    return Stock(
        columns=stock.field.columns,
        grid=stock.field.grid,
        z_range=stock.z_range,
        resolution=resolution,
        material=material,
    )


class Tops:
    """Heights z (n, m) [m] over x (n,) and y (m,), straight between them and level beyond them."""

    def __init__(self, x: Sequence[float], y: Sequence[float], z: Sequence[Sequence[float]]) -> None:
        self._x, self._y, self._z = np.array(x), np.array(y), np.array(z)

    def at(self, x: Array, y: Array) -> Array:
        """Heights (p, q) over x (p,) and y (q,)."""
        i, s = _between(self._x, x)
        j, t = _between(self._y, y)
        low = self._z[i] + s[:, None] * (self._z[i + 1] - self._z[i])
        made: Array = low[:, j] + t * (low[:, j + 1] - low[:, j])
        return made


def _between(lines: Array, places: Array) -> tuple[NDArray[np.int64], Array]:
    """The line below each place, and the share of the way to the next one, 0 to 1."""
    below = np.clip(np.searchsorted(lines, places, side="right") - 1, 0, len(lines) - 2)
    share = (places - lines[below]) / (lines[below + 1] - lines[below])
    return below, np.clip(share, 0.0, 1.0)
