"""Stock: material as columns of exact height on a regular grid ("dexels"), and what tools do to it.

Each column of the grid in x, y holds a short sorted list of intervals [lo, hi]
along Z of the stock frame S. Heights are exact; x and y are asked at the
centres of the cells. So floors and heights come out to rounding error, and
walls stand up to half a cell beside their place; where they really stand is
kept at the borders of the columns (`walls`), so that volumes are far better.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.shape import no_bodies

if TYPE_CHECKING:
    from gcodesim.material.surface import Surface, Tiles

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]
Vector = Sequence[float] | Array

WALL_PLANES = 8
"""What is kept of the walls at the borders of columns (wall_kernels)."""

BYTES_PER_COLUMN = 8 + 8 + 4 + 4 * WALL_PLANES
"""Memory of a column with one interval and its two borders; each further interval costs 16 bytes in every column."""

PATCH = 16
"""Columns along one side of a patch, the unit in which changes are watched (2 ** PATCH_SHIFT of the kernels)."""

GAP_CLOSED = 1.0e-9
"""Gaps [m] up to which added material fuses with what lies above or below: rounding of layer heights."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Removal:
    """What happened along c pieces: volumes [m^3] and depth [m], each (c,)."""

    volume: Array
    body_volume: Array
    body_depth: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Deposition:
    """What was added along c pieces [m^3], each (c,); `nominal` is bead area times length, whatever was in the way."""

    volume: Array
    nominal: Array


def cells_along(length: float, resolution: float) -> int:
    """Number of cells, at most `resolution` wide, that divide `length` exactly [m]."""
    return max(1, ceil(length / resolution * (1.0 - 1e-9)))


def memory_needed(size: Vector, resolution: float) -> int:
    """Bytes that a fresh stock of `size` (x, y, z) takes at `resolution` [m]; cutting undercuts may multiply it."""
    return cells_along(size[0], resolution) * cells_along(size[1], resolution) * BYTES_PER_COLUMN


def finest_resolution(size: Vector, budget: int) -> float:
    """The finest resolution [m], two digits, at which a stock of `size` (x, y, z) fits into `budget` bytes."""
    fit = sqrt(size[0] * size[1] * BYTES_PER_COLUMN / budget)
    step = 10.0 ** np.floor(np.log10(fit) - 1.0)
    wanted = float(np.ceil(fit / step) * step)
    while memory_needed(size, wanted) > budget:
        wanted += step
    return float(wanted)


class Stock:
    """A workpiece in its frame S. Arrays change in place; everything else stays.

    `turn` (3, 3) is nearly always the identity: axes of the frame in which the columns stand, seen from the part's
    own frame, when the part was laid on another side (`turning`). All arrays and points are in the former.
    """

    __slots__ = (
        "count", "dirty", "grid", "hi", "lo", "material", "original", "resolution", "tops", "turn", "walls", "z_range"
    )  # fmt: skip

    def __init__(
        self,
        *,
        lo: Array,
        hi: Array,
        count: Ints,
        grid: Array,
        z_range: tuple[float, float],
        resolution: float,
        material: str = "",
        original: tuple[Array, Array, Ints] | None = None,
    ) -> None:
        """From columns lo, hi (nx, ny, k) [m], count (nx, ny) and grid (x, y of the outer corner, dx, dy) [m].

        `z_range` is the height of the stock as it came; `original` its columns then (default: as they are now).
        """
        from gcodesim.material.kernels import patch_tops

        self.lo, self.hi, self.count, self.grid = lo, hi, count, grid
        self.z_range, self.resolution, self.material = z_range, resolution, material
        self.turn: Array = np.eye(3)
        self.original = original if original is not None else (lo.copy(), hi.copy(), count.copy())
        patches = (-(-count.shape[0] // PATCH), -(-count.shape[1] // PATCH))
        self.dirty: Bytes = np.zeros(patches, dtype=np.uint8)
        self.tops: Array = np.zeros(patches)
        self.walls: Singles = np.zeros((WALL_PLANES, count.shape[0] + 1, count.shape[1] + 1), dtype=np.float32)
        patch_tops(hi, count, self.tops)

    @classmethod
    def box(cls, minimum: Vector, maximum: Vector, resolution: float, material: str = "") -> Stock:
        """A box between two corners of S [m]; cells divide it exactly and are at most `resolution` wide."""
        grid, shape = grid_of(minimum, maximum, resolution)
        low, high = float(minimum[2]), float(maximum[2])
        return cls(
            lo=np.full((*shape, 1), low),
            hi=np.full((*shape, 1), high),
            count=np.ones(shape, dtype=np.int32),
            grid=grid,
            z_range=(low, high),
            resolution=resolution,
            material=material,
            # all columns of a box begin alike, so one stands for all
            original=(np.full((1, 1, 1), low), np.full((1, 1, 1), high), np.ones((1, 1), dtype=np.int32)),
        )

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
        x = (grid[0] + (np.arange(shape[0]) + 0.5) * grid[2])[:, None] - begin[0]
        y = (grid[1] + (np.arange(shape[1]) + 0.5) * grid[3])[None, :] - begin[1]
        if axis == "z":
            half = np.where(x**2 + y**2 <= radius**2, length / 2.0, 0.0)
            middle = begin[2] + length / 2.0
        else:
            across = y if axis == "x" else x
            half = np.broadcast_to(np.sqrt(np.maximum(radius**2 - across**2, 0.0)), shape)
            middle = begin[2]
        return cls(
            lo=np.ascontiguousarray(middle - half)[:, :, None],
            hi=np.ascontiguousarray(middle + half)[:, :, None],
            count=(half > 0.0).astype(np.int32),
            grid=grid,
            z_range=(float(minimum[2]), float(maximum[2])),
            resolution=resolution,
            material=material,
        )

    @classmethod
    def empty(cls, minimum: Vector, maximum: Vector, resolution: float, material: str = "") -> Stock:
        """Room without material, to be printed into [m]."""
        stock = cls.box(minimum, maximum, resolution, material)
        stock.count[:] = 0
        stock.hi[:] = stock.lo
        stock.original[2][:] = 0
        stock.tops[:] = -np.inf
        return stock

    @property
    def origin(self) -> Array:
        """Outer corner (x, y) of the grid [m]."""
        return self.grid[:2].copy()

    @property
    def spacing(self) -> Array:
        """Cell size (dx, dy) [m]."""
        return self.grid[2:].copy()

    @property
    def volume(self) -> float:
        """All material [m^3]: the columns, and what true walls take of them or leave beside them."""
        from gcodesim.material.kernels import beyond_columns, volume_of

        strips = float(beyond_columns(self.walls)) * float(self.grid[2] * self.grid[3])
        return float(volume_of(self.lo, self.hi, self.count, self.grid)) - strips

    def error_bound(self) -> float:
        """How far [m^3] the volume cut or added may be off on this grid; 0 when nothing changed.

        A tenth to a half of a cell at every wall that was made, and the bend of slopes; it shrinks with the cell.
        Cuts narrower than a cell can slip between the columns and are not in it.
        """
        from gcodesim.material.error_kernels import changes, error_bound

        change = np.zeros(self.count.shape)
        if changes(self.lo, self.hi, self.count, *self.original, change) == 0.0:
            return 0.0
        return float(error_bound(self.lo, self.hi, self.count, self.walls, change, self.grid))

    def copy(self) -> Stock:
        """An independent stock in the same state."""
        twin = Stock(
            lo=self.lo.copy(),
            hi=self.hi.copy(),
            count=self.count.copy(),
            grid=self.grid.copy(),
            z_range=self.z_range,
            resolution=self.resolution,
            material=self.material,
            original=self.original,
        )
        twin.dirty[:] = self.dirty
        twin.walls[:] = self.walls
        twin.turn = self.turn.copy()
        return twin

    def memento(self) -> Callable[[], None]:
        """Remember the state; the answer puts it back."""
        names = ("lo", "hi", "count", "dirty", "tops", "walls")
        kept = {name: getattr(self, name).copy() for name in names}

        def restore() -> None:
            for name, values in kept.items():
                setattr(self, name, values.copy())

        return restore

    def grow(self) -> None:
        """Double the intervals that a column can hold."""
        empty = np.zeros_like(self.lo)
        self.lo = np.concatenate((self.lo, empty), axis=2)
        self.hi = np.concatenate((self.hi, empty), axis=2)

    def remove(self, starts: Array, ends: Array, shape: Array, bodies: Array | None = None) -> Removal:
        """Cut along c straight pieces, tool upright: tips from `starts` to `ends` (c, 3) in S [m].

        `shape` (8,) is the cutting part, `bodies` (b, 8) shank and holder: what they run through, after each piece,
        is reported and not removed.
        """
        from gcodesim.material.kernels import remove

        starts, ends = _pieces(starts), _pieces(ends)
        bodies = no_bodies() if bodies is None else np.ascontiguousarray(bodies, dtype=float)
        result = Removal(
            volume=np.zeros(len(starts)), body_volume=np.zeros(len(starts)), body_depth=np.zeros(len(starts))
        )
        done = 0
        while True:
            done = remove(
                self.lo, self.hi, self.count, self.grid, self.dirty, self.walls, self.tops, starts, ends, shape, bodies,
                done, result.volume, result.body_volume, result.body_depth,
            )  # fmt: skip
            if done == len(starts):
                return result
            self.grow()

    def remove_tilted(self, starts: Array, ends: Array, axes_start: Array, axes_end: Array, shape: Array) -> Array:
        """Cut along c pieces with an axis that turns: unit vectors (c, 3) from tip to holder at both ends, in S.

        Volume (c,) [m^3]. The body is asked at poses half a cell apart; rounded corners are 24 facets, the facets
        staying inside by less than a thousandth of the corner radius.
        """
        from gcodesim.material.shape import profile
        from gcodesim.material.tilted_kernels import remove_tilted

        starts, ends, axes_start, axes_end = (_pieces(a) for a in (starts, ends, axes_start, axes_end))
        radii, heights = profile(shape)
        volume = np.zeros(len(starts))
        done = 0
        while True:
            done = remove_tilted(
                self.lo, self.hi, self.count, self.grid, self.dirty, self.walls, starts, ends, axes_start, axes_end,
                radii, heights, done, volume,
            )  # fmt: skip
            if done == len(starts):
                return volume
            self.grow()

    def add_bead(self, starts: Array, ends: Array, width: float, height: float) -> Deposition:
        """Lay a bead of `width` >= `height` [m] along c pieces of the nozzle tip (c, 3) in S; it hangs below the tip.

        Pieces that follow each other make one strand with flat ends and round corners. The part outside the grid
        is not kept: `volume` then stays below `nominal`.
        """
        from gcodesim.material.kernels import add_bead

        if not 0.0 < height <= width:
            raise ValueError(f"a bead {width} m wide and {height} m high")
        starts, ends = _pieces(starts), _pieces(ends)
        area = (width - height) * height + np.pi * height**2 / 4.0
        result = Deposition(volume=np.zeros(len(starts)), nominal=area * np.linalg.norm(ends - starts, axis=1))
        done = 0
        while True:
            done = add_bead(
                self.lo, self.hi, self.count, self.grid, self.dirty, self.tops, starts, ends, width, height,
                GAP_CLOSED, done, result.volume,
            )  # fmt: skip
            if done == len(starts):
                return result
            self.grow()

    def touch(self, starts: Array, ends: Array, shape: Array) -> tuple[Array, Array]:
        """Material that `shape` would run through along c pieces, each against the stock as it is now.

        Volume (c,) [m^3] and depth (c,) [m]; nothing is removed.
        """
        from gcodesim.material.kernels import touch_piece

        starts, ends = _pieces(starts), _pieces(ends)
        found = [
            touch_piece(self.lo, self.hi, self.count, self.grid, self.tops, a, b, shape)
            for a, b in zip(starts, ends, strict=True)
        ]
        pairs = np.array(found, dtype=float).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    def inside(self, tip: Vector, shape: Array) -> bool:
        """Whether a tool of this shape, standing with its tip there [m], is in material."""
        point = np.array([tip], dtype=float)
        return bool(self.touch(point, point, shape)[0][0] > 0.0)

    def occupancy(self, x: float, y: float, z0: float, z1: float) -> float:
        """Share [-] of the height z0 < z1 [m] that is material at (x, y), bilinear between column centres."""
        from gcodesim.material.kernels import occupancy

        return float(occupancy(self.lo, self.hi, self.count, self.grid, x, y, z0, z1))

    def height_at(self, x: float, y: float) -> float:
        """Height [m] of the highest material in the column of (x, y); -inf where there is none."""
        from gcodesim.material.kernels import highest

        return float(highest(self.hi, self.count, self.grid, x, y))

    def surface(self, spacing: float | None = None) -> Surface:
        """The closed surface, columns drawn about `spacing` [m] apart (default: the resolution; 0: all columns)."""
        from gcodesim.material.surface import build_surface

        return build_surface(self, self.resolution if spacing is None else spacing)

    def tiles(self, across: int = 4, spacing: float | None = None) -> Tiles:
        """The surface in `across` x `across` tiles for the log, which can be asked again for what changed."""
        from gcodesim.material.surface import Tiles

        return Tiles(self, across=across, spacing=spacing)


def _pieces(points: Array) -> Array:
    """Points as a contiguous (c, 3) array."""
    return np.ascontiguousarray(points, dtype=float).reshape(-1, 3)


def grid_of(minimum: Vector, maximum: Vector, resolution: float) -> tuple[Array, tuple[int, int]]:
    """Grid (4,) and number of columns of a box; ValueError when it has no volume."""
    size = [float(b) - float(a) for a, b in zip(minimum, maximum, strict=True)]
    if not (all(s > 0.0 for s in size) and resolution > 0.0):
        raise ValueError(f"a stock of size {size} m at resolution {resolution} m")
    nx, ny = cells_along(size[0], resolution), cells_along(size[1], resolution)
    return np.array([float(minimum[0]), float(minimum[1]), size[0] / nx, size[1] / ny]), (nx, ny)
