"""Force on an upright cutter from the stock around it, averaged over a revolution and at its worst angle.

Which part of the edge is in material is asked where the edge will be next: a
point of the cutter's surface at height z and angle phi is moved ahead, onto a
circle that is larger by the diagonal of a cell, and kept inside the width that
the tool sweeps. So none of the four columns that are asked is one that the
tool has cut already: a slot counts as full from wall to wall wherever it lies
on the grid, and force does not ripple from cell to cell. A tool that follows
its own finished wall touches nothing.

Frame K: X (u) along the horizontal feed, Y (l) to its left, Z up to the holder; phi runs clockwise from Y
(spindle M3). On an element of edge of width b with chip thickness h = c (v . n):
dF = -dFt t - dFr n - dFa e, with t along the cutting velocity, n the outward normal of the edge, e along the edge
away from the tip; each of Ft, Fr, Fa = b (K h**p + E) (see `laws`). b has no 1/cos(helix) (Altintas 2012, sec. 2.8).
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
TABLE = 1025  # points of x**p on 0..1

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

# columns of the result of `cutting_force`
FORCE, TORQUE, CHIP, DEPTH, WIDTH, ENTRY, EXIT, CONTACT = 0, 6, 7, 8, 9, 10, 11, 12
RESULT = 13


@kernel(lean=True)
def power_table(laws: Array, table: Array) -> None:
    """Fill `table` (3, TABLE) with x**p on 0..1 for the exponents laws[:, 1]: a power costs more than all the rest."""
    for component in range(3):
        for i in range(table.shape[1]):
            table[component, i] = (i / (table.shape[1] - 1.0)) ** laws[component, 1]


@kernel(lean=True)
def power_at(table: Array, component: int, left: int, part: float) -> float:
    """Value between point `left` of `table` and the next, `part` of the way."""
    value: float = (1.0 - part) * table[component, left] + part * table[component, left + 1]
    return value


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
    nx, ny = count.shape
    ahead, aside = clearances(grid, ux, uy)
    frame = grid_frame(grid, tip, ux, uy)
    single = lo.shape[2] == 1 and nx > 1 and ny > 1  # nearly always
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
        line[front_end:back_begin] = ELSEWHERE
        for begin, end in ((0, front_end), (back_begin, last)):
            lay_places(
                sines[begin:end], cosines[begin:end], radius, outer, ahead, inside, level, climb, least_way, frame,
                us[begin:end], vs[begin:end], ups[begin:end],
            )  # fmt: skip
            if single:
                read_single(
                    lows, highs, np.float64(nx - 2), np.float64(ny - 2), np.uint64(ny), us[begin:end], vs[begin:end],
                    ups[begin:end], bottom, top, line[begin:end],
                )  # fmt: skip
            else:
                line[begin:end] = ELSEWHERE
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
def locate_edge(weights: Array, i: int, k: int, fraction: float) -> None:
    """Move the limit between angles k-1 and k of row i: it lies `fraction` (0..1) of the way."""
    shift = fraction - 0.5
    before, here = weights[i, k - 1], weights[i, k]
    if shift > 0.0:
        weights[i, k] = (1.0 - shift) * here + shift * before
    else:
        weights[i, k - 1] = (1.0 + shift) * before - shift * here


@kernel(lean=True)
def contact_of_cylinder(
    lo: Array, hi: Array, count: Ints, grid: Array, circle: Array, tip: Array, ux: float, uy: float, level: float,
    climb: float, rows: Array, first: int, number: int, weights: Array, line: Array, places: Array,
) -> bool:  # fmt: skip
    """The same for all rows of a cylinder at once, first..first+number: they stand above each other."""
    nx, ny = count.shape
    ahead, aside = clearances(grid, ux, uy)
    half = ANGLES // 2
    radius, outer = rows[first, 0], rows[first, 7] + ahead
    share, us, vs, ups = places[0, :half], places[1, :half], places[2, :half], places[3, :half]
    bottom, top = tip[2] + rows[first, 5], tip[2] + rows[first + number - 1, 6]
    height = (top - bottom) / number
    if lo.shape[2] == 1 and nx > 1 and ny > 1:
        lay_places(
            circle[0, :half], circle[1, :half], radius, outer, ahead, max(radius - aside, 0.0), level, climb, 0.0,
            grid_frame(grid, tip, ux, uy), us, vs, ups,
        )  # fmt: skip
        read_single(
            lo.reshape(lo.size), hi.reshape(hi.size), np.float64(nx - 2), np.float64(ny - 2), np.uint64(ny), us, vs,
            ups, bottom, top, share,
        )  # fmt: skip
    else:
        share[:] = ELSEWHERE
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
def lay_rows(edge: Array, height: float, cell: float, rows: Array, piece: int) -> int:
    """Cut the part of piece `piece` of the edge (k, 8) below `height` [m] into rows; returns their number.

    See `Cutter.edge` for the columns of a piece and `ask_rows` for those of a row.
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
def unit_forces(
    laws: Array, table: Array, scale: Array, circle: Array, level: float, climb: float, sin_kappa: float,
    cos_kappa: float, begin: int, end: int, unit: Array,
) -> None:  # fmt: skip
    """Fill unit[:, begin:end] with force per width [N/m] at each angle: tangential, inward (radial), along the axis.

    scale (3,): K c**p of each component; angles at which the edge does not advance get 0.
    """
    sines, unit_t, unit_r, unit_a = circle[0, begin:end], unit[0, begin:end], unit[1, begin:end], unit[2, begin:end]
    fall = climb * cos_kappa
    if laws[0, 1] == 1.0 and laws[1, 1] == 1.0 and laws[2, 1] == 1.0:
        for k in range(sines.shape[0]):
            advance = level * sines[k] * sin_kappa - fall
            grown = min(advance, 1.0)
            normal, axial = scale[1] * grown + laws[1, 2], scale[2] * grown + laws[2, 2]
            cuts = advance > LEAST_ADVANCE
            unit_t[k] = scale[0] * grown + laws[0, 2] if cuts else 0.0
            unit_r[k] = normal * sin_kappa + axial * cos_kappa if cuts else 0.0
            unit_a[k] = normal * cos_kappa - axial * sin_kappa if cuts else 0.0
        return
    common = laws[0, 1] == laws[1, 1] and laws[0, 1] == laws[2, 1]
    for k in range(sines.shape[0]):
        advance = min(level * sines[k] * sin_kappa - fall, 1.0)
        if advance <= LEAST_ADVANCE:
            unit_t[k], unit_r[k], unit_a[k] = 0.0, 0.0, 0.0
            continue
        place = advance * (TABLE - 1)
        left = min(int(place), TABLE - 2)
        part = place - left
        grown_t = power_at(table, 0, left, part)
        grown_r, grown_a = grown_t, grown_t
        if not common:
            grown_r, grown_a = power_at(table, 1, left, part), power_at(table, 2, left, part)
        normal, axial = scale[1] * grown_r + laws[1, 2], scale[2] * grown_a + laws[2, 2]
        unit_t[k] = scale[0] * grown_t + laws[0, 2]
        unit_r[k] = normal * sin_kappa + axial * cos_kappa
        unit_a[k] = normal * cos_kappa - axial * sin_kappa


@kernel(lean=True)
def add_row(
    circle: Array, unit: Array, weights: Array, r: float, z: float, width: float, begin: int, end: int,
    force_u: Array, force_l: Array, force_z: Array, sums: Array,
) -> None:  # fmt: skip
    """Force of one row (ANGLES,) on one tooth along u, l, z [N], and its part in `sums` (SUMS, ANGLES).

    Only angles begin..end, the others carry none and are not written.

    Sums over rows stay apart by angle: so this loop has no dependence between its turns.
    """
    # slices, because an index of which the compiler cannot see that it is not negative keeps it to one angle at a time
    sines, cosines, share = circle[0, begin:end], circle[1, begin:end], weights[begin:end]
    unit_t, unit_r, unit_a = unit[0, begin:end], unit[1, begin:end], unit[2, begin:end]
    f_u, f_l, f_z = force_u[begin:end], force_l[begin:end], force_z[begin:end]
    all_u, all_l, all_z = sums[0, begin:end], sums[1, begin:end], sums[2, begin:end]
    tilt_u, tilt_l, lift = sums[3, begin:end], sums[4, begin:end], sums[5, begin:end]
    torque, contact, most, widest = sums[6, begin:end], sums[7, begin:end], sums[8, begin:end], sums[9, begin:end]
    for k in range(share.shape[0]):
        b = share[k] * width
        tangential, inward = b * unit_t[k], b * unit_r[k]
        a_u = -tangential * cosines[k] - inward * sines[k]
        a_l = tangential * sines[k] - inward * cosines[k]
        a_z = b * unit_a[k]
        f_u[k], f_l[k], f_z[k] = a_u, a_l, a_z
        all_u[k] += a_u
        all_l[k] += a_l
        all_z[k] += a_z
        tilt_u[k] += z * a_u
        tilt_l[k] += z * a_l
        lift[k] += r * a_z
        torque[k] += r * tangential
        contact[k] += share[k]
        most[k] = max(most[k], share[k])
        widest[k] = max(widest[k], share[k] * r)


SUMS = 10
SPARE = 9  # rows below the sums: unit forces (until then shares), places, components, slices, one for the caller


@kernel(lean=True)
def cutting_force(
    lo: Array, hi: Array, count: Ints, grid: Array, tool: Array, edge: Array, laws: Array, table: Array,
    circle: Array, tip: Array, ux: float, uy: float, level: float, climb: float, chip: float, top: float,
    rows: Array, weights: Array, force: Array, sums: Array, result: Array,
) -> int:  # fmt: skip
    """Mean force over a revolution with the tip at `tip` [m]; returns the number of rows filled in `rows`, `force`.

    tool (4,): radius, flutes, tan(helix), height of the edge; circle (2, ANGLES): sine, cosine of phi;
    ux, uy: horizontal direction of the feed; level, climb: its horizontal and vertical share (unit vector);
    chip [m]: feed per tooth; top [m]: no material is higher near the tool.
    rows (ROWS, COLUMNS), sums (SUMS + SPARE, ANGLES): scratch;
    force (3, ROWS, ANGLES) [N]: on one tooth per row and angle, along u, l, z, within the range of each row.
    result (RESULT,): wrench about the tip in S (6), torque, greatest chip thickness, axial depth, radial width,
    entry and exit angle, and the sum of engaged elements (0: no contact).
    """
    result[:] = 0.0
    height = min(tool[3], top - tip[2])
    if height <= min(STEEPEST * max(grid[2], grid[3]) * climb, 0.0):
        return 0
    height = max(height, 1.0e-9)  # downwards the lowest rows ask for what is still below the tip
    last = ANGLES if climb < 0.0 else ANGLES // 2  # nothing behind the tool cuts unless it goes down
    scale, line = sums[SUMS + 6], sums[SUMS + 7]
    for component in range(3):
        scale[component] = laws[component, 0] * chip ** laws[component, 1] if chip > 0.0 else 0.0
    unit = sums[SUMS : SUMS + 3]
    sums[:SUMS] = 0.0
    used = 0
    steepest = 0.0
    for piece in range(edge.shape[0]):
        number = lay_rows(edge, height, max(grid[2], grid[3]), rows[used:], piece)
        if number == 0:
            continue
        first, end = used, used + number - 1
        touched = False
        if max(level * rows[first, 2] - climb * rows[first, 3], level * rows[end, 2] - climb * rows[end, 3]) <= (
            LEAST_ADVANCE
        ):
            continue  # no angle at which this piece advances: a flat bottom in a level cut
        if edge[piece, 0] == 0.0 and rows[first, 3] < UPRIGHT:
            touched = contact_of_cylinder(
                lo, hi, count, grid, circle, tip, ux, uy, level, climb, rows, first, number, weights, line,
                sums[SUMS + 2 : SUMS + 6],
            )  # fmt: skip
        else:
            touched = contact_of_rows(
                lo, hi, count, grid, circle, tip, ux, uy, level, climb, rows, first, number, last, weights,
                sums[SUMS + 3 : SUMS + 6],
            )  # fmt: skip
        if not touched:
            continue
        used += number
        straight = edge[piece, 0] == 0.0
        if straight:  # rows of one slope share the force per width
            begin, end = last, 0
            for i in range(first, used):
                begin, end = min(begin, int(rows[i, FROM])), max(end, int(rows[i, TO]))
            unit_forces(laws, table, scale, circle, level, climb, rows[first, 2], rows[first, 3], begin, end, unit)
        for i in range(first, used):
            begin, end = int(rows[i, FROM]), int(rows[i, TO])
            if begin >= end:
                continue
            if not straight:
                unit_forces(laws, table, scale, circle, level, climb, rows[i, 2], rows[i, 3], begin, end, unit)
            add_row(
                circle, unit, weights[i], rows[i, 0], rows[i, 1], rows[i, 4], begin, end, force[0, i], force[1, i],
                force[2, i], sums,
            )  # fmt: skip
        steepest = max(steepest, rows[used - 1, 2])
    if used == 0:
        return 0
    f_u, f_l, f_z, m_u, m_l, torque = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    delta = 2.0 * np.pi / ANGLES
    entry, leave, fullest = 2.0 * np.pi, 0.0, 0
    for k in range(last):
        f_u += sums[0, k]
        f_l += sums[1, k]
        f_z += sums[2, k]
        m_u += circle[1, k] * sums[5, k] - sums[4, k]
        m_l += sums[3, k] - circle[0, k] * sums[5, k]
        torque += sums[6, k]
        result[CONTACT] += sums[7, k]
        if sums[7, k] > sums[7, fullest]:
            fullest = k
        if circle[0, k] > 0.0:
            result[WIDTH] += sums[9, k] * circle[0, k] * delta
        w = sums[8, k]
        if w > 0.05:
            entry, leave = min(entry, (k + 1.0 - w) * delta), max(leave, (k + w) * delta)
            result[CHIP] = max(result[CHIP], chip * (level * circle[0, k] * steepest))
    if climb < 0.0:  # the bottom takes the chip of the fall
        result[CHIP] = max(result[CHIP], -chip * climb * rows[0, 3])
    if result[CONTACT] <= 0.0:
        return 0
    for i in range(used):
        result[DEPTH] += weights[i, fullest] * (rows[i, 6] - rows[i, 5])
    share = tool[1] / ANGLES
    result[0] = share * (ux * f_u - uy * f_l)
    result[1] = share * (uy * f_u + ux * f_l)
    result[2] = share * f_z
    result[3] = share * (ux * m_u - uy * m_l)
    result[4] = share * (uy * m_u + ux * m_l)
    result[5] = share * torque
    result[TORQUE] = share * torque
    if leave > entry:
        result[ENTRY], result[EXIT] = entry, leave
    return used


@kernel(lean=True)
def peak_force(tool: Array, rows: Array, force: Array, used: int, turning: Array) -> float:
    """Greatest force [N] within a revolution: all teeth and heights at once, each height late by its helix lag.

    Rows lag by z tan(helix) / radius; forces between the angles are interpolated.
    turning (3, 3 ANGLES + 1): scratch; one tooth's force over its angle at the tip, twice, then that of all teeth.
    """
    delta = 2.0 * np.pi / ANGLES
    teeth = int(tool[1])
    turning[:] = 0.0
    for i in range(used):
        begin, end = int(rows[i, FROM]), int(rows[i, TO])
        if begin >= end:
            continue
        place = (rows[i, 1] * tool[2] / tool[0] / delta) % ANGLES
        whole = int(place)
        part = place - whole
        for axis in range(3):
            source = force[axis, i]
            target = turning[axis, whole:]
            target[begin] += (1.0 - part) * source[begin]
            inner, here, earlier = target[begin + 1 : end], source[begin + 1 : end], source[begin : end - 1]
            for k in range(inner.shape[0]):
                inner[k] = inner[k] + (1.0 - part) * here[k] + part * earlier[k]
            target[end] += part * source[end - 1]
    for axis in range(3):  # both halves in one, and the first angles again behind them for what turns past the end
        one, all_teeth = turning[axis, : 2 * ANGLES + 1], turning[axis, 2 * ANGLES + 1 : 3 * ANGLES + 1]
        for k in range(ANGLES):
            one[k] += one[ANGLES + k]
            one[ANGLES + k] = one[k]
        one[2 * ANGLES] = one[0]
        for tooth in range(teeth):
            place = tooth * ANGLES / teeth
            whole = int(place)
            part = place - whole
            here, following = one[whole : whole + ANGLES], one[whole + 1 : whole + 1 + ANGLES]
            for k in range(ANGLES):
                all_teeth[k] += (1.0 - part) * here[k] + part * following[k]
    greatest = 0.0
    for k in range(ANGLES):
        square = 0.0
        for axis in range(3):
            square += turning[axis, 2 * ANGLES + 1 + k] ** 2
        greatest = max(greatest, square)
    return float(np.sqrt(greatest))
