"""Which part of an upright cutter's edge is in material, angle by angle.

It is asked where the edge will be next: a point of the cutter's surface at
height z and angle phi is moved ahead, onto a circle that is larger by the
diagonal of a cell, and kept inside the width that the tool sweeps. So none of
the four columns that are asked is one that the tool has cut already: a slot
counts as full from wall to wall wherever it lies on the grid, and force does
not ripple from cell to cell. A tool that follows its own finished wall touches
nothing.

Frame K: X (u) along the horizontal feed, Y (l) to its left, Z up to the holder; phi runs clockwise from Y
(spindle M3). The edge is cut into rows, each at one height; most loops run over the angles of one row.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.kernels import fill_slices, occupancy, surrounding

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

ANGLES = 64
SLICES = 16  # elements along the engaged part of one piece of the edge, at most
LEAST_SLICES = 4  # of a cylinder, whose elements are SLICE_CELLS high between these two limits
SLICE_CELLS = 2.0
UPRIGHT = 1.0e-12  # cosine of kappa below which a straight piece is part of a cylinder
ROWS = 4 * SLICES  # room for four pieces

# Nearly all rows touch material at few angles, so each keeps the range of those; nothing else is worked on.
FROM, TO = 8, 9  # columns of `rows` (ROWS, COLUMNS)
COLUMNS = 10

# An edge that moves into material at less than this share of its speed slides on it and does not cut: the flat bottom
# of an end mill in a horizontal cut, whose commanded height is never exactly constant.
LEAST_ADVANCE = 1.0e-4

# Up to this tangent of kappa an element of a falling tool is asked so deep that its wall counts as full.
STEEPEST = 4.0

ELSEWHERE = -1.0  # no share: has to be asked column by column
THIN = 1.0e-7  # [m] least height over which material is asked for


@kernel(lean=True)
def lay_rows(edge: Array, height: float, cell: float, rows: Array, piece: int) -> int:
    """Cut the part of piece `piece` of the edge (k, 8) below `height` [m] into rows; returns their number.

    See `Cutter.edge` for the columns of a piece. Those of a row: radius and height in its middle, sine and cosine of
    kappa, width, lowest and highest place, largest radius; then FROM, TO.
    """
    radius, kappa0, kappa1 = edge[piece, 0], edge[piece, 3], edge[piece, 4]
    length, z0, z1 = edge[piece, 5], edge[piece, 6], edge[piece, 7]
    if z0 >= height or length <= 0.0:
        return 0
    if radius > 0.0:
        if z1 > height:
            kappa1 = np.arccos(max((edge[piece, 2] - height) / radius, -1.0))
        step = (kappa1 - kappa0) / SLICES
        for i in range(SLICES):
            a = kappa0 + i * step
            kappa = a + 0.5 * step
            rows[i, 0] = edge[piece, 1] + radius * np.sin(kappa)
            rows[i, 1] = edge[piece, 2] - radius * np.cos(kappa)
            rows[i, 2], rows[i, 3] = np.sin(kappa), np.cos(kappa)
            rows[i, 4] = radius * step
            rows[i, 5] = edge[piece, 2] - radius * np.cos(a)
            rows[i, 6] = edge[piece, 2] - radius * np.cos(a + step)
            rows[i, 7] = edge[piece, 1] + radius * np.sin(a + step)
        return SLICES
    sine, cosine = np.sin(kappa0), np.cos(kappa0)
    if z1 > height:
        length = (height - z0) / sine
    number = SLICES
    if cosine < UPRIGHT:  # all at one radius, so that only their number over the height matters
        number = min(max(int(np.ceil(length / (SLICE_CELLS * cell))), LEAST_SLICES), SLICES)
    step = length / number
    for i in range(number):
        s = (i + 0.5) * step
        rows[i, 0], rows[i, 1] = edge[piece, 1] + s * cosine, z0 + s * sine
        rows[i, 2], rows[i, 3] = sine, cosine
        rows[i, 4] = step
        rows[i, 5], rows[i, 6] = z0 + i * step * sine, z0 + (i + 1) * step * sine
        rows[i, 7] = rows[i, 0] + 0.5 * step * cosine
    return number


@kernel(lean=True)
def clearances(grid: Array, ux: float, uy: float) -> tuple[float, float]:
    """How far [m] ahead of the cutter, and inside its width, to ask: no column around such a place is under it.

    Ahead it is the diagonal of a cell, for any direction; aside the width of a cell seen along the feed (ux, uy).
    """
    return float(np.sqrt(grid[2] * grid[2] + grid[3] * grid[3])), float(grid[2] * abs(uy) + grid[3] * abs(ux))


@kernel(lean=True)
def probe(
    r: float, outer: float, sine: float, cosine: float, ahead: float, aside: float, level: float
) -> tuple[float, float, float]:
    """Where to ask for material ahead of the point at radius r and angle phi: (x, y) along u and l, way d [m].

    outer: largest radius of the element; ahead, aside: see `clearances`; level: share of the feed that is horizontal.
    d is the way along the feed.
    """
    x, y = r * sine, r * cosine
    if sine <= 0.0:
        return x + level * ahead, y, ahead
    inside = max(r - aside, 0.0)
    wide = min(max(y, -inside), inside)
    way = np.sqrt((outer + ahead) * (outer + ahead) - wide * wide) - x
    return x + level * way, y + level * (wide - y), way


@kernel(lean=True)
def turned(sine: float, cosine: float, angle: float) -> tuple[float, float]:
    """Sine and cosine a small `angle` (up to 0.1 rad) further on; series, exact to the last digits."""
    b = angle * angle
    s = angle * (1.0 - b / 6.0 * (1.0 - b / 20.0 * (1.0 - b / 42.0)))
    c = 1.0 - b / 2.0 * (1.0 - b / 12.0 * (1.0 - b / 30.0 * (1.0 - b / 56.0)))
    return sine * c + cosine * s, cosine * c - sine * s


@kernel(lean=True)
def plunge_way(rows: Array, i: int, cell: float, level: float) -> float:
    """Least way d [m] for row i: falling, so far that columns a cell nearer to the axis, with lower floor, are full."""
    steep = STEEPEST if rows[i, 2] > STEEPEST * rows[i, 3] else rows[i, 2] / rows[i, 3]
    return float((1.0 - level) * (0.5 * (rows[i, 6] - rows[i, 5]) + cell * steep))


@kernel(lean=True)
def share_at(
    lo: Array, hi: Array, count: Ints, grid: Array, tip: Array, ux: float, uy: float, level: float, climb: float,
    cell: float, rows: Array, i: int, sine: float, cosine: float,
) -> float:  # fmt: skip
    """Share [-] of row i that is in material at one angle; see `contact_of_rows`."""
    ahead, aside = clearances(grid, ux, uy)
    px, py, way = probe(rows[i, 0], rows[i, 7], sine, cosine, ahead, aside, level)
    x, y = tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py
    rise = climb * max(way, plunge_way(rows, i, cell, level) if climb < 0.0 else 0.0)
    low = tip[2] + rows[i, 5] + rise + min(0.5 * (1.0 - level) * cell * climb, 0.0)
    high = max(tip[2] + rows[i, 6] + rise, low + THIN)
    simple, share = solid(lo, hi, count, grid, x, y, low, high)
    if simple == 1:
        return share
    return float(occupancy(lo, hi, count, grid, x, y, low, high))


@kernel(lean=True)
def solid(
    lo: Array, hi: Array, count: Ints, grid: Array, x: float, y: float, z0: float, z1: float
) -> tuple[int, float]:
    """(1, share of z0..z1 that is material) if each of the columns around (x, y) has one interval, else (0, 0).

    The common case of `occupancy`, without its loops.
    """
    i, j, wx, wy = surrounding(grid, x, y)
    if i < 0 or j < 0 or i + 1 >= count.shape[0] or j + 1 >= count.shape[1]:
        return 0, 0.0
    if count[i, j] * count[i + 1, j] * count[i, j + 1] * count[i + 1, j + 1] != 1:
        return 0, 0.0
    a = max(min(hi[i, j, 0], z1) - max(lo[i, j, 0], z0), 0.0)
    b = max(min(hi[i + 1, j, 0], z1) - max(lo[i + 1, j, 0], z0), 0.0)
    c = max(min(hi[i, j + 1, 0], z1) - max(lo[i, j + 1, 0], z0), 0.0)
    d = max(min(hi[i + 1, j + 1, 0], z1) - max(lo[i + 1, j + 1, 0], z0), 0.0)
    return 1, ((1.0 - wy) * ((1.0 - wx) * a + wx * b) + wy * ((1.0 - wx) * c + wx * d)) / (z1 - z0)


@kernel(lean=True)
def read_single(
    lo: Array, hi: Array, last_i: float, last_j: float, ny: np.uint64, us: Array, vs: Array, ups: Array, bottom: float,
    top: float, share: Array,
) -> None:  # fmt: skip
    """Share (n,) of bottom..top [m], raised by `ups`, that is material at places (us, vs) between column centres.

    For stocks of which each column has one interval; an empty one ends where it begins. Places that have no four
    columns around them get ELSEWHERE.
    """
    scale = 1.0 / (top - bottom)
    for k in range(share.shape[0]):
        u, v = min(max(us[k], 0.0), last_i), min(max(vs[k], 0.0), last_j)
        # truncation is the floor here; unsigned indices spare the check for negative ones
        i, j = np.uint64(u), np.uint64(v)
        a = i * ny + j
        b = a + ny
        z0, z1 = bottom + ups[k], top + ups[k]
        wx, wy = u - np.float64(i), v - np.float64(j)
        near = (1.0 - wx) * max(min(hi[a], z1) - max(lo[a], z0), 0.0)
        near += wx * max(min(hi[b], z1) - max(lo[b], z0), 0.0)
        a += np.uint64(1)
        b += np.uint64(1)
        far = (1.0 - wx) * max(min(hi[a], z1) - max(lo[a], z0), 0.0)
        far += wx * max(min(hi[b], z1) - max(lo[b], z0), 0.0)
        full = scale * ((1.0 - wy) * near + wy * far)
        share[k] = full if u == us[k] and v == vs[k] else ELSEWHERE


@kernel(lean=True)
def behind_range(sines: Array, gain: float, fall: float) -> int:
    """How many angles from either side of the tool backwards an element may advance, up to a quarter of the circle.

    It does where gain sin(phi) > fall; sines (ANGLES,) of the angles.
    """
    for k in range(ANGLES // 4):
        if gain * sines[k] >= -fall:
            return k
    return ANGLES // 4


@kernel(lean=True)
def grid_frame(grid: Array, tip: Array, ux: float, uy: float) -> tuple[float, float, float, float, float, float]:
    """From u, l about the tip to columns: (i0, j0, i per u, i per l, j per u, j per l); whole at centres of columns."""
    to_x, to_y = 1.0 / grid[2], 1.0 / grid[3]
    return (
        (tip[0] - grid[0]) * to_x - 0.5, (tip[1] - grid[1]) * to_y - 0.5, ux * to_x, -uy * to_x, uy * to_y, ux * to_y
    )  # fmt: skip


@kernel(lean=True)
def lay_places(
    sines: Array, cosines: Array, radius: float, outer: float, ahead: float, inside: float, level: float, climb: float,
    least_way: float, frame: tuple[float, float, float, float, float, float], us: Array, vs: Array, ups: Array,
) -> None:  # fmt: skip
    """Where to ask for material at many angles at once, as `probe` does for one: columns (us, vs), rise `ups` [m].

    outer [m]: the element's largest radius and `ahead` together; inside [m]: greatest distance to the side; least_way
    [m]: the shortest way along the feed; frame: see `grid_frame`. No branches, no dependence between turns.
    """
    i0, j0, i_u, i_l, j_u, j_l = frame
    for k in range(us.shape[0]):
        px, py = radius * sines[k], radius * cosines[k]
        wide = min(max(py, -inside), inside)
        front = sines[k] > 0.0
        way = np.sqrt(outer * outer - wide * wide) - px if front else ahead
        py = py + level * (wide - py) if front else py
        px += level * way
        us[k] = i0 + i_u * px + i_l * py
        vs[k] = j0 + j_u * px + j_l * py
        ups[k] = climb * max(way, least_way)


@kernel(lean=True)
def ask_places(
    lows: Array, highs: Array, count: Ints, us: Array, vs: Array, ups: Array, bottom: float, top: float, share: Array
) -> None:
    """Share (n,) of bottom..top [m] that is material at places from `lay_places`; ELSEWHERE where columns have more
    than one interval, or the stock is a single row. lows, highs: the ends of all intervals in one row.
    """
    nx, ny = count.shape
    if lows.shape[0] == nx * ny and nx > 1 and ny > 1:  # nearly always
        read_single(
            lows, highs, np.float64(nx - 2), np.float64(ny - 2), np.uint64(ny), us, vs, ups, bottom, top, share
        )  # fmt: skip
    else:
        share[:] = ELSEWHERE


@kernel(lean=True)
def leave_advancing(sines: Array, level: float, sin_kappa: float, fall: float, line: Array) -> bool:
    """Set the share (n,) to 0 where an element does not advance; whether any is left that is not known."""
    unknown = np.uint8(0)
    for k in range(line.shape[0]):
        share = line[k] if level * sines[k] * sin_kappa - fall > LEAST_ADVANCE else 0.0
        unknown |= np.uint8(share == ELSEWHERE)
        line[k] = share
    return bool(unknown > 0)


@kernel(lean=True)
def mark_steps(
    sines: Array, level: float, sin_kappa: float, fall: float, line: Array, copy: Array, steps: Array
) -> int:
    """Copy `line` (n,) and mark in `steps` (n,) where it changes by more than half from angle to angle, both advancing.

    Returns how many there are.
    """
    number = 0
    for k in range(line.shape[0]):
        copy[k] = line[k]
    steps[0] = 0.0
    # slices, because an index of which the compiler cannot see that it is not negative keeps it to one angle at a time
    before, after, step_after, sines_before, sines_after = line[:-1], line[1:], steps[1:], sines[:-1], sines[1:]
    for k in range(step_after.shape[0]):
        advancing = np.uint8(level * sines_after[k] * sin_kappa - fall > LEAST_ADVANCE)
        advancing &= np.uint8(level * sines_before[k] * sin_kappa - fall > LEAST_ADVANCE)
        step = advancing & np.uint8(abs(after[k] - before[k]) > 0.5)
        step_after[k] = 1.0 if step else 0.0
        number += 1 if step else 0
    return number


@kernel(lean=True)
def reach_of(share: Array, steps: Array) -> tuple[int, int]:
    """The range of angles of which `share` (n,) is not 0, or can get a part of what is across a step."""
    n = share.shape[0]
    begin, end = 0, n
    while begin < n and share[begin] <= 0.0:
        begin += 1
    if begin == n:
        return n, 0
    while share[end - 1] <= 0.0:
        end -= 1
    if steps[begin] > 0.0:
        begin -= 1
    if end < n and steps[end] > 0.0:
        end += 1
    return begin, end


@kernel(lean=True)
def locate_edge(weights: Array, i: int, k: int, fraction: float) -> None:
    """Move the limit between angles k-1 and k of row i: it lies `fraction` (0..1) of the way."""
    shift = fraction - 0.5
    before, here = weights[i, k - 1], weights[i, k]
    if shift > 0.0:
        weights[i, k] = (1.0 - shift) * here + shift * before
    else:
        weights[i, k - 1] = (1.0 + shift) * before - shift * here


@kernel(lean=True)
def contact_of_rows(
    lo: Array, hi: Array, count: Ints, grid: Array, circle: Array, tip: Array, ux: float, uy: float, level: float,
    climb: float, rows: Array, first: int, number: int, last: int, weights: Array, places: Array,
) -> bool:  # fmt: skip
    """Fill weights[first:first + number, :last]: share of each element in material at each angle at which it advances.

    0 where it does not advance. Returns whether there is any, and keeps the range of those angles in each row.

    An element is asked where it will be a way d further along the feed; falling, half a cell more is asked for
    below, so that contact grows gradually.
    Where contact begins or ends between two angles, the limit is found by halving and the weight is shared out.
    """
    cell = max(grid[2], grid[3])
    ahead, aside = clearances(grid, ux, uy)
    frame = grid_frame(grid, tip, ux, uy)
    lows, highs = lo.reshape(lo.size), hi.reshape(hi.size)
    sines, cosines, us, vs, ups = circle[0], circle[1], places[0], places[1], places[2]
    found = False
    for i in range(first, first + number):
        radius, outer = rows[i, 0], rows[i, 7] + ahead
        inside = max(radius - aside, 0.0)
        sin_kappa, fall = rows[i, 2], climb * rows[i, 3]
        least_way = plunge_way(rows, i, cell, level) if climb < 0.0 else 0.0
        bottom, top = tip[2] + rows[i, 5] + min(0.5 * (1.0 - level) * cell * climb, 0.0), tip[2] + rows[i, 6]
        top = max(top, bottom + THIN)
        line = weights[i, :last]
        behind = behind_range(sines, level * sin_kappa, LEAST_ADVANCE + fall) if last == ANGLES else 0
        front_end, back_begin = min(ANGLES // 2 + behind, last), last - behind
        line[front_end:back_begin] = ELSEWHERE  # nothing advances there; rounding may leave one to be asked by itself
        for begin, end in ((0, front_end), (back_begin, last)):
            lay_places(
                sines[begin:end], cosines[begin:end], radius, outer, ahead, inside, level, climb, least_way, frame,
                us[begin:end], vs[begin:end], ups[begin:end],
            )  # fmt: skip
            ask_places(
                lows, highs, count, us[begin:end], vs[begin:end], ups[begin:end], bottom, top, line[begin:end]
            )  # fmt: skip
        if leave_advancing(sines, level, sin_kappa, fall, line):
            for k in range(last):
                if line[k] == ELSEWHERE:
                    line[k] = share_at(
                        lo, hi, count, grid, tip, ux, uy, level, climb, cell, rows, i, sines[k], cosines[k]
                    )  # fmt: skip
        found_share, steps = us[:last], vs[:last]  # the places are not needed any more
        left = mark_steps(sines, level, sin_kappa, fall, line, found_share, steps)
        begin, end = reach_of(found_share, steps)
        for k in range(last):
            if left == 0:
                break
            if steps[k] == 0.0:
                continue
            left -= 1
            earlier, w = found_share[k - 1], found_share[k]
            least, most = 0.0, 1.0
            for _ in range(4):
                middle = 0.5 * (least + most)
                sine, cosine = turned(sines[k - 1], cosines[k - 1], middle * (2.0 * np.pi / ANGLES))
                between = share_at(lo, hi, count, grid, tip, ux, uy, level, climb, cell, rows, i, sine, cosine)
                if (between > 0.5 * (w + earlier)) == (w > earlier):
                    most = middle
                else:
                    least = middle
            locate_edge(weights, i, k, 0.5 * (least + most))
        rows[i, FROM], rows[i, TO] = begin, end
        found = found or end > begin
    return found


@kernel(lean=True)
def contact_of_cylinder(
    lo: Array, hi: Array, count: Ints, grid: Array, circle: Array, tip: Array, ux: float, uy: float, level: float,
    climb: float, rows: Array, first: int, number: int, weights: Array, line: Array, places: Array,
) -> bool:  # fmt: skip
    """The same for all rows of a cylinder at once, first..first+number: they stand above each other."""
    ahead, aside = clearances(grid, ux, uy)
    half = ANGLES // 2
    radius, outer = rows[first, 0], rows[first, 7] + ahead
    share, us, vs, ups = places[0, :half], places[1, :half], places[2, :half], places[3, :half]
    bottom, top = tip[2] + rows[first, 5], tip[2] + rows[first + number - 1, 6]
    height = (top - bottom) / number
    lay_places(
        circle[0, :half], circle[1, :half], radius, outer, ahead, max(radius - aside, 0.0), level, climb, 0.0,
        grid_frame(grid, tip, ux, uy), us, vs, ups,
    )  # fmt: skip
    ask_places(lo.reshape(lo.size), hi.reshape(hi.size), count, us, vs, ups, bottom, top, share)
    earlier = -1.0
    begin, end = half, 0
    for k in range(half):
        if level * circle[0, k] <= LEAST_ADVANCE:
            weights[first : first + number, k] = 0.0
            earlier = -1.0
            continue
        if share[k] == 0.0 or share[k] >= 1.0 - 1.0e-9:  # all of it, or nothing
            total = 0.0 if share[k] == 0.0 else 1.0
            for i in range(number):
                weights[first + i, k] = total
        else:
            px, py, way = probe(radius, rows[first, 7], circle[0, k], circle[1, k], ahead, aside, level)
            x, y = tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py
            z0 = bottom + climb * way
            total = fill_slices(lo, hi, count, grid, x, y, z0, height, line[:number]) / number
            for i in range(number):
                weights[first + i, k] = line[i]
        if earlier >= 0.0 and abs(total - earlier) > 0.5 * max(total, earlier):
            least, most = 0.0, 1.0
            for _ in range(4):
                middle = 0.5 * (least + most)
                fine_sine, fine_cosine = turned(circle[0, k - 1], circle[1, k - 1], middle * (2.0 * np.pi / ANGLES))
                px, py, way = probe(radius, rows[first, 7], fine_sine, fine_cosine, ahead, aside, level)
                z0, z1 = bottom + climb * way, top + climb * way
                x, y = tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py
                between = occupancy(lo, hi, count, grid, x, y, z0, z1)
                if (between > 0.5 * (total + earlier)) == (total > earlier):
                    most = middle
                else:
                    least = middle
            for i in range(first, first + number):
                locate_edge(weights, i, k, 0.5 * (least + most))
            begin = min(begin, k - 1)
            end = k + 1
        earlier = total
        if total > 0.0:
            begin = min(begin, k)
            end = k + 1
    weights[first : first + number, half:] = 0.0
    rows[first : first + number, FROM] = begin
    rows[first : first + number, TO] = end
    return end > begin
