"""The time law of a path: pieces, caps, one pass back and one forth.

    python -m benchmarks.time_law [BLOCKS]

The yardstick is the same pair of passes over the same segments in numpy scalars and Python, without corner arcs.
toppra stands beside it where it is installed.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from typing import Any

import numpy as np

from benchmarks import job
from benchmarks.compare import seconds, show
from gcodesim.diagnostics import SourceText
from gcodesim.frames import Array
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.timing import time_law
from gcodesim.rs274 import interpret


def plain(length: Array, speed: float, acceleration: float) -> float:
    """Duration [s] of segments (n,) [m] run one after the other under one speed and one acceleration."""
    reach = np.zeros(len(length) + 1)
    for i in range(len(length) - 1, 0, -1):
        reach[i] = min(speed, (reach[i + 1] ** 2 + 2.0 * acceleration * length[i]) ** 0.5)
    total = 0.0
    for i, way in enumerate(length):
        reach[i + 1] = min(reach[i + 1], (reach[i] ** 2 + 2.0 * acceleration * way) ** 0.5)
        top = min(speed, ((reach[i] ** 2 + reach[i + 1] ** 2) / 2.0 + acceleration * way) ** 0.5)
        ramp = (2.0 * top**2 - reach[i] ** 2 - reach[i + 1] ** 2) / (2.0 * acceleration)
        total += (2.0 * top - reach[i] - reach[i + 1]) / acceleration + max(way - ramp, 0.0) / top
    return float(total)


def toppra_seconds(points: Array) -> float | None:
    """Processor time of toppra on the polyline (n, 3); None when it is not installed."""
    if importlib.util.find_spec("toppra") is None:
        return None
    toppra: Any = importlib.import_module("toppra")
    algorithm: Any = importlib.import_module("toppra.algorithm")
    constraint: Any = importlib.import_module("toppra.constraint")
    s = np.linspace(0.0, 1.0, len(points))
    path = toppra.SplineInterpolator(s, points)
    limits = [
        constraint.JointVelocityConstraint(np.tile([-0.5, 0.5], (3, 1))),
        constraint.JointAccelerationConstraint(np.tile([-2.0, 2.0], (3, 1))),
    ]
    return seconds(lambda: algorithm.TOPPRA(limits, path, gridpoints=s).compute_trajectory(0, 0), 1)


def main(blocks: int = 20_000) -> None:
    path = build_tool_path(
        list(interpret(SourceText("reference.nc", "\n".join(job.moves(blocks)).encode()))), (0.0,) * 6
    )
    limits = AxisLimits(speed=np.full(6, 0.5), acceleration=np.full(6, 2.0))
    length = path.length[path.length > 0.0]
    pieces = blend(path, limits)
    ours = seconds(lambda: time_law(pieces))
    both = seconds(lambda: time_law(blend(path, limits)))
    theirs = len(length) / seconds(lambda: plain(length, 2.0 / 60.0, 2.0), 1)
    show("time law", len(length) / ours, "two passes in Python", theirs, "segments/s")
    show("corner arcs and time law", len(length) / both, "two passes in Python", theirs, "segments/s")
    other = toppra_seconds(path.end[path.length > 0.0][:2000, :3])
    if other is None:
        print("toppra is not installed, so it is not beside")
    else:
        show("corner arcs and time law", len(length) / both, "toppra", min(len(length), 2000) / other, "segments/s", 15)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
