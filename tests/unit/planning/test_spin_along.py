"""Splines of what the planner chooses along a path."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.planning.spin_along import SpinAlong, _bends, _slopes

WAY = np.array([0.0, 0.1, 0.25, 0.3, 0.5])
SPIN = np.array([0.0, 0.2, 0.1, 0.1, 0.6])


def spline(*, soft: bool) -> SpinAlong:
    none = np.zeros(1)
    bend = _bends(WAY, SPIN) if soft else None
    return SpinAlong(none, np.zeros(1, dtype=bool), WAY, SPIN, _slopes(WAY, SPIN), none, bend)


def step_of_acceleration(along: SpinAlong, knot: float, h: float = 1e-6) -> float:
    before, here, after = (float(along.at(np.zeros(1, dtype=np.int64), np.array([knot + d]))[1][0]) for d in (-h, 0, h))
    return abs((after - here) - (here - before)) / h


@pytest.mark.parametrize("knot", WAY[1:-1])
def test_only_soft_splines_have_no_steps_of_acceleration(knot: float) -> None:
    assert step_of_acceleration(spline(soft=True), knot) < 1e-1
    assert step_of_acceleration(spline(soft=False), knot) > 1.0


def test_soft_splines_run_through_their_knots_and_slopes_are_their_derivatives() -> None:
    along, piece = spline(soft=True), np.zeros(200, dtype=np.int64)
    assert np.allclose(along.at(piece[:5], WAY)[0], SPIN)
    s, h = np.linspace(0.001, 0.499, 200), 1e-6
    difference = (along.at(piece, s + h)[0] - along.at(piece, s - h)[0]) / (2.0 * h)
    assert np.allclose(along.at(piece, s)[1], difference, atol=1e-5)


@pytest.mark.parametrize("soft", [False, True])
def test_where_a_spin_stands_nothing_moves_and_it_comes_there_from_one_side(soft: bool) -> None:
    way, spin = np.array([0.0, 0.1, 0.2, 0.27, 0.4, 0.5, 0.6]), np.array([0.0, 0.2, 0.4, 0.5, 0.5, 0.5, 0.3])
    none = np.zeros(1)
    along = SpinAlong(
        none, np.zeros(1, dtype=bool), way, spin, _slopes(way, spin), none, _bends(way, spin) if soft else None
    )
    s = np.linspace(0.0, 0.6, 500)
    value, _ = along.at(np.zeros(500, dtype=np.int64), s)
    standing = (s > 0.27) & (s < 0.5)
    assert (value[standing] == 0.5).all()
    assert value.max() <= 0.5 + 1e-15
