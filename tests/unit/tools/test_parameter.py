"""What the cell reader is told about the keys of a tool."""

import math

import pytest

from gcodesim.tools import TOOLS, parameters
from gcodesim.units import DEG, MM


def keys(kind: str) -> dict[str, object]:
    return {parameter.name: parameter for parameter in parameters(TOOLS[kind])}


def test_required_keys_come_first_and_are_marked():
    found = parameters(TOOLS["bull_nose_end_mill"])

    assert [p.name for p in found if p.required] == ["diameter", "corner_radius"]
    assert [p.required for p in found] == sorted((p.required for p in found), reverse=True)


def test_dimensions_decide_the_units():
    drill = keys("drill")

    assert drill["diameter"].dimension == "length"
    assert drill["point_angle"].dimension == "angle"
    assert drill["flutes"].dimension == "count"
    assert drill["mass"].dimension == "mass"


def test_a_holder_is_a_group_with_keys_of_its_own():
    holder = keys("flat_end_mill")["holder"]

    assert holder.dimension == "group"
    assert [p.name for p in holder.members] == ["diameter", "length"]
    assert holder.kind(diameter=0.04, length=0.05).length == 0.05


def test_defaults_are_constants_or_rules_in_words():
    drill = keys("drill")

    assert drill["point_angle"].default == pytest.approx(math.radians(118.0))
    assert drill["length"].default is None
    assert "4 times the diameter" in drill["length"].rule


@pytest.mark.parametrize(("diameter_mm", "length_mm"), [(6.0, 40.0), (10.0, 40.0), (20.0, 80.0)])
def test_length_follows_the_diameter(diameter_mm, length_mm):
    tool = TOOLS["flat_end_mill"](diameter=diameter_mm * MM)

    assert tool.length == pytest.approx(length_mm * MM)
    assert tool.flute_length == tool.length


def test_given_values_stay():
    tool = TOOLS["drill"](number=7, name="pilot", diameter=5.0 * MM, point_angle=140.0 * DEG, length=90.0 * MM)

    assert (tool.name, tool.length, tool.flute_length) == ("pilot", 90.0 * MM, 90.0 * MM)
    assert tool.point_angle == 140.0 * DEG
