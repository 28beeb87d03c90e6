"""The surface of a stock as triangles: whole, for a file, or in tiles, for the log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]

STEP_JOINED = 1.5
"""Steps up to so many cells become a slope through one vertex, higher ones a wall. Less shows terraces on gentle
curves, more bevels the edges of shallow pockets."""

DRAWN_COLUMNS = 160_000
"""Columns of the whole stock that the log draws: keeps each of 16 tiles near 1 MB, well below the viewer's 4 MB."""

ROUNDING = 2.0**20
"""Points of tiles are whole multiples of 1 / ROUNDING metres: the zero bits that follow compress well."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """Closed triangle mesh, outside counter-clockwise: vertices (v, 3) [m] in S, faces (f, 3), cut (f,) 0 or 1."""

    vertices: Array
    faces: Ints
    cut: Bytes

    @property
    def volume(self) -> float:
        """Enclosed volume [m^3] (divergence theorem)."""
        if len(self.faces) == 0:
            return 0.0
        base = self.vertices[0]
        a, b, c = (self.vertices[self.faces[:, k]] - base for k in range(3))
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tile:
    """One tile as the log draws it: points (v, 3) [m] in S, triangles (f, 3) of original and of changed surface."""

    number: int
    points: Array
    original: Ints
    changed: Ints


def build_surface(stock: Stock, spacing: float = 0.0) -> Surface:
    """The whole surface from columns about `spacing` [m] apart; 0 takes all of them."""
    lattice = _Lattice.spaced(stock, spacing)
    columns = _Columns(stock.lo, stock.hi, stock.count, stock.walls, stock.original)
    points, faces, cut = _mesh(columns, lattice, 0, len(lattice.ix), 0, len(lattice.iy))
    return Surface(vertices=points, faces=faces, cut=cut)


class _Columns(NamedTuple):
    """The columns of a stock as kernels take them, and those it came with."""

    lo: Array
    hi: Array
    intervals: Ints
    walls: NDArray[np.float32]
    original: tuple[Array, Array, Ints]


class _Lattice(NamedTuple):
    """Which columns are drawn (ix, iy) and the corners between them (xs, ys) [m]."""

    ix: Ints
    iy: Ints
    xs: Array
    ys: Array

    @staticmethod
    def spaced(stock: Stock, spacing: float) -> _Lattice:
        """Columns at most `spacing` [m] apart, unless there are fewer; the outer corners stay the stock's own."""
        picks, corners = [], []
        for cells, origin, step in zip(stock.count.shape, stock.grid[:2], stock.grid[2:], strict=True):
            drawn = min(cells, max(1, ceil(cells * step / spacing - 1e-9))) if spacing > 0.0 else cells
            picks.append(((np.arange(drawn) + 0.5) * cells / drawn).astype(np.int32))
            corners.append(origin + np.arange(drawn + 1) * (cells * step / drawn))
        return _Lattice(picks[0], picks[1], corners[0], corners[1])


def _mesh(columns: _Columns, lattice: _Lattice, i0: int, i1: int, j0: int, j1: int) -> tuple[Array, Ints, Bytes]:
    """Points, faces and their class of the drawn columns [i0, i1) x [j0, j1)."""
    from gcodesim.material.flat_kernels import find_flat, flat_faces
    from gcodesim.material.surface_kernels import build_chains, build_faces

    ix, iy, xs, ys = lattice.ix, lattice.iy, lattice.xs, lattice.ys
    limit = STEP_JOINED * max(xs[1] - xs[0], ys[1] - ys[0])
    start, bits, rising, below, vertex, extra, points = build_chains(
        columns.lo, columns.hi, columns.intervals, columns.walls, ix, iy, xs, ys, i0, i1, j0, j1, limit
    )
    flat = find_flat(columns.lo, columns.hi, columns.intervals, *columns.original, ix, iy, i0, i1, j0, j1)
    faces, cut = build_faces(
        columns.lo, columns.hi, columns.intervals, *columns.original, ix, iy, i0, i1, j0, j1,
        start, bits, rising, below, vertex, extra, points, flat,
    )  # fmt: skip
    flat_parts, flat_cut = flat_faces(flat, i0, i1, j0, j1, start, vertex)
    faces, cut = np.concatenate((faces, flat_parts)), np.concatenate((cut, flat_cut))
    # points inside flat parts are in no triangle
    used = np.zeros(len(points), dtype=bool)
    used[faces] = True
    number = (np.cumsum(used) - 1).astype(np.int32)
    return points[used], number[faces], cut


class Tiles:
    """The surface of one stock in at most `across` x `across` tiles, drawn again only where the stock changed."""

    def __init__(self, stock: Stock, *, across: int = 4, spacing: float | None = None) -> None:
        """`spacing` [m] between drawn columns; default: the stock's own, or coarser to keep tiles small."""
        if not 1 <= across <= 4:
            raise ValueError("the log has room for 16 tiles")
        nx, ny = stock.count.shape
        area = nx * ny * stock.grid[2] * stock.grid[3]
        self._stock = stock
        self._lattice = _Lattice.spaced(stock, sqrt(area / DRAWN_COLUMNS) if spacing is None else spacing)
        self._all_drawn = (len(self._lattice.ix), len(self._lattice.iy)) == (nx, ny)
        ix, iy, xs, ys = self._lattice
        self._places = _Lattice(np.arange(len(ix), dtype=np.int32), np.arange(len(iy), dtype=np.int32), xs, ys)
        self._original = self._drawn_original()
        self._edges_i = _edges(len(self._lattice.ix), across)
        self._edges_j = _edges(len(self._lattice.iy), across)

    def __len__(self) -> int:
        return (len(self._edges_i) - 1) * (len(self._edges_j) - 1)

    def all(self) -> list[Tile]:
        """Every tile as it is now; the stock's marks of change are cleared."""
        return self._glimpse(range(len(self))).draw()

    def changed(self) -> Glimpse:
        """The tiles of which any point may have moved since the last call, yet to be drawn; the marks are cleared."""
        return self._glimpse([number for number in range(len(self)) if self._is_dirty(number)])

    def _glimpse(self, numbers: Sequence[int]) -> Glimpse:
        self._stock.dirty[:] = 0
        tiles = [(number, self._range(number)) for number in numbers]
        return Glimpse(tiles=tiles, lattice=self._places, columns=self._drawn() if tiles else None)

    def _drawn(self) -> _Columns:
        """A copy of the columns that are drawn."""
        stock = self._stock
        if self._all_drawn:
            return _Columns(stock.lo.copy(), stock.hi.copy(), stock.count.copy(), stock.walls.copy(), self._original)
        at = np.ix_(self._lattice.ix, self._lattice.iy)
        return _Columns(stock.lo[at], stock.hi[at], stock.count[at], np.zeros((4, 0, 0), np.float32), self._original)

    def _drawn_original(self) -> tuple[Array, Array, Ints]:
        lo, hi, count = self._stock.original
        ix = self._lattice.ix if count.shape[0] > 1 else np.zeros(1, np.int32)  # one for all columns of a box
        iy = self._lattice.iy if count.shape[1] > 1 else np.zeros(1, np.int32)
        at = np.ix_(ix, iy)
        return lo[at], hi[at], count[at]

    def _range(self, number: int) -> tuple[int, int, int, int]:
        row, column = divmod(number, len(self._edges_j) - 1)
        return self._edges_i[row], self._edges_i[row + 1], self._edges_j[column], self._edges_j[column + 1]

    def _is_dirty(self, number: int) -> bool:
        """Whether a column that the tile draws, or one next to it, lies in a changed patch."""
        from gcodesim.material.stock import PATCH

        i0, i1, j0, j1 = self._range(number)
        ix, iy = self._lattice.ix, self._lattice.iy
        first_i, last_i = ix[max(i0 - 1, 0)], ix[min(i1, len(ix) - 1)]
        first_j, last_j = iy[max(j0 - 1, 0)], iy[min(j1, len(iy) - 1)]
        near = self._stock.dirty[first_i // PATCH : last_i // PATCH + 1, first_j // PATCH : last_j // PATCH + 1]
        return bool(near.any())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Glimpse:
    """Tiles as they were at a moment, with a copy of the columns that they draw: drawing them can wait."""

    tiles: Sequence[tuple[int, tuple[int, int, int, int]]]
    lattice: _Lattice
    columns: _Columns | None

    def draw(self) -> list[Tile]:
        """The tiles; from any thread."""
        return [self._draw(number, span) for number, span in self.tiles]

    def _draw(self, number: int, span: tuple[int, int, int, int]) -> Tile:
        assert self.columns is not None
        points, faces, cut = _mesh(self.columns, self.lattice, *span)
        return Tile(
            number=number,
            points=np.round(points * ROUNDING) / ROUNDING + 0.0,
            original=faces[cut == 0],
            changed=faces[cut == 1],
        )


def _edges(cells: int, across: int) -> list[int]:
    """Borders of up to `across` nearly equal runs of cells."""
    runs = min(across, cells)
    return [cells * k // runs for k in range(runs + 1)]
