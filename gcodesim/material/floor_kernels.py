"""The floor of what an upright cutter sweeps along a piece, over many columns of a row at once.

A row is worked on in blocks of `BLOCK` columns. Loops over a block have no branches, no dependence between their
iterations and always the same length: so each of their instructions does several columns, and no rest is left that is
done one by one. They say of each column what `swept_interval` says.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.sweep_kernels import (
    BALL,
    BULL_NOSE,
    CLOSE,
    CONE,
    TURNS,
    Piece,
    Shape,
    first_sine,
    next_sine,
    underside,
)

Array = NDArray[np.float64]

BLOCK = 16
"""Columns that are worked on together."""

NONE = np.inf
"""The floor of a column from which nothing is swept."""


class Sweep(NamedTuple):
    """A shape that moves along a piece, and heights [m] in S."""

    shape: Shape
    piece: Piece
    low_tip: float
    high_tip: float
    begin: float  # of the tip where the piece begins; of one that is level or a plunge, its lowest
    lowest: float  # of the shape anywhere
    cylinder: float  # from which on it is a cylinder, where the tip is lowest
    top: float  # of the shape, where the tip is lowest


class FloorLine(NamedTuple):
    """A row of n columns, each (n,): where they stand along y [m], the floor that is found, by how much they are cut,

    and room for a search: square of the distance from the line of the piece, a sine, and where the tool is lowest.
    """

    ys: Array
    floor: Array
    gone: Array
    squares: Array
    sines: Array
    free: Array


@kernel(lean=True)
def sweep_of(shape: Shape, piece: Piece, low_tip: float, high_tip: float) -> Sweep:
    """The sweep of a shape along a piece with these lowest and highest tips [m]."""
    lowest = low_tip + shape.bottom
    begin = piece.z if piece.slope != 0.0 else low_tip
    cylinder = lowest + underside(shape, shape.radius)
    return Sweep(shape, piece, low_tip, high_tip, begin, lowest, cylinder, low_tip + shape.top)


@kernel(lean=True, inlined=True)
def floor_of_ball(sweep: Sweep, x: float, line: FloorLine, at: np.uint64) -> None:
    """Fill the floor [m] of a block of columns from `at` on, at x from where the piece begins.

    NONE where the ball never is.
    """
    ux, uy, length, slope = sweep.piece.ux, sweep.piece.uy, sweep.piece.length, sweep.piece.slope
    radius2 = sweep.shape.radius * sweep.shape.radius
    middle = sweep.begin + sweep.shape.bottom + sweep.shape.radius
    ys, floor, y0 = line.ys, line.floor, sweep.piece.y
    lean = slope / np.sqrt(1.0 + slope * slope)
    for k in range(BLOCK):
        j = at + np.uint64(k)
        y = ys[j] - y0
        along, across = x * ux + y * uy, y * ux - x * uy
        room2 = radius2 - across * across
        u = min(max(-lean * np.sqrt(max(room2, 0.0)), -along), length - along)
        depth2 = room2 - u * u
        deep = middle + slope * (along + u) - np.sqrt(max(depth2, 0.0))
        floor[j] = deep if depth2 >= 0.0 else NONE


@kernel(lean=True, inlined=True)
def floor_of_cylinder(sweep: Sweep, x: float, line: FloorLine, at: np.uint64) -> None:
    """The same for a flat underside: on a slope it is lowest where the tool comes to the column, or leaves it."""
    ux, uy, length, slope = sweep.piece.ux, sweep.piece.uy, sweep.piece.length, sweep.piece.slope
    radius2, bottom, begin = sweep.shape.radius * sweep.shape.radius, sweep.shape.bottom, sweep.begin
    ys, floor, y0 = line.ys, line.floor, sweep.piece.y
    free = 0.0 if slope == 0.0 else (-sweep.shape.radius if slope > 0.0 else sweep.shape.radius)
    for k in range(BLOCK):
        j = at + np.uint64(k)
        y = ys[j] - y0
        along, across = x * ux + y * uy, y * ux - x * uy
        near = min(max(0.0, -along), length - along)
        half = np.sqrt(max(radius2 - across * across, 0.0))
        u = min(max(free, max(-along, -half)), min(length - along, half))
        deep = begin + slope * along + slope * u + bottom
        floor[j] = deep if across * across + near * near <= radius2 else NONE


@kernel(lean=True, inlined=True)
def floor_of_cone(sweep: Sweep, x: float, line: FloorLine, at: np.uint64) -> None:
    """The same for a cone, with a flat or without."""
    ux, uy, length, slope = sweep.piece.ux, sweep.piece.uy, sweep.piece.length, sweep.piece.slope
    radius2, bottom, begin = sweep.shape.radius * sweep.shape.radius, sweep.shape.bottom, sweep.begin
    flat, rise, steep = sweep.shape.flat, sweep.shape.rise, abs(slope)
    ys, floor, y0 = line.ys, line.floor, sweep.piece.y
    runs = rise > steep  # up the flank, rather than down it
    gain = rise * rise - steep * steep if runs else 1.0
    for k in range(BLOCK):
        j = at + np.uint64(k)
        y = ys[j] - y0
        along, across = x * ux + y * uy, y * ux - x * uy
        c2 = across * across
        near = min(max(0.0, -along), length - along)
        half = np.sqrt(max(radius2 - c2, 0.0))
        reach = max(np.sqrt(max(flat * flat - c2, 0.0)), steep * np.sqrt(c2 / gain)) if runs else sweep.shape.radius
        free = 0.0 if slope == 0.0 else (-reach if slope > 0.0 else reach)
        u = min(max(free, max(-along, -half)), min(length - along, half))
        deep = begin + slope * along + slope * u + bottom
        floor[j] = deep + max(np.sqrt(u * u + c2) - flat, 0.0) * rise if c2 + near * near <= radius2 else NONE


@kernel(lean=True, inlined=True)
def is_rising(flat: float, corner2: float, c2: float, slope: float, u: float) -> bool:
    """Whether slope * u + b(rho) of a bull nose rises with u; multiplied out, to avoid a pole at the rim."""
    rho = np.sqrt(u * u + c2)
    beyond = max(rho - flat, 0.0)
    return bool(slope * rho * np.sqrt(max(corner2 - beyond * beyond, 0.0)) + beyond * u > 0.0)


@kernel(lean=True, inlined=True)
def seek_lowest(sweep: Sweep, x: float, line: FloorLine, at: np.uint64) -> None:
    """Fill `free` of a block: where along the piece, from each column, a bull nose is lowest over it [m].

    Beyond the ends of the piece it is only known to be there; steps of `next_sine` are made if some are between.
    """
    ux, uy, length, slope = sweep.piece.ux, sweep.piece.uy, sweep.piece.length, sweep.piece.slope
    flat, corner, radius2 = sweep.shape.flat, sweep.shape.corner, sweep.shape.radius * sweep.shape.radius
    ys, squares, sines, free, y0 = line.ys, line.squares, line.sines, line.free, sweep.piece.y
    between = np.uint8(0)
    for k in range(BLOCK):
        j = at + np.uint64(k)
        y = ys[j] - y0
        along, across = x * ux + y * uy, y * ux - x * uy
        c2 = min(across * across, radius2)
        half = np.sqrt(radius2 - c2)
        first, last = max(-along, -half), min(length - along, half)
        falls = np.uint8(is_rising(flat, corner * corner, c2, slope, first)) ^ np.uint8(1)
        rises = np.uint8(is_rising(flat, corner * corner, c2, slope, last))
        between |= falls & rises & np.uint8(first < last)
        free[j] = np.inf if falls else -np.inf
        squares[j] = c2
        sines[j] = first_sine(flat, corner, c2, slope)
    if between == 0:
        return
    for _ in range(TURNS):
        if between == 0:
            break
        between = np.uint8(0)
        for k in range(BLOCK):
            j = at + np.uint64(k)
            following = next_sine(flat, corner, squares[j], slope, sines[j])
            between |= np.uint8(sines[j] - following > CLOSE)
            sines[j] = following
    side = -1.0 if slope > 0.0 else 1.0
    for k in range(BLOCK):
        j = at + np.uint64(k)
        rho = flat + corner * sines[j]
        free[j] = side * np.sqrt(max(rho * rho - squares[j], 0.0))


@kernel(lean=True, inlined=True)
def floor_of_bull_nose(sweep: Sweep, x: float, line: FloorLine, at: np.uint64) -> None:
    """The same for a rounded corner around a flat."""
    ux, uy, length, slope = sweep.piece.ux, sweep.piece.uy, sweep.piece.length, sweep.piece.slope
    radius2, bottom, begin = sweep.shape.radius * sweep.shape.radius, sweep.shape.bottom, sweep.begin
    flat, corner = sweep.shape.flat, sweep.shape.corner
    ys, floor, free, y0 = line.ys, line.floor, line.free, sweep.piece.y
    level = slope == 0.0
    if slope != 0.0:
        seek_lowest(sweep, x, line, at)
    for k in range(BLOCK):
        j = at + np.uint64(k)
        y = ys[j] - y0
        along, across = x * ux + y * uy, y * ux - x * uy
        c2 = across * across
        near = min(max(0.0, -along), length - along)
        half = np.sqrt(max(radius2 - c2, 0.0))
        u = min(max(0.0 if level else free[j], max(-along, -half)), min(length - along, half))
        beyond = max(np.sqrt(u * u + c2) - flat, 0.0)
        deep = begin + slope * along + slope * u + bottom
        deep += corner - np.sqrt(max(corner * corner - beyond * beyond, 0.0))
        floor[j] = deep if c2 + near * near <= radius2 else NONE


@kernel(lean=True, inlined=True)
def find_floor(sweep: Sweep, x: float, line: FloorLine, at: np.uint64) -> None:
    """Fill the floor [m] of a block of columns from `at` on, at x from where the piece begins.

    NONE where the tool never is.
    """
    if sweep.shape.kind == BALL:
        floor_of_ball(sweep, x, line, at)
    elif sweep.shape.kind == BULL_NOSE:
        floor_of_bull_nose(sweep, x, line, at)
    elif sweep.shape.kind == CONE:
        floor_of_cone(sweep, x, line, at)
    else:
        floor_of_cylinder(sweep, x, line, at)
