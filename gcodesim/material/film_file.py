"""Files of a film: a coloured mesh for viewers, and a table of its faces."""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.material.film import BodyFilm
from gcodesim.units import MM, UM

TABLE_HEAD: Final = "x_mm,y_mm,z_mm,nx,ny,nz,area_mm2,film_um,wet_um\n"
MESH_HEAD: Final = b"ply\nformat binary_little_endian 1.0\ncomment gcodesim film"

RAMP: Final = ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))
"""Colours from none to the most, dark to light: five of viridis (van der Walt, Smith 2015), which print in grey."""

BARE: Final = (150, 150, 150)

_CORNER: Final = np.dtype([("place", "<f4", 3), ("colour", "u1", 3), ("film", "<f4")])
_FACE: Final = np.dtype([("corners", "u1"), ("corner", "<i4", 3), ("colour", "u1", 3), ("film", "<f4")])

Turn = Callable[[Array], Array]


def colours(thickness: Array, top: float, bare: float) -> NDArray[np.uint8]:
    """Red, green, blue (n, 3) of thicknesses (n,) [m]: grey below `bare`, then along the ramp up to `top`."""
    steps = np.array(RAMP, dtype=float)
    at = np.clip(thickness / (top or 1.0), 0.0, 1.0) * (len(steps) - 1)
    low = np.minimum(at.astype(np.int64), len(steps) - 2)
    mixed = steps[low] + (at - low)[:, None] * (steps[low + 1] - steps[low])
    mixed[thickness < bare] = BARE
    found: NDArray[np.uint8] = np.rint(mixed).astype(np.uint8)
    return found


def write_mesh(film: BodyFilm, file: BinaryIO, *, top: float, bare: float, in_part: Turn) -> None:
    """Binary PLY in mm: each face with its own corners, colour, and `film_um`; the colour `top` [m] is the lightest.

    Corners are not shared, so that viewers which colour corners show each face in one colour.
    """
    count = len(film)
    head = MESH_HEAD.decode() + (
        f", unit mm, film in um, lightest colour at {top / UM:.6g} um\n"
        f"element vertex {3 * count}\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float film_um\n"
        f"element face {count}\nproperty list uchar int vertex_indices\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float film_um\nend_header\n"
    )
    file.write(head.encode())
    colour, thickness = colours(film.coat.dry, top, bare), film.coat.dry / UM
    corners = np.zeros((count, 3), dtype=_CORNER)
    corners["place"] = in_part(film.points)[film.faces] / MM
    corners["colour"], corners["film"] = colour[:, None], thickness[:, None]
    file.write(corners.tobytes())
    faces = np.zeros(count, dtype=_FACE)
    faces["corners"], faces["corner"] = 3, np.arange(3 * count).reshape(count, 3)
    faces["colour"], faces["film"] = colour, thickness
    file.write(faces.tobytes())


def write_table(film: BodyFilm, file: BinaryIO, *, in_part: Turn) -> None:
    """CSV, one face a row: its middle, normal and area, and the thickness of its film, dry and as it was laid."""
    coat = film.coat
    origin = in_part(np.zeros((1, 3)))
    columns = np.column_stack(
        [
            in_part(coat.middle) / MM,
            in_part(coat.normal) - origin,
            coat.area / (MM * MM),
            coat.dry / UM,
            coat.wet / UM,
        ]
    )
    file.write(TABLE_HEAD.encode())
    row = "%.3f,%.3f,%.3f,%.4f,%.4f,%.4f,%.6g,%.6g,%.6g\n"
    for first in range(0, len(columns), 10_000):
        part = columns[first : first + 10_000] + 0.0
        file.write((row * len(part) % tuple(part.reshape(-1).tolist())).encode())
