"""The surface of a stock at the end, coarse enough for a repository, and where two surfaces differ.

A coarse surface has at most `ACROSS` cells a side. Each knows the lowest top of its columns and the mean height of its
material, so a narrow groove shows in the first and whatever takes volume, also from below, in the second. Heights are
whole micrometres in the stock's own axes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.regress.changes import SurfaceChange
from gcodesim.units import MM, UM

if TYPE_CHECKING:
    from gcodesim.material.relief import Relief
    from gcodesim.material.stock import Stock

ACROSS: Final = 24

Array = NDArray[np.float64]
_RUN = re.compile(r"(?:([0-9]+)\*)?(-?[0-9]+|_)")


@frozen(eq=False)
class Coarse:
    """`corner` and `cell` (x, y) [m]; `lowest` and `mean` (i, j) [m], NaN where no column has material."""

    corner: tuple[float, float]
    cell: tuple[float, float]
    lowest: Array
    mean: Array

    def as_json(self) -> dict[str, Any]:
        """The form in accepted results: rows along Y as text, runs as `12*-2000`, equal rows as `3x 12*-2000`."""
        return {
            "corner_mm": [_mm(v) for v in self.corner],
            "cell_mm": [_mm(v) for v in self.cell],
            "lowest_um": _rows(self.lowest),
            "mean_um": _rows(self.mean),
        }

    @staticmethod
    def from_json(value: Mapping[str, Any]) -> Coarse:
        """ValueError, KeyError or TypeError when `value` is not a coarse surface."""
        x, y = (float(v) * MM for v in value["corner_mm"])
        dx, dy = (float(v) * MM for v in value["cell_mm"])
        lowest, mean = (
            np.array([row for text in value[key] for row in _heights(text)]) for key in ("lowest_um", "mean_um")
        )
        if lowest.ndim != 2 or lowest.shape != mean.shape or not lowest.size:
            raise ValueError("rows of the surface differ in length")
        return Coarse(corner=(x, y), cell=(dx, dy), lowest=lowest, mean=mean)


def _mm(value: float) -> float:
    rounded = round(value / MM, 6) + 0.0
    return int(rounded) if rounded.is_integer() else rounded


def _rows(heights: Array) -> list[str]:
    texts = [" ".join(_runs(["_" if np.isnan(h) else str(round(h / UM)) for h in row], "*")) for row in heights]
    return _runs(texts, "x ")


def _runs(texts: Sequence[str], sign: str) -> list[str]:
    """Equal neighbours as one entry, with their number before `sign`."""
    return [
        text if count == 1 else f"{count}{sign}{text}" for text, count in ((k, len([*g])) for k, g in groupby(texts))
    ]


def _heights(text: str) -> list[list[float]]:
    """The rows that one line of text stands for."""
    times, cross, row = text.rpartition("x ")
    heights: list[float] = []
    for part in row.split():
        match = _RUN.fullmatch(part)
        if match is None:
            raise ValueError(f"`{part}` is no height")
        heights += [np.nan if match[2] == "_" else int(match[2]) * UM] * int(match[1] or 1)
    return [heights] * (int(times) if cross else 1)


def coarse_of(stock: Stock) -> Coarse:
    """The coarse surface of a stock as it is now."""
    relief = stock.relief()
    tops, lengths = relief.tops, relief.lengths
    i, j = (_borders(n) for n in tops.shape)
    # an empty column is as deep as the stock's floor: it counts, as the deepest
    filled = np.where(np.isnan(tops), stock.z_range[0], tops)
    lowest = np.minimum.reduceat(np.minimum.reduceat(filled, i[:-1], axis=0), j[:-1], axis=1)
    area = np.diff(i)[:, None] * np.diff(j)[None, :]
    mean = np.add.reduceat(np.add.reduceat(lengths, i[:-1], axis=0), j[:-1], axis=1) / area
    empty = np.logical_and.reduceat(np.logical_and.reduceat(np.isnan(tops), i[:-1], axis=0), j[:-1], axis=1)
    size = np.array(tops.shape) * relief.cell
    cells = (float(size[0]) / len(lowest), float(size[1]) / lowest.shape[1])
    return Coarse(
        corner=relief.corner,
        cell=cells,
        lowest=np.where(empty, np.nan, lowest),
        mean=np.where(empty, np.nan, mean),
    )


def _borders(columns: int) -> NDArray[np.int64]:
    """Borders of at most `ACROSS` nearly equal runs of columns."""
    runs = min(ACROSS, columns)
    return np.arange(runs + 1, dtype=np.int64) * columns // runs


def compare_coarse(name: str, old: Coarse, new: Coarse, allowed_mm: float) -> SurfaceChange | None:
    """Where two coarse surfaces differ most; None within `allowed_mm` or on different grids (then volumes show it)."""
    if old.lowest.shape != new.lowest.shape or not np.allclose(
        (*old.corner, *old.cell), (*new.corner, *new.cell), atol=1e-9
    ):
        return None
    found = [
        _most(name, old, a, b, allowed_mm, exact=False) for a, b in ((old.lowest, new.lowest), (old.mean, new.mean))
    ]
    sound = [change for change in found if change is not None]
    return max(sound, key=lambda change: change.deviation_mm, default=None)


def compare_stocks(name: str, old: Stock, new: Stock, allowed_mm: float) -> SurfaceChange | None:
    """Where the tops of two stocks differ most, column by column; None within `allowed_mm`.

    Columns at other places are compared with the nearest ones of the old grid.
    """
    before, after = old.relief(), new.relief()
    return _most(name, before, before.tops, after.tops_at(before), allowed_mm, exact=True)


def _most(
    name: str, places: Coarse | Relief, old: Array, new: Array, allowed_mm: float, *, exact: bool
) -> SurfaceChange | None:
    """The place of the greatest difference; where one side has no material, the whole height counts.

    A wall one cell beside its place is not a difference: the last bit of a coordinate may move it over the middle of a
    column. So a height differs only if it is outside all heights that the other surface has around there.
    """
    (x, y), (dx, dy) = places.corner, places.cell
    bottom = float(np.nanmin([np.nanmin(old, initial=np.inf), np.nanmin(new, initial=np.inf)]))
    floor = bottom if np.isfinite(bottom) else 0.0
    a, b = np.where(np.isnan(old), floor, old), np.where(np.isnan(new), floor, new)
    # files hold whole micrometres: half of one on either side is not a difference
    slack = allowed_mm * MM + (1e-9 if exact else UM)
    off = _outside(a, b, slack) | _outside(b, a, slack)
    if not off.any():
        return None
    apart = np.abs(b - a)
    i, j = np.unravel_index(int(np.argmax(np.where(off, apart, -1.0))), apart.shape)
    return SurfaceChange(
        stock=name,
        x_mm=round(_mm(x + (int(i) + 0.5) * dx), 3),
        y_mm=round(_mm(y + (int(j) + 0.5) * dy), 3),
        old_mm=None if np.isnan(old[i, j]) else _mm(float(old[i, j])),
        new_mm=None if np.isnan(new[i, j]) else _mm(float(new[i, j])),
        deviation_mm=_mm(float(apart[i, j])),
        area_mm2=round(float(off.sum()) * (dx * dy) / (MM * MM), 3),
        allowed_mm=allowed_mm,
        exact=exact,
    )


def _outside(heights: Array, among: Array, slack: float) -> NDArray[np.bool_]:
    """Where `heights` are below or above everything that `among` has in that cell and the eight around it."""
    padded = np.pad(among, 1, mode="edge")
    nx, ny = among.shape
    around = [padded[i : i + nx, j : j + ny] for i in range(3) for j in range(3)]
    low, high = np.minimum.reduce(around), np.maximum.reduce(around)
    outside: NDArray[np.bool_] = (heights < low - slack) | (heights > high + slack)
    return outside
