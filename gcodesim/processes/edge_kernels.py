"""The edge of an upright cutter, cut into rows, and where ahead of it the stock is sampled.

Frame K: X (u) along the horizontal feed, Y (l) to its left, Z up to the holder; phi runs clockwise from Y
(spindle M3). Each row is at one height; most loops run over the angles of one row.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.atan_kernels import acos
from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.material.kernels import Field, breadth_along, coarsest, diagonal

Array = NDArray[np.float64]

ANGLES = 64
SLICES = 16  # elements along the engaged part of one piece of the edge, at most
LEAST_SLICES = 4  # of a cylinder, whose elements are SLICE_CELLS high between these two limits
SLICE_CELLS = 2.0
UPRIGHT = 1.0e-12  # cosine of kappa below which a straight piece is part of a cylinder
LEAST_PIECES = 4  # of an edge for which there is room

# Columns of `Teeth.pieces`, the outline of an edge: see `Cutter.edge`.
# After them what it is pressed into the material by [N/m], however thin the chip.
ARC, AT_R, AT_Z, KAPPA, KAPPA_END, LENGTH, FOOT, HEAD, WEIGHT, PUSH = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9

# Columns of `Room.rows`: radius and height of a row in its middle, kappa there, width, lowest and highest place,
# largest radius. Nearly all rows touch material at few angles, so each keeps the range of those; nothing else is worked
# on. Then what the limits of contact within an angle add to the sums of sines and cosines, and that times height [m];
# in the first row of an arc, whose sines take long, also which piece it is (its number + 1) and the kappa at its end;
# and the push of the piece [N/m]; where teeth differ, the share of them that rubs where it is in contact.
# The width of a row is that of an edge of weight 1 with the same force.
RADIUS, HEIGHT, SIN_KAPPA, COS_KAPPA, EDGE_WIDTH, LOW, HIGH, OUTER, FROM, TO = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
MORE_SINES, MORE_COSINES, LEVER_SINES, LEVER_COSINES = 10, 11, 12, 13
OF_ARC, UP_TO = 14, 15
PUSHED = 16
RUBS = 17
COLUMNS = 18

# An edge that moves into material at less than this share of its speed slides on it without cutting, as the flat bottom
# of an end mill in a horizontal cut, whose commanded height is never exactly constant.
LEAST_ADVANCE = 1.0e-4

# Up to this tangent of kappa an element of a falling tool is sampled so deep that its wall counts as full.
STEEPEST = 4.0

THIN = 1.0e-7  # [m] least height over which material is sampled


class Circle(NamedTuple):
    """Sine and cosine of phi at the angles (ANGLES,) at which a revolution is sampled."""

    sines: Array
    cosines: Array


class Heading(NamedTuple):
    """The direction of feed: horizontal (ux, uy), and how level and how steep it is; both are unit vectors.

    `turn` [1/m] is how much the way bends to the left: 1 by the radius of an arc.
    """

    ux: float
    uy: float
    level: float
    climb: float
    turn: float


@kernel(lean=True)
def lay_rows(pieces: Array, piece: int, height: float, cell: float, rows: Array) -> int:
    """Cut the part of a piece of the edge that is below `height` [m] into rows; returns their number.

    rows (n, COLUMNS) are those of the same cutter from call to call, at first zeros: an arc that is there stays.
    """
    radius, kappa0, kappa1 = pieces[piece, ARC], pieces[piece, KAPPA], pieces[piece, KAPPA_END]
    length, z0, z1 = pieces[piece, LENGTH], pieces[piece, FOOT], pieces[piece, HEAD]
    if z0 >= height or length <= 0.0:
        return 0
    if radius > 0.0:
        if z1 > height:
            kappa1 = acos(max((pieces[piece, AT_Z] - height) / radius, -1.0))
        for i in range(SLICES):
            for more in range(MORE_SINES, LEVER_COSINES + 1):
                rows[i, more] = 0.0
        if rows[0, OF_ARC] == piece + 1.0 and rows[0, UP_TO] == kappa1:
            return SLICES
        step = (kappa1 - kappa0) / SLICES
        for i in range(SLICES):
            a = kappa0 + i * step
            kappa = a + 0.5 * step
            cosine, sine = cos_sin(kappa)
            cosine_low, sine_low = cos_sin(a)
            cosine_high, sine_high = cos_sin(a + step)
            rows[i, RADIUS] = pieces[piece, AT_R] + radius * sine
            rows[i, HEIGHT] = pieces[piece, AT_Z] - radius * cosine
            rows[i, SIN_KAPPA], rows[i, COS_KAPPA] = sine, cosine
            rows[i, EDGE_WIDTH] = radius * step
            rows[i, PUSHED] = 0.0
            rows[i, LOW] = pieces[piece, AT_Z] - radius * cosine_low
            rows[i, HIGH] = pieces[piece, AT_Z] - radius * cosine_high
            rows[i, OUTER] = pieces[piece, AT_R] + radius * max(sine_low, sine_high)  # undercut: the lower end
            rows[i, OF_ARC], rows[i, UP_TO] = piece + 1.0 if i == 0 else 0.0, kappa1
        return SLICES
    cosine, sine = cos_sin(kappa0)
    if z1 > height:
        length = (height - z0) / sine
    number = SLICES
    if abs(cosine) < UPRIGHT:  # all at one radius, so that only their number over the height matters
        number = min(max(int(np.ceil(length / (SLICE_CELLS * cell))), LEAST_SLICES), SLICES)
    step = length / number
    for i in range(number):
        s = (i + 0.5) * step
        rows[i, RADIUS], rows[i, HEIGHT] = pieces[piece, AT_R] + s * cosine, z0 + s * sine
        rows[i, SIN_KAPPA], rows[i, COS_KAPPA] = sine, cosine
        rows[i, EDGE_WIDTH], rows[i, PUSHED] = step * pieces[piece, WEIGHT], pieces[piece, PUSH]
        rows[i, LOW], rows[i, HIGH] = z0 + i * step * sine, z0 + (i + 1) * step * sine
        rows[i, OUTER] = rows[i, RADIUS] + 0.5 * step * abs(cosine)
        rows[i, MORE_SINES], rows[i, MORE_COSINES], rows[i, LEVER_SINES], rows[i, LEVER_COSINES] = 0.0, 0.0, 0.0, 0.0
        rows[i, OF_ARC] = 0.0
    return number


class Clearance(NamedTuple):
    """How far from the cutter to sample, so that no column around such a place is under it, all [m]."""

    cell: float  # width of the widest
    ahead: float  # of the cutter: the diagonal of a cell, for any direction
    aside: float  # inside its width: a cell seen along the feed


@kernel(lean=True, inlined=True)
def clearance_of(field: Field, heading: Heading) -> Clearance:
    """The clearances for a direction of feed."""
    return Clearance(coarsest(field), diagonal(field), breadth_along(field, heading.ux, heading.uy))


@kernel(lean=True, inlined=True)
def off_way(square: float, y: float, turn: float) -> float:
    """How far to the left of the way [m] a place is: y to the left of the tool, square [m²] of its distance from it.

    On an arc what lies beside the way keeps its distance from the centre, not from the line of feed.
    """
    return float((2.0 * y - turn * square) / (1.0 + np.sqrt(max(1.0 - 2.0 * turn * y + turn * turn * square, 0.0))))


@kernel(lean=True, inlined=True)
def on_way(square: float, off: float, turn: float) -> float:
    """The inverse of `off_way`: how far to the left of the tool [m] a place of that distance is, `off` the way."""
    return off + 0.5 * turn * (square - off * off)


@kernel(lean=True, inlined=True)
def along_way(ahead: float, off: float, turn: float) -> tuple[float, float]:
    """Where a place is that is so far `off` a way that turns, ahead and to the left of the tool [m].

    On a straight way it would be `ahead` of the tool; it is as far from it.
    """
    square = ahead * ahead + off * off
    left = on_way(square, off, turn)
    return float(np.sqrt(max(square - left * left, 0.0))) if turn != 0.0 else ahead, left


@kernel(lean=True)
def probe(
    r: float, outer: float, sine: float, cosine: float, ahead: float, aside: float, level: float, turn: float
) -> tuple[float, float, float]:
    """Where to ask for material ahead of the point at radius r and angle phi: (u, l), and the way d there [m].

    outer: largest radius of the element; ahead, aside: see `Clearance`; level, turn: see `Heading`.
    d is the way along the feed.
    """
    x, y = r * sine, r * cosine
    if sine <= 0.0:
        return x + level * ahead, y, ahead
    inside = max(r - aside, 0.0)
    wide, front = min(max(off_way(r * r, y, turn), -inside), inside), outer + ahead
    wide = min(max(on_way(front * front, wide, turn), -front), front)
    way = np.sqrt(front * front - wide * wide) - x
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
    """Least way d [m] for row i: in a fall, enough to fill columns a cell nearer to the axis, whose floor is lower."""
    steep = STEEPEST if rows[i, SIN_KAPPA] > STEEPEST * rows[i, COS_KAPPA] else rows[i, SIN_KAPPA] / rows[i, COS_KAPPA]
    return float((1.0 - level) * (0.5 * (rows[i, HIGH] - rows[i, LOW]) + cell * steep))
