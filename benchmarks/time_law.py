"""The time law of a path: pieces, caps, one pass back and one forth.

    python -m benchmarks.time_law [BLOCKS]

The yardstick is the same pair of passes over the same segments in numpy scalars and Python, without corner arcs.
toppra stands beside it where it is installed; there the joint path of an arm is timed too, by both on the same grid
under the same limits, and the durations have to agree within 0.1 %.
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
from gcodesim.kinematics import MODELS, load_urdf
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.timing import time_law
from gcodesim.planning.path_timing_kernels import fastest, seconds_along
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


def arm() -> None:
    """The least time of a joint path of a KR 10 through 12 vectors, on 2,000 grid points, beside toppra."""
    toppra: Any = importlib.import_module("toppra")
    algorithm: Any = importlib.import_module("toppra.algorithm")
    constraint: Any = importlib.import_module("toppra.constraint")
    chain, _ = load_urdf(MODELS["kuka_kr10_r1100_2"].path)
    assert chain is not None
    speed, acceleration = chain.driven_joints.speed, chain.driven_joints.acceleration
    q = np.random.default_rng(1).uniform(-1.0, 1.0, (12, len(speed)))
    knots, grid = np.linspace(0.0, 1.0, len(q)), np.linspace(0.0, 1.0, 2000)
    path = toppra.SplineInterpolator(knots, q, bc_type="natural")
    limits = [
        constraint.JointVelocityConstraint(np.column_stack([-speed, speed])),
        constraint.JointAccelerationConstraint(np.column_stack([-acceleration, acceleration])),
    ]
    first, second = np.ascontiguousarray(path(grid, 1)), np.ascontiguousarray(path(grid, 2))
    reach, times = np.empty(len(grid)), np.empty(len(grid))

    def ours() -> None:
        most = 1.0 / (np.abs(first) / speed).max(axis=1) ** 2
        fastest(grid, first, second, most, acceleration, reach)
        seconds_along(grid, reach, times)

    def theirs() -> Array:
        found: Array = algorithm.TOPPRA(limits, path, gridpoints=grid).compute_parameterization(0, 0)[1]
        return found

    rates = theirs()
    duration = float((2.0 * np.diff(grid) / (rates[1:] + rates[:-1])).sum())
    rate = len(grid) / seconds(ours)
    show("joint path of an arm", rate, "toppra", len(grid) / seconds(theirs, 3), "points/s", 15)
    off = float(times[-1]) / duration - 1.0
    print(f"  its duration is {times[-1]:.6f} s, that of toppra {duration:.6f} s: {100.0 * off:+.5f} %")
    if abs(off) > 1e-3:
        raise SystemExit("the durations differ by more than 0.1 %")


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
        arm()


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
