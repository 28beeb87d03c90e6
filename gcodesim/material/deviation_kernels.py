"""Stock against target, column by column: parts of columns that are only in one of both, and how they hang together.

Both stand as columns in the same places, so every part is exact where its column is; what is narrower than the distance
of two columns can lie between them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.compiled import kernel
from gcodesim.material.distance_kernels import DEEPEST, SkinTree, skin_distance
from gcodesim.material.field_kernels import Columns, Grid

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

EXCESS, GOUGE = 1, -1

SHORTEST = 1.0e-7
"""Parts [m] shorter than this are rounding."""

FAR = 1.0e3
"""A distance [m] that nothing has."""


class Comb(NamedTuple):
    """Where columns stand. Upright ones: at the middles of the cells of `grid` in x and y, with s for z.

    `turned` ones stand on the axis of a lathe: x of the grid is z, column j points along (cosine, sine) (ny,), and s is
    the radius.
    """

    grid: Grid
    turned: bool
    cosine: Array
    sine: Array


class Parts(NamedTuple):
    """m parts of columns that are only in the stock (side EXCESS) or only in the target (GOUGE), by columns.

    `first` (columns + 1,): where the parts of each column begin; column (i, j) is i ny + j. A part runs from lo to hi
    (m,); `cut` (m,): bit 0 if the skin of the stock ends it below, bit 1 above. `body` (m,) is the body of the stock
    that it belongs to (0 for a GOUGE). `depth` (m,) [m] is the greatest distance from the skin of the target that was
    found, at the place `at` (m,); region (m,): 0 none.
    """

    first: NDArray[np.int64]
    column: Ints
    side: NDArray[np.int8]
    lo: Array
    hi: Array
    cut: NDArray[np.int8]
    body: Ints
    depth: Array
    at: Array
    region: Ints


@kernel(lean=True)
def point_of(comb: Comb, i: int, j: int, s: float) -> tuple[float, float, float]:
    """The point at s on column (i, j)."""
    u = comb.grid.x + (i + 0.5) * comb.grid.dx
    if comb.turned:
        return s * comb.cosine[j], s * comb.sine[j], u
    return u, comb.grid.y + (j + 0.5) * comb.grid.dy, s


@kernel(lean=True)
def root_of(parent: Ints, k: int) -> int:
    """The first member of the set of k; the way there becomes shorter."""
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


@kernel(lean=True)
def unite(parent: Ints, a: int, b: int) -> None:
    """One set of two; its first member is the least."""
    a, b = root_of(parent, a), root_of(parent, b)
    if a < b:
        parent[b] = a
    elif b < a:
        parent[a] = b


@kernel
def label_bodies(columns: Columns, first: NDArray[np.int64], closed: bool, parent: Ints) -> None:
    """Which intervals hang together: `parent` (intervals,) becomes the first interval of each body.

    `first` (nx ny + 1,): the number of intervals before each column; `closed`: the last column of a row is beside the
    first one.
    """
    lo, hi, count = columns
    nx, ny = count.shape
    for k in range(parent.shape[0]):
        parent[k] = k
    for i in range(nx):
        for j in range(ny):
            for way in range(2):
                ii, jj = (i + 1, j) if way == 0 else (i, j + 1)
                if jj == ny and closed and ny > 2:
                    jj = 0
                if ii >= nx or jj >= ny:
                    continue
                for a in range(count[i, j]):
                    for b in range(count[ii, jj]):
                        if min(hi[i, j, a], hi[ii, jj, b]) > max(lo[i, j, a], lo[ii, jj, b]):
                            unite(parent, first[i * ny + j] + a, first[ii * ny + jj] + b)
    for k in range(parent.shape[0]):
        parent[k] = root_of(parent, k)


@kernel(lean=True)
def weight(comb: Comb, low: float, high: float) -> float:
    """Volume [m³] that stands for the stretch low..high of a column."""
    area = comb.grid.dx * comb.grid.dy
    return area * 0.5 * (high * high - low * low) if comb.turned else area * (high - low)


@kernel
def weigh_bodies(
    columns: Columns, target: Columns, comb: Comb, first: NDArray[np.int64], body: Ints, whole: Array, shared: Array
) -> None:
    """Volume [m³] of each body, and how much of it is in the target too, added to the place of its first interval."""
    lo, hi, count = columns
    nx, ny = count.shape
    for i in range(nx):
        for j in range(ny):
            for a in range(count[i, j]):
                own = body[first[i * ny + j] + a]
                whole[own] += weight(comb, lo[i, j, a], hi[i, j, a])
                for b in range(target.number[i, j]):
                    low, high = max(lo[i, j, a], target.lo[i, j, b]), min(hi[i, j, a], target.hi[i, j, b])
                    if high > low:
                        shared[own] += weight(comb, low, high)


@kernel(lean=True)
def store_part(parts: Parts, m: int, column: int, side: int, low: float, high: float, cut: int, body: int) -> int:
    """Write part m unless it is too short, and unless there is no room, which counts only; the next number."""
    if high - low < SHORTEST:
        return m
    if m < parts.lo.shape[0]:
        parts.column[m], parts.side[m], parts.cut[m], parts.body[m] = column, side, cut, body
        parts.lo[m], parts.hi[m] = low, high
    return m + 1


@kernel(lean=True)
def rest(a: Columns, b: Columns, i: int, j: int, k: int, side: int, body: int, parts: Parts, m: int) -> int:
    """The parts of interval k of `a` that are not in `b`, from number m on; the number after them."""
    low, high = a.lo[i, j, k], a.hi[i, j, k]
    column = i * a.number.shape[1] + j
    own, other = (1, 0) if side == EXCESS else (0, 1)  # whether the stock is what ends a part: by a, by b
    at, ended_by = low, own
    for t in range(b.number[i, j]):
        if b.hi[i, j, t] <= at:
            continue
        if b.lo[i, j, t] >= high:
            break
        if b.lo[i, j, t] > at:
            m = store_part(parts, m, column, side, at, b.lo[i, j, t], ended_by + 2 * other, body)
        at, ended_by = b.hi[i, j, t], other
    if at < high:
        m = store_part(parts, m, column, side, at, high, ended_by + 2 * own, body)
    return m


@kernel
def find_parts(stock: Columns, target: Columns, first: NDArray[np.int64], body: Ints, parts: Parts) -> int:
    """All parts, as far as there is room; their number. first, body: as in `label_bodies`, of the stock."""
    nx, ny = stock.number.shape
    m = 0
    for i in range(nx):
        for j in range(ny):
            column = i * ny + j
            parts.first[column] = m
            for k in range(stock.number[i, j]):
                m = rest(stock, target, i, j, k, EXCESS, body[first[column] + k], parts, m)
            for k in range(target.number[i, j]):
                m = rest(target, stock, i, j, k, GOUGE, 0, parts, m)
    parts.first[nx * ny] = m
    return m


@kernel(lean=True)
def depth_at(parts: Parts, m: int, s: float, comb: Comb, tree: SkinTree, waiting: NDArray[np.int64]) -> float:
    """Distance [m] of the point at s of part m from the skin of the target; keeps the greatest."""
    most = FAR  # where the skin of the target ends the part, the point is no farther from it than from there
    if parts.cut[m] & 1 == 0:
        most = min(most, s - parts.lo[m] + 1e-9)
    if parts.cut[m] & 2 == 0:
        most = min(most, parts.hi[m] - s + 1e-9)
    ny = comb.cosine.shape[0]
    x, y, z = point_of(comb, parts.column[m] // ny, parts.column[m] % ny, s)
    depth = skin_distance(tree, x, y, z, most, waiting)
    if depth > parts.depth[m]:
        parts.depth[m], parts.at[m] = depth, s
    return depth


@kernel
def measure(parts: Parts, comb: Comb, tree: SkinTree, tolerance: float, step: float) -> None:
    """Depths of all parts that may be deeper than `tolerance` [m], and of others that may be the deepest of their side.

    Along a column the distance changes by no more than the way, so a point leaves out all that it rules out; `step`
    [m] is the least way between two points.
    """
    waiting = np.zeros(DEEPEST, np.int64)
    deepest = np.zeros(3)
    for m in range(parts.lo.shape[0]):
        low, high = parts.lo[m], parts.hi[m]
        length, side = high - low, parts.side[m] + 1
        single = parts.cut[m] == 1 or parts.cut[m] == 2
        reach = length if single else 0.5 * length
        if parts.cut[m] != 3 and reach <= tolerance and reach <= deepest[side]:
            continue
        if parts.cut[m] & 1:
            depth_at(parts, m, low, comb, tree, waiting)
        if parts.cut[m] & 2:
            depth_at(parts, m, high, comb, tree, waiting)
        if length > step:
            depth_at(parts, m, 0.5 * (low + high), comb, tree, waiting)
        if length > 16.0 * step:
            depth_at(parts, m, 0.75 * low + 0.25 * high, comb, tree, waiting)
            depth_at(parts, m, 0.25 * low + 0.75 * high, comb, tree, waiting)
        s = low
        while parts.depth[m] <= tolerance and s < high and reach > tolerance:
            depth = depth_at(parts, m, s, comb, tree, waiting)
            s += max(step, tolerance - depth)
        deepest[side] = max(deepest[side], parts.depth[m])


@kernel
def refine(parts: Parts, chosen: NDArray[np.int64], comb: Comb, tree: SkinTree, step: float) -> None:
    """The greatest depths of the `chosen` parts, up to half of `step` [m]."""
    waiting = np.zeros(DEEPEST, np.int64)
    for c in range(chosen.shape[0]):
        m = chosen[c]
        s = parts.lo[m]
        while s < parts.hi[m]:
            depth = depth_at(parts, m, s, comb, tree, waiting)
            s += max(step, parts.depth[m] - depth)


@kernel(lean=True)
def beside(comb: Comb, columns: int, column: int, way: int) -> int:
    """One of the eight columns around a column, or -1 at a border."""
    ny = comb.cosine.shape[0]
    i, j = column // ny, column % ny
    place = way if way < 4 else way + 1
    i, j = i + place // 3 - 1, j + place % 3 - 1
    if comb.turned and ny > 2:
        j = (j + ny) % ny
    if i < 0 or j < 0 or j >= ny or i * ny + j >= columns:
        return -1
    return int(i * ny + j)


@kernel
def join_parts(parts: Parts, comb: Comb, tolerance: float, slack: float) -> int:
    """Regions: parts deeper than `tolerance` that hang together, also across a gap of `slack` [m]; their number."""
    columns = parts.first.shape[0] - 1
    parent = np.arange(parts.lo.shape[0]).astype(np.int32)
    for m in range(parts.lo.shape[0]):
        if parts.depth[m] <= tolerance:
            continue
        for way in range(9):
            column = parts.column[m] if way == 8 else beside(comb, columns, parts.column[m], way)
            if column < 0:
                continue
            for n in range(parts.first[column], parts.first[column + 1]):
                if n < m and parts.side[n] == parts.side[m] and parts.depth[n] > tolerance:
                    near = way == 8 or parts.body[n] == parts.body[m]
                    if near and parts.lo[n] <= parts.hi[m] + slack and parts.lo[m] <= parts.hi[n] + slack:
                        unite(parent, m, n)
    regions = 0
    for m in range(parts.lo.shape[0]):
        if parts.depth[m] <= tolerance:
            continue
        first = root_of(parent, m)
        if first == m:
            regions += 1
            parts.region[m] = regions
        else:
            parts.region[m] = parts.region[first]
    return regions


@kernel
def grow_regions(parts: Parts, comb: Comb, layers: int) -> None:
    """Add to each region the shallow parts beside it, up to so many columns away: its rim inside of the band."""
    columns = parts.first.shape[0] - 1
    for _ in range(layers):
        before = parts.region.copy()
        for m in range(parts.lo.shape[0]):
            if before[m] > 0:
                continue
            for way in range(8):
                column = beside(comb, columns, parts.column[m], way)
                if column < 0:
                    continue
                for n in range(parts.first[column], parts.first[column + 1]):
                    if before[n] > 0 and parts.side[n] == parts.side[m] and parts.body[n] == parts.body[m]:
                        shares = min(parts.hi[n], parts.hi[m]) > max(parts.lo[n], parts.lo[m])
                        if shares and (parts.region[m] == 0 or before[n] < parts.region[m]):
                            parts.region[m] = before[n]


@kernel(lean=True)
def region_at(parts: Parts, comb: Comb, side: int, x: float, y: float, z: float) -> int:
    """The region of a side in which a point lies, 0 if in none; by the column nearest to it."""
    ny = comb.cosine.shape[0]
    nx = (parts.first.shape[0] - 1) // ny
    if comb.turned:
        s = float(np.sqrt(x * x + y * y))
        i = int(np.floor((z - comb.grid.x) / comb.grid.dx))
        j = int(np.floor((atan2(y, x) - comb.grid.y) / comb.grid.dy)) % ny
    else:
        s = z
        i = int(np.floor((x - comb.grid.x) / comb.grid.dx))
        j = int(np.floor((y - comb.grid.y) / comb.grid.dy))
    if i < 0 or j < 0 or i >= nx or j >= ny:
        return 0
    for m in range(parts.first[i * ny + j], parts.first[i * ny + j + 1]):
        if parts.region[m] > 0 and parts.side[m] == side and parts.lo[m] <= s <= parts.hi[m]:
            return int(parts.region[m])
    return 0


@kernel
def share_skin(triangles: Array, parts: Parts, comb: Comb, tolerance: float, spacing: float, areas: Array) -> None:
    """Add to `areas` (regions + 1,) [m²] the skin of the target beside which each region lies; all of it to the first.

    triangles (f, 9), counter-clockwise from outside; they are looked at in points about `spacing` [m] apart. Those of
    something round are long and narrow, so points stand in rows beside the longest side.
    """
    t = np.zeros(9)
    for f in range(triangles.shape[0]):
        length = longest_first(triangles[f], t)
        bx, by, bz = t[3] - t[0], t[4] - t[1], t[5] - t[2]
        cx, cy, cz = t[6] - t[0], t[7] - t[1], t[8] - t[2]
        nx, ny, nz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
        twice = float(np.sqrt(nx * nx + ny * ny + nz * nz))
        if twice == 0.0:
            continue
        nx, ny, nz = nx / twice * tolerance, ny / twice * tolerance, nz / twice * tolerance
        areas[0] += 0.5 * twice
        rows = points_on(twice / length, spacing)
        for row in range(rows):
            lower, upper = (
                1.0 - row / rows,
                1.0 - (row + 1) / rows,
            )  # the widths of the row, as shares of the longest side
            w = (row + (lower + 2.0 * upper) / (3.0 * (lower + upper))) / rows
            many = points_on((1.0 - w) * length, spacing)
            small = 0.5 * twice * (lower * lower - upper * upper) / many
            for k in range(many):
                v = (1.0 - w) * (k + 0.5) / many
                x, y, z = t[0] + v * bx + w * cx, t[1] + v * by + w * cy, t[2] + v * bz + w * cz
                region = region_at(parts, comb, EXCESS, x + nx, y + ny, z + nz)
                if region == 0:
                    region = region_at(parts, comb, GOUGE, x - nx, y - ny, z - nz)
                if region > 0:
                    areas[region] += small


@kernel(lean=True)
def longest_first(triangle: Array, out: Array) -> float:
    """A triangle (9,) into `out` (9,), turned so that its longest side comes first; the length of that side."""
    longest, first = -1.0, 0
    for k in range(3):
        a, b = 3 * k, 3 * ((k + 1) % 3)
        x, y, z = triangle[b] - triangle[a], triangle[b + 1] - triangle[a + 1], triangle[b + 2] - triangle[a + 2]
        if x * x + y * y + z * z > longest:
            longest, first = x * x + y * y + z * z, a
    for k in range(9):
        out[k] = triangle[(first + k) % 9]
    return float(np.sqrt(longest))


@kernel(lean=True)
def points_on(length: float, spacing: float) -> int:
    """How many points stand about `spacing` apart on a length [m]."""
    return int(max(1.0, min(2000.0, np.ceil(length / spacing))))


@kernel
def regions_beside(parts: Parts, comb: Comb, points: Array, region: Ints) -> None:
    """The region (n,) of points (n, 3) between upright columns: one at whose part a point lies, 0 where there is none.

    A point counts with the columns around it, if it is no farther above or below a part than a tenth of a cell.
    """
    grid, ny = comb.grid, comb.cosine.shape[0]
    nx = (parts.first.shape[0] - 1) // ny
    slack = 0.1 * max(grid.dx, grid.dy)
    for p in range(points.shape[0]):
        i = int(np.floor((points[p, 0] - grid.x) / grid.dx - 0.5))
        j = int(np.floor((points[p, 1] - grid.y) / grid.dy - 0.5))
        for ii in range(max(i, 0), min(i + 2, nx)):
            for jj in range(max(j, 0), min(j + 2, ny)):
                for m in range(parts.first[ii * ny + jj], parts.first[ii * ny + jj + 1]):
                    if parts.region[m] > 0 and parts.lo[m] - slack <= points[p, 2] <= parts.hi[m] + slack:
                        region[p] = parts.region[m]
