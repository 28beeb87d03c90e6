"""Surface, volume and pieces of a stock whose columns stand along x, y and z; see `lattice_kernels`.

Faces of any direction come out right to the square of a cell; edges are bevelled by less than a cell.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.material.lattice_kernels import CellSpan, LatticeMesh, LatticeNodes, ThreeWays

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.material.surface import Surface

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


class Facing(NamedTuple):
    """A mesh (v, 3), (f, 3), whether points were cut (v,), and a node in material behind each face (f, 3)."""

    points: Array
    faces: Ints
    cut: NDArray[np.uint8]
    nodes: Ints


def nodes_of(stock: Stock, stride: int = 1) -> LatticeNodes:
    """The nodes of a stock, each `stride` columns apart."""
    assert stock.lattice is not None
    grid, upright = stock.field.grid, stock.lattice.fields[0].grid
    nx, ny = stock.field.columns.number.shape
    nz = stock.lattice.fields[0].columns.number.shape[1]
    picks, places = [], []
    for origin, step, cells in ((grid.x, grid.dx, nx), (grid.y, grid.dy, ny), (upright.y, upright.dy, nz)):
        runs = -(-cells // stride)
        pick = ((np.arange(runs) + 0.5) * cells / runs).astype(np.int32)
        at = origin + (pick + 0.5) * step
        picks.append(pick)
        places.append(np.concatenate([[origin - step], at, [origin + (cells + 1) * step]]))
    return LatticeNodes(*picks, *places)


def ways_of(stock: Stock) -> tuple[ThreeWays, ThreeWays]:
    """All columns of a stock as they are, and as they were at the start."""
    assert stock.lattice is not None
    x, y = stock.lattice.fields
    return ThreeWays(x.columns, y.columns, stock.field.columns), ThreeWays(*stock.lattice.start, stock.original)


def whole(nodes: LatticeNodes) -> CellSpan:
    """All cells."""
    return CellSpan(0, len(nodes.ix) + 1, 0, len(nodes.iy) + 1, 0, len(nodes.iz) + 1)


def span_around(nodes: LatticeNodes, low: Array, high: Array) -> CellSpan:
    """The cells that meet the box from `low` to `high` (3,) [m]."""
    ends = []
    for axis, places in enumerate((nodes.x, nodes.y, nodes.z)):
        first = int(np.searchsorted(places, low[axis])) - 2
        last = int(np.searchsorted(places, high[axis])) + 1
        cells = len(places) - 1
        ends += [min(max(first, 0), cells), min(max(last, 0), cells)]
    return CellSpan(*ends)


def mesh_of(stock: Stock, nodes: LatticeNodes, span: CellSpan) -> Facing:
    """The surface of a stock in the cells of a span."""
    from gcodesim.material.lattice_kernels import march
    from gcodesim.material.loops import loop_table

    now, start = ways_of(stock)
    none = LatticeMesh(np.zeros((0, 3)), np.zeros(0, np.uint8), np.zeros((0, 3), np.int32), np.zeros((0, 3), np.int32))
    table = loop_table()
    points, faces = march(now, start, nodes, span, table, none)
    mesh = LatticeMesh(
        np.zeros((points, 3)),
        np.zeros(points, np.uint8),
        np.zeros((faces, 3), np.int32),
        np.zeros((faces, 3), np.int32),
    )
    if faces:
        march(now, start, nodes, span, table, mesh)
    return Facing(mesh.points, mesh.faces, mesh.cut, mesh.nodes)


def meshed_volume(stock: Stock, nodes: LatticeNodes, span: CellSpan, about: Array) -> float:
    """Volume [m³] between `about` (3,) and the surface in a span; that of the stock where all cells are in it."""
    from gcodesim.material.lattice_kernels import enclosed

    mesh = mesh_of(stock, nodes, span)
    volume = np.zeros(1)
    enclosed(mesh.points - about, mesh.faces, np.zeros(len(mesh.faces), np.int32), volume)
    return float(volume[0])


def volumes_of_pieces(stock: Stock) -> Array:
    """The volume [m³] of each piece in which a stock lies, greatest first."""
    from gcodesim.material.lattice_kernels import enclosed, find_inside, label_pieces

    nodes = nodes_of(stock)
    span = whole(nodes)
    inside = np.zeros((len(nodes.x), len(nodes.y), len(nodes.z)), np.uint8)
    for i in range(1, len(nodes.x) - 1):
        find_inside(stock.field.columns, nodes, span, i, inside[i])
    label = np.zeros(inside.shape, np.int32)
    volumes = np.zeros(label_pieces(inside, label, np.zeros(inside.size, np.int32)))
    mesh = mesh_of(stock, nodes, span)
    low, high = stock.bounds
    enclosed(mesh.points - 0.5 * (low + high), mesh.faces, label[tuple(mesh.nodes.T)] - 1, volumes)
    ordered: Array = np.sort(volumes)[::-1]
    return ordered


def volume_inside(stock: Stock) -> float:
    """Volume [m³] of a stock with columns in three directions."""
    assert stock.lattice is not None
    nodes = nodes_of(stock)
    low, high = stock.bounds
    return meshed_volume(stock, nodes, whole(nodes), 0.5 * (low + high)) + stock.lattice.offset


BENT: Final = 1.0 / 6.0
"""Share of cell² x length x angle that is in doubt at an edge between two faces: twice the mean bevel of an edge
(cell² / 8 at a right angle), and twice what lies between an arc and its chords (angle x cell² / 12)."""

ROUGH: Final = 0.003
"""Cells by which a cut face may lie aside, from facets and from poses of a turning axis."""


def volume_error(stock: Stock) -> float:
    """By how much [m³] the removed volume may be wrong: at each edge between faces that a cut has made.

    It falls with the square of the cell.
    """
    nodes = nodes_of(stock)
    mesh = mesh_of(stock, nodes, whole(nodes))
    cut: NDArray[np.bool_] = np.any(mesh.cut[mesh.faces] > 0, axis=1)
    if not cut.any():
        return 0.0
    a, b, c = (mesh.points[mesh.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    twice = norms(normal)
    unit = normal / np.maximum(twice, 1e-300)[:, None]
    ends = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    one, other = order[0::2] // 3, order[1::2] // 3  # each edge has two faces
    length = norms(mesh.points[ends[order[0::2], 0]] - mesh.points[ends[order[0::2], 1]])
    angle = acos(np.clip(dots(unit[one], unit[other]), -1.0, 1.0))
    thin = (twice[one] < 1e-18) | (twice[other] < 1e-18)
    told = (cut[one] | cut[other]) & ~thin
    cell = max(
        float(np.diff(places).max()) for places in (nodes.x[1:-1], nodes.y[1:-1], nodes.z[1:-1]) if len(places) > 1
    )
    return float(BENT * cell * cell * (length * angle)[told].sum() + ROUGH * cell * 0.5 * twice[cut].sum())


def lattice_surface(stock: Stock, spacing: float) -> Surface:
    """The closed surface of a stock with columns in three directions, drawn about `spacing` [m] apart."""
    from gcodesim.material.surface import Surface

    nodes = nodes_of(stock, max(1, round(spacing / stock.cell)))
    mesh = mesh_of(stock, nodes, whole(nodes))
    cut: NDArray[np.bool_] = np.any(mesh.cut[mesh.faces] > 0, axis=1)
    return Surface(vertices=mesh.points, faces=mesh.faces, cut=cut.astype(np.uint8))
