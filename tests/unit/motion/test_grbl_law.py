"""Grbl's planner: the path as it is, corners by junction deviation; against a planner of the test's own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.printer_law import as_printed, is_printed, without_blending
from gcodesim.motion.timing import time_law
from gcodesim.motion.trajectory import Trajectory
from gcodesim.rs274 import Settings, interpret

Point = tuple[float, float, float]


def run(program: str, acceleration: Point, speed: Point, settings: Settings) -> Trajectory:
    reading = interpret(SourceText("corners.nc", program.encode()), settings)
    assert reading.failed is None
    path = build_tool_path(reading)
    assert is_printed(path)
    none = (math.inf,) * 3
    machine = AxisLimits(
        speed=np.array(speed + none) * 1e-3 / np.array([1.0] * 3 + [1e-3] * 3),
        acceleration=np.array(acceleration + none) * 1e-3 / np.array([1.0] * 3 + [1e-3] * 3),
    )
    return time_law(as_printed(blend(without_blending(path), machine, sampled=False, early=False)))


def planned(points: list[Point], feeds: list[float], a: Point, v: Point, deviation: float) -> float:
    """How long grbl takes [s]: `plan_buffer_line` and trapezoids between the speeds that it leaves; mm, s."""
    ways = np.diff(np.array(points), axis=0)
    length = np.linalg.norm(ways, axis=1)
    unit = ways / length[:, None]

    def along(limits: Point, direction: np.ndarray) -> float:
        return min(limit / abs(share) for limit, share in zip(limits, direction, strict=True) if share != 0.0)

    most = np.array([along(a, u) for u in unit])
    nominal = np.array([min(feed, along(v, u)) for feed, u in zip(feeds, unit, strict=True)])
    n = len(length)
    square = np.zeros(n + 1)
    for k in range(1, n):
        cosine = -float(unit[k - 1] @ unit[k])
        if cosine > 0.999999:
            continue
        square[k] = min(nominal[k - 1], nominal[k]) ** 2
        if cosine > -0.999999:
            turn = unit[k] - unit[k - 1]
            sine = math.sqrt(0.5 * (1.0 - cosine))
            square[k] = min(square[k], along(a, turn / np.linalg.norm(turn)) * deviation * sine / (1.0 - sine))
    for k in reversed(range(n)):
        square[k] = min(square[k], square[k + 1] + 2.0 * most[k] * length[k])
    for k in range(n):
        square[k + 1] = min(square[k + 1], square[k] + 2.0 * most[k] * length[k])
    total = 0.0
    for k in range(n):
        peak = min(nominal[k], math.sqrt(0.5 * (square[k] + square[k + 1]) + most[k] * length[k]))
        ramps = (2.0 * peak * peak - square[k] - square[k + 1]) / (2.0 * most[k])
        speeds = math.sqrt(square[k]) + math.sqrt(square[k + 1])
        total += (2.0 * peak - speeds) / most[k] + (length[k] - ramps) / peak
    return total


@pytest.mark.parametrize("seed", range(12))
def test_lines_take_as_long_as_grbl_plans_them(seed: int) -> None:
    """Drawn corners, short and long lines, rapids among them, machines whose axes differ, own deviations."""
    rng = np.random.default_rng(seed)
    acceleration = tuple(float(x) for x in rng.uniform(50.0, 2000.0, 3))
    speed = tuple(float(x) for x in rng.uniform(20.0, 200.0, 3))
    deviation = 0.01 if seed % 2 else float(rng.uniform(0.002, 0.1))
    points: list[Point] = [(0.0, 0.0, 0.0)]
    feeds, blocks = [], ["G21 G90 G94 G17"]
    for _ in range(30):
        step = rng.normal(size=3) * rng.choice([0.3, 3.0, 30.0]) * rng.choice([1.0, 1.0, 0.0], 3)
        if not step.any():
            step[0] = 5.0
        x, y, z = (round(float(v), 4) for v in np.array(points[-1]) + step)
        rapid, feed = rng.random() < 0.2, round(float(rng.uniform(100.0, 8000.0)), 1)
        blocks.append(f"G0 X{x} Y{y} Z{z}" if rapid else f"G1 X{x} Y{y} Z{z} F{feed}")
        points.append((x, y, z))
        feeds.append(math.inf if rapid else feed / 60.0)
    settings = Settings(dialect="grbl", limits={} if seed % 2 else {"deviation": deviation * 1e-3})
    found = run("\n".join([*blocks, "M2", ""]), acceleration, speed, settings)

    assert found.duration == pytest.approx(planned(points, feeds, acceleration, speed, deviation), rel=1e-6)


def test_the_path_is_followed_as_it_is() -> None:
    """Corners were rounded as LinuxCNC rounds them in G64 without P: a drill that comes from the side cut a slot."""
    program = "G21 G90 G94\nG1 X10 F1200\nG1 Z-5 F600\nG1 Z0\nG1 X20 Y5 F1200\nM2\n"
    found = run(program, (200.0, 200.0, 50.0), (80.0, 80.0, 10.0), Settings(dialect="grbl"))
    where = found.sample(np.linspace(0.0, found.duration, 20001)).position[:, :3] * 1e3
    deep = where[where[:, 2] < -1e-6]

    assert np.abs(deep[:, 0] - 10.0).max() < 1e-9
    assert where[:, 2].min() == pytest.approx(-5.0, abs=1e-3)
