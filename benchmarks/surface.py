"""The surface of a milled block of 32 million cells, beside scikit-image's marching cubes where that is installed.

    python -m benchmarks.surface [CELLS_ALONG]

A ball end mill has gone to and fro over the whole block. The yardstick gets the same block as cells that are in or out,
and makes its triangles of them.
"""

from __future__ import annotations

import importlib.util
import sys

import numpy as np

from benchmarks import job
from benchmarks.compare import seconds, show
from gcodesim.frames import Array
from gcodesim.material.stock import Stock
from gcodesim.tools import TOOLS
from gcodesim.units import MM

SIZE, HEIGHT = 100.0, 50.0  # mm
STEP_OVER = 1.0  # mm
GOAL = 5.0


def raster() -> Array:
    """Tips (n, 3) [m] of a ball to and fro over the whole block, whose top is at 0."""
    rows = []
    for k, y in enumerate(np.arange(0.5 * STEP_OVER, SIZE, STEP_OVER)):
        x = np.arange(0.0, SIZE + 0.5 * job.CHORD, job.CHORD)[:: -1 if k % 2 else 1]
        rows.append([(place, y, job.depth(place, y)) for place in x.tolist()])
    return np.concatenate(rows) * MM


def milled(along: int) -> Stock:
    """The block with cells of SIZE / `along`, after the raster."""
    stock = Stock.box((0.0, 0.0, -HEIGHT * MM), (SIZE * MM, SIZE * MM, 0.0), SIZE * MM / along)
    tips = raster()
    tool = TOOLS["ball_end_mill"](number=1, diameter=6.0 * MM, flutes=2, length=60 * MM)
    stock.remove(tips[:-1], tips[1:], tool.cutting_shape)
    return stock


def cells_of(stock: Stock) -> Array:
    """Whether material is in the middle of each cell, with air around: 1 or 0."""
    low, size = -HEIGHT * MM, stock.cell
    z = low + (np.arange(round(HEIGHT * MM / size)) + 0.5) * size
    top = np.nan_to_num(stock.relief().tops, nan=-np.inf)
    return np.pad((z < top[:, :, None]).astype(np.float32), 1)


def main(along: int = 400) -> None:
    stock = milled(along)
    cells = along * along * along // 2
    ours = seconds(stock.surface)
    faces = len(stock.surface().faces)
    if importlib.util.find_spec("skimage") is None:
        print(f"surface of {cells / 1e6:.0f} M cells: {ours:.3f} s, {faces:,} faces (scikit-image is not installed)")
        return
    from skimage.measure import marching_cubes

    voxels = cells_of(stock)
    theirs = seconds(lambda: marching_cubes(voxels, 0.5), 3)
    show(f"surface of {cells / 1e6:.0f} M cells", cells / ours, "marching cubes", cells / theirs, "cells/s", GOAL)
    print(f"{faces:,} faces in {ours:.3f} s; scikit-image {len(marching_cubes(voxels, 0.5)[1]):,} in {theirs:.3f} s")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
