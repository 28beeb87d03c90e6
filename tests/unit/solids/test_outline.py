"""Outlines of bodies of revolution."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.solids import Cylinder, Sphere, outline_of, widest
from tests.unit.solids.test_solid import BOX, CONE, ROD, SPINDLE


def test_outlines_run_from_the_top_down() -> None:
    ball = outline_of(Sphere(radius=0.01))

    assert np.all(np.diff(ball[:, 1]) < 0.0)
    assert np.hypot(*ball.T) == pytest.approx(0.01)
    assert outline_of(Cylinder(radius=1.0, bottom=2.0, top=3.0)).tolist() == [[1.0, 3.0], [1.0, 2.0]]
    with pytest.raises(ValueError, match="revolution"):
        outline_of(BOX)


def test_the_widest_place_is_the_greatest_distance_from_the_axis() -> None:
    assert widest(ROD) == 0.01
    assert widest(CONE) == 0.02
    assert widest(SPINDLE) == 0.01
    assert widest(BOX) == pytest.approx(np.hypot(0.03, 0.02))
