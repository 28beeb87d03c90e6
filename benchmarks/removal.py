"""Removal by a ball end mill, by other kinds of cutters beside it, and its force at one step.

    python -m benchmarks.removal [CHORDS]

The yardstick of removal is a plain numpy kernel that lowers a height map one chord at a time. Force is a step of the
whole process (engagement at 64 angles x 16 heights, force, its peaks, removal) and printed in microseconds, the least
of some runs; it ends in an error unless all of the steps cut.
"""

from __future__ import annotations

import math
import sys
import time
from itertools import pairwise

import numpy as np

from benchmarks import job
from benchmarks.compare import RUNS, seconds, show
from gcodesim.frames import Array
from gcodesim.material.stock import Stock
from gcodesim.processes.laws import LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.processes.milling_kernels import FREE, FREEDOM
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS
from gcodesim.units import MM

RADIUS = 3.0 * MM
CELL = 0.25 * MM
LOW, HIGH = (0.0, 0.0, -0.02), (0.1, 0.06, 0.0)
OTHERS = {"bull_nose_end_mill": {"corner_radius": 1.0 * MM}, "flat_end_mill": {}, "drill": {}}
STEP = 0.1333 * MM  # of 4 ms at 2000 mm/min


def points(count: int) -> Array:
    """Tips (count + 1, 3) [m] along the rows of the reference job, beginning outside."""
    table = np.empty((count + 1, 3))
    for k in range(count + 1):
        row, i = divmod(k, job.CHORDS_OF_ROW + 1)
        x = float(i if row % 2 == 0 else job.CHORDS_OF_ROW - i)
        y = (row % job.ROWS_OF_LAYER + 0.5) * job.STEP_OVER
        table[k] = x, y, job.depth(x, y) - row // job.ROWS_OF_LAYER
    return table * MM


def by_numpy(tips: Array) -> Array:
    """Height map (nx, ny) [m] after the chords between tips; the tool's ball at the nearest point of each."""
    nx, ny = (round((HIGH[i] - LOW[i]) / CELL) for i in range(2))
    x, y = (np.arange(nx) + 0.5) * CELL, (np.arange(ny) + 0.5) * CELL
    heights = np.zeros((nx, ny))
    for a, b in pairwise(tips):
        low, high = np.minimum(a, b)[:2] - RADIUS, np.maximum(a, b)[:2] + RADIUS
        i0, j0 = np.maximum(np.floor(low / CELL).astype(int), 0)
        i1, j1 = np.ceil(high / CELL).astype(int) + 1
        px, py = x[i0:i1, None] - a[0], y[None, j0:j1] - a[1]
        d = b - a
        flat2 = max(d[0] ** 2 + d[1] ** 2, 1e-18)
        along = px * d[0] + py * d[1]
        across2 = np.maximum(px**2 + py**2 - along**2 / flat2, 0.0)
        slope = d[2] / math.sqrt(flat2)
        room = np.sqrt(np.maximum(RADIUS**2 - across2, 0.0))
        s = np.clip(along / flat2 - slope * room / math.sqrt(1.0 + slope**2) / math.sqrt(flat2), 0.0, 1.0)
        rho2 = (px - s * d[0]) ** 2 + (py - s * d[1]) ** 2
        floor = np.where(
            rho2 <= RADIUS**2, a[2] + s * d[2] + RADIUS - np.sqrt(np.maximum(RADIUS**2 - rho2, 0.0)), np.inf
        )
        heights[i0:i1, j0:j1] = np.minimum(heights[i0:i1, j0:j1], floor)
    return heights


def window(tips: Array, dt: float = 0.004) -> Window:
    """Steps of 0.13 mm along the chords between tips."""
    reach = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(tips, axis=0), axis=1))])
    s = np.arange(0.0, reach[-1], STEP)
    path = np.column_stack([np.interp(s, reach, tips[:, i]) for i in range(3)])
    n = len(path) - 1
    return Window(
        piece_start=path[:-1],
        piece_end=path[1:],
        piece_step=np.arange(n),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=np.diff(path, axis=0) / dt,
        rapid=np.zeros(n, dtype=bool),
        signals={"spindle": np.full(n, 1885.0), "active": np.zeros(n, dtype=bool)},
        dt=dt,
    )


def main(chords: int = 5000) -> None:
    tips = points(chords)
    tool = TOOLS["ball_end_mill"](number=1, diameter=2 * RADIUS, flutes=2, length=60 * MM)
    shape = tool.cutting_shape

    def whole() -> Stock:
        return Stock.box(LOW, HIGH, CELL)

    fresh = seconds(whole)
    ours = max(seconds(lambda: whole().remove(tips[:-1], tips[1:], shape)) - fresh, 1e-9)
    few = tips[: max(chords // 5, 1) + 1]
    theirs = seconds(lambda: by_numpy(few), 1)
    plain = (len(few) - 1) / theirs
    show("removal, ball end, upright", chords / ours, "plain numpy, height map", plain, "chords/s", 15)

    for kind, more in OTHERS.items():
        other = TOOLS[kind](number=1, diameter=2 * RADIUS, flutes=2, length=60 * MM, **more).cutting_shape
        spent = seconds(lambda shape=other: whole().remove(tips[:-1], tips[1:], shape)) - fresh  # type: ignore[misc]
        name, rate = kind.replace("_", " "), chords / spent
        print(f"{name:34} {rate:14,.0f} chords/s   {spent / ours:.2f} x a ball's time   goal 3 x")

    process = Milling(cutter=tool, law=LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8))
    steps = window(few)

    def cut(one: Milling) -> float:
        spent = []
        for _ in range(RUNS):
            state, stock = one.begin(), whole()
            state.values[FREEDOM] = FREE  # the raster begins in the block, which a tool otherwise does not cut
            begin = time.process_time()
            step = one.run(stock, steps, state)
            spent.append(time.process_time() - begin)
            if not np.all(step.columns["engaged"]):
                raise RuntimeError("not all steps cut: what is measured is no step with force")
        return min(spent) / steps.steps * 1e6

    print(f"{'a step of 0.13 mm, with force':34} {cut(process):14.1f} us")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
