"""Shanks and holders of several sections: where they stand, what is impossible, how they bend, how heavy they are."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.processes.cutter_load import sections_of
from gcodesim.processes.tool_bending import MODULI, tip_compliance
from gcodesim.tools.body import STEEL_DENSITY
from gcodesim.tools.flat_end_mill import FlatEndMill
from gcodesim.tools.sections import Holder, Shank, StackedSection
from gcodesim.units import MM
from tests.unit.cell.text import loaded, sound

CELL = "machine: gantry_xyz\ntools:\n  1: {type: flat_end_mill, diameter: 6, length: 40, flute_length: 15, %s}\n"


def tool_of(keys: str) -> FlatEndMill:
    found = sound(CELL % keys).tools[1]
    assert isinstance(found, FlatEndMill)
    return found


def test_sections_stand_on_each_other_up_to_the_holder() -> None:
    tool = tool_of(
        "shank: {diameter: 5, length: 10, above: [{diameter: 5, upper_diameter: 8, length: 6}]}, "
        "holder: {diameter: 20, upper_diameter: 30, length: 25, above: [{diameter: 44, length: 12}]}"
    )

    assert np.array(tool.shank_frusta) / MM == pytest.approx(
        np.array([[2.5, 2.5, 15, 25], [2.5, 4, 25, 31], [4, 4, 31, 40]])
    )
    assert np.array(tool.holder_frusta) / MM == pytest.approx(np.array([[10, 15, 40, 65], [22, 22, 65, 77]]))
    assert tool.true_length / MM == pytest.approx(77)


def test_a_diameter_alone_is_the_whole_shank() -> None:
    assert np.array(tool_of("shank: 8").shank_frusta) / MM == pytest.approx(np.array([[4, 4, 15, 40]]))
    assert np.array(tool_of("name: plain").shank_frusta) / MM == pytest.approx(np.array([[3, 3, 15, 40]]))


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ("shank: {diameter: 5, length: 26}", "from the flutes to the holder there are 25 mm"),
        ("shank: {diameter: 5, length: 5, above: [{diameter: -6, length: 5}]}", "`shank.above.0.diameter`"),
        ("holder: {diameter: 20, length: 25, above: [{diameter: 30, upper_diameter: 0, length: 5}]}", "above.0.upper"),
    ],
)
def test_impossible_sections_say_why(keys: str, told: str) -> None:
    (fault,) = loaded(CELL % keys).findings
    assert fault.code == "GS720" and told in fault.message


def test_no_shank_where_the_flutes_reach_up_to_the_holder() -> None:
    (fault,) = loaded("machine: gantry_xyz\ntools: {1: {type: flat_end_mill, diameter: 6, shank: 5}}\n").findings
    assert "give `flute_length`" in fault.message


def test_a_conical_shank_bends_as_the_integral_says() -> None:
    """From d to D over L above a fluted part of no length: delta / F = 64 L^3 / (3 pi E d D^3)."""
    d, wide, long = 4e-3, 9e-3, 50e-3
    tool = FlatEndMill(
        diameter=d, flute_length=1e-9, length=long, substrate="carbide", shank=Shank(diameter=d, upper_diameter=wide)
    )

    found = tip_compliance(sections_of(tool), MODULI["carbide"])

    assert found == pytest.approx(64.0 * long**3 / (3.0 * math.pi * MODULI["carbide"] * d * wide**3), rel=1e-3)


def test_the_mass_is_that_of_all_sections() -> None:
    holder = Holder(
        diameter=20e-3, upper_diameter=30e-3, length=25e-3, above=(StackedSection(diameter=44e-3, length=12e-3),)
    )
    bare, held = FlatEndMill(diameter=6e-3, length=40e-3), FlatEndMill(diameter=6e-3, length=40e-3, holder=holder)

    cone = math.pi * 25e-3 / 3.0 * (10e-3**2 + 10e-3 * 15e-3 + 15e-3**2)
    assert held.inertia.mass - bare.inertia.mass == pytest.approx(
        STEEL_DENSITY * (cone + math.pi * 22e-3**2 * 12e-3), rel=1e-9
    )
