"""A stock compared with the part that it should have become, within a band of tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import ceil, pi
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.elementary import cos_sin
from gcodesim.arithmetic.matrices import applied
from gcodesim.frozen import frozen
from gcodesim.material.deviation_kernels import EXCESS, FAR, GOUGE, Comb, Parts
from gcodesim.material.distance_kernels import SkinTree
from gcodesim.material.distance_tree import skin_tree
from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.material.mesh import OpenMeshError, columns_of_mesh, outward

if TYPE_CHECKING:
    from gcodesim.material.revolved import Profile, Revolved
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

REFINED: Final = 64
"""Parts of a region that are looked at again for its greatest depth."""

ASKED, FEWEST = 8_000, 48
"""Faces for which it is asked who made them: of all regions together, and of a small one of many."""

MOST_ASKED: Final = 400
"""Such faces of one region."""

AROUND: Final = 24
"""Directions in which the part of a lathe is compared."""

MOST_RINGS: Final = 4000
"""Places along the axis of a lathe where it is compared."""

SKIN_POINTS: Final = 1_000_000
"""At so many points of its skin the target is looked at, at the most."""


@frozen(eq=False)
class Misfit:
    """A place where the stock is out of tolerance.

    Volume [m³] between stock and target; area [m²] of the target's skin there; the greatest depth [m] and where that
    is, `at` (3,), between the corners `low` and `high` (3,) [m] in S. `faces` (n, 3) are some points of it on the skin
    of the stock, or the deepest ones where it has none there, in columns `depths` (n,) [m] deep that hold `volumes`.
    """

    gouge: bool
    volume: float
    area: float
    depth: float
    at: Array
    low: Array
    high: Array
    faces: Array
    depths: Array
    volumes: Array


@frozen(eq=False)
class LoosePart:
    """A body of the stock that has nothing of the target: volume [m³] and a point (3,) in it."""

    volume: float
    at: Array


@frozen(eq=False)
class Deviation:
    """Stock against target: regions by volume, the greatest first; bodies that are loose.

    `least` and `most` [m]: the deepest gouge (0 or below) and the highest excess (0 or above), also inside of the band.
    area [m²]: the skin of the target; `overhang` [m]: how far the target stands out of the stock as it was, beside all
    columns.
    """

    regions: Sequence[Misfit]
    loose: Sequence[LoosePart]
    least: float
    most: float
    area: float
    overhang: float

    @property
    def area_outside(self) -> float:
        """The skin of the target [m²] that is out of tolerance."""
        return float(sum(region.area for region in self.regions))


@frozen(eq=False)
class _Compared:
    """Stock and target as columns in the same places."""

    stock: Columns
    target: Columns
    comb: Comb
    cell: float


def compare(stock: Stock, vertices: Array, faces: Ints, tolerance: float) -> Deviation:
    """The finished stock against a closed mesh in its frame S: vertices (v, 3) [m], faces (f, 3).

    Where a column runs, both are exact. Regions narrower than the distance of columns may lie between them.
    OpenMeshError when the mesh is not closed.
    """
    vertices, faces = outward(vertices, faces)
    revolved = hasattr(stock, "profile")
    both = _turned_columns(cast("Revolved", stock), vertices, faces) if revolved else _upright(stock, vertices, faces)
    tree = skin_tree(vertices, faces)
    first = _starts(both.stock)
    body, loose = _bodies(both, first)
    parts = _parts(both, first, body)
    offcut = np.isin(parts.body, [number for number, _ in loose]) & (parts.side == EXCESS)
    if revolved:  # what the chuck holds behind the part is no fault of the program
        rings = parts.column // len(both.comb.sine)
        behind = both.comb.grid.x + (rings + 0.5) * both.comb.grid.dx < vertices[:, 2].min()
        offcut |= behind & (parts.side == EXCESS)
    parts = _chosen(parts, ~offcut)
    regions = _regions(stock, both, parts, tree, tolerance)
    most, least = (float(parts.depth[parts.side == side].max(initial=0.0)) for side in (EXCESS, GOUGE))
    low, high = stock.bounds
    out = np.maximum(low - vertices.min(axis=0), vertices.max(axis=0) - high)
    overhang = max(0.0, float(out[2]) if revolved else float(out[:2].max()))  # the rest is seen in columns
    area = _skin_areas(both, parts, tree, tolerance, len(regions))
    return Deviation(
        regions=sorted(
            (replace(region, area=float(area[number + 1])) for number, region in enumerate(regions)),
            key=lambda region: -region.volume,
        ),
        loose=[part for _, part in loose],
        least=-max([least, *(region.depth for region in regions if region.gouge)]),
        most=max([most, *(region.depth for region in regions if not region.gouge)]),
        area=float(area[0]),
        overhang=overhang,
    )


def _upright(stock: Stock, vertices: Array, faces: Ints) -> _Compared:
    columns, grid = stock.field.columns, stock.field.grid
    nx, ny = columns.number.shape
    target, leaks = columns_of_mesh(vertices, faces, grid, (nx, ny))
    if leaks:
        raise OpenMeshError(leaks, nx * ny)
    return _Compared(
        stock=columns, target=target, comb=Comb(grid, False, np.ones(ny), np.zeros(ny)), cell=float(stock.cell)
    )


def _turned_columns(stock: Revolved, vertices: Array, faces: Ints) -> _Compared:
    """Columns along the radius, at so many places of the axis and in `AROUND` directions."""
    profiles = stock.finished
    base = profiles[0] if len(profiles) == 1 else _united(profiles)
    stride = max(1, ceil(len(base.number) / MOST_RINGS))
    picked = slice(stride // 2, None, stride)
    lo, hi, number = base.lo[picked], base.hi[picked], base.number[picked]
    rings, dz = len(number), base.dz * stride
    z = base.z + (stride // 2 + 0.5) * base.dz - 0.5 * dz  # so that the first ring is in the middle of its cell
    angles: Array = (np.arange(AROUND, dtype=np.float64) + 0.5) * (2.0 * pi / AROUND)
    cosine, sine = cos_sin(angles)
    shape = (rings, AROUND, lo.shape[1])
    own = Columns(
        np.ascontiguousarray(np.broadcast_to(lo[:, None], shape)),
        np.ascontiguousarray(np.broadcast_to(hi[:, None], shape)),
        np.ascontiguousarray(np.broadcast_to(number[:, None], shape[:2])),
    )
    found = []
    for c, s in zip(cosine, sine, strict=True):
        turned = applied(np.array([[-s, c, 0.0], [0.0, 0.0, 1.0], [c, s, 0.0]]), vertices)  # across, axis, radius
        columns, leaks = columns_of_mesh(turned, faces, Grid(-0.5e-3, z, 1e-3, dz), (1, rings))
        if leaks:
            raise OpenMeshError(leaks, rings)
        found.append(Columns(columns.lo[0], columns.hi[0], columns.number[0]))
    room = max(columns.lo.shape[1] for columns in found)
    empty = np.zeros((rings, AROUND, room))
    target = Columns(empty, empty.copy(), np.zeros((rings, AROUND), np.int32))
    for j, columns in enumerate(found):
        kept = (np.arange(columns.lo.shape[1])[None, :] < columns.number[:, None]) & (columns.hi > 0.0)
        place = np.cumsum(kept, axis=1) - 1
        i, k = np.nonzero(kept)
        target.lo[i, j, place[i, k]], target.hi[i, j, place[i, k]] = np.maximum(columns.lo[i, k], 0.0), columns.hi[i, k]
        target.number[:, j] = kept.sum(axis=1)
    comb = Comb(Grid(z, 0.0, dz, 2.0 * pi / AROUND), True, np.ascontiguousarray(cosine), np.ascontiguousarray(sine))
    return _Compared(stock=own, target=target, comb=comb, cell=dz)


def _united(profiles: Sequence[Profile]) -> Profile:
    """Pieces that lie in one line, as one profile: in each disc the rings of all, by radius."""
    lo, hi = (np.hstack([getattr(profile, name) for profile in profiles]) for name in ("lo", "hi"))
    used = np.hstack([np.arange(p.lo.shape[1])[None, :] < p.number[:, None] for p in profiles])
    order = np.argsort(np.where(used, lo, FAR), axis=1, kind="stable")
    rows = np.arange(len(lo))[:, None]
    return profiles[0]._replace(lo=lo[rows, order], hi=hi[rows, order], number=used.sum(axis=1).astype(np.int32))


def _starts(columns: Columns) -> NDArray[np.int64]:
    """The number of intervals before each column (nx ny + 1,)."""
    return np.concatenate(([0], np.cumsum(columns.number.ravel(), dtype=np.int64)))


def _bodies(both: _Compared, first: NDArray[np.int64]) -> tuple[Ints, list[tuple[int, LoosePart]]]:
    """The body of each interval, by its first interval; and those bodies that have nothing of the target."""
    from gcodesim.material.deviation_kernels import label_bodies, weigh_bodies

    count = int(first[-1])
    body, whole, shared = np.zeros(count, np.int32), np.zeros(count), np.zeros(count)
    label_bodies(both.stock, first, both.comb.turned, body)
    weigh_bodies(both.stock, both.target, both.comb, first, body, whole, shared)
    loose: list[tuple[int, LoosePart]] = []
    if not shared.any():  # there is no part beside which anything could lie
        return body, loose
    for number in np.flatnonzero((whole > 0.0) & (shared == 0.0)).tolist():
        column = int(np.searchsorted(first, number, side="right")) - 1
        i, j = divmod(column, both.stock.number.shape[1])
        k = number - int(first[column])
        middle = 0.5 * (both.stock.lo[i, j, k] + both.stock.hi[i, j, k])
        at = _points(both.comb, np.array([column]), np.array([middle]))[0]
        loose.append((number, LoosePart(volume=float(whole[number]), at=at)))
    return body, loose


def _parts(both: _Compared, first: NDArray[np.int64], body: Ints) -> Parts:
    from gcodesim.material.deviation_kernels import find_parts

    columns = both.stock.number.size
    parts = _room(columns, 0)
    count = find_parts(both.stock, both.target, first, body, parts)
    parts = _room(columns, count)
    find_parts(both.stock, both.target, first, body, parts)
    return parts


def _room(columns: int, count: int) -> Parts:
    def whole(kind: Any) -> Any:
        return np.zeros(count, dtype=kind)

    return Parts(
        first=np.zeros(columns + 1, dtype=np.int64),
        column=whole(np.int32),
        side=whole(np.int8),
        lo=whole(float),
        hi=whole(float),
        cut=whole(np.int8),
        body=whole(np.int32),
        depth=whole(float),
        at=whole(float),
        region=whole(np.int32),
    )


def _chosen(parts: Parts, kept: NDArray[np.bool_]) -> Parts:
    before = np.concatenate(([0], np.cumsum(kept, dtype=np.int64)))
    chosen: Any = [part[kept] for part in parts[1:]]
    return Parts(before[parts.first], *chosen)


def _points(comb: Comb, column: NDArray[Any], s: Array) -> Array:
    """Points (n, 3) at `s` (n,) on columns (n,)."""
    i, j = np.divmod(column, len(comb.sine))
    u: Array = comb.grid.x + (i + 0.5) * comb.grid.dx
    if comb.turned:
        return np.stack([s * comb.cosine[j], s * comb.sine[j], u], axis=1)
    return np.stack([u, comb.grid.y + (j + 0.5) * comb.grid.dy, s], axis=1)


def _volumes(comb: Comb, parts: Parts) -> Array:
    area = comb.grid.dx * comb.grid.dy
    if comb.turned:
        turned: Array = area * 0.5 * (np.square(parts.hi) - np.square(parts.lo))
        return turned
    return area * (parts.hi - parts.lo)


def _regions(stock: Stock, both: _Compared, parts: Parts, tree: SkinTree, tolerance: float) -> list[Misfit]:
    """The regions in the order of their numbers, without their areas."""
    from gcodesim.material.deviation_kernels import grow_regions, join_parts, measure, refine

    step = 0.5 * both.cell
    measure(parts, both.comb, tree, tolerance, step)
    count = join_parts(parts, both.comb, tolerance, both.cell)
    grow_regions(parts, both.comb, min(20, 1 + ceil(tolerance / both.cell)))
    if count == 0:
        return []
    order = np.argsort(parts.region, kind="stable")
    borders = np.searchsorted(parts.region[order], np.arange(1, count + 2))
    volumes = _volumes(both.comb, parts)
    groups = [order[begin:end] for begin, end in pairwise(borders.tolist())]
    deepest = [group[np.argsort(-parts.depth[group], kind="stable")[:REFINED]] for group in groups]
    refine(parts, np.concatenate(deepest), both.comb, tree, 0.5 * step)
    beyond = _wall_depths(stock, both, parts, tree, count)
    found = []
    asked = max(FEWEST, min(MOST_ASKED, ASKED // count))
    for number, group in enumerate(groups):
        own = _region(both.comb, parts, volumes, group, asked)
        depth = min(max(own.depth, float(beyond[number + 1])), own.depth + both.cell)
        found.append(replace(own, depth=depth))
    return found


def _region(comb: Comb, parts: Parts, volumes: Array, group: NDArray[np.int64], most: int) -> Misfit:
    worst = int(group[np.argmax(parts.depth[group])])
    ends = np.concatenate([_points(comb, parts.column[group], s[group]) for s in (parts.lo, parts.hi)])
    by_depth = group[np.argsort(-parts.depth[group], kind="stable")]
    asked = distinct(np.concatenate((by_depth[: most // 3], group[:: max(1, ceil(len(group) / most))])))
    face = np.where(parts.cut & 1, parts.lo, np.where(parts.cut & 2, parts.hi, parts.at))
    # a part whose both ends are cut: the end nearer to the deepest place
    double = (parts.cut == 3) & (parts.hi - parts.at < parts.at - parts.lo)
    face = np.where(double, parts.hi, face)
    return Misfit(
        gouge=bool(parts.side[worst] == GOUGE),
        volume=float(volumes[group].sum()),
        area=0.0,
        depth=float(parts.depth[worst]),
        at=_points(comb, parts.column[[worst]], parts.at[[worst]])[0],
        low=ends.min(axis=0),
        high=ends.max(axis=0),
        faces=_points(comb, parts.column[asked], face[asked]),
        depths=parts.depth[asked],
        volumes=volumes[asked],
    )


def _wall_depths(stock: Stock, both: _Compared, parts: Parts, tree: SkinTree, count: int) -> Array:
    """The greatest distance (count + 1,) [m] from the target of points of the stock's skin beside each region.

    A column stands up to a cell beside the wall that it belongs to; the skin has the real place of walls.
    """
    from gcodesim.material.deviation_kernels import regions_beside
    from gcodesim.material.distance_kernels import skin_distances

    deepest = np.zeros(count + 1)
    if both.comb.turned:  # radii are exact
        return deepest
    skin = stock.surface(0.0)
    a, b, c = (skin.vertices[skin.faces[:, k]] for k in range(3))
    # corners of a wall lie where it begins and ends, often on the skin of the target, so its middle is asked as well
    points = np.concatenate((skin.vertices, (a + b + c) / 3.0, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)))
    region = np.zeros(len(points), np.int32)
    regions_beside(parts, both.comb, points, region)
    near = np.flatnonzero(region)
    distance = np.zeros(len(near))
    skin_distances(tree, np.ascontiguousarray(points[near]), FAR, distance)
    np.maximum.at(deepest, region[near], distance)
    return deepest


def _skin_areas(both: _Compared, parts: Parts, tree: SkinTree, tolerance: float, count: int) -> Array:
    """The skin of the target, and of it that beside each region (count + 1,) [m²]."""
    from gcodesim.material.deviation_kernels import share_skin

    corners = tree.triangles.reshape(-1, 3, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    whole = 0.5 * float(np.sqrt(np.square(normals).sum(axis=1)).sum())
    areas = np.zeros(count + 1)
    if count == 0:
        areas[0] = whole
        return areas
    spacing = max(0.5 * both.cell, float(np.sqrt(whole / SKIN_POINTS)))
    share_skin(tree.triangles, parts, both.comb, tolerance, spacing, areas)
    return areas
