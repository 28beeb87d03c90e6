"""The table of units: spellings, factors, suggestions."""

from __future__ import annotations

from math import pi

import pytest

from gcodesim.declarations.units import DIMENSIONS, UNITS, find, in_unit, measures, names, nearest, normal, shown


@pytest.mark.parametrize(
    ("text", "dimension", "factor"),
    [
        ("mm", "length", 1e-3),
        ("in", "length", 0.0254),
        ("µm", "length", 1e-6),
        ("μm", "length", 1e-6),
        ("°", "angle", pi / 180),
        ("m/min", "speed", 1 / 60),
        ("mm/min", "speed", 1e-3 / 60),
        ("rpm", "rotational speed", 2 * pi / 60),
        ("1/min", "rotational speed", 2 * pi / 60),
        ("m/s²", "acceleration", 1.0),
        ("m/s2", "acceleration", 1.0),
        ("mm/s^2", "acceleration", 1e-3),
        ("N·m", "torque", 1.0),
        ("N*m", "torque", 1.0),
        ("N m", "torque", 1.0),
        ("Nm", "torque", 1.0),
        ("N⋅m / rad", "torsional stiffness", 1.0),
        ("N/mm²", "pressure", 1e6),
        ("N/mm2", "pressure", 1e6),
        ("MPa", "pressure", 1e6),
        ("N/mm", "force per length", 1e3),
        ("kW", "power", 1e3),
        ("ms", "time", 1e-3),
        ("%", "ratio", 0.01),
        ("J/(kg*K)", "specific heat", 1.0),
        ("J / (kg K)", "specific heat", 1.0),
        ("J/kg/K", "specific heat", 1.0),
        ("kJ/kgK", "specific heat", 1e3),
        ("(N·m)/rad", "torsional stiffness", 1.0),
        ("mm/s/s", "acceleration", 1e-3),
        ("hp/(in^3/min)", "pressure", 550 * 0.3048 * 0.45359237 * 9.80665 * 60 / 0.0254**3),
    ],
)
def test_spellings(text: str, dimension: str, factor: float) -> None:
    unit = find(text, dimension)

    assert unit is not None and unit.factor == pytest.approx(factor, rel=1e-14)


def test_case_counts() -> None:
    assert find("MM", "length") is None and find("Mpa", "pressure") is None
    assert nearest("MM", "length") == "mm" and nearest("rmp", "rotational speed") == "rpm"


def test_a_unit_may_measure_several_things() -> None:
    assert set(measures("N/mm")) == {"force per length", "stiffness"}
    assert measures("furlong") == ()


def test_no_spelling_stands_twice_in_a_dimension() -> None:
    spellings = [(u.dimension, normal(s)) for u in UNITS for s in (u.name, *u.aliases)]

    assert len(set(spellings)) == len(spellings)


@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_every_dimension_shows_in_a_unit_of_its_own(dimension: str) -> None:
    d = DIMENSIONS[dimension]

    assert names(dimension)
    assert not d.shown or find(d.shown, dimension) is not None
    assert d.plain or d.example.split(" ", 1)[1] in names(dimension)
    assert shown(0.0, dimension).startswith("0") or not d.zero


def test_values_are_shown_without_noise() -> None:
    assert shown(0.1 + 0.2, "length") == "300 mm"
    assert shown(24000 * 2 * pi / 60, "rotational speed") == "24000 rpm"


@pytest.mark.parametrize(("unit", "value"), [("degC", 26.85), ("K", 300.0), ("degF", 80.33)])
def test_temperatures_count_from_zeros_of_their_own(unit: str, value: float) -> None:
    found = find(unit, "temperature")

    assert found is not None and in_unit(300.0, found) == pytest.approx(value, abs=1e-9)
    assert shown(300.0, "temperature") == "26.85 degC" and find("°C", "temperature") == find("degC", "temperature")
