"""Laying a strand by volume: what a nozzle gives goes where there is room, onto whatever lies below, and none is lost.

A piece of the way gives a volume. Its cross-section A = volume / length becomes a bead of height h, the gap below the
nozzle, and of width w = A / h + h (1 - pi / 4), a rectangle with half-round sides. Each column takes the share of that
section that lies over it, filled up from what is below. What finds no room under the nozzle goes sideways, nearest
first, and what is left then swells up beside the nozzle. Volume is conserved to rounding.

What comes while the nozzle stands is a blob: it fills the room around the tip, nearest first, as far as a strand would
reach or half a ball of its volume does, and the rest swells up as a dome. With nothing below the tip it falls, and is
not kept.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.root_kernels import cube_root
from gcodesim.compiled import kernel
from gcodesim.material.bead_kernels import Bead, bead_thickness, fill_layer, unite
from gcodesim.material.field_kernels import PATCH_SHIFT, Columns, Field
from gcodesim.material.removal_kernels import overlap
from gcodesim.material.sweep_kernels import x_of, y_of

Array = NDArray[np.float64]

ROUND = 1.0 - 0.25 * math.pi  # of the height that half-round sides take off the width
DEEPEST = 1.5  # of the nominal height: how far below the nozzle there may be support
UNDER = 1.05  # of the nominal height: below this a bead of the same layer does not count as support
LEAST = 0.25  # of the nominal height: a gap that is less says only that a neighbour is there already
WIDEST = 2.0  # of the nominal width: what is asked for beyond that flows to all sides
SLIVER = 0.1  # of the height: what is thinner at the border of a bead goes to the columns beside it
SPREAD = 1.5  # of the width: how far from a strand its material flows to the sides
AT_REST = 1.0e-9  # [m]: on a way that is shorter a nozzle stands
TINY = 1.0e-15  # [m³]


class Nozzle(NamedTuple):
    """What the nozzle is set to: nominal `width` and `height` of its bead; it fuses with what is nearer than `fuse`.

    `floor` is the underside of the stock, above which beads lie.
    """

    width: float
    height: float
    fuse: float
    floor: float


class Laid(NamedTuple):
    """What became of c pieces: `volume` in the stock, swollen `above` the nozzle, `beside` the stock [m³];
    whether there was `support` below; `width` of the bead [m]."""

    volume: Array
    above: Array
    beside: Array
    support: Array
    width: Array


class StrandRoom(NamedTuple):
    """Columns that a piece may reach, m of them: indices, share of the section, free height [m] below the nozzle.

    In place of the share `around` gives the distance [m].
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    share: Array
    free: Array


@kernel
def top_below(columns: Columns, i: int, j: int, tip: float, fuse: float) -> float:
    """Height [m] of the highest material of a column up to `tip`, which counts inside material; -inf if none."""
    lo, hi, count = columns
    for k in range(count[i, j] - 1, -1, -1):  # from above: a nozzle works near the top
        if lo[i, j, k] <= tip + fuse and hi[i, j, k] > lo[i, j, k]:
            return float(min(hi[i, j, k], tip))
    return -np.inf


@kernel
def is_between(columns: Columns, i: int, j: int, bottom: float, top: float) -> bool:
    """Whether a column has material inside [bottom, top]."""
    lo, hi, count = columns
    for k in range(count[i, j] - 1, -1, -1):
        if hi[i, j, k] <= bottom:
            return False
        if min(hi[i, j, k], top) > max(lo[i, j, k], bottom):
            return True
    return False


@kernel
def end_of_filled(columns: Columns, i: int, j: int, height: float, fuse: float, without: float) -> float:
    """The upper end [m] of the material of a column at `height`; `without` where there is none."""
    lo, hi, count = columns
    for k in range(count[i, j] - 1, -1, -1):
        if lo[i, j, k] <= height + fuse:
            return hi[i, j, k] if hi[i, j, k] >= height - fuse else without
    return without


@kernel
def hangs(columns: Columns, i: int, j: int, tip: float, nozzle: Nozzle) -> bool:
    """Whether nothing carries a bead in a column: what is there begins far below the nozzle, or within the layer.

    So it is at the round sides of a bead, and where it is a bridge.
    """
    lo, hi, count = columns
    for k in range(count[i, j] - 1, -1, -1):
        if lo[i, j, k] <= tip + nozzle.fuse and hi[i, j, k] > lo[i, j, k]:
            within = lo[i, j, k] > tip - nozzle.height + nozzle.fuse
            return bool(within or tip - hi[i, j, k] > DEEPEST * nozzle.height)
    return True


@kernel
def room_below(columns: Columns, i: int, j: int, tip: float, nozzle: Nozzle) -> float:
    """The height [m] that is free between the nozzle and what carries the bead in a column, or its own height."""
    if hangs(columns, i, j, tip, nozzle):
        return nozzle.height - overlap(columns, i, j, tip - nozzle.height, tip)
    return max(tip - top_below(columns, i, j, tip, nozzle.fuse), 0.0)


@kernel
def cell_of(field: Field, x: float, y: float) -> tuple[int, int]:
    """The column over (x, y); it may lie outside."""
    grid = field.grid
    return math.floor((x - grid.x) / grid.dx), math.floor((y - grid.y) / grid.dy)


@kernel
def carries(field: Field, x: float, y: float, tip: float, nozzle: Nozzle) -> int:
    """1 if something lies under a bead at (x, y), its own layer left out, else 0; -1 beside the stock.

    A bed that is thinner than the bead may lie within its layer, where the nozzle is pressed down.
    """
    i, j = cell_of(field, x, y)
    nx, ny = field.columns.number.shape
    if i < 0 or j < 0 or i >= nx or j >= ny:
        return -1
    under = tip - UNDER * nozzle.height
    if is_between(field.columns, i, j, tip - DEEPEST * nozzle.height, under):
        return 1
    lo, _, count = field.columns
    stands = count[i, j] > 0 and abs(lo[i, j, 0] - nozzle.floor) <= nozzle.fuse
    return 1 if stands and nozzle.floor >= under else 0


@kernel
def is_carried(field: Field, start: Array, end: Array, nozzle: Nozzle, width: float) -> bool:
    """Whether a piece lies on something: under its middle, or under either half; nobody knows what is off the stock."""
    x, y, tip = 0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]), 0.5 * (start[2] + end[2])
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.sqrt(dx * dx + dy * dy)
    middle = carries(field, x, y, tip, nozzle)
    if middle > 0 or length == 0.0:
        return middle != 0
    ox, oy = -dy / length * width / 3.0, dx / length * width / 3.0
    left = carries(field, x + ox, y + oy, tip, nozzle)
    right = carries(field, x - ox, y - oy, tip, nozzle)
    return left > 0 or right > 0 or (middle < 0 and left < 0 and right < 0)


@kernel
def gap_ahead(field: Field, start: Array, end: Array, nozzle: Nozzle) -> float:
    """The free height [m] below the nozzle just ahead of where it goes, where nothing of this strand lies yet."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return nozzle.height
    ahead = max(field.grid.dx, field.grid.dy) * 1.5
    i, j = cell_of(field, end[0] + dx / length * ahead, end[1] + dy / length * ahead)
    nx, ny = field.columns.number.shape
    if i < 0 or j < 0 or i >= nx or j >= ny:
        return nozzle.height
    return room_below(field.columns, i, j, end[2], nozzle)


@kernel
def gather(
    field: Field, start: Array, end: Array, width: float, height: float, nozzle: Nozzle
) -> tuple[StrandRoom, float]:
    """The columns of a piece with their shares of the section and their room, and the share beside the stock."""
    columns, grid = field.columns, field.grid
    nx, ny = columns.number.shape
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.sqrt(dx * dx + dy * dy)
    ux, uy = (dx / length, dy / length) if length > 0.0 else (1.0, 0.0)
    across_cell = abs(uy) * grid.dx + abs(ux) * grid.dy
    along_cell = abs(ux) * grid.dx + abs(uy) * grid.dy
    reach = 0.5 * width + 0.5 * across_cell
    far = reach + 0.5 * along_cell
    first_i = math.floor((min(start[0], end[0]) - far - grid.x) / grid.dx)
    last_i = (math.floor((max(start[0], end[0]) + far - grid.x) / grid.dx)) + 1
    first_j = math.floor((min(start[1], end[1]) - far - grid.y) / grid.dy)
    last_j = (math.floor((max(start[1], end[1]) + far - grid.y) / grid.dy)) + 1
    most = max(last_i - first_i, 0) * max(last_j - first_j, 0)
    at_i, at_j = np.empty(most, dtype=np.int64), np.empty(most, dtype=np.int64)
    share, free = np.empty(most), np.empty(most)
    m, beside = 0, 0.0
    rise = end[2] - start[2]
    for i in range(first_i, last_i):
        x = x_of(grid, i) - start[0]
        for j in range(first_j, last_j):
            y = y_of(grid, j) - start[1]
            along, across = x * ux + y * uy, y * ux - x * uy
            low, high = max(along - 0.5 * along_cell, 0.0), min(along + 0.5 * along_cell, length)
            part = high - low if length > 0.0 else (along_cell if abs(along) <= 0.5 * along_cell else 0.0)
            if part <= 0.0 or abs(across) > reach:
                continue
            weight = part * bead_thickness(across, across_cell, width, height)
            if weight <= SLIVER * part * height:
                continue
            if i < 0 or j < 0 or i >= nx or j >= ny:
                beside += weight
                continue
            tip = start[2] + rise * min(max(along / length, 0.0), 1.0) if length > 0.0 else end[2]
            at_i[m], at_j[m], free[m] = i, j, room_below(columns, i, j, tip, nozzle)
            share[m] = weight
            m += 1
    return StrandRoom(at_i[:m], at_j[:m], share[:m], free[:m]), beside


@kernel
def around(
    field: Field, start: Array, end: Array, reach: float, nozzle: Nozzle, ahead: bool, least: float
) -> StrandRoom:
    """The columns within `reach` of a piece that have more than `least` of room, each with its distance [m] from it.

    They are what a strand flows into, nearest first. Only what asks for more than the widest bead flows `ahead`: what
    the nozzle comes upon there passes for what carries the strand. None where `reach` is negative.
    """
    if reach < 0.0:
        none = np.empty(0, dtype=np.int64)
        return StrandRoom(none, none, np.empty(0), np.empty(0))
    columns, grid = field.columns, field.grid
    nx, ny = columns.number.shape
    dx, dy = end[0] - start[0], end[1] - start[1]
    length2 = dx * dx + dy * dy
    first_i = max(math.floor((min(start[0], end[0]) - reach - grid.x) / grid.dx), 0)
    last_i = min(math.floor((max(start[0], end[0]) + reach - grid.x) / grid.dx) + 1, nx)
    first_j = max(math.floor((min(start[1], end[1]) - reach - grid.y) / grid.dy), 0)
    last_j = min(math.floor((max(start[1], end[1]) + reach - grid.y) / grid.dy) + 1, ny)
    most = max(last_i - first_i, 0) * max(last_j - first_j, 0)
    at_i, at_j = np.empty(most, dtype=np.int64), np.empty(most, dtype=np.int64)
    away, free = np.empty(most), np.empty(most)
    m = 0
    for i in range(first_i, last_i):
        x = x_of(grid, i) - start[0]
        for j in range(first_j, last_j):
            y = y_of(grid, j) - start[1]
            along = (x * dx + y * dy) / length2 if length2 > 0.0 else 1.0
            if along > 1.0 and not ahead:
                continue
            along = min(max(along, 0.0), 1.0)
            ex, ey = x - along * dx, y - along * dy
            distance = math.sqrt(ex * ex + ey * ey)
            if distance > reach:
                continue
            room = room_below(columns, i, j, start[2] + along * (end[2] - start[2]), nozzle)
            if room > least:
                at_i[m], at_j[m], away[m], free[m] = i, j, distance, room
                m += 1
    return StrandRoom(at_i[:m], at_j[:m], away[:m], free[:m])


@kernel
def put(field: Field, i: int, j: int, tip: float, thickness: float, nozzle: Nozzle) -> float:
    """Put `thickness` [m] of material into a column: onto what is below the nozzle, or hanging there; -1: no interval
    is left for it. What finds no room under the nozzle stands above it."""
    columns, _, _, dirty, tops = field
    top = top_below(columns, i, j, tip, nozzle.fuse)
    bottom, added, left = top, 0.0, thickness
    if hangs(columns, i, j, tip, nozzle):
        added = fill_layer(columns, i, j, tip, thickness, Bead(nozzle.width, nozzle.height, nozzle.fuse))
        if added < 0.0:
            return -1.0
        bottom, left = tip, thickness - added
    if bottom >= tip - nozzle.fuse:  # up to the nozzle all is full: it swells above
        bottom = end_of_filled(columns, i, j, tip, nozzle.fuse, bottom)
    for _ in range(8):  # what it meets on its way up fuses with it
        if left <= 1.0e-12:
            break
        grown = unite(columns, i, j, bottom, bottom + left, nozzle.fuse)
        if grown < 0.0:
            return -1.0
        added += grown
        left -= grown
        bottom += grown
        bottom = end_of_filled(columns, i, j, bottom, nozzle.fuse, bottom)
    pi, pj = i >> PATCH_SHIFT, j >> PATCH_SHIFT
    dirty[pi, pj] = 1
    tops[pi, pj] = max(tops[pi, pj], bottom + left)
    return added


@kernel
def has_interval(columns: Columns, room: StrandRoom) -> bool:
    """Whether every column can take one more interval."""
    lo, _, count = columns
    for m in range(len(room.i)):  # noqa: SIM110  (kernels have no generators)
        if count[room.i[m], room.j[m]] >= lo.shape[2]:
            return False
    return True


@kernel
def lay_piece(
    field: Field, start: Array, end: Array, volume: float, nozzle: Nozzle, before: float
) -> tuple[float, float, float, bool, float, float]:
    """Lay `volume` [m³] along a piece; in the stock, above the nozzle, beside the stock, support, width, height.

    `before` is the height of the strand so far, 0 where it begins. A first value of -1 means that a column has no
    interval left, and nothing was done.
    """
    columns, grid = field.columns, field.grid
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = max(math.sqrt(dx * dx + dy * dy), 1.0e-9)
    section = volume / length
    height = gap_ahead(field, start, end, nozzle)
    if height < LEAST * nozzle.height:
        height = before if before > 0.0 else nozzle.height
    least = 0.25 * math.pi * height * height
    if section < least:  # a thin round strand, which does not fill the gap
        height = math.sqrt(section / (0.25 * math.pi))
        width = height
    else:
        width = section / height + ROUND * height
    width = min(width, max(WIDEST * nozzle.width, height))
    support = is_carried(field, start, end, nozzle, width)
    tip = 0.5 * (start[2] + end[2])
    room, beside = gather(field, start, end, width, height, nozzle)
    total = beside
    for m in range(len(room.share)):
        total += room.share[m]
    if total <= 0.0:
        return 0.0, 0.0, volume, support, width, height
    lost = volume * beside / total
    area = grid.dx * grid.dy
    left = 0.0
    for m in range(len(room.share)):
        wanted = volume * room.share[m] / total / area
        left += (wanted - min(wanted, room.free[m])) * area
    reach, floods = SPREAD * width if left > TINY else -1.0, width >= WIDEST * nozzle.width
    wide = around(field, start, end, reach, nozzle, floods, 0.0)  # as it is before anything is put
    if not has_interval(columns, room) or not has_interval(columns, wide):
        return -1.0, 0.0, 0.0, support, width, height
    inside = 0.0
    for m in range(len(room.share)):
        given = min(volume * room.share[m] / total / area, room.free[m])
        if given > 0.0:
            inside += put(field, room.i[m], room.j[m], tip, given, nozzle) * area
    for _ in range(len(wide.share)):  # sideways, as far as there is room
        if left <= TINY:
            break
        nearest = np.argmin(wide.share)
        wide.share[nearest] = np.inf
        i, j = wide.i[nearest], wide.j[nearest]
        free = room_below(columns, i, j, tip, nozzle)
        if free > 0.0:
            added = put(field, i, j, tip, min(left / area, free), nozzle) * area
            inside += added
            left -= added
    above = 0.0
    if left > TINY:
        total -= beside
        for m in range(len(room.share)):
            above += put(field, room.i[m], room.j[m], tip, left * room.share[m] / total / area, nozzle) * area
    return inside + above, above, lost, support, width, height


@kernel
def lay_blob(field: Field, at: Array, volume: float, nozzle: Nozzle, before: float) -> tuple[float, float, float]:
    """Lay `volume` [m³] where the nozzle stands; in the stock, above the nozzle, fallen with nothing below.

    `before` is what came out there already. A first value of -1 means that a column has no interval left, and nothing
    was done.
    """
    columns, grid = field.columns, field.grid
    i, j = cell_of(field, at[0], at[1])
    nx, ny = columns.number.shape
    if i < 0 or j < 0 or i >= nx or j >= ny:
        return 0.0, 0.0, volume
    if at[2] - top_below(columns, i, j, at[2], nozzle.fuse) > DEEPEST * nozzle.height:
        return 0.0, 0.0, volume
    ball = cube_root(1.5 / math.pi * (before + volume))
    reach = max(SPREAD * WIDEST * nozzle.width, ball, math.hypot(grid.dx, grid.dy))
    room = around(field, at, at, reach, nozzle, True, -1.0)
    if not has_interval(columns, room):
        return -1.0, 0.0, 0.0
    area, left, inside = grid.dx * grid.dy, volume, 0.0
    for m in np.argsort(room.share, kind="mergesort"):
        if left <= TINY:
            break
        if room.free[m] > 0.0:
            added = put(field, room.i[m], room.j[m], at[2], min(left / area, room.free[m]), nozzle) * area
            inside += added
            left -= added
    if left <= TINY:
        return inside, 0.0, 0.0
    total = 0.0
    for m in range(len(room.share)):
        room.free[m] = math.sqrt(max(reach * reach - room.share[m] * room.share[m], 0.0))  # of the dome, its shape
        total += room.free[m]
    above = 0.0
    for m in range(len(room.share)):
        above += put(field, room.i[m], room.j[m], at[2], left * room.free[m] / total / area, nozzle) * area
    return inside + above, above, 0.0


@kernel
def lay(
    field: Field, ways: Array, volumes: Array, sizes: Array, carry: Array, floor: float, first: int, laid: Laid
) -> int:
    """Lay pieces `first`… in order; the index of the piece that found no room, or their number.

    ways (c, 6): start and end of the nozzle tip in S [m]; volumes (c,) [m³], none where it is not positive; sizes
    (c, 2): nominal width and height [m]; `floor` is the underside of the stock; carry (5,): where the last piece ended,
    the height of its strand, and what has come out since the nozzle stands there. A blob's support and width are 0. To
    go on after a stop, give the columns more room and call again.
    """
    pieces = len(ways)
    for p in range(first, pieces):
        start, end = ways[p, :3], ways[p, 3:]
        if volumes[p] <= 0.0:
            continue
        nozzle = Nozzle(sizes[p, 0], sizes[p, 1], 1.0e-9, floor)
        goes_on = np.max(np.abs(carry[:3] - start)) < AT_REST
        if np.max(np.abs(end - start)) < AT_REST:
            before = carry[4] if goes_on else 0.0
            inside, above, beside = lay_blob(field, end, volumes[p], nozzle, before)
            if inside < 0.0:
                return p
            laid.volume[p], laid.above[p], laid.beside[p] = inside, above, beside
            carry[:3], carry[3], carry[4] = end, nozzle.height, before + volumes[p]
            continue
        inside, above, beside, support, width, height = lay_piece(
            field, start, end, volumes[p], nozzle, carry[3] if goes_on else 0.0
        )
        if inside < 0.0:
            return p
        laid.volume[p], laid.above[p], laid.beside[p] = inside, above, beside
        laid.support[p], laid.width[p] = 1.0 if support else 0.0, width
        carry[:3], carry[3], carry[4] = end, height, 0.0
    return pieces
