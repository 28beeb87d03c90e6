"""Closed meshes turned into a stock."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import dots
from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.material.stock import Lines, Stock, grid_of

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


class OpenMeshError(ValueError):
    """The mesh does not enclose a volume: along some columns it is entered and never left."""

    def __init__(self, columns: int, of: int) -> None:
        super().__init__(f"the mesh is not closed: {columns} of {of} columns enter it and never leave it")
        self.columns = columns


def stock_of_mesh(vertices: Array, faces: Ints, resolution: float, material: str = "") -> Stock:
    """Stock in the shape of a closed mesh: vertices (v, 3) [m] in S, faces (f, 3) counter-clockwise from outside.

    Overlapping closed shells are united; a mesh that is inside out is reversed. OpenMeshError when it is not closed.
    """
    vertices, faces = outward(vertices, faces)
    minimum, maximum = vertices.min(axis=0), vertices.max(axis=0)
    grid, shape = grid_of(minimum, maximum, resolution)
    columns, leaks = columns_of_mesh(vertices, faces, grid, shape)
    if leaks:
        raise OpenMeshError(leaks, columns.number.size)
    stock = Stock(
        columns=columns,
        grid=grid,
        z_range=(float(minimum[2]), float(maximum[2])),
        resolution=resolution,
        material=material,
    )

    def exact(order: tuple[int, int, int]) -> Lines:
        field = stock_of_mesh(vertices[:, list(order)], faces, resolution).field
        return field.columns, field.grid

    stock.exact = exact
    return stock


def outward(vertices: Array, faces: Ints) -> tuple[Array, Ints]:
    """A closed mesh as kernels take it, turned over if it is inside out."""
    vertices = np.ascontiguousarray(vertices, dtype=np.float64)
    faces = np.ascontiguousarray(faces, dtype=np.int32)
    a, b, c = (vertices[faces[:, k]] - vertices[0] for k in range(3))
    if dots(a, np.cross(b, c)).sum() < 0.0:
        faces = np.ascontiguousarray(faces[:, ::-1])
    return vertices, faces


def columns_of_mesh(vertices: Array, faces: Ints, grid: Grid, shape: tuple[int, int]) -> tuple[Columns, int]:
    """A mesh that is `outward` as columns on a grid, and how many columns it enters and never leaves.

    With such columns there are none.
    """
    from gcodesim.material.raster_kernels import Crossings, fill_columns, find_crossings

    number, start = np.zeros((2, *shape), dtype=np.int32)
    crossings = Crossings(number, start, np.zeros(0), np.zeros(0, dtype=np.int32))
    find_crossings(vertices, faces, grid, crossings, False)
    start[:] = (np.cumsum(number.ravel()) - number.ravel()).reshape(shape)
    total = int(number.sum())
    crossings = Crossings(number, start, np.zeros(total), np.zeros(total, dtype=np.int32))
    find_crossings(vertices, faces, grid, crossings, True)

    columns = _no_columns(shape, 1)
    most, leaks = fill_columns(crossings, columns, True)
    if not leaks:
        columns = _no_columns(shape, max(most, 1))
        fill_columns(crossings, columns, False)
    return columns, leaks


def _no_columns(shape: tuple[int, int], room: int) -> Columns:
    """Empty columns with room for the given number of intervals each."""
    return Columns(np.zeros((*shape, room)), np.zeros((*shape, room)), np.zeros(shape, dtype=np.int32))
