"""Laying a strand by its volume on a stock."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.strand_kernels import AT_REST, Laid, lay

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]

CARRY = 5
"""Numbers that a strand takes from one call to the next: where it ended (3) [m], its height there [m], and what came
out since the nozzle stands there [m³]."""


class FilamentStrand(NamedTuple):
    """c pieces of a strand in S: from `starts` to `ends` (c, 3) [m] of the nozzle's tip with `volumes` (c,) [m³].

    `widths` and `heights` (c,) [m] are those that the bead is meant to have. Where the nozzle stands, it lays a blob.
    """

    starts: Array
    ends: Array
    volumes: Array
    widths: Array
    heights: Array

    @property
    def at_rest(self) -> NDArray[np.bool_]:
        """The pieces (c,) on which the nozzle stands."""
        found: NDArray[np.bool_] = np.abs(self.ends - self.starts).max(axis=1) < AT_REST
        return found


def lay_strand(stock: Stock, strand: FilamentStrand, carry: Array) -> Laid:
    """Lay a strand on whatever lies below it, in place; `carry` (CARRY,) is changed.

    What lies beside the stock's grid, and blobs with nothing below, are not kept and told as such; all else is in the
    stock. Columns along x and y are given up.
    """
    stock.lattice = None
    count = len(strand.volumes)
    laid = Laid(*np.zeros((len(Laid._fields), count)))
    ways = np.ascontiguousarray(np.hstack([strand.starts, strand.ends]))
    volumes = np.ascontiguousarray(strand.volumes)
    sizes = np.ascontiguousarray(np.column_stack([strand.widths, strand.heights]))
    floor, done = float(stock.z_range[0]), 0
    while (done := lay(stock.field, ways, volumes, sizes, carry, floor, done, laid)) < count:
        stock.grow()
    return laid


def carried(stock: Stock, starts: Array, ends: Array, width: float, height: float) -> Array:
    """1.0 for each of c pieces of a bead of `width` and `height` [m] below which there is something, else 0.0."""
    from gcodesim.material.support_kernels import support_of

    found = np.zeros(len(starts))
    ways = np.ascontiguousarray(np.hstack([starts, ends]))
    support_of(stock.field, ways, width, height, float(stock.z_range[0]), found)
    return found
