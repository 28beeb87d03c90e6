"""Closed meshes: read from a file, and turned into a stock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.stock import Stock, grid_of

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


class OpenMeshError(ValueError):
    """The mesh does not enclose a volume: along some columns it is entered and never left."""

    def __init__(self, columns: int, of: int) -> None:
        super().__init__(f"the mesh is not closed: {columns} of {of} columns enter it and never leave it")
        self.columns = columns


def read_mesh(path: Path, scale: float = 1.0) -> tuple[Array, Ints]:
    """Vertices (v, 3) [m] and faces (f, 3) of an STL, OBJ, PLY … file whose unit is `scale` metres.

    ValueError when the file cannot be read or holds no triangles; the text says why.
    """
    import trimesh

    try:
        mesh = trimesh.load(str(path), force="mesh", process=False)
    except Exception as fault:  # each kind of file has a reader that fails in its own ways
        raise ValueError(f"{path.name}: {fault or type(fault).__name__}") from fault
    vertices = np.ascontiguousarray(mesh.vertices, dtype=np.float64) * scale
    faces = np.ascontiguousarray(mesh.faces, dtype=np.int32)
    if len(faces) == 0:
        raise ValueError(f"{path.name} holds no triangles")
    return vertices, faces


def stock_of_mesh(vertices: Array, faces: Ints, resolution: float, material: str = "") -> Stock:
    """Stock in the shape of a closed mesh: vertices (v, 3) [m] in S, faces (f, 3) counter-clockwise from outside.

    Overlapping closed shells unite; a mesh that is inside out is turned. OpenMeshError when it is not closed.
    """
    from gcodesim.material.raster_kernels import crossings, fill_columns

    vertices = np.ascontiguousarray(vertices, dtype=np.float64)
    faces = np.ascontiguousarray(faces, dtype=np.int32)
    a, b, c = (vertices[faces[:, k]] - vertices[0] for k in range(3))
    if np.einsum("ij,ij->i", a, np.cross(b, c)).sum() < 0.0:
        faces = np.ascontiguousarray(faces[:, ::-1])
    minimum, maximum = vertices.min(axis=0), vertices.max(axis=0)
    grid, shape = grid_of(minimum, maximum, resolution)

    found = np.zeros(shape, dtype=np.int32)
    start = np.zeros(shape, dtype=np.int32)
    nothing = np.zeros(0)
    crossings(vertices, faces, grid, found, nothing, start, start, False)
    start = (np.cumsum(found.ravel()) - found.ravel()).astype(np.int32).reshape(shape)
    heights = np.zeros(int(found.sum()))
    ups = np.zeros(len(heights), dtype=np.int32)
    crossings(vertices, faces, grid, found, heights, ups, start, True)

    lo, hi = np.zeros((*shape, 1)), np.zeros((*shape, 1))
    count = np.zeros(shape, dtype=np.int32)
    most, leaks = fill_columns(found, heights, ups, start, lo, hi, count, True)
    if leaks:
        raise OpenMeshError(leaks, count.size)
    lo, hi = np.zeros((*shape, max(most, 1))), np.zeros((*shape, max(most, 1)))
    fill_columns(found, heights, ups, start, lo, hi, count, False)
    return Stock(
        lo=lo,
        hi=hi,
        count=count,
        grid=grid,
        z_range=(float(minimum[2]), float(maximum[2])),
        resolution=resolution,
        material=material,
    )
