"""Mesh files, read by one library in one place."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.extras import ExtraMissingError, require_extra
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.solids.obj_file import counted_from_one

Faces = NDArray[np.int32]

_HEADER: Final = 84  # bytes of a binary STL before its triangles; the last four count them
_TRIANGLE: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class MeshError(ValueError):
    """A mesh file without triangles that can be read; `hint` says what helps."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


@frozen(eq=False)
class Triangles:
    """Triangles `faces` (t, 3), counter-clockwise seen from outside, over `points` (v, 3) [m]."""

    points: Array
    faces: Faces

    @property
    def lowest(self) -> float:
        """The height [m] of its lowest point."""
        return float(self.points[:, 2].min())

    def moved(self, X: Pose) -> Triangles:
        """The same as it is seen from A, at X_AB."""
        return Triangles(points=X.apply(self.points), faces=self.faces)


@frozen
class MeshFile:
    """A mesh file; its numbers times `scale` along x, y, z are metres."""

    path: Path
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def read(self) -> Triangles:
        """ValueError when the file cannot be read or holds no triangles; the text says why."""
        points, faces = read_mesh(self.path)
        return Triangles(points=points * np.array(self.scale), faces=faces)


def read_mesh(path: Path, scale: float = 1.0) -> tuple[Array, Faces]:
    """Vertices (v, 3) [m] and faces (f, 3) of an STL, OBJ, PLY … file whose unit is `scale` metres.

    MeshError when the file cannot be read or holds no triangles; the text says why.
    """
    try:
        raw = path.read_bytes()
    except OSError as fault:
        raise MeshError(f"{path.name}: {fault}") from fault
    corners = _binary_stl(raw) if path.suffix.lower() == ".stl" else None
    if corners is None:
        points, triangles = _by_library(path, raw)
    else:
        points, triangles = corners, np.arange(len(corners), dtype=np.int64).reshape(-1, 3)
    vertices = np.ascontiguousarray(points, dtype=np.float64) * scale
    faces = np.ascontiguousarray(triangles, dtype=np.int32)
    if len(faces) == 0:
        raise MeshError(f"{path.name} holds no triangles")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise MeshError(f"{path.name}: a triangle names a corner that is not there")
    if not np.isfinite(vertices).all():
        raise MeshError(f"{path.name}: a corner is not a finite number")
    return vertices, faces


def _binary_stl(raw: bytes) -> Array | None:
    """The corners (3 t, 3) of a binary STL, three a triangle; None for any other file.

    Most meshes are in such files, and the library that reads all kinds takes seconds to be imported.
    """
    count = int.from_bytes(raw[_HEADER - 4 : _HEADER], "little")
    if len(raw) < _HEADER or len(raw) != _HEADER + _TRIANGLE.itemsize * count:
        return None
    corners: Array = np.frombuffer(raw, _TRIANGLE, offset=_HEADER)["corners"].reshape(-1, 3).astype(np.float64)
    return corners


def _by_library(path: Path, raw: bytes) -> tuple[Array, NDArray[np.int64]]:
    """Vertices and faces of a file of any kind; MeshError as of `read_mesh`."""
    import trimesh

    suffix = path.suffix[1:].lower()
    if suffix == "dae":
        try:
            require_extra("dae", "a mesh in Collada")
        except ExtraMissingError as missing:
            raise MeshError(f"{path.name}: {missing}", "or convert the file to STL or OBJ") from None
    try:
        # the bytes, not the path: the readers would open whatever else a file names, such as materials
        content = counted_from_one(raw) if suffix == "obj" else raw
        mesh = trimesh.load(BytesIO(content), file_type=suffix, force="mesh", process=False)
        return mesh.vertices, mesh.faces
    except Exception as fault:  # each kind of file has a reader that fails in its own ways
        raise MeshError(f"{path.name}: {fault or type(fault).__name__}") from fault
