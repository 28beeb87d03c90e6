"""Corner arcs touch both curves; compared with the tangency conditions themselves."""

from __future__ import annotations

from math import cos, hypot, isnan, pi, sin, tan

import pytest

from gcodesim.motion.corner_kernels import corner_center, corner_radius, part_for_corner, way_from_corner


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
    half = 0.5 * (pi - turn)
    s = sin(half)

    assert corner_radius(half, tolerance, 1.0, 1.0) == pytest.approx(tolerance * s / (1 - s))
    assert corner_radius(half, 1.0, 1e-3, 2e-3) == pytest.approx(1e-3 / tan(turn / 2))


def test_an_arc_that_bends_into_its_corner_gives_less_of_itself() -> None:
    """Its secant stands for it, which meets the other curve under a narrower angle."""
    into = part_for_corner(0.02, 1.0, 0.8, 0.5)
    away = part_for_corner(0.02, -1.0, 0.8, 0.5)

    assert into == pytest.approx((0.5, 0.02 * sin(0.125), 0.125))
    assert away == pytest.approx((0.8, 0.016, 0.0))
    assert part_for_corner(0.02, 1.0, 0.2, 0.5)[0] == pytest.approx(0.2)
    assert part_for_corner(0.02, -1.0, 9.0, 0.5)[0] == pytest.approx(pi / 2)


def test_there_is_no_circle_larger_than_the_arc_it_has_to_fit_into() -> None:
    assert isnan(corner_center(1.0, 0.01, 1.0, 0.0, 1.0, 0.02)[0])
