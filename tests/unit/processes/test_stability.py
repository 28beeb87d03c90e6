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


def averaged(entry: float, leave: float, n: int = 20000) -> np.ndarray:
    """Directional matrix averaged over a turn, summed over small angles."""
    phi = entry + (np.arange(n) + 0.5) * (leave - entry) / n
    s, c = np.sin(phi), np.cos(phi)
    rows = [[-s * c - RATIO * s * s, -c * c - RATIO * s * c], [s * s - RATIO * s * c, s * c - RATIO * c * c]]
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
