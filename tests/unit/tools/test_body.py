"""Mass of simple bodies against textbook values."""

import math

import pytest

from gcodesim.tools.body import STEEL_DENSITY, cone, cylinder, mass_properties, sphere


def test_cylinder():
    r, length = 0.01, 0.06
    m = STEEL_DENSITY * math.pi * r**2 * length

    found = mass_properties([cylinder("cutting", r, 0.0, length)])

    assert (found.mass, found.center) == pytest.approx((m, 0.03))
    assert found.axial == pytest.approx(0.5 * m * r**2)
    assert found.transverse == pytest.approx(m * (3.0 * r**2 + length**2) / 12.0)


def test_sphere_and_cone_volumes():
    assert sphere("cutting", 0.003, 0.0).solid.volume == pytest.approx(4.0 / 3.0 * math.pi * 0.003**3)
    assert cone("cutting", 0.0, 0.003, 0.0, 0.01).solid.volume == pytest.approx(math.pi * 0.003**2 * 0.01 / 3.0)


def test_two_halves_are_one_whole():
    whole = mass_properties([cylinder("holder", 0.02, 0.0, 0.1)])
    halves = mass_properties([cylinder("holder", 0.02, 0.0, 0.04), cylinder("holder", 0.02, 0.04, 0.1)])

    assert halves.transverse == pytest.approx(whole.transverse)
    assert halves.center == pytest.approx(whole.center)


def test_a_given_mass_scales_the_inertia():
    light = mass_properties([cylinder("holder", 0.02, 0.0, 0.1)])
    heavy = mass_properties([cylinder("holder", 0.02, 0.0, 0.1)], mass=2.0 * light.mass)

    assert heavy.axial == pytest.approx(2.0 * light.axial)


def test_nothing_weighs_nothing():
    assert mass_properties([]).mass == 0.0
