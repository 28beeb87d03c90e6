"""Stock: material as columns of exact height on a regular grid ("dexels"), and what tools do to it.

Each column of the grid in x, y holds a short sorted list of intervals [lo, hi]
along Z of the stock frame S. Heights are exact; x and y are sampled at the
centres of the cells. So floors and heights are right up to rounding, and
walls are up to half a cell beside their place; their real place is
kept at the borders of the columns (`walls`), so that volumes are far better.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, sqrt
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import log10, power
from gcodesim.arithmetic.matrices import applied, norms
from gcodesim.frozen import frozen
from gcodesim.material.field_kernels import PATCH, Columns, Field, Grid
from gcodesim.material.sweep_kernels import Shape
from gcodesim.material.wall_kernels import HEIGHT, HUNG, LOWER, PLACE, SAME_HEIGHT, SECOND, WALL_PLANES

if TYPE_CHECKING:
    from gcodesim.material.axis_way import AxisWay
    from gcodesim.material.lattice import Lattice
    from gcodesim.material.loose import Parting
    from gcodesim.material.relief import Relief
    from gcodesim.material.surface import Surface, Tiles

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Vector = Sequence[float] | Array

Lines = tuple[Columns, Grid]
"""Columns along one axis of S, and the grid on which they stand in the other two."""

Exact = Callable[[tuple[int, int, int]], Lines]
"""The columns of a stock as it was made, along that axis of S which is the last of three."""

BYTES_PER_COLUMN = 8 + 8 + 4 + 4 * WALL_PLANES
"""Memory of a column with one interval and its two borders; each further interval costs 16 bytes in every column."""

DOUBLED = 8
"""Intervals a column up to which their number is doubled: beyond that every one is felt in memory."""

GAP_CLOSED = 1.0e-9
"""Gaps [m] up to which added material fuses with what lies above or below: rounding of layer heights."""


@frozen
class Removal:
    """What happened along c pieces: volumes [m^3] and depth [m], each (c,)."""

    volume: Array
    body_volume: Array
    body_depth: Array


@frozen
class Deposition:
    """What was added along c pieces [m^3], each (c,); `nominal` is bead area times length, whatever was in the way."""

    volume: Array
    nominal: Array


def cells_along(length: float, resolution: float) -> int:
    """The number of cells, at most `resolution` wide, into which `length` is divided exactly [m]."""
    return max(1, ceil(length / resolution * (1.0 - 1e-9)))


def memory_needed(size: Vector, resolution: float) -> int:
    """Bytes that a fresh stock of `size` (x, y, z) takes at `resolution` [m]; cutting undercuts may multiply it."""
    return cells_along(size[0], resolution) * cells_along(size[1], resolution) * BYTES_PER_COLUMN


def finest_resolution(size: Vector, budget: int) -> float:
    """The finest resolution [m], two digits, at which a stock of `size` (x, y, z) fits into `budget` bytes."""
    fit = sqrt(size[0] * size[1] * BYTES_PER_COLUMN / budget)
    step = power(10.0, np.floor(log10(fit) - 1.0))
    wanted = float(np.ceil(fit / step) * step)
    while memory_needed(size, wanted) > budget:
        wanted += step
    return float(wanted)


class Stock:
    """A workpiece in its frame S. The contents of its field change in place; everything else stays.

    Outside of this package nobody looks into `field`: kernels pass it on whole (`view`), other code calls methods.
    There are columns along Z, in `field`, and from the first cut with a leaning tool on also along x and y, in
    `lattice`; `exact` makes those of the stock as it was at the start, where its shape is known.
    `turn` (3, 3) is nearly always the identity: axes of the frame in which the columns stand, seen from the part's
    own frame, when the part was laid on another side (`turning`). All points are in the frame of the columns.
    `first_walls` are those at the start, of a stock that was cut before.
    `doses` is what beams have given each column per area, (nx, ny), by the name of what is meant.
    `parting` looks in a run for pieces that come loose.
    `ridges` are the ways of round and pointed tools by patches of columns (`ridge_kernels`), None before the first one;
    `first_ridges` are those at the start.
    """

    __slots__ = (
        "doses",
        "exact",
        "field",
        "first_ridges",
        "first_walls",
        "lattice",
        "material",
        "original",
        "parting",
        "resolution",
        "ridges",
        "turn",
        "z_range",
    )

    def __init__(
        self,
        *,
        columns: Columns,
        grid: Grid,
        z_range: tuple[float, float],
        resolution: float,
        material: str = "",
        original: Columns | None = None,
    ) -> None:
        """`z_range` is the height of the stock at the start; `original` its columns then (default: as they are now)."""
        from gcodesim.material.kernels import patch_tops

        self.z_range, self.resolution, self.material = z_range, resolution, material
        self.turn: Array = np.eye(3)
        self.lattice: Lattice | None = None
        self.parting: Parting | None = None
        self.exact: Exact | None = None
        self.doses: dict[str, Array] = {}
        self.original = original if original is not None else _copied(columns)
        self.first_walls: Singles | None = None
        self.ridges: Array | None = None
        self.first_ridges: Array | None = None
        nx, ny = columns.number.shape
        patches = (-(-nx // PATCH), -(-ny // PATCH))
        self.field = Field(
            columns=columns,
            grid=grid,
            walls=np.zeros((WALL_PLANES, nx + 1, ny + 1), dtype=np.float32),
            dirty=np.zeros(patches, dtype=np.uint8),
            tops=np.zeros(patches),
        )
        patch_tops(columns, self.field.tops)

    @classmethod
    def box(cls, minimum: Vector, maximum: Vector, resolution: float, material: str = "") -> Stock:
        """A box between two corners of S [m]; cells divide it exactly and are at most `resolution` wide."""
        grid, shape = grid_of(minimum, maximum, resolution)
        low, high = float(minimum[2]), float(maximum[2])
        stock = cls(
            columns=_equal_columns(shape, low, high),
            grid=grid,
            z_range=(low, high),
            resolution=resolution,
            material=material,
            original=_equal_columns((1, 1), low, high),  # all columns of a box start alike, so one represents all
        )

        def exact(order: tuple[int, int, int]) -> Lines:
            corners = [[float(corner[axis]) for axis in order] for corner in (minimum, maximum)]
            field = cls.box(corners[0], corners[1], resolution).field
            return field.columns, field.grid

        stock.exact = exact
        return stock

    @classmethod
    def cylinder(
        cls,
        center: Vector,
        diameter: float,
        length: float,
        resolution: float,
        material: str = "",
        axis: str = "z",
    ) -> Stock:
        """A round bar [m] whose axis (x, y or z) begins at `center`, the middle of its lower (or first) end face."""
        radius = diameter / 2.0
        begin = np.asarray(center, dtype=float)
        along = "xyz".index(axis)
        minimum, maximum = begin - radius, begin + radius
        minimum[along], maximum[along] = begin[along], begin[along] + length
        grid, shape = grid_of(minimum, maximum, resolution)
        x = (grid.x + (np.arange(shape[0]) + 0.5) * grid.dx)[:, None] - begin[0]
        y = (grid.y + (np.arange(shape[1]) + 0.5) * grid.dy)[None, :] - begin[1]
        if axis == "z":
            half = np.where(x * x + y * y <= radius * radius, length / 2.0, 0.0)
            middle = begin[2] + length / 2.0
        else:
            across = y if axis == "x" else x
            half = np.broadcast_to(np.sqrt(np.maximum(radius * radius - across * across, 0.0)), shape)
            middle = begin[2]
        stock = cls(
            columns=Columns(
                lo=np.ascontiguousarray(middle - half)[:, :, None],
                hi=np.ascontiguousarray(middle + half)[:, :, None],
                number=(half > 0.0).astype(np.int32),
            ),
            grid=grid,
            z_range=(float(minimum[2]), float(maximum[2])),
            resolution=resolution,
            material=material,
        )

        def exact(order: tuple[int, int, int]) -> Lines:
            turned_axis = "xyz"[order.index(along)]
            field = cls.cylinder(begin[list(order)], diameter, length, resolution, "", turned_axis).field
            return field.columns, field.grid

        stock.exact = exact
        return stock

    @classmethod
    def empty(cls, minimum: Vector, maximum: Vector, resolution: float, material: str = "") -> Stock:
        """Room without material, to be printed into [m]."""
        stock = cls.box(minimum, maximum, resolution, material)
        lo, hi, count = stock.field.columns
        count[:] = 0
        hi[:] = lo
        stock.exact = None
        stock.original.number[:] = 0
        stock.field.tops[:] = -np.inf
        return stock

    def view(self, axis: Vector) -> Field:
        """The field whose columns are nearest to `axis` (3,), from a tool's tip to its holder; the only one is along Z.

        For kernels, which pass it on to those of this package. It is valid until the stock has to `grow`.
        """
        return self.field

    @property
    def wall_places(self) -> Singles:
        """Where walls are at the borders in x and in y (2, nx + 1, ny + 1), as `walls` has it: those that stand, else
        those that hang from the side that was up before the stock was turned over."""
        walls = self.field.walls
        if len(walls) == WALL_PLANES:
            return walls[:2]
        return np.where(walls[:2] != 0.0, walls[:2], walls[HUNG : HUNG + 2])

    @property
    def columns_along(self) -> int:
        """The number of axes along which there are columns: 1, or 3 from the first cut with a leaning tool on."""
        return 1 if self.lattice is None else 3

    @property
    def origin(self) -> Array:
        """Outer corner (x, y) of the grid [m]."""
        return np.array(self.field.grid[:2])

    @property
    def spacing(self) -> Array:
        """Cell size (dx, dy) [m]."""
        return np.array(self.field.grid[2:])

    @property
    def cell(self) -> float:
        """The longer side of a cell [m]."""
        return float(self.spacing.max())

    @property
    def bounds(self) -> tuple[Array, Array]:
        """The lowest and the highest corner (3,) [m] of the stock at the start, or as high as beads lie on it."""
        far = self.origin + self.spacing * self.field.columns.number.shape
        return np.append(self.origin, self.z_range[0]), np.append(far, max(self.z_range[1], self.top))

    @property
    def top(self) -> float:
        """Height [m] that no material surpasses; -inf where there is none."""
        return float(self.field.tops.max())

    def in_part(self, points: Array) -> Array:
        """Points (n, 3) [m] in the part's own frame, on whichever side it lies."""
        turned: Array = applied(self.turn, points)
        return turned

    @property
    def volume(self) -> float:
        """Volume of all material [m^3]: the columns, corrected by what true walls take of them or leave beside them.

        With columns in three directions it is that inside of their common surface.
        """
        if self.lattice is not None:
            from gcodesim.material.lattice_surface import volume_inside

            return volume_inside(self)
        from gcodesim.material.kernels import beyond_columns, volume_of

        grid = self.field.grid
        strips = float(beyond_columns(self.field.walls)) * float(grid.dx * grid.dy)
        return float(volume_of(self.field)) - strips

    def error_bound(self) -> float:
        """By how much [m^3] the removed or added volume may be wrong on this grid; 0 when nothing changed.

        It falls with the square of the cell, at round edges with its power 1.5 (`error_kernels`). Held against closed
        forms, it is not exceeded, and three to ten times the error of the like on other grids; a lucky grid may do
        better. What slips between the columns is not included: cuts, and what is left beside them or beside a border,
        that are narrower than a cell. Ridges between rows of ball and bull noses are (`ridge_kernels`).
        """
        if self.lattice is not None:
            from gcodesim.material.lattice_surface import volume_error

            return volume_error(self)
        from gcodesim.material.error_kernels import changes, error_bound

        columns = self.field.columns
        change = np.zeros(columns.number.shape)
        if changes(columns, self.original, change) == 0.0:
            return 0.0
        walls = self._new_walls()
        bound = float(error_bound(self.field._replace(walls=walls), change))
        from gcodesim.material.ridge_kernels import ridge_error

        if self.ridges is not None:
            bound += float(ridge_error(self.field._replace(walls=walls), change, change, self.ridges))
        if self.first_ridges is not None:
            standing = self.first_walls if self.first_walls is not None else np.zeros_like(walls)
            first = self.field._replace(columns=self.original, walls=standing)
            bound += float(ridge_error(first, change, np.ones_like(change), self.first_ridges))
        return bound

    def all_ridges(self) -> Array | None:
        """The `ridges` that there are now: its own where this run has cut with such a tool, ways of whole patches."""
        if self.ridges is None:
            return self.first_ridges
        from gcodesim.material.error_kernels import changes
        from gcodesim.material.ridge_kernels import WAY

        nx, ny = self.field.columns.number.shape
        change = np.zeros((nx, ny))
        changes(self.field.columns, self.original, change)
        rows, columns = np.arange(0, nx, PATCH), np.arange(0, ny, PATCH)

        def in_patches(cut: Array) -> Array:
            return np.add.reduceat(np.add.reduceat(cut, rows, axis=0), columns, axis=1)

        now = self.ridges.copy()
        now[WAY] *= in_patches(np.ones_like(change)) / np.maximum(in_patches((change > 0.0).astype(float)), 1.0)
        return now if self.first_ridges is None else np.where(now[WAY] > 0.0, now, self.first_ridges)

    def _new_walls(self) -> Singles:
        """The walls without what of them stood at the start, since that is on both sides of the change.

        Walls that are gone count as steps: where others cross them their corners are not known.
        """
        walls, first = self.field.walls, self.first_walls
        if first is None or first.shape != walls.shape:
            return walls
        new = walls.copy()
        for axis in range(2):
            for place, size in ((PLACE + axis, HEIGHT + axis), (SECOND + axis, LOWER + axis)):
                kept = walls[place] == first[place]
                new[size] = np.where(kept, np.maximum(walls[size] - first[size], 0.0), walls[size])
            gone = (new[HEIGHT + axis] <= SAME_HEIGHT) & (new[LOWER + axis] <= SAME_HEIGHT)
            new[PLACE + axis] = np.where(gone, 0.0, walls[PLACE + axis])
        return new

    def copy(self) -> Stock:
        """An independent stock in the same state."""
        twin = Stock(
            columns=_copied(self.field.columns),
            grid=self.field.grid,
            z_range=self.z_range,
            resolution=self.resolution,
            material=self.material,
            original=self.original,
        )
        twin.field.dirty[:] = self.field.dirty
        twin.set_walls(self.field.walls.copy())
        twin.first_walls = self.first_walls
        twin.turn, twin.exact = self.turn.copy(), self.exact
        twin.doses = {name: dose.copy() for name, dose in self.doses.items()}
        twin.lattice = None if self.lattice is None else self.lattice.copy()
        twin.ridges, twin.first_ridges = None if self.ridges is None else self.ridges.copy(), self.first_ridges
        return twin

    def memento(self) -> Callable[[], None]:
        """Remember the state; calling the result restores it."""
        kept = _kept(self.field)
        lattice = None if self.lattice is None else self.lattice.copy()
        doses = {name: dose.copy() for name, dose in self.doses.items()}
        ridges = None if self.ridges is None else self.ridges.copy()

        def restore() -> None:
            self.field = kept()
            self.doses = {name: dose.copy() for name, dose in doses.items()}
            self.lattice = None if lattice is None else lattice.copy()
            self.ridges = None if ridges is None else ridges.copy()

        return restore

    def set_walls(self, walls: Singles) -> None:
        """Give it the walls at the borders of its columns; more planes where it was turned over (`wall_kernels`)."""
        self.field = self.field._replace(walls=np.ascontiguousarray(walls))

    def begin_with(self, walls: Singles) -> None:
        """Give it walls that stand at the start, since it was cut before."""
        self.set_walls(walls)
        self.first_walls = walls.copy() if walls.any() else None

    def grow(self) -> None:
        """Make room for more intervals in every column."""
        self.field = widened(self.field)

    def remove(self, starts: Array, ends: Array, shape: Shape, bodies: Sequence[Shape] = ()) -> Removal:
        """Cut along c straight pieces, tool upright: tips from `starts` to `ends` (c, 3) in S [m].

        `shape` is the cutting part, `bodies` are shank and holder: material that they run through, after each piece,
        is reported and not removed.
        """
        from gcodesim.material.kernels import Found, remove

        starts, ends = _pieces(starts), _pieces(ends)
        if self.lattice is not None:
            from gcodesim.material.axis_way import upright
            from gcodesim.material.solid_of_revolution import slabs_of_shape

            self.follow(upright(starts, ends), slabs_of_shape(shape, self.cell))
        others = np.array(bodies, dtype=float).reshape(-1, len(Shape._fields))
        found = Found(*np.zeros((3, len(starts))))
        done = 0
        while True:
            done = remove(self.field, starts, ends, shape, others, done, found)
            if done == len(starts):
                self.note_way(starts, ends, found.volume, shape)
                return Removal(**found._asdict())
            self.grow()

    def note_way(self, starts: Array, ends: Array, took: Array, shape: Shape) -> None:
        """Remember pieces (c, 3) [m] of an upright tool that took material (c,), if it leaves ridges: round or pointed.

        Of rows no wider than what is looked at, a flat tip leaves no ridges or lower ones.
        """
        from gcodesim.material.ridge_kernels import CLOSE, RIDGE_PLANES, note_way

        half = 0.5 * CLOSE * self.cell
        rise = shape.rise * max(half - shape.flat, 0.0) / half
        if (shape.corner <= 0.0 and rise <= 0.0) or not (took > 0.0).any():
            return

        if self.ridges is None:
            self.ridges = np.zeros((RIDGE_PLANES, *self.field.dirty.shape))
        bend = 1.0 / shape.corner if shape.corner > 0.0 else 0.0
        note_way(self.field.grid, starts, ends, took, bend, rise, self.ridges)

    def sweep(self, way: AxisWay, slabs: Array) -> Array:
        """Cut along c pieces with an axis of any direction, which may turn; volume (c,) [m^3] that each takes.

        `slabs` (m, 6) is the body (`solid_of_revolution`). The first such cut gives the stock columns along x and y
        as well. The sum of the volumes is what the volume of the stock falls by; its parts are shared out by what each
        piece takes of the columns.
        """
        from gcodesim.material.lattice import sweep

        return sweep(self, way, slabs, range(3))

    def follow(self, way: AxisWay, slabs: Array) -> None:
        """Cut the columns along x and y, if there are any, like those along Z, which have been cut already."""
        if self.lattice is not None and len(way.starts):
            from gcodesim.material.lattice import sweep

            sweep(self, way, slabs, range(2))

    def depths(self, way: AxisWay, slabs: Array) -> Array:
        """How deep (c,) [m] a body is in material at the start of each piece; nothing is removed."""
        from gcodesim.material.line_kernels import ToolWay, depths_in

        depths = np.zeros(len(way.starts))
        depths_in(self.field, ToolWay(*map(_pieces, way)), slabs, depths)
        return depths

    def piece_volumes(self) -> Array:
        """The volume [m^3] of each piece in which the stock lies, greatest first; gives it columns along x and y."""
        from gcodesim.material.lattice import ensure_lattice
        from gcodesim.material.lattice_surface import volumes_of_pieces

        ensure_lattice(self)
        return volumes_of_pieces(self)

    def add_bead(self, starts: Array, ends: Array, width: float, height: float) -> Deposition:
        """Lay a bead of `width` >= `height` [m] along c pieces of the nozzle tip (c, 3) in S; it hangs below the tip.

        Pieces that follow each other make one strand with flat ends and round corners. The part outside the grid
        is not kept: `volume` then stays below `nominal`. Columns along x and y are given up.
        """
        self.lattice = None
        from gcodesim.material.kernels import Bead, add_bead

        if not 0.0 < height <= width:
            raise ValueError(f"a bead {width} m wide and {height} m high")
        starts, ends = _pieces(starts), _pieces(ends)
        area = (width - height) * height + np.pi * (height * height) / 4.0
        bead = Bead(float(width), float(height), GAP_CLOSED)
        result = Deposition(volume=np.zeros(len(starts)), nominal=area * norms(ends - starts))
        done = 0
        while True:
            done = add_bead(self.field, starts, ends, bead, done, result.volume)
            if done == len(starts):
                return result
            self.grow()

    def touch(self, starts: Array, ends: Array, shape: Shape) -> tuple[Array, Array]:
        """Material that `shape` would run through along c pieces, each against the stock as it is now.

        Volume (c,) [m^3] and depth (c,) [m]; nothing is removed.
        """
        from gcodesim.material.kernels import touch_piece

        starts, ends = _pieces(starts), _pieces(ends)
        found = [touch_piece(self.field, a, b, shape) for a, b in zip(starts, ends, strict=True)]
        pairs = np.array(found, dtype=float).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    def inside(self, tip: Vector, shape: Shape) -> bool:
        """Whether a tool of this shape, standing with its tip there [m], is in material."""
        point = np.array([tip], dtype=float)
        return bool(self.touch(point, point, shape)[0][0] > 0.0)

    def occupancy(self, x: float, y: float, z0: float, z1: float) -> float:
        """Share [-] of the height z0 < z1 [m] that is material at (x, y), bilinear between column centres."""
        from gcodesim.material.kernels import occupancy

        return float(occupancy(self.field, x, y, z0, z1))

    def intervals_at(self, x: float, y: float) -> list[tuple[float, float]]:
        """The intervals [m] of material in the column of (x, y), from below."""
        lo, hi, count = self.field.columns
        i, j = np.floor((np.array([x, y]) - self.origin) / self.spacing).astype(int)
        if not (0 <= i < count.shape[0] and 0 <= j < count.shape[1]):
            return []
        n = count[i, j]
        return list(zip(lo[i, j, :n].tolist(), hi[i, j, :n].tolist(), strict=True))

    def extent(self) -> tuple[Array, Array]:
        """The lowest and the highest corner (3,) [m] of a box around all material; `bounds` where there is none."""
        lo, hi, count = self.field.columns
        filled = count > 0
        if not filled.any():
            return self.bounds
        x, y, dx, dy = self.field.grid
        i, j = np.flatnonzero(filled.any(axis=1)), np.flatnonzero(filled.any(axis=0))
        used = np.arange(lo.shape[2]) < count[:, :, None]
        low = np.array([x + dx * i[0], y + dy * j[0], lo[used].min()])
        return low, np.array([x + dx * (i[-1] + 1), y + dy * (j[-1] + 1), hi[used].max()])

    def relief(self) -> Relief:
        """The heights of the columns, and how much material each one holds."""
        from gcodesim.material.relief import relief_of

        return relief_of(self)

    def spacing_for(self, columns: int) -> float:
        """The spacing [m] at which the whole stock has about `columns` columns; never less than a cell."""
        area = float(np.prod(self.spacing * self.field.columns.number.shape))
        return max(self.cell, sqrt(area / columns))

    def surface(self, spacing: float | None = None) -> Surface:
        """The closed surface, columns drawn about `spacing` [m] apart (default: the resolution; 0: all columns)."""
        if self.lattice is not None:
            from gcodesim.material.lattice_surface import lattice_surface

            return lattice_surface(self, self.resolution if spacing is None else spacing)
        from gcodesim.material.surface import build_surface

        return build_surface(self, self.resolution if spacing is None else spacing)

    def tiles(self, across: int = 4, spacing: float | None = None) -> Tiles:
        """The surface in `across` x `across` tiles for the log, which can later be asked for what has changed."""
        from gcodesim.material.surface import Tiles

        return Tiles(self, across=across, spacing=spacing)

    def save(self, path: Path) -> None:
        """Write the file from which a later run goes on."""
        from gcodesim.material.stock_file import save_stock

        save_stock(self, path)


def _copied(columns: Columns) -> Columns:
    return Columns(columns.lo.copy(), columns.hi.copy(), columns.number.copy())


def widened(field: Field) -> Field:
    """A field whose columns can hold twice as many intervals, or half as many again where they are many already."""
    lo, hi, count = field.columns
    held = lo.shape[2]
    room = (*count.shape, held + max(held // 2, min(held, DOUBLED)))
    wider = Columns(np.zeros(room), np.zeros(room), count)
    wider.lo[:, :, :held], wider.hi[:, :, :held] = lo, hi
    return field._replace(columns=wider)


def _kept(field: Field) -> Callable[[], Field]:
    """Remember a field; calling the result gives one like it."""
    from gcodesim.material.packing_kernels import pack, unpack

    number, held = field.columns.number.copy(), field.columns.lo.shape[2]
    low, high = np.empty((2, int(number.sum(dtype=np.int64))))
    pack(field.columns, low, high)
    walls, dirty, tops = field.walls.copy(), field.dirty.copy(), field.tops.copy()

    def again() -> Field:
        columns = Columns(np.zeros((*number.shape, held)), np.zeros((*number.shape, held)), number.copy())
        unpack(low, high, columns)
        return Field(columns, field.grid, walls.copy(), dirty.copy(), tops.copy())

    return again


def _equal_columns(shape: tuple[int, int], low: float, high: float) -> Columns:
    """Columns of one interval each, all from `low` to `high` [m]."""
    return Columns(np.full((*shape, 1), low), np.full((*shape, 1), high), np.ones(shape, dtype=np.int32))


def _pieces(points: Array) -> Array:
    """Points as a contiguous (c, 3) array."""
    return np.ascontiguousarray(points, dtype=float).reshape(-1, 3)


def grid_of(minimum: Vector, maximum: Vector, resolution: float) -> tuple[Grid, tuple[int, int]]:
    """Grid and number of columns of a box; ValueError when it has no volume."""
    size = [float(b) - float(a) for a, b in zip(minimum, maximum, strict=True)]
    if not (all(s > 0.0 for s in size) and resolution > 0.0):
        raise ValueError(f"a stock of size {size} m at resolution {resolution} m")
    nx, ny = cells_along(size[0], resolution), cells_along(size[1], resolution)
    return Grid(float(minimum[0]), float(minimum[1]), size[0] / nx, size[1] / ny), (nx, ny)
