"""Binary STL, the file that every program reads; the same surface gives the same bytes."""

from __future__ import annotations

from typing import BinaryIO, Final

import numpy as np

from gcodesim.arithmetic.matrices import norms
from gcodesim.material.surface import Surface
from gcodesim.units import MM

HEADER = b"gcodesim binary STL, unit mm"
"""Must not begin with 'solid', otherwise readers take the file for text."""

_RECORD = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])

_AT_A_TIME: Final = 16_384
"""Triangles written at once: millions need no memory beside the surface, and a block fits into the cache."""


def write_stl(surface: Surface, file: BinaryIO) -> None:
    """Write the surface in mm, the unit that readers of STL assume."""
    file.write(HEADER.ljust(80, b"\0"))
    file.write(np.uint32(len(surface.faces)).astype("<u4").tobytes())
    for first in range(0, len(surface.faces), _AT_A_TIME):
        triangles = surface.vertices[surface.faces[first : first + _AT_A_TIME]] / MM
        records = np.zeros(len(triangles), dtype=_RECORD)
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        lengths = norms(normals)[:, None]
        records["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
        records["points"] = triangles
        file.write(records.tobytes())
