"""The size of a mesh; for common formats it is found without a mesh library."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import numpy as np

from gcodesim.solids import Point
from gcodesim.solids.obj_file import NUMBER, plain_points

MESH_SUFFIXES: Final = (".stl", ".obj", ".ply", ".off", ".glb")
_STL_HEADER: Final = 84
_STL_FACET: Final = 50
_STL_VERTEX = re.compile(rb"\bvertex\s+" + NUMBER + rb"\s+" + NUMBER + rb"\s+" + NUMBER)
_STL_VERTICES = re.compile(rb"\bvertex\b")

Corners = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
_READ_IT: Final = np.zeros((0, 3))
"""The file is not as most programs write it: whether it is sound is for the mesh library to say."""


def bounds(path: Path, raw: bytes) -> tuple[Point, Point] | str:
    """Least and greatest corner, in units of the file, of the mesh at `path` with content `raw`; a text says why there
    are none."""
    suffix = path.suffix.lower()
    points = _stl(raw) if suffix == ".stl" else _obj(raw) if suffix == ".obj" else _READ_IT
    if points is _READ_IT:
        from gcodesim.solids import read_mesh

        try:
            points = read_mesh(path)[0]
        except ValueError as fault:
            return str(fault)
    if points is None:
        return "the file is cut off"
    if len(points) == 0:
        return "it holds no triangle"
    if not np.isfinite(points).all():
        return "a corner is not a finite number"
    low, high = points.min(axis=0), points.max(axis=0)
    return (float(low[0]), float(low[1]), float(low[2])), (float(high[0]), float(high[1]), float(high[2]))


def _obj(raw: bytes) -> Corners:
    points = plain_points(raw)
    return _READ_IT if points is None else points


def _stl(raw: bytes) -> Corners | None:
    """Corners (n, 3) of a binary or ASCII STL; None if a binary one is shorter than it claims."""
    count = int.from_bytes(raw[80:_STL_HEADER], "little") if len(raw) >= _STL_HEADER else 0
    size = _STL_HEADER + _STL_FACET * count
    if raw.lstrip()[:5].lower() == b"solid" and b"facet" in raw[:4096] and len(raw) != size:
        points = _ascii(_STL_VERTEX, raw)
        return points if len(points) == len(_STL_VERTICES.findall(raw)) and len(points) % 3 == 0 else _READ_IT
    if len(raw) < size or len(raw) < _STL_HEADER:
        return None
    facets = np.frombuffer(
        raw, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("flags", "<u2")], count=count, offset=_STL_HEADER
    )
    return facets["corners"].reshape(-1, 3).astype(np.float64)


def _ascii(pattern: re.Pattern[bytes], raw: bytes) -> Corners:
    return np.array(pattern.findall(raw), dtype=np.float64).reshape(-1, 3)
