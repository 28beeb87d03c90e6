"""Draw the part that a run left: `python scripts/picture.py out/demo/stock.stl docs/bracket.png`.

An orthographic view from the front left, from above; shaded by the direction and the height of each face. The
triangles are covered with points less than a pixel apart, and of all points in a pixel the nearest is seen.
"""

from __future__ import annotations

import argparse
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

Array = NDArray[np.float64]

WIDTH = 800
FINER = 2  # the picture is drawn so much larger and then averaged, which smooths the edges
MARGIN = 0.03
MOST_POINTS = 500_000
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


def cover(corners: Array, spacing: float) -> Iterator[tuple[Array, NDArray[np.intp]]]:
    """Points (p, 3) on triangles (t, 3, 3), at most `spacing` apart, and the triangle of each; some at a time."""
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.maximum(np.ceil(edges / spacing), 1.0).astype(int)
    # few different sizes, so that many go at once
    parts = np.where(parts > 8, -(-parts // 64) * 64, 2 ** np.ceil(np.log2(parts)).astype(int))
    for n in np.unique(parts):
        mine = np.flatnonzero(parts == n)
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
        u, v = (i[i + j <= n] / n, j[i + j <= n] / n)
        weights = np.stack([1.0 - u - v, u, v], axis=1)
        batch = max(1, MOST_POINTS // len(weights))
        for first in range(0, len(mine), batch):
            chosen = mine[first : first + batch]
            yield np.einsum("pk,tkd->tpd", weights, corners[chosen]).reshape(-1, 3), np.repeat(chosen, len(weights))


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
    picture = np.full((height, fine, 3), PAPER)
    depth = np.full((height, fine), -np.inf)
    for points, owner in cover(seen, 0.7 / scale):
        order = np.argsort(points[:, 2], kind="stable")  # far ones first, so that near ones are written over them
        points, owner = points[order], owner[order]
        column = np.clip(((points[:, 0] - low[0]) * scale).astype(int) + border, 0, fine - 1)
        row = np.clip(((high[1] - points[:, 1]) * scale).astype(int) + border, 0, height - 1)
        nearer = points[:, 2] > depth[row, column]
        row, column = row[nearer], column[nearer]
        depth[row, column] = points[nearer, 2]
        picture[row, column] = shade[owner[nearer], None] * METAL
    averaged = picture.reshape(height // FINER, FINER, width, FINER, 3).mean(axis=(1, 3))
    return averaged.round().astype(np.uint8)


def png(picture: NDArray[np.uint8]) -> bytes:
    """A PNG file (W3C, 2003) of a picture (h, w, 3); every row is stored as its difference from the one to its left."""
    height, width = picture.shape[:2]
    left = np.zeros_like(picture)
    left[:, 1:] = picture[:, :-1]
    rows = np.concatenate([np.ones((height, 1), np.uint8), (picture - left).reshape(height, -1)], axis=1)

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", type=Path, metavar="STL", help="stock.stl of a run")
    parser.add_argument("picture", type=Path, metavar="PNG", help="the file to write")
    parser.add_argument("--width", type=int, default=WIDTH, metavar="PIXELS")
    arguments = parser.parse_args()
    mesh = trimesh.load_mesh(arguments.mesh)
    arguments.picture.write_bytes(png(draw(np.asarray(mesh.triangles, dtype=float), arguments.width)))


if __name__ == "__main__":
    main()
