"""What a cutter sweeps: the lowest and highest point over one column while the tip moves along a straight piece.

The tool stands upright (axis +Z of S). Along the piece, u is the horizontal
distance of the tip from the point nearest to the column's line, c the
horizontal distance between column and that line, m the slope dz/du. The tool's
underside is b(rho), rho = sqrt(u^2 + c^2); it is convex and rises with rho, so
m u + b(rho) has one minimum over the interval of u in which the tool stands
over the column, and that minimum is the floor of the swept volume there.
Every shape is convex, so what it sweeps over a column is one interval.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Grid

Array = NDArray[np.float64]

# Columns are sampled this far (in cells) beside their centre, differently in x and y: a wall that runs exactly
# through centres then owns them on one side only, whatever rounding does, as if walls were half open.
NUDGE_X = 1.0e-7
NUDGE_Y = 0.63e-7

TURNS = 24  # steps of Newton at most
CLOSE = 1.0e-9  # step of a sine after which the next one is none; heights change by its square

CYLINDER, BALL, BULL_NOSE, CONE = 0.0, 1.0, 2.0, 3.0  # kinds of shapes


class Shape(NamedTuple):
    """A body of revolution about the tool's axis: cutter, shank or holder. Made by `shape.py`.

    Below `top` it is a cylinder of `radius` that ends in an underside, as its `kind` says; it is convex.
    """

    kind: float  # CYLINDER, BALL, BULL_NOSE or CONE
    radius: float  # [m] of the whole
    corner: float  # radius [m] of the corner; of a ball, `radius`
    flat: float  # radius [m] of the flat at the bottom
    rise: float  # of a cone, dz / drho [-]
    bottom: float  # height [m] of the lowest point above the tip
    top: float  # height [m] of the top above the tip


@kernel(lean=True, inlined=True)
def shape_in(rows: Array, k: int) -> Shape:
    """Shape k of those that are rows (n, 7)."""
    return Shape(rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5], rows[k, 6])


class Piece(NamedTuple):
    """A straight piece of the tip's way: start, horizontal unit direction, horizontal length [m], slope dz/du [-]."""

    x: float
    y: float
    z: float
    ux: float
    uy: float
    length: float
    slope: float


@kernel(lean=True)
def piece_of(start: Array, end: Array) -> Piece:
    """The piece from `start` to `end` (3,) [m].

    A piece without horizontal length has direction (1, 0), length 0 and slope 0; its heights are then
    `start[2]` and `end[2]` alone.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = np.sqrt(dx * dx + dy * dy)
    if length < 1.0e-12:
        return Piece(start[0], start[1], start[2], 1.0, 0.0, 0.0, 0.0)
    return Piece(start[0], start[1], start[2], dx / length, dy / length, length, (end[2] - start[2]) / length)


@kernel(lean=True)
def underside(shape: Shape, rho: float) -> float:
    """Height b(rho) [m] of the tool's underside above the lowest point of the shape, at radius rho <= its own."""
    beyond = rho - float(shape.flat)
    if beyond <= 0.0:
        return 0.0
    if shape.kind == CONE:
        return beyond * float(shape.rise)
    corner = float(shape.corner)
    if corner <= 0.0:
        return 0.0
    return corner - float(np.sqrt(max(corner * corner - beyond * beyond, 0.0)))


@kernel(lean=True, inlined=True)
def first_sine(flat: float, corner: float, c2: float, slope: float) -> float:
    """Where to begin with `next_sine`: sin(t) if rho were the least that it can be, which is never too little."""
    tilt = 1.0 + slope * slope
    least = flat + corner * abs(slope) / np.sqrt(tilt)
    rho2 = max(least * least, c2)
    return float(min(abs(slope) * np.sqrt(rho2 / (tilt * rho2 - c2)), 1.0))


@kernel(lean=True, inlined=True)
def next_sine(flat: float, corner: float, c2: float, slope: float, sine: float) -> float:
    """A step of Newton towards the place on a corner around a flat that is lowest over a column.

    With rho = flat + corner sin(t) the condition b'(rho) u / rho = slope is, squared,
    sin^2(t) ((1 + slope^2) rho^2 - c^2) = slope^2 rho^2. From its root on to sin(t) = 1 the difference of both sides
    is convex, so that steps that begin above the root come down to it and never pass it.
    """
    rho, square = flat + corner * sine, slope * slope
    tilt = 1.0 + square
    inner = tilt * rho * rho - c2
    value = sine * sine * inner - square * rho * rho
    gain = 2.0 * (sine * inner + corner * rho * (tilt * sine * sine - square))
    return sine - value / gain


@kernel(lean=True)
def bull_nose_reach(flat: float, corner: float, c2: float, slope: float) -> float:
    """Distance |u| [m] at which a corner of radius `corner` around a flat of radius `flat` is lowest over a column."""
    sine = first_sine(flat, corner, c2, slope)
    for _ in range(TURNS):
        earlier, sine = sine, next_sine(flat, corner, c2, slope, sine)
        if earlier - sine <= CLOSE:
            break
    rho = flat + corner * sine
    return float(np.sqrt(max(rho * rho - c2, 0.0)))


@kernel(lean=True)
def rises_at(flat: float, corner: float, c2: float, slope: float, u: float) -> bool:
    """Whether slope * u + b(rho) of a bull nose rises with u there; multiplied out, to avoid a pole at the rim."""
    rho = np.sqrt(u * u + c2)
    beyond = rho - flat
    if beyond <= 0.0:
        return slope > 0.0
    return bool(slope * rho * np.sqrt(max(corner * corner - beyond * beyond, 0.0)) + beyond * u > 0.0)


@kernel(lean=True)
def lowest_at(shape: Shape, c2: float, slope: float, first: float, last: float) -> float:
    """The u [m] at which slope * u + b(rho) is least; first <= u <= last, all of it over the column; c2 = c^2."""
    if slope == 0.0:
        return min(max(0.0, first), last)
    steep = abs(slope)
    if shape.kind == BALL:
        reach = steep * np.sqrt(max(shape.radius * shape.radius - c2, 0.0)) / np.sqrt(1.0 + slope * slope)
    elif shape.kind == BULL_NOSE:
        # short pieces are mostly lowest at an end, which is quick to see
        if rises_at(shape.flat, shape.corner, c2, slope, first):
            return first
        if not rises_at(shape.flat, shape.corner, c2, slope, last):
            return last
        reach = bull_nose_reach(shape.flat, shape.corner, c2, slope)
    elif shape.kind == CONE:
        reach = np.sqrt(max(shape.flat * shape.flat - c2, 0.0))
        if shape.rise > steep:
            reach = max(reach, steep * np.sqrt(c2 / (shape.rise * shape.rise - steep * steep)))
        else:
            reach = shape.radius
    else:
        reach = shape.radius
    free = float(-reach if slope > 0.0 else reach)
    return min(max(free, first), last)


@kernel(lean=True)
def swept_interval(
    shape: Shape, piece: Piece, c2: float, along: float, low_z: float, high_z: float
) -> tuple[float, float]:
    """Swept interval (bottom, top) [m] over a column, or (1, 0) when the tool never stands over it.

    c2: squared distance [m^2] between column and the line of the piece; along: position [m] of the column along it;
    low_z, high_z: lowest and highest tip height of the piece.
    """
    length, slope = piece.length, piece.slope
    radius2 = shape.radius * shape.radius
    first, last = -along, length - along
    near = min(max(0.0, first), last)
    if c2 + near * near > radius2:
        return 1.0, 0.0
    if slope == 0.0:
        return low_z + shape.bottom + underside(shape, np.sqrt(c2 + near * near)), high_z + shape.top
    half = np.sqrt(radius2 - c2)
    first, last = max(first, -half), min(last, half)
    u = lowest_at(shape, c2, slope, first, last)
    line_z = piece.z + slope * along
    bottom = line_z + slope * u + shape.bottom + underside(shape, np.sqrt(u * u + c2))
    top = line_z + (slope * last if slope > 0.0 else slope * first) + shape.top
    return bottom, top


@kernel(lean=True)
def row_range(origin: float, step: float, nudge: float, count: int, least: float, most: float) -> tuple[int, int]:
    """First and last + 1 index of the columns whose (nudged) centres lie in [least, most], widened by one."""
    first = int(np.floor((least - origin) / step - 0.5 - nudge)) - 1
    last = int(np.ceil((most - origin) / step - 0.5 - nudge)) + 2
    return max(first, 0), min(last, count)


@kernel(lean=True, inlined=True)
def columns_across_x(grid: Grid, nx: int, least: float, most: float) -> tuple[int, int]:
    """First and last + 1 index i of the columns that may lie in least..most [m] along x."""
    return row_range(grid.x, grid.dx, NUDGE_X, nx, least, most)


@kernel(lean=True, inlined=True)
def columns_across_y(grid: Grid, ny: int, least: float, most: float) -> tuple[int, int]:
    """The same along y, index j."""
    return row_range(grid.y, grid.dy, NUDGE_Y, ny, least, most)


@kernel(lean=True, inlined=True)
def x_of(grid: Grid, i: int) -> float:
    """Where columns i are sampled [m]."""
    return grid.x + (i + 0.5 + NUDGE_X) * grid.dx


@kernel(lean=True, inlined=True)
def y_of(grid: Grid, j: int) -> float:
    """Where columns j are sampled [m]."""
    return grid.y + (j + 0.5 + NUDGE_Y) * grid.dy


@kernel(lean=True)
def strip_range(x: float, radius: float, piece: Piece) -> tuple[float, float]:
    """Range (least, most) of y [m] in which the sweep of a disc can cover points of the line x = const.

    (1, 0) when there is none. Never too small; up to a few cells too large.
    """
    y0, ux, uy = piece.y, piece.ux, piece.uy
    # positions along the piece at which the disc reaches this x
    first, last = 0.0, piece.length
    offset = x - piece.x
    slowness = 1.0 / ux if ux != 0.0 else 0.0
    if ux != 0.0:
        a, b = (offset - radius) * slowness, (offset + radius) * slowness
        first, last = max(first, min(a, b)), min(last, max(a, b))
        if first > last:
            return 1.0, 0.0
        near = min(max(offset * slowness, first), last)
    else:
        near = first
    miss = offset - ux * near
    if miss * miss > radius * radius:
        return 1.0, 0.0
    half = np.sqrt(radius * radius - miss * miss)
    ya, yb = y0 + uy * first, y0 + uy * last
    least, most = min(ya, yb) - half, max(ya, yb) + half
    if abs(ux) > 1.0e-9:
        middle = y0 + offset * uy * slowness
        wide = radius * abs(slowness)
        least, most = max(least, middle - wide), min(most, middle + wide)
    return least, most
