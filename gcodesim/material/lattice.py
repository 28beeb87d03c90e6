"""A stock whose columns stand along x, y and z: made from its columns along Z, and cut in any direction.

All three kinds of columns meet in the same nodes, between which runs one surface (`lattice_surface`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.field_kernels import PATCH, Columns, Field, Grid
from gcodesim.material.lattice_surface import meshed_volume, nodes_of, span_around, volume_inside

if TYPE_CHECKING:
    from collections.abc import Iterable

    from gcodesim.material.axis_way import AxisWay
    from gcodesim.material.stock import Lines, Stock

Array = NDArray[np.float64]

ORDERS: Final = ((1, 2, 0), (2, 0, 1), (0, 1, 2))
"""Axes of S that are x, y and Z of the columns along x, along y and along z."""


class Lattice:
    """The columns along x and y of a stock, beside those along z, which the stock keeps.

    `start` are those at the beginning; `offset` [m³] is the volume of the stock beyond that of its mesh.
    """

    __slots__ = ("fields", "offset", "start")

    def __init__(self, fields: tuple[Field, Field], start: tuple[Columns, Columns], offset: float = 0.0) -> None:
        self.fields, self.start, self.offset = fields, start, offset

    def copy(self) -> Lattice:
        """The same in a state of its own."""
        x, y = self.fields
        return Lattice((_copied(x), _copied(y)), self.start, self.offset)


def _copied(field: Field) -> Field:
    return Field(own_columns(field), field.grid, field.walls, field.dirty.copy(), field.tops.copy())


def field_of(columns: Columns, grid: Grid) -> Field:
    """Columns as a field; it keeps no walls, which the other directions know better."""
    shape = columns.number.shape
    patches = (-(-shape[0] // PATCH), -(-shape[1] // PATCH))
    columns = Columns(*map(np.ascontiguousarray, columns))
    return Field(columns, grid, np.zeros((0, 0, 0), np.float32), np.zeros(patches, np.uint8), np.zeros(patches))


def ensure_lattice(stock: Stock) -> Lattice:
    """The columns along x and y of a stock, made when it has none.

    Where the stock is as it was made they are exact; else they come from its columns and walls, up to half a cell
    beside slopes.
    """
    if stock.lattice is not None:
        return stock.lattice
    volume = stock.volume
    start = None if stock.exact is None else (stock.exact((1, 2, 0)), stock.exact((2, 0, 1)))
    if start is None or not _is_untouched(stock):
        made = (_rows_along_x(stock), _rows_along_y(stock))
        now = made if start is None else (both_of(start[0], made[0]), both_of(start[1], made[1]))
        start = start or made
    else:
        now = start
    fields = (field_of(*now[0]), field_of(*now[1]))
    own = (own_columns(fields[0]), own_columns(fields[1]))
    stock.lattice = Lattice(fields, own if start is now else (start[0][0], start[1][0]))
    stock.lattice.offset = volume - volume_inside(stock)
    return stock.lattice


def own_columns(field: Field) -> Columns:
    """A copy of the columns of a field."""
    lo, hi, number = field.columns
    return Columns(lo.copy(), hi.copy(), number.copy())


def _is_untouched(stock: Stock) -> bool:
    from gcodesim.material.error_kernels import changes

    columns = stock.field.columns
    return bool(changes(columns, stock.original, np.zeros(columns.number.shape)) == 0.0)


def _rows_along_x(stock: Stock) -> Lines:
    """Columns along x at (y, z) from those along z."""
    from gcodesim.material.turning import on_edge

    turned = on_edge(stock).field  # its x is -z
    lo, hi, number = turned.columns
    grid = turned.grid
    order = Columns(lo[::-1].transpose(1, 0, 2), hi[::-1].transpose(1, 0, 2), number[::-1].T)
    return order, Grid(grid.y, stock.z_range[0], grid.dy, grid.dx)


def _rows_along_y(stock: Stock) -> Lines:
    """Columns along y at (z, x) from those along z."""
    from gcodesim.material.turning import on_edge, quarter_turned

    turned = on_edge(quarter_turned(stock)).field  # its x is -z, its y is -x
    lo, hi, number = turned.columns
    grid, own = turned.grid, stock.field.grid
    order = Columns(lo[::-1, ::-1], hi[::-1, ::-1], number[::-1, ::-1])
    return order, Grid(stock.z_range[0], own.x, grid.dx, own.dx)


def both_of(one: Lines, other: Lines) -> Lines:
    """What is in material in both of two sets of columns on the same grid."""
    from gcodesim.material.line_kernels import common_columns

    a, b = one[0], other[0]
    room = a.lo.shape[2] + b.lo.shape[2]
    shape = (*a.number.shape, room)
    made = Columns(np.zeros(shape), np.zeros(shape), np.zeros(a.number.shape, np.int32))
    common_columns(a, Columns(*map(np.ascontiguousarray, b)), made)
    k = max(1, int(made.number.max()))
    return Columns(*map(np.ascontiguousarray, (made.lo[:, :, :k], made.hi[:, :, :k], made.number))), one[1]


def sweep(stock: Stock, way: AxisWay, slabs: Array, fields: Iterable[int]) -> Array:
    """Cut `fields` (0: columns along x, 1: along y, 2: along z) of a stock; volume (c,) [m³] of each piece.

    For less than all fields the volume has no meaning.
    """
    from gcodesim.material.line_kernels import ToolWay, cut_along
    from gcodesim.material.stock import widened

    lattice = ensure_lattice(stock)
    pieces = len(way.starts)
    taken = np.zeros(pieces)
    if pieces == 0 or len(slabs) == 0:
        return taken
    nodes = nodes_of(stock)
    low, high = sweep_room(way, slabs)
    span = span_around(nodes, low, high)
    middle = 0.5 * (low + high)
    measured = list(fields)
    before = meshed_volume(stock, nodes, span, middle) if len(measured) == 3 else 0.0
    for which in measured:
        order = list(ORDERS[which])
        turned = ToolWay(*(np.ascontiguousarray(part[:, order]) for part in way))
        done = 0
        while True:
            field = stock.field if which == 2 else lattice.fields[which]
            done = cut_along(field, turned, slabs, done, taken)
            if done == pieces:
                break
            wider = widened(field)
            if which == 2:
                stock.field = wider
            else:
                x, y = lattice.fields
                lattice.fields = (wider, y) if which == 0 else (x, wider)
    if len(measured) < 3:
        return taken
    removed = before - meshed_volume(stock, nodes, span, middle)
    total = float(taken.sum())
    return taken * (removed / total) if total > 0.0 else taken


def volume_near(stock: Stock, room: tuple[Array, Array]) -> float:
    """Volume [m³] that changes as that of the stock does by changes inside of `room`, two corners (3,)."""
    nodes = nodes_of(stock)
    low, high = room
    return meshed_volume(stock, nodes, span_around(nodes, low, high), 0.5 * (low + high))


def sweep_room(way: AxisWay, slabs: Array) -> tuple[Array, Array]:
    """The lowest and the highest corner (3,) [m] of a box around all that a body sweeps."""
    low, high = sweep_rooms(way, slabs)
    return low.min(axis=0), high.max(axis=0)


def sweep_rooms(way: AxisWay, slabs: Array) -> tuple[Array, Array]:
    """Corners (c, 3) [m] of boxes around what a body sweeps along each piece."""
    widest = float(slabs[:, 5].max())
    low, high = np.full(way.starts.shape, np.inf), np.full(way.starts.shape, -np.inf)
    for tips, axes in ((way.starts, way.axes_start), (way.ends, way.axes_end)):
        for h in (slabs[:, 1].min(), slabs[:, 2].max()):
            points = tips + axes * h
            low, high = np.minimum(low, points), np.maximum(high, points)
    # between its ends a turning axis comes farther out than the chord
    bulge = float(np.abs(slabs[:, 1:3]).max()) * float(np.square(way.axes_end - way.axes_start).max())
    return low - widest - bulge, high + widest + bulge
