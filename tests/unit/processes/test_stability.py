"""Stability lobes against the characteristic equation from which they come."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from gcodesim.processes.stability import Mode, lobes
from gcodesim.units import DEG

X = Mode(frequency=600.0, stiffness=5.6e6, damping=0.035)
Y = Mode(frequency=660.0, stiffness=5.7e6, damping=0.035)
KTC, RATIO, TEETH = 600e6, 0.07, 3


def averaged(entry: float, leave: float, ratio: float = RATIO, n: int = 20000) -> np.ndarray:
    """Directional matrix averaged over a turn, summed over small angles."""
    phi = entry + (np.arange(n) + 0.5) * (leave - entry) / n
    s, c = np.sin(phi), np.cos(phi)
    rows = [[-s * c - ratio * s * s, -c * c - ratio * s * c], [s * s - ratio * s * c, s * c - ratio * c * c]]
    return np.array([[2.0 * value.sum() for value in row] for row in rows]) * (leave - entry) / n


def compliance(mode: Mode, frequency: float) -> complex:
    r = frequency / mode.frequency
    return 1.0 / (mode.stiffness * (1.0 - r * r + 2j * mode.damping * r))


@pytest.mark.parametrize(("entry", "leave"), [(0.0, 180.0), (0.0, 60.0), (120.0, 180.0)])
def test_each_point_is_on_the_edge_of_stability(entry: float, leave: float) -> None:
    found = lobes(X, Y, ktc=KTC, ratio=RATIO, teeth=TEETH, entry=entry * DEG, exit=leave * DEG)
    matrix = averaged(entry * DEG, leave * DEG)
    assert len(found.depth) > 100

    for i in range(0, len(found.depth), len(found.depth) // 25):
        f, depth = found.frequency[i], found.depth[i]
        period = 2.0 * math.pi / TEETH / found.speed(1)[i]
        gain = TEETH / (4.0 * math.pi) * depth * KTC * (1.0 - cmath.exp(-2j * math.pi * f * period))
        loop = np.eye(2) - gain * matrix @ np.diag([compliance(X, f), compliance(Y, f)])
        assert abs(np.linalg.det(loop)) < 1e-3


def test_a_pocket_is_deeper_than_the_limit_and_a_lobe_is_not() -> None:
    found = lobes(X, X, ktc=KTC, ratio=RATIO, teeth=TEETH, entry=0.0, exit=60.0 * DEG)
    limit, chatter = found.limit
    pocket = found.depth_at(2.0 * math.pi * X.frequency / TEETH)
    at = int(np.argmin(found.depth))

    assert chatter > X.frequency
    assert pocket > 2.0 * limit
    assert found.depth_at(float(found.speed(2)[at])) == pytest.approx(limit, rel=1e-3)


@pytest.mark.parametrize("speed", [300.0, 4200.0, 10508.0, 17000.0])
def test_depth_at_a_speed_of_a_mode_that_hardly_damps(speed: float) -> None:
    """Beside a scan of a million frequencies for the roots of both curves; points evenly apart were 9 % too deep."""
    sharp, dull = (
        Mode(frequency=1740.0, stiffness=22e6, damping=0.0066),
        Mode(frequency=1530.0, stiffness=33e6, damping=0.05),
    )
    found = lobes(dull, sharp, ktc=3078e6, ratio=0.633, teeth=2, entry=134.0 * DEG, exit=math.pi)
    matrix = averaged(134.0 * DEG, math.pi, 0.633)
    f = np.linspace(1400.0, 2000.0, 1_000_001)
    x, y = (
        1.0 / (m.stiffness * (1.0 - (f / m.frequency) ** 2 + 2j * m.damping * f / m.frequency)) for m in (dull, sharp)
    )
    a0 = x * y * (matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0])
    a1 = matrix[0, 0] * x + matrix[1, 1] * y
    depths = []
    for sign in (1.0, -1.0):
        root = -(a1 + sign * np.sqrt(a1 * a1 - 4.0 * a0)) / (2.0 * a0)
        depth = -2.0 * math.pi * root.real / (2 * 3078e6) * (1.0 + (root.imag / root.real) ** 2)
        waves = f * 60.0 / (2 * speed) - (math.pi - 2.0 * np.arctan(root.imag / root.real)) / (2.0 * math.pi)
        step = np.diff(np.floor(waves))
        meets = (step != 0.0) & (np.abs(np.diff(waves)) < 0.5) & (depth[1:] > 0.0) & (depth[:-1] > 0.0)
        depths.extend(depth[:-1][meets & (waves[1:] > 0.0)])

    assert found.depth_at(speed * 2.0 * math.pi / 60.0) == pytest.approx(min(depths), rel=2e-3)
