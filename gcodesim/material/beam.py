"""Beams on a stock: lasers, jets and whatever else acts at a distance, and the dose that each column has got."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.beam_kernels import (
    FLAT,
    GAUSSIAN,
    GAUSSIAN_REACH,
    TOP_HAT,
    Ablating,
    BeamForm,
    BeamWay,
    Struck,
    radius_at,
    share_within,
    strike,
)

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]

PROFILES = {"gaussian": GAUSSIAN, "top_hat": TOP_HAT, "flat": FLAT}
"""How a beam spreads over its footprint; `flat` leaves a level floor when it moves."""

__all__ = ["PROFILES", "BeamForm", "BeamWay", "Struck", "radius_at", "share_within", "strike_stock", "widest_within"]


def widest_within(form: BeamForm, depth: float) -> float:
    """The radius [m] that no ray of a beam leaves before the distance `depth` [m] beyond the tip."""
    widest = max(float(radius_at(form, form.mouth)), float(radius_at(form, depth)))
    return GAUSSIAN_REACH * widest if form.profile == GAUSSIAN else widest


def strike_stock(stock: Stock, form: BeamForm, way: BeamWay, kind: str, threshold: float = 0.0) -> Struck:
    """Let a beam act on `stock` (in place) along c pieces; see `BeamWay` and `Struck`.

    The dose of each column, `stock.doses[kind]` (nx, ny) [per m² of level area], is added to; material is taken only
    from what a column gets beyond `threshold`. Columns along x and y are given up where material is taken.
    """
    count = len(way.volume)
    struck = Struck(np.zeros(count), np.zeros(count), np.full(count, np.inf), np.zeros(count))
    if kind not in stock.doses:
        stock.doses[kind] = np.zeros(stock.field.columns.number.shape)
    if way.volume.any():
        stock.lattice = None
    notes = np.zeros(2)
    way = BeamWay(*(np.ascontiguousarray(part, dtype=float) for part in way))
    done = 0
    while (done := strike(Ablating(stock.field, stock.doses[kind], threshold, notes), form, way, done, struck)) < count:
        stock.grow()
        notes[:] = 0.0
    if notes[1]:  # what the last piece asked for
        stock.grow()
    return struck
