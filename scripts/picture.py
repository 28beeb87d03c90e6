"""Draw the part that a run left: `python scripts/picture.py out/demo/stock.stl docs/bracket.png`.

From the front left, from above, and from so far away that lines which are parallel stay so; shaded by the direction and
the height of each face.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from gcodesim.sensors.png import png_of
from gcodesim.sensors.raster_kernels import NOBODY, Exposed, Lens, expose

Array = NDArray[np.float64]

WIDTH = 800
FINER = 2  # the picture is drawn so much larger and then averaged, which smooths the edges
MARGIN = 0.03
FAR = 1e4  # how far away the eye is, in lengths of the part
TURN, TILT = np.radians(-28.0), np.radians(42.0)
LIGHT = np.array([-0.35, 0.45, 0.82])
METAL = np.array([196.0, 204.0, 214.0])
PAPER = 255.0


def view_axes() -> Array:
    """Rows: right, up, towards the eye, in axes of the part."""
    c, s = np.cos(TURN), np.sin(TURN)
    right = np.array([c, s, 0.0])
    into = np.array([-s, c, 0.0])
    up = np.sin(TILT) * into + np.array([0.0, 0.0, np.cos(TILT)])
    return np.stack([right, up, np.cross(right, up)])


def draw(corners: Array, width: int) -> NDArray[np.uint8]:
    """Picture (h, w, 3) of triangles (t, 3, 3)."""
    seen = corners @ view_axes().T
    normal = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])
    length = np.linalg.norm(normal, axis=1)
    facing = (length > 0.0) & (normal[:, 2] > 0.0)
    seen, normal = seen[facing], normal[facing] / length[facing, None]
    light = LIGHT / np.linalg.norm(LIGHT)
    shade = 0.35 + 0.65 * np.clip(normal @ light, 0.0, 1.0)
    height = corners[facing, :, 2].mean(axis=1)
    shade *= 0.8 + 0.2 * (height - height.min()) / max(float(np.ptp(height)), 1e-9)  # floors are darker than the top
    fine = width * FINER
    low, high = seen.min(axis=(0, 1)), seen.max(axis=(0, 1))
    scale = fine * (1.0 - 2.0 * MARGIN) / (high[0] - low[0])
    border = int(fine * MARGIN)
    height = int((high[1] - low[1]) * scale) + 2 * border
    height += -height % FINER
    film = Exposed(np.full((height, fine), np.inf), np.full((height, fine), NOBODY, np.int32))
    away = FAR * float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    camera = np.stack([seen[..., 0] - low[0], high[1] - seen[..., 1], high[2] - seen[..., 2] + away], axis=-1)
    expose(np.ascontiguousarray(camera), Lens(away * scale, away * scale, border, border, 0.5 * away), film)
    picture = np.full((height, fine, 3), PAPER)
    there = film.owner != NOBODY
    picture[there] = shade[film.owner[there], None] * METAL
    averaged = picture.reshape(height // FINER, FINER, width, FINER, 3).mean(axis=(1, 3))
    return averaged.round().astype(np.uint8)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", type=Path, metavar="STL", help="stock.stl of a run")
    parser.add_argument("picture", type=Path, metavar="PNG", help="the file to write")
    parser.add_argument("--width", type=int, default=WIDTH, metavar="PIXELS")
    arguments = parser.parse_args()
    mesh = trimesh.load_mesh(arguments.mesh)
    arguments.picture.write_bytes(png_of(draw(np.asarray(mesh.triangles, dtype=float), arguments.width)))


if __name__ == "__main__":
    main()
