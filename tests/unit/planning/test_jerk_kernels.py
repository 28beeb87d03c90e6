"""Jerk of steps at borders: what is passed within a control cycle counts together, and stays within the limit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.planning.arm_kernels import JointCaps, SegmentRates
from gcodesim.planning.jerk import softer
from gcodesim.simulation import Options, prepare

CYCLE, SHARE = 1e-3, 0.9
LIMIT = np.array([50.0])


def borders(slope: list[float], length: list[float], speed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speeds, and what is left of jerk, at the ends of straight segments of one joint, with `slope` of it each."""
    n = len(slope)
    rates = SegmentRates(*(np.array(slope)[:, None].copy() for _ in range(3)))
    caps = JointCaps(*(np.full(n, speed) for _ in range(2)), np.full(n, 10.0), np.zeros(n, dtype=np.int64), np.zeros(n))
    follows = np.append(np.ones(n - 1, dtype=bool), False)
    lower = softer(rates, np.array(length), follows, np.zeros(n, dtype=bool), LIMIT, caps, np.full(n, np.inf))
    return lower.junction, lower.soft.calm, lower.soft.push


def test_a_kink_and_the_jerk_of_the_law_share_the_limit() -> None:
    """A step of q' by k at speed v is a jerk of k v / T² over a cycle T."""
    junction, calm, push = borders([0.5, 0.501], [0.1, 0.1], 1.0)
    taken = 0.001 * junction[0] / CYCLE**2

    assert taken == pytest.approx(0.75 * SHARE * LIMIT[0], rel=1e-6)
    assert taken + 0.501 * calm[0] + 0.001 * push[0] / CYCLE <= SHARE * LIMIT[0] * (1 + 1e-9)
    assert calm[0] > 0.0 and push[0] > 0.0


def test_kinks_within_two_cycles_count_together() -> None:
    far = borders([0.5, 0.501, 0.5], [0.1, 0.1, 0.1], 1.0)[0]
    near = borders([0.5, 0.501, 0.5], [0.1, 1e-6, 0.1], 1.0)[0]

    assert near[:2] == pytest.approx(0.5 * far[:2], rel=1e-6)


def test_a_border_without_a_step_is_no_cap() -> None:
    junction, calm, _ = borders([0.5, 0.5], [0.1, 0.1], 1.0)

    assert junction[0] == 1.0
    assert calm[0] >= 1e30


def test_a_straight_way_has_the_whole_limit() -> None:
    """Where nothing bends, a joint jerks q' times as much as the law; beside a kink a tenth is left for the rest."""
    rates = SegmentRates(*(np.array([0.5, 0.5, 0.501])[:, None].copy() for _ in range(3)))
    caps = JointCaps(*(np.ones(3) for _ in range(2)), np.full(3, 10.0), np.zeros(3, dtype=np.int64), np.zeros(3))
    follows, smooth = np.array([True, True, False]), np.zeros(3, dtype=bool)
    jerk = softer(rates, np.full(3, 0.1), follows, smooth, LIMIT, caps, np.full(3, np.inf)).soft.jerk

    assert jerk * rates.start[:, 0] == pytest.approx(np.array([1.0, SHARE, SHARE]) * LIMIT, rel=1e-6)


def test_a_corner_at_which_the_machine_stands_leaves_the_whole_limit() -> None:
    rates = SegmentRates(*(np.array([0.5, -0.25])[:, None].copy() for _ in range(3)))
    caps = JointCaps(*(np.ones(2) for _ in range(2)), np.full(2, 10.0), np.zeros(2, dtype=np.int64), np.zeros(2))
    follows, stands = np.array([True, False]), np.array([0.0, 0.0])
    lower = softer(rates, np.full(2, 0.1), follows, np.zeros(2, dtype=bool), LIMIT, caps, stands)

    assert lower.soft.jerk * np.abs(rates.start[:, 0]) == pytest.approx(np.full(2, LIMIT[0]), rel=1e-6)
    assert lower.junction.tolist() == [0.0, 0.0]


def test_a_lift_behind_a_feed_takes_as_long_as_its_own_s_curve() -> None:
    """200 mm from rest to rest at 5 m/s² and 100 m/s³: v/a + a/j for each ramp, v from v (v/a + a/j) = 200 mm."""
    axes = "".join(
        f"    {letter}: {{travel: [-900, 900 mm], speed: 60 m/min, acceleration: 5 m/s^2, jerk: 100 m/s^3}}\n"
        for letter in "XYZ"
    )
    cell = SourceText("cell.yaml", f"gcodesim: 1\nmachine:\n  axes:\n{axes}".encode())
    program = SourceText("lift.nc", b"G21 G90 G94 G61.1\nG1 X50 F3000\nG0 Z200\nG0 X100\nM2\n")
    plan = prepare(program, read_cell(cell, Path("cell.yaml")), Options(world="kinematic")).plan
    assert plan is not None
    ramp = 5.0 / 100.0
    speed = 0.5 * 5.0 * (-ramp + np.sqrt(ramp * ramp + 4.0 * 0.2 / 5.0))

    taken = plan.trajectory.row_time[[plan.path.span(row).line for row in range(len(plan.path))].index(3)]

    assert taken == pytest.approx(2.0 * (speed / 5.0 + ramp), rel=5e-3)
