"""Corner arcs touch both curves; compared with the tangency conditions themselves."""

from __future__ import annotations

from math import cos, hypot, isnan, pi, sin, tan

import numpy as np
import pytest

from gcodesim.motion.corner_kernels import corner_center, corner_radius, way_from_corner


def distance_to(x: float, y: float, angle: float, r: float, side: float) -> float:
    """From a point to the whole line or circle that leaves the origin at `angle`."""
    along, across = cos(angle) * x + sin(angle) * y, cos(angle) * y - sin(angle) * x
    return abs(across) if r == 0.0 else abs(hypot(along, across - side * r) - r)


@pytest.mark.parametrize("r1", [0.0, 3.0, 0.5])
@pytest.mark.parametrize("r2", [0.0, 2.0])
@pytest.mark.parametrize("sides", [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)])
@pytest.mark.parametrize("turn", [0.2, 1.5, 2.8])
def test_circle_touches_both_curves(r1: float, r2: float, sides: tuple[float, float], turn: float) -> None:
    radius = 0.01

    x, y = corner_center(turn, r1, sides[0], r2, sides[1], radius)

    assert distance_to(x, y, 0.0, r1, sides[0]) == pytest.approx(radius)
    assert distance_to(x, y, turn, r2, sides[1]) == pytest.approx(radius)
    # near the corner, in front of it on the first curve and behind it on the second
    assert way_from_corner(x, y, 0.0, r1, sides[0]) < 0.0 < way_from_corner(x, y, turn, r2, sides[1])


def test_two_lines_have_the_closed_form() -> None:
    """R = P s / (1 - s); trim = R / tan(half the included angle)."""
    turn, tolerance = 1.2, 1e-4
    s = sin(0.5 * (pi - turn))

    assert corner_radius(turn, 0, 1, 0, 1, tolerance, 1.0, 1.0, 1.0) == pytest.approx(tolerance * s / (1 - s))
    assert corner_radius(turn, 0, 1, 0, 1, 1.0, 1e-3, 2e-3, 1.0) == pytest.approx(1e-3 / tan(turn / 2))
    assert corner_radius(turn, 0, 1, 0, 1, 1.0, 1.0, 1.0, 1e-5) == 1e-5


@pytest.mark.parametrize(("r1", "side1"), [(0.02, 1.0), (0.02, -1.0)])
def test_an_arc_misses_its_corner_by_the_tolerance(r1: float, side1: float) -> None:
    turn, tolerance = 1.0, 1e-5

    radius = corner_radius(turn, r1, side1, 0.0, 1.0, tolerance, 0.01, 0.01, 0.01)

    x, y = corner_center(turn, r1, side1, 0.0, 1.0, radius)
    assert hypot(x, y) - radius == pytest.approx(tolerance, rel=1e-6)


def test_arcs_of_large_radius_are_lines_in_the_limit() -> None:
    rng = np.random.default_rng(5)
    for turn in rng.uniform(0.1, 3.0, 20):
        arcs = corner_radius(turn, 1e6, 1.0, 1e6, -1.0, 1e-4, 1e-2, 1e-2, 1e-2)
        lines = corner_radius(turn, 0.0, 1.0, 0.0, 1.0, 1e-4, 1e-2, 1e-2, 1e-2)

        assert arcs == pytest.approx(lines, rel=1e-4)


def test_there_is_no_circle_larger_than_the_arc_it_has_to_fit_into() -> None:
    assert isnan(corner_center(1.0, 0.01, 1.0, 0.0, 1.0, 0.02)[0])
    assert corner_radius(1.0, 0.01, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0) < 0.01
