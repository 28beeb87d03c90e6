"""The surface of a stock as triangles: whole, for a file, or in tiles, for the log."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product
from math import ceil, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.material.field_kernels import PATCH, Columns
from gcodesim.material.flat_kernels import ColumnSpan, PatchTriangles

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]

STEP_JOINED = 1.5
"""Steps up to this many cells become a slope through one vertex, higher ones a wall. Less shows terraces on gentle
curves, more bevels the edges of shallow pockets."""

DRAWN_COLUMNS = 160_000
"""Columns of the whole stock that the log draws: keeps each of 16 tiles near 1 MB, well below the viewer's 4 MB."""

ROUNDING = 2.0**20
"""Points of tiles are whole multiples of 1 / ROUNDING metres: the zero bits that follow compress well."""


@frozen
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
        from gcodesim.material.mesh_volume_kernels import six_volumes

        volumes = np.empty(len(self.faces))
        six_volumes(self.vertices, self.faces, volumes)
        return float(volumes.sum() / 6.0)


class Facets(NamedTuple):
    """Triangles (f, 3), counter-clockwise from outside, and their points (v, 3) [m] in S."""

    points: Array
    triangles: Ints


@frozen
class Tile:
    """One tile as the log draws it: surface as it was at the start, and surface that was changed."""

    number: int
    original: Facets
    changed: Facets


def build_surface(stock: Stock, spacing: float = 0.0) -> Surface:
    """The whole surface, from columns about `spacing` [m] apart; 0 takes all of them."""
    lattice = _Lattice.spaced(stock, spacing)
    if lattice.has_all(stock):
        drawn = _Drawn(stock.field.columns, stock.wall_places, stock.original)
    else:
        drawn = lattice.columns(stock, lattice.original(stock))
    points, fine, coarse = _mesh(drawn, lattice, ColumnSpan(0, len(lattice.ix), 0, len(lattice.iy)))
    faces, cut = np.concatenate((fine.faces, coarse.faces)), np.concatenate((fine.cut, coarse.cut))
    # points inside flat parts belong to no triangle
    used = np.zeros(len(points), dtype=bool)
    used[faces] = True
    number = (np.cumsum(used) - 1).astype(np.int32)
    return Surface(vertices=points[used], faces=number[faces], cut=cut)


class _Drawn(NamedTuple):
    """Columns (m, n) that are drawn, and those at the start, which may be one for all.

    The walls are those at the columns if all columns of a stock are drawn, else (4, 0, 0).
    """

    columns: Columns
    walls: NDArray[np.float32]
    original: Columns

    def same(self, other: _Drawn) -> bool:
        """Whether they are the same as `other` columns of the same place."""
        from gcodesim.material.tile_kernels import same_columns

        return bool(same_columns(self.columns, other.columns)) and np.array_equal(self.walls, other.walls)


class _Lattice(NamedTuple):
    """Which columns are drawn (ix, iy) and the corners between them (xs, ys) [m].

    A step between two columns of up to `joined` [m] becomes a slope.
    """

    ix: Ints
    iy: Ints
    xs: Array
    ys: Array
    joined: float

    @staticmethod
    def spaced(stock: Stock, spacing: float) -> _Lattice:
        """Columns at most `spacing` [m] apart, unless there are fewer; the outer corners stay the stock's own."""
        picks, corners = [], []
        for cells, origin, step in zip(stock.field.columns.number.shape, stock.origin, stock.spacing, strict=True):
            drawn = min(cells, max(1, ceil(cells * step / spacing - 1e-9))) if spacing > 0.0 else cells
            picks.append(((np.arange(drawn) + 0.5) * cells / drawn).astype(np.int32))
            corners.append(origin + np.arange(drawn + 1) * (cells * step / drawn))
        xs, ys = corners
        return _Lattice(picks[0], picks[1], xs, ys, float(STEP_JOINED * max(xs[1] - xs[0], ys[1] - ys[0])))

    def has_all(self, stock: Stock) -> bool:
        """Whether all columns of the stock are drawn."""
        return stock.field.columns.number.shape == (len(self.ix), len(self.iy))

    def part(self, i0: int, i1: int, j0: int, j1: int) -> _Lattice:
        """The lattice of only the columns [i0, i1) x [j0, j1)."""
        xs, ys = self.xs[i0 : i1 + 1], self.ys[j0 : j1 + 1]
        return _Lattice(self.ix[i0:i1], self.iy[j0:j1], xs, ys, self.joined)

    def original(self, stock: Stock) -> Columns:
        """The columns at the start, where this lattice draws them; one for all of a box."""
        lo, hi, count = stock.original
        none = np.zeros(1, np.int32)
        at = np.ix_(self.ix if count.shape[0] > 1 else none, self.iy if count.shape[1] > 1 else none)
        return Columns(lo[at], hi[at], count[at])

    @property
    def spacing(self) -> float:
        """The greatest distance between columns [m]."""
        return float(max(self.xs[1] - self.xs[0], self.ys[1] - self.ys[0]))

    def columns(self, stock: Stock, original: Columns, closing: float = 0.0) -> _Drawn:
        """A copy of the columns of the stock that are drawn, without its walls.

        Voids between what was laid are left out if they are less than `closing` [m] high.
        """
        from gcodesim.material.tile_kernels import close_voids, most_intervals, take_columns

        shape = (len(self.ix), len(self.iy))
        columns = stock.field.columns
        room = (*shape, max(1, most_intervals(columns, self.ix, self.iy)))
        taken = Columns(np.zeros(room), np.zeros(room), np.empty(shape, dtype=np.int32))
        take_columns(columns, self.ix, self.iy, taken)
        if closing > 0.0 and room[2] > 1:
            most = max(1, close_voids(taken, original, closing))
            if most < room[2]:
                taken = Columns(taken.lo[:, :, :most].copy(), taken.hi[:, :, :most].copy(), taken.number)
        return _Drawn(taken, np.zeros((4, 0, 0), np.float32), original)


def _mesh(drawn: _Drawn, lattice: _Lattice, span: ColumnSpan) -> tuple[Array, PatchTriangles, PatchTriangles]:
    """Points and triangles of the columns of a span; those of flat parts separately."""
    from gcodesim.material.face_kernels import build_faces
    from gcodesim.material.flat_kernels import find_flat, flat_faces
    from gcodesim.material.surface_kernels import Corners, build_chains

    columns, walls, original = drawn
    chains = build_chains(columns, walls, Corners(lattice.xs, lattice.ys), span, lattice.joined)
    flat = find_flat(columns, original, span)
    return chains.points, build_faces(columns, original, span, chains, flat), flat_faces(flat, span, chains)


class _Place(NamedTuple):
    """Where a tile is: its own columns [i0, i1) x [j0, j1) of a lattice that has one column more to each side."""

    number: int
    lattice: _Lattice
    span: ColumnSpan
    corner: tuple[int, int]  # of the lattice in that of all tiles
    original: Columns


class Tiles:
    """The surface of one stock in at most `across` x `across` tiles, drawn again only where the stock changed.

    Voids between beads that are lower than the distance of drawn columns are left out: nobody sees them, and a print is
    full of them.
    """

    def __init__(self, stock: Stock, *, across: int = 4, spacing: float | None = None) -> None:
        """`spacing` [m] between drawn columns; default: the stock's own, or coarser to keep tiles small."""
        if not 1 <= across <= 4:
            raise ValueError("the log has room for 16 tiles")
        nx, ny = stock.field.columns.number.shape
        area = nx * ny * stock.field.grid.dx * stock.field.grid.dy
        self._stock = stock
        lattice = _Lattice.spaced(stock, sqrt(area / DRAWN_COLUMNS) if spacing is None else spacing)
        self._all_drawn = lattice.has_all(stock)
        edges_i, edges_j = _edges(len(lattice.ix), across), _edges(len(lattice.iy), across)
        self._places = [
            _place(number, lattice, stock, i, j)
            for number, (i, j) in enumerate(product(pairwise(edges_i), pairwise(edges_j)))
        ]
        self._drawn: dict[int, _Drawn] = {}

    def __len__(self) -> int:
        return len(self._places)

    def all(self) -> list[Tile]:
        """Every tile as it is now; the stock's marks of change are cleared."""
        self._drawn.clear()
        return self._glimpse(self._places).draw()

    def changed(self) -> Glimpse:
        """The tiles of which any point may have moved since the last call, not yet drawn; the marks are cleared."""
        return self._glimpse([place for place in self._places if self._is_dirty(place)])

    def _glimpse(self, places: Sequence[_Place]) -> Glimpse:
        self._stock.field.dirty[:] = 0
        return Glimpse(tiles=[(place, self._columns(place)) for place in places], drawn=self._drawn)

    def _columns(self, place: _Place) -> _Drawn:
        """A copy of the columns that a tile draws, and of those around them."""
        columns = place.lattice.columns(self._stock, place.original, place.lattice.spacing)
        if not self._all_drawn:
            return columns
        i, j = place.corner
        xs, ys = place.lattice.xs, place.lattice.ys
        return columns._replace(walls=self._stock.wall_places[:, i : i + len(xs), j : j + len(ys)].copy())

    def _is_dirty(self, place: _Place) -> bool:
        """Whether a column that the tile draws, or one next to it, lies in a changed patch."""
        ix, iy = place.lattice.ix, place.lattice.iy
        near = self._stock.field.dirty[ix[0] // PATCH : ix[-1] // PATCH + 1, iy[0] // PATCH : iy[-1] // PATCH + 1]
        return bool(near.any())


def _place(number: int, lattice: _Lattice, stock: Stock, i: tuple[int, int], j: tuple[int, int]) -> _Place:
    """The tile of columns [i0, i1) x [j0, j1)."""
    (i0, i1), (j0, j1) = i, j
    low_i, low_j = max(i0 - 1, 0), max(j0 - 1, 0)
    around = lattice.part(low_i, min(i1 + 1, len(lattice.ix)), low_j, min(j1 + 1, len(lattice.iy)))
    span = ColumnSpan(i0 - low_i, i1 - low_i, j0 - low_j, j1 - low_j)
    return _Place(number, around, span, (low_i, low_j), around.original(stock))


@frozen(eq=False)
class Glimpse:
    """Tiles as they were at one moment, with a copy of the columns that they draw, so that drawing can wait.

    `drawn` are the columns of which each tile is drawn now.
    """

    tiles: Sequence[tuple[_Place, _Drawn]]
    drawn: dict[int, _Drawn]

    def draw(self) -> list[Tile]:
        """The tiles that look different from those of the glimpses drawn before; from one thread at a time."""
        fresh = []
        for place, columns in self.tiles:
            before = self.drawn.get(place.number)
            if before is None or not columns.same(before):
                self.drawn[place.number] = columns
                fresh.append(_tile(place, columns))
        return fresh


def _tile(place: _Place, drawn: _Drawn) -> Tile:
    from gcodesim.material.tile_kernels import facets_of

    mesh = _mesh(drawn, place.lattice, place.span)
    original, changed = (Facets(*facets_of(*mesh, which, ROUNDING)) for which in range(2))
    return Tile(number=place.number, original=original, changed=changed)


def _edges(cells: int, across: int) -> list[int]:
    """Borders of up to `across` nearly equal runs of cells."""
    runs = min(across, cells)
    return [cells * k // runs for k in range(runs + 1)]
