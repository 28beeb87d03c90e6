"""Tools whose sizes are equal but for rounding are no impossible ones; those that differ more are."""

from __future__ import annotations

from math import radians, tan

import numpy as np
import pytest

from gcodesim.tools import TOOLS
from gcodesim.tools.sizes import exceeds
from gcodesim.units import MM

INCH = 25.4 * MM
DRAWS = 400


def drawn(seed: int):
    """A diameter [m] as somebody writes it, in mm or in inches."""
    rng = np.random.default_rng(seed)
    while True:
        metric = bool(rng.integers(2))
        yield rng, (round(float(rng.uniform(0.5, 40)), int(rng.integers(4))) or 1.0) * (MM if metric else INCH)


def as_written(length: float, digits: int, unit: float) -> float:
    return float(f"{length / unit:.{digits}g}") * unit


@pytest.mark.parametrize("kind", ["drill", "spot_drill", "countersink", "chamfer_mill", "v_bit", "step_drill"])
def test_a_cone_as_long_as_the_flutes_is_a_tool(kind: str) -> None:
    """Written with four to nine digits, in either unit, with and without a shank above the flutes."""
    draws = drawn(1)
    for _ in range(DRAWS):
        rng, diameter = next(draws)
        angle = radians(float(rng.choice([60.0, 82.0, 90.0, 118.0, 135.0, 140.0, rng.uniform(20.0, 170.0)])))
        more, height = {"point_angle": angle}, 0.5 * diameter / tan(0.5 * angle)
        if kind == "step_drill":
            more = {"step_angle": angle, "tip_diameter": 0.5 * diameter, "step_length": diameter}
            height = diameter + 0.25 * diameter / tan(0.5 * angle)
        elif kind not in ("drill", "spot_drill"):
            more = {"angle": angle}
        flutes = as_written(height, int(rng.integers(4, 10)), float(rng.choice([MM, INCH])))
        length = flutes if rng.integers(2) else 2.0 * flutes
        tool = TOOLS[kind](diameter=diameter, flute_length=flutes, length=length, **more)

        assert tool.problems() == [], (diameter, angle, flutes, length)
        assert tool.flute_length <= tool.length == pytest.approx(length, rel=1e-3)
        assert all(body.placed.solid.top > body.placed.solid.bottom for body in tool.primitives)


def test_flutes_up_to_the_holder_may_be_given_in_other_units() -> None:
    """3 in are 76.19999999999999 mm."""
    for quarters in range(1, 40):
        inch, metric = 0.25 * quarters * INCH, 6.35 * quarters * MM
        for flutes, length in ((inch, metric), (metric, inch)):
            tool = TOOLS["flat_end_mill"](diameter=6 * MM, flute_length=flutes, length=length)
            assert tool.problems() == [] and tool.flute_length <= tool.length


def test_half_a_diameter_is_a_corner_and_the_longest_chisel_edge_is_one() -> None:
    draws = drawn(2)
    for _ in range(DRAWS):
        rng, diameter = next(draws)
        unit = MM if rng.integers(2) else INCH
        bull = TOOLS["bull_nose_end_mill"](diameter=diameter, corner_radius=(0.5 * diameter / unit) * unit)
        assert bull.problems() == [] and bull.corner_radius <= bull.radius
        assert bull.cutting_shape.flat == 0.0
        chisel = 0.4 * (diameter / unit) * unit
        assert TOOLS["drill"](diameter=diameter, chisel_edge=chisel).problems() == []
        neck = (diameter / unit) * unit
        assert TOOLS["t_slot_mill"](diameter=diameter, flute_length=MM, neck_diameter=neck).problems() == []


def test_what_differs_by_more_is_refused() -> None:
    for kind, sizes, key in (
        ("flat_end_mill", {"flute_length": 30.001, "length": 30.0}, "flute_length"),
        ("bull_nose_end_mill", {"corner_radius": 5.001}, "corner_radius"),
        ("drill", {"chisel_edge": 4.001}, "chisel_edge"),
        ("drill", {"flute_length": 2.99}, "flute_length"),
        ("lollipop_mill", {"neck_diameter": 10.001}, "neck_diameter"),
    ):
        tool = TOOLS[kind](diameter=10 * MM, **{name: size * MM for name, size in sizes.items()})
        assert [name for name, _ in tool.problems()] == [key]


def test_more_by_rounding_is_no_more() -> None:
    assert not exceeds(0.1 + 0.2, 0.3) and not exceeds(0.3, 0.1 + 0.2)
    assert exceeds(0.300001, 0.3) and exceeds(1e-12, 0.0) and exceeds(float("nan"), 1.0)
