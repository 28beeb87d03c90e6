"""No print goes beyond what its firmware allows: the motion itself, over programs and limits drawn at random.

Corners are passed at speed by a step in the speed of axes. What a step counts is written down here once more: by jerk
as Marlin counts it, by deviation and square corner velocity as a circle that stays near to the corner (Jeon 2011).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin, sqrt
from pathlib import Path
from random import Random

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.motion.tool_path import ToolPath
from gcodesim.motion.trajectory import Trajectory
from gcodesim.simulation import prepare

MM = 1e-3
CELL = """gcodesim: 1
machine:
  axes:
    X: {travel: [-500, 500 mm], speed: 2 m/s, acceleration: 50 m/s^2}
    Y: {travel: [-500, 500 mm], speed: 2 m/s, acceleration: 50 m/s^2}
    Z: {travel: [-500, 500 mm], speed: 2 m/s, acceleration: 50 m/s^2}
dialect: marlin
tools: {0: {type: extruder, bead_width: 0.6, bead_height: 0.3, length: 40}}
"""
BESIDE = 1e-7  # [s] of the ends of phases, at which speeds are asked for
ROUNDING = 1e-7  # of limits: accelerations are differences of speeds over phases of a few times BESIDE


@dataclass(frozen=True)
class Print:
    """A program and its limits in mm and s: of X, Y, Z, E by axis, and what rules its corners by `rule`."""

    program: str
    speed: list[float]
    acceleration: list[float]
    printing: float
    travel: float
    rule: str
    corner: list[float]


def drawn(rng: Random) -> Print:
    """Lines that bend a little, sharply, or turn back; some short, some without filament."""

    def between(*ends: tuple[float, float]) -> list[float]:
        return [round(rng.uniform(*each), 3) for each in ends]

    speed = between((50, 400), (50, 400), (5, 40), (10, 60))
    acceleration = between((500, 5000), (500, 5000), (50, 500), (500, 9000))
    printing, travel = between((300, 5000), (300, 5000))
    rule = rng.choice(("jerk", "deviation", "square"))
    jerk = between((2, 20), (2, 20), (0.1, 1), (1, 8))
    by_axis = [
        " ".join(f"{letter}{v:.3f}" for letter, v in zip("XYZE", values, strict=True))
        for values in (speed, acceleration, jerk)
    ]
    deviation, square = between((0.005, 0.08), (2, 15))
    words = {
        "jerk": f"M205 {by_axis[2]}",
        "deviation": f"M205 J{deviation:.4f} E{jerk[3]:.3f}",
        "square": f"SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY={square:.3f}",
    }
    lines = [f"M203 {by_axis[0]}", f"M201 {by_axis[1]}", f"M204 P{printing:.3f} T{travel:.3f} R1000", words[rule]]
    lines += ["M83", "G1 X0 Y0 Z5 F6000", "M400"]
    x, y, z, heading = 0.0, 0.0, 5.0, rng.uniform(0, 2 * pi)
    for _ in range(60):
        heading += rng.choice((0.0, 0.02, 0.3, 1.5, pi)) * rng.uniform(-1, 1)
        way = 10 ** rng.uniform(-1.0, 1.5)
        x, y = x + way * cos(heading), y + way * sin(heading)
        z += rng.choice((0.0, 0.0, 0.2))
        e = f" E{0.04 * way:.5f}" if rng.random() < 0.8 else ""
        lines.append(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f}{e} F{10 ** rng.uniform(3.0, 4.4):.0f}")
    corner = {"jerk": jerk, "deviation": [deviation, jerk[3]], "square": [square]}[rule]
    return Print("\n".join([*lines, ""]), speed, acceleration, printing, travel, rule, corner)


def trajectory_of(text: str) -> Trajectory:
    loaded = read_cell(SourceText("cell.yaml", CELL.encode()), Path("cell.yaml"))
    job = prepare(SourceText("print.gcode", text.encode()), loaded, Options(world="kinematic"))
    assert job.plan is not None, [f.message for f in job.findings]
    return job.plan.trajectory


def velocities(trajectory: Trajectory, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Speeds (n, 4) [mm/s] of X, Y, Z and E, and the rows of the path."""
    found = trajectory.sample(t)
    length = np.maximum(trajectory.path.length, 1e-12)[found.row]
    filament = trajectory.path.extrude[found.row] / length * found.speed
    return np.column_stack([found.velocity[:, :3], filament]) / MM, found.row


def corner_share(each: Print, before: np.ndarray, after: np.ndarray, acceleration: float) -> float:
    """Of what is allowed in a corner that is passed with these speeds (4,), how much is used."""
    v = float(np.linalg.norm(after[:3]))
    if v < 1e-6:
        return 0.0
    if each.rule == "jerk":
        step = np.where(before * after < 0.0, np.maximum(abs(before), abs(after)), abs(before - after))
        return float((step / np.array(each.corner)).max())
    cosine = -float(before[:3] @ after[:3]) / (float(np.linalg.norm(before[:3])) * v)
    if cosine < -0.999999:
        return 0.0
    s = sqrt(0.5 * (1.0 - min(cosine, 0.999999)))
    square = s / (1.0 - s)
    if each.rule == "square":
        return v / (each.corner[0] * sqrt((sqrt(2.0) - 1.0) * square))
    # the extruder keeps its jerk
    return max(v / sqrt(acceleration * each.corner[0] * square), abs(after[3] - before[3]) / each.corner[1])


def shares(each: Print) -> tuple[float, float, float]:
    """The greatest shares of speed, of acceleration and of corners that are used."""
    trajectory = trajectory_of(each.program)
    phases, path = trajectory.phases, trajectory.path
    corner = 0.0
    begin, end = phases.time, phases.time + phases.duration
    inside = (phases.event < 0) & (phases.duration > 4.0 * BESIDE)
    first, row = velocities(trajectory, begin[inside] + BESIDE)
    last, _ = velocities(trajectory, end[inside] - BESIDE)
    rate = (last - first) / (phases.duration[inside] - 2.0 * BESIDE)[:, None]
    first, last = first - BESIDE * rate, last + BESIDE * rate  # a phase has one acceleration
    own = np.where(path.extrude[row] != 0.0, each.printing, each.travel)
    speed = float((np.abs(np.concatenate([first, last])) / each.speed).max())
    acceleration = max(
        float((np.abs(rate) / each.acceleration).max()),
        float((np.linalg.norm(rate[:, :3], axis=1) / own).max()),
    )
    for k in np.flatnonzero(row[1:] != row[:-1]):
        if abs(end[inside][k] - begin[inside][k + 1]) < BESIDE:
            share = corner_share(each, last[k], first[k + 1], float(min(_along(each, path, row[k : k + 2]))))
            corner = max(corner, share)
    return speed, acceleration, corner


def _along(each: Print, path: ToolPath, rows: np.ndarray) -> np.ndarray:
    """The accelerations [mm/s²] along rows (k,) that all limits together allow."""
    way = np.column_stack([path.end[rows, :3] - path.start[rows, :3], path.extrude[rows]])
    share = np.abs(way) / np.linalg.norm(way[:, :3], axis=1)[:, None]
    own = np.where(path.extrude[rows] != 0.0, each.printing, each.travel)
    return np.minimum(own, (np.array(each.acceleration) / np.maximum(share, 1e-9)).min(axis=1))


def check(seeds: range) -> None:
    used = np.zeros(3)
    for seed in seeds:
        found = np.array(shares(drawn(Random(f"print {seed}"))))
        assert (found <= 1.0 + ROUNDING).all(), (seed, found)
        used = np.maximum(used, found)
    assert (used > 0.9).all()  # and limits are made use of


def test_no_print_is_beyond_the_limits_of_its_firmware() -> None:
    check(range(6))


@pytest.mark.slow
def test_no_print_of_many_is_beyond_the_limits_of_its_firmware() -> None:
    check(range(6, 200))
