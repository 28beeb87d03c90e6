"""Zones: whether a process may meet a box on its way, compared with many points of the zone."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.processes.zone import EVERYWHERE, Zone

LOW, HIGH = np.array([0.0, 0.0, -0.02]), np.array([0.06, 0.04, 0.0])
UP = np.array([[0.0, 0.0, 1.0]])


def meets(zone: Zone, tip: tuple[float, float, float], axis: np.ndarray = UP, margin: float = 0.0) -> bool:
    at = np.array([tip])
    return zone.meets(at, at, axis, LOW, HIGH, margin)


def test_a_laser_acts_below_its_tip() -> None:
    near, far = Zone(radius=1e-4, below=1e-3), Zone(radius=1e-4, below=0.3)

    assert meets(near, (0.03, 0.02, 0.9e-3)) and not meets(near, (0.03, 0.02, 1.1e-3))
    assert meets(far, (0.03, 0.02, 0.299)) and not meets(far, (0.03, 0.02, 0.301))
    assert not meets(far, (0.07, 0.02, 0.1))  # beside the box
    assert not meets(far, (0.03, 0.02, -0.021))  # below the box, looking down


def test_a_shank_acts_above_its_tip() -> None:
    mill = Zone(radius=5e-3, above=0.05)

    assert meets(mill, (0.03, 0.02, -0.06)) and not meets(mill, (0.03, 0.02, -0.08))
    assert meets(mill, (-4.9e-3, 0.02, -0.01)) and not meets(mill, (-5.1e-3, 0.02, -0.01))
    assert meets(mill, (-5.1e-3, 0.02, -0.01), margin=1e-3)


def test_a_zone_may_begin_away_from_the_tip() -> None:
    beyond = Zone(radius=1e-3, below=0.3, above=-0.1)

    assert meets(beyond, (0.03, 0.02, 0.2))
    assert not meets(beyond, (0.03, 0.02, 0.07))  # the box ends before the zone begins


def test_nothing_is_outside_a_zone_without_end() -> None:
    assert EVERYWHERE.everywhere
    assert meets(EVERYWHERE, (9.0, 9.0, 9.0))


@pytest.mark.parametrize("seed", range(40))
def test_a_zone_with_a_point_in_the_box_always_meets_it(seed: int) -> None:
    """At any tilt and along any way; a false yes is allowed, a false no is not."""
    rng = np.random.default_rng(seed)
    zone = Zone(radius=rng.uniform(1e-4, 0.02), below=rng.uniform(0.0, 0.1), above=rng.uniform(-0.01, 0.1))
    axis = rng.normal(size=(5, 3)) * [1.0, 1.0, 3.0]
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    start, end = rng.uniform(-0.1, 0.1, (2, 5, 3))
    hit = False
    for a, b, k in zip(start, end, axis, strict=True):
        side = np.cross(k, rng.normal(size=3))
        side /= np.linalg.norm(side)
        share, along, out = rng.uniform(size=(3, 4000, 1))
        at = a + share * (b - a) + (along * (zone.above + zone.below) - zone.below) * k + out * zone.radius * side
        hit |= bool(((at > LOW) & (at < HIGH)).all(axis=1).any())
    assert zone.meets(start, end, axis, LOW, HIGH) or not hit
