"""Outlines of cutters: what the force kernels integrate along."""

import math
from itertools import pairwise

import numpy as np
import pytest

from gcodesim.tools import TOOLS
from gcodesim.tools.sections import Holder

D = 8.0e-3
KINDS = {
    "flat_end_mill": {},
    "ball_end_mill": {},
    "bull_nose_end_mill": {"corner_radius": 1.5e-3},
    "drill": {},
}


@pytest.mark.parametrize("kind", KINDS)
def test_pieces_of_an_edge_join(kind):
    edge = TOOLS[kind](diameter=D, **KINDS[kind]).edge

    def end(row):
        if row[0] > 0.0:
            return row[1] + row[0] * math.sin(row[4]), row[2] - row[0] * math.cos(row[4])
        return row[1] + row[5] * math.cos(row[3]), row[2] + row[5] * math.sin(row[3])

    def start(row):
        if row[0] > 0.0:
            return row[1] + row[0] * math.sin(row[3]), row[2] - row[0] * math.cos(row[3])
        return row[1], row[2]

    assert start(edge[0]) == pytest.approx((0.0, 0.0), abs=1e-12)
    for before, after in pairwise(edge):
        assert end(before) == pytest.approx(start(after), abs=1e-12)
    assert end(edge[-1])[0] == pytest.approx(D / 2.0)


def test_drill_lips_have_the_length_of_the_handbook():
    """Two lips of D / (2 sin sigma), sigma half the point angle."""
    drill = TOOLS["drill"](diameter=D)

    assert drill.edge[:, 5].sum() == pytest.approx(D / (2.0 * math.sin(math.radians(59.0))))
    assert drill.edge_height == pytest.approx(D / 2.0 / math.tan(math.radians(59.0)))


def test_shapes_stand_on_each_other():
    tool = TOOLS["flat_end_mill"](
        diameter=D, length=60e-3, flute_length=20e-3, holder=Holder(diameter=40e-3, length=50e-3)
    )

    assert tool.cutting_shape[-2:] == pytest.approx([0.0, 20e-3])
    assert [tuple(part) for part in tool.shank_frusta] == [pytest.approx((4e-3, 4e-3, 20e-3, 60e-3))]
    assert [tuple(part) for part in tool.holder_frusta] == [pytest.approx((20e-3, 20e-3, 60e-3, 110e-3))]
    assert tool.true_length == pytest.approx(110e-3)
    assert tool.X_FT.p == pytest.approx([0.0, 0.0, 110e-3])
    assert np.array_equal(tool.X_FT.R, np.eye(3))


def test_no_shank_without_unfluted_length():
    assert TOOLS["flat_end_mill"](diameter=D).shank_frusta == ()


@pytest.mark.parametrize(
    ("kind", "values", "key"),
    [
        ("flat_end_mill", {"diameter": 0.0}, "diameter"),
        ("flat_end_mill", {"diameter": math.nan}, "diameter"),
        ("flat_end_mill", {"diameter": D, "flutes": 0}, "flutes"),
        ("flat_end_mill", {"diameter": D, "helix": math.pi / 2}, "helix"),
        ("flat_end_mill", {"diameter": D, "length": 0.03, "flute_length": 0.04}, "flute_length"),
        ("ball_end_mill", {"diameter": D, "flute_length": 2e-3}, "flute_length"),
        ("bull_nose_end_mill", {"diameter": D, "corner_radius": 5e-3}, "corner_radius"),
        ("drill", {"diameter": D, "point_angle": 4.0}, "point_angle"),
        ("flat_end_mill", {"diameter": D, "holder": Holder(diameter=-1.0, length=0.05)}, "holder.diameter"),
        ("flat_end_mill", {"diameter": D, "mass": 0.0}, "mass"),
        ("extruder", {"bead_width": 2e-3, "bead_height": 3e-3}, "bead_height"),
        ("extruder", {"bead_width": 6e-3, "bead_height": 3e-3, "filament_diameter": 0.0}, "filament_diameter"),
    ],
)
def test_impossible_tools_say_which_key(kind, values, key):
    assert key in [name for name, _ in TOOLS[kind](**values).problems()]


@pytest.mark.parametrize("kind", ["drill", "spot_drill", "countersink", "chamfer_mill"])
@pytest.mark.parametrize("point", [30.0, 60.0, 118.0])
def test_a_cone_may_be_as_long_as_its_flutes(kind: str, point: float) -> None:
    """Cells round the height of a cone, mostly down; the cone then ends where the flutes do."""
    height = 2.5e-3 / math.tan(math.radians(0.5 * point))
    name = "point_angle" if kind.endswith("drill") else "angle"
    for length in (height, math.nextafter(height, 0.0), math.floor(height * 1e6) / 1e6):
        tool = TOOLS[kind](diameter=5e-3, length=60e-3, flute_length=length, **{name: math.radians(point)})
        assert tool.problems() == []
        assert tool.flute_length == pytest.approx(height, rel=1e-12)
    short = TOOLS[kind](diameter=5e-3, length=60e-3, flute_length=0.99 * height, **{name: math.radians(point)})
    assert [key for key, _ in short.problems()] == ["flute_length"]
