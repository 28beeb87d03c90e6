"""Numbers with units, alone and in lists."""

from __future__ import annotations

import pytest

from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import UNREAD
from tests.unit.declarations.text import codes, read


@pytest.mark.parametrize(
    ("dimension", "text", "value"),
    [
        ("length", "10", 0.01),
        ("length", "1 in", 0.0254),
        ("force", "0.4 kN", 400.0),
        ("force", "0", 0.0),
        ("temperature", "20 degC", 293.15),
        ("ratio", "30 %", 0.3),
    ],
)
def test_values_are_si(dimension: str, text: str, value: float) -> None:
    assert read(Quantity(dimension), text)[0] == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("400", "GS708"),
        ("400 W", "GS709"),
        ("400 n", "GS709"),
        ("much", "GS707"),
        ("1e999 N", "GS707"),
        ("-1 N", "GS710"),
        ("[1 N]", "GS706"),
        ("", "GS705"),
    ],
)
def test_faults(text: str, code: str) -> None:
    value, to = read(Quantity("force", POSITIVE), text)

    assert value is UNREAD and codes(to) == [code]


def test_the_unit_of_the_last_entry_holds_for_the_others() -> None:
    assert read(Vector(Quantity("force"), 3), "[1, 2 N, 3 kN]")[0] == (1e3, 2.0, 3e3)
    assert codes(read(Vector(Quantity("force"), 3), "[1, 2, 3]")[1]) == ["GS708"]
    assert codes(read(Vector(Quantity("force"), 3), "[1, 2 N]")[1]) == ["GS706"]


def test_bounds_are_told_in_the_unit_of_listings() -> None:
    [finding] = read(Quantity("temperature", Range(least=273.15)), "-10 degC")[1].findings

    assert finding.message == "`x` is -10 degC; it must be at least 0 degC"


def test_what_is_shown_names_its_unit() -> None:
    force = Quantity("force")

    assert (force.show(400.0), force.plain(400.0)) == ("400 N", ("_N", 400.0))
    assert (force.show(float("inf")), force.plain(None)) == ("none", ("_N", None))
    assert Vector(Quantity("length")).plain((0.0, 0.6)) == ("_mm", [0.0, 600.0])


def test_an_example_stands_for_that_of_the_dimension() -> None:
    assert Quantity("length").expected == "a length such as `10 mm`"
    assert Quantity("length", example="0.2 mm").expected == "a length such as `0.2 mm`"
    assert Vector(Quantity("length"), 2, "[0, 600 mm]").expected == "a list of 2 lengths such as `[0, 600 mm]`"
