"""Moments of inertia in closed form."""

from __future__ import annotations

import pytest

from gcodesim.solids import Cone, moments
from tests.unit.solids.test_solid import BALL, BOX, ROD


def test_moments_of_a_box_a_rod_and_a_ball() -> None:
    assert moments(BOX, 2.0) == pytest.approx((2 * 5e-4 / 12, 2 * 17e-4 / 12, 2 * 20e-4 / 12))
    across = 3.0 * (0.01**2 / 4.0 + 0.06**2 / 12.0)
    assert moments(ROD, 3.0) == pytest.approx((across, across, 3.0 * 0.01**2 / 2.0))
    assert moments(BALL, 1.0) == pytest.approx((4e-5,) * 3)


def test_a_cone_of_equal_ends_is_a_rod() -> None:
    assert moments(Cone(bottom_radius=0.01, top_radius=0.01, bottom=-0.02, top=0.04), 3.0) == moments(ROD, 3.0)
