"""Mesh files, read by one library in one place."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gcodesim.extras import ExtraMissingError, require_extra
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.solids.obj_file import counted_from_one

Faces = NDArray[np.int32]


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
    import trimesh

    if path.suffix.lower() == ".dae":
        try:
            require_extra("dae", "a mesh in Collada")
        except ExtraMissingError as missing:
            raise MeshError(f"{path.name}: {missing}", "or convert the file to STL or OBJ") from None
    try:
        raw, suffix = path.read_bytes(), path.suffix[1:].lower()
        # the bytes, not the path: the readers would open whatever else a file names, such as materials
        content = counted_from_one(raw) if suffix == "obj" else raw
        mesh = trimesh.load(BytesIO(content), file_type=suffix, force="mesh", process=False)
    except Exception as fault:  # each kind of file has a reader that fails in its own ways
        raise MeshError(f"{path.name}: {fault or type(fault).__name__}") from fault
    vertices = np.ascontiguousarray(mesh.vertices, dtype=np.float64) * scale
    faces = np.ascontiguousarray(mesh.faces, dtype=np.int32)
    if len(faces) == 0:
        raise MeshError(f"{path.name} holds no triangles")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise MeshError(f"{path.name}: a triangle names a corner that is not there")
    if not np.isfinite(vertices).all():
        raise MeshError(f"{path.name}: a corner is not a finite number")
    return vertices, faces
