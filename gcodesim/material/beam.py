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
    StruckParts,
    radius_at,
    share_within,
    strike,
)

if TYPE_CHECKING:
    from gcodesim.material.assembly import StockAssembly
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]

PROFILES = {"gaussian": GAUSSIAN, "top_hat": TOP_HAT, "flat": FLAT}
"""How a beam spreads over its footprint; `flat` leaves a level floor when it moves."""

__all__ = [
    "PROFILES",
    "BeamForm",
    "BeamWay",
    "Struck",
    "StruckParts",
    "radius_at",
    "share_within",
    "strike_assembly",
    "strike_stock",
    "widest_within",
]

LEANS = 0.95
"""Cosine of the angle to its columns below which a beam mostly comes in through their sides."""

ROOM_ACROSS = 4
"""Intervals that columns have room for before a beam cuts into their sides; they get more before these are used up."""

ONE_GRID = 1e-9
"""[m] by which columns of two stocks may differ in width and still be called alike."""


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
    _begin_dose(stock, kind, takes=bool(way.volume.any()))
    _make_room(stock, way.axes)
    notes = np.zeros(2)
    way = BeamWay(*(np.ascontiguousarray(part, dtype=float) for part in way))
    done = 0
    while (done := strike(Ablating(stock.field, stock.doses[kind], threshold, notes), form, way, done, struck)) < count:
        stock.grow()
        notes[:] = 0.0
    if notes[1]:  # what the last piece asked for
        stock.grow()
    return struck


def strike_assembly(
    assembly: StockAssembly, form: BeamForm, way: BeamWay, volume: Array, kind: str, threshold: float = 0.0
) -> StruckParts:
    """The same for stocks that stand in each other: each ray meets one after the other, and the first shades the next.

    `volume` (c, m) [m³] is what the beam could take of each stock, in place of `way.volume`; `way` is in the frame of
    the first.
    """
    from gcodesim.material.ablating_parts import put_back, side_by_side
    from gcodesim.material.beam_in_parts_kernels import Together, strike_through

    stocks, (count, m) = assembly.stocks, volume.shape
    for stock, own in zip(stocks, volume.T, strict=True):
        _begin_dose(stock, kind, takes=bool(own.any()))
    for stock, X in zip(stocks, assembly.X, strict=True):
        _make_room(stock, X.inverse().rotate(way.axes))
    sides = np.array([stock.spacing for stock in stocks])
    home = int(np.argmin(sides.min(axis=1)))
    alike = bool(np.ptp(sides, axis=0).max() < ONE_GRID)
    from_whole = assembly.X[home].inverse()
    frames = [from_whole @ X for X in assembly.X]
    alike &= all(np.array_equal(X.R, np.eye(3)) for X in frames)
    together = Together(
        np.array([X.p for X in frames]),
        np.array([X.R for X in frames]),
        home,
        np.inf if alike else 0.5 * float(sides.min()),
    )
    starts, ends = from_whole.apply(way.starts), from_whole.apply(way.ends)
    way = way._replace(starts=starts, ends=ends, axes=from_whole.rotate(way.axes))
    way = BeamWay(*(np.ascontiguousarray(part, dtype=float) for part in way))
    struck = StruckParts(np.zeros((count, m)), np.zeros(count), np.full(count, np.inf), np.zeros(count))
    volume, done = np.ascontiguousarray(volume), 0
    while done < count:
        parts = side_by_side(stocks, kind, threshold)
        done = strike_through(parts, together, form, way, volume, done, struck)
        put_back(parts, stocks, kind)
    return struck


def _begin_dose(stock: Stock, kind: str, *, takes: bool) -> None:
    """Have a dose of this kind counted in each column; columns along x and y are given up where material is taken."""
    if kind not in stock.doses:
        stock.doses[kind] = np.zeros(stock.field.columns.number.shape)
    if takes:
        stock.lattice = None


def _make_room(stock: Stock, axes: Array) -> None:
    """Room for cuts into the sides of columns where one of these axes (c, 3) leans."""
    while stock.field.columns.lo.shape[2] < ROOM_ACROSS and (np.abs(axes[:, 2]) < LEANS).any():
        stock.grow()
