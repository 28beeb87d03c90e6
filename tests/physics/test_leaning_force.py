"""A cut is as heavy however stock and tool are turned: leaning cuts are compared with upright ones."""

import math

import numpy as np
import pytest

from gcodesim.material import shape
from gcodesim.material.axis_way import AxisWay
from gcodesim.material.solid_of_revolution import slabs_of_shape
from gcodesim.material.stock import Stock
from gcodesim.processes.laws import Kienzle, LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.tools import TOOLS
from tests.unit.processes.test_milling import line, window

STEEL = Kienzle.from_table(2500.0, 0.26)
ALUMINIUM = LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8)
CELL = 0.5e-3
CUTS = {
    "slot": ("flat_end_mill", {"flutes": 3}, STEEL, (-10, 3.07, -3), (10, 3.07, -3)),
    "ball": ("ball_end_mill", {}, STEEL, (-10, 0.03, -2), (10, 0.03, -2)),
    "ramp": ("bull_nose_end_mill", {"corner_radius": 2e-3}, ALUMINIUM, (-10, 0.2, 0), (10, 0.2, -4)),
    "plunge": ("flat_end_mill", {"flutes": 3}, STEEL, (0.3, 0.1, 1), (0.3, 0.1, -4)),
    "cone": ("chamfer_mill", {"tip_diameter": 2e-3}, STEEL, (-10, 3.07, -3), (10, 3.07, -3)),
}


def turned(angle):
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def block(angle):
    """Material below the plane through the origin that is turned about Y."""
    if angle == 0:
        return Stock.box((-30e-3, -20e-3, -20e-3), (30e-3, 20e-3, 0.0), CELL)
    stock = Stock.box((-45e-3, -20e-3, -45e-3), (45e-3, 20e-3, 45e-3), CELL)
    ends = turned(angle) @ np.array([[-80e-3, 80e-3], [0.0, 0.0], [0.0, 0.0]])
    axis = turned(angle)[:, 2]
    face = slabs_of_shape(shape.flat(120e-3, 120e-3), CELL)
    stock.sweep(AxisWay(ends[None, :, 0], ends[None, :, 1], axis[None], axis[None]), face)
    return stock


def cut(name, angle, stiffness=None):
    """Means over the later part of a cut, in axes of the tool."""
    kind, more, law, start, end = CUTS[name]
    R, stock = turned(angle), block(angle)
    process = Milling(cutter=TOOLS[kind](number=1, diameter=10e-3, length=60e-3, **more), law=law)
    state = process.begin()
    start, end = 1e-3 * np.array(start, dtype=float), 1e-3 * np.array(end, dtype=float)
    compliance = None if stiffness is None else np.diag([1.0 / stiffness] * 3 + [0.0] * 3)
    before = stock.volume
    for points in (line(start + np.array([0.0, 0.0, 12e-3]), start, 24), line(start, end, 80)):
        more = {} if compliance is None else {"compliance": np.tile(compliance, (len(points) - 1, 1, 1))}
        axis = np.tile(R[:, 2], (len(points) - 1, 1))
        found = process.run(stock, window(points @ R.T, axis=axis, **more), state)
    late = slice(30, 75)
    return {
        "force": (found.wrench[late, :3] @ R).mean(axis=0),
        "moment": (found.wrench[late, 3:] @ R).mean(axis=0),
        "bend": (found.deflection[late] @ R).mean(axis=0),
        "volume": before - stock.volume,
        **{
            column: found[column][late].mean()
            for column in (
                "torque",
                "power",
                "peak_force",
                "peak_torque",
                "axial_force",
                "feed_force",
                "side_force",
                "axial_depth",
                "radial_width",
                "chip_thickness",
                "engaged",
            )
        },
    }


@pytest.mark.parametrize("angle", [30, 54.7, 90])
@pytest.mark.parametrize("name", CUTS)
def test_a_leaning_cut_is_as_heavy_as_the_upright_one(name, angle):
    upright, leaning = cut(name, 0), cut(name, angle)
    least = 1e-3 * float(np.abs(upright["force"]).max())
    for key, value in upright.items():
        share = 0.02 if key == "radial_width" else 0.005  # a width is counted in columns
        assert leaning[key] == pytest.approx(value, rel=share, abs=least if "force" in key else 1e-6), key


@pytest.mark.parametrize("angle", [30, 90])
@pytest.mark.parametrize("stiffness", [5e6, 0.5e6])
def test_a_machine_that_yields_bends_as_far(angle, stiffness):
    upright, leaning = cut("slot", 0, stiffness), cut("slot", angle, stiffness)
    assert np.abs(upright["bend"]).max() > 0.2e-3
    assert leaning["bend"] == pytest.approx(upright["bend"], rel=0.005, abs=1e-6)
    assert leaning["force"] == pytest.approx(upright["force"], rel=0.005, abs=1.0)
    assert leaning["volume"] == pytest.approx(upright["volume"], rel=0.005)


def test_the_own_groove_is_no_cut_again():
    """A second pass at the same place, leaning by 30 degrees: reading a surface leaves next to nothing."""
    R, stock = turned(30), block(30)
    process = Milling(cutter=TOOLS["flat_end_mill"](number=1, diameter=10e-3, length=60e-3), law=STEEL)
    points = line((-10e-3, 3.07e-3, -3e-3), (10e-3, 3.07e-3, -3e-3), 80)
    path = np.concatenate([line((-10e-3, 3.07e-3, 3e-3), points[0], 12)[:-1], points]) @ R.T
    first, again = (
        process.run(stock, window(path, axis=np.tile(R[:, 2], (len(path) - 1, 1))), process.begin()) for _ in range(2)
    )
    assert first["removed"].sum() > 700e-9
    assert again["removed"].sum() < 1e-3 * first["removed"].sum()
    assert again["torque"].max() < 1e-3 * first["torque"].max()


def test_an_axis_that_turns_cuts_with_nearly_the_force_of_one_that_stands():
    """Over 4 degrees about its tip a ball meets the same groove."""
    R, stock = turned(30), block(30)
    process = Milling(cutter=TOOLS["ball_end_mill"](number=1, diameter=10e-3, length=60e-3), law=STEEL)
    points = line((-10e-3, 0.03e-3, -2e-3), (10e-3, 0.03e-3, -2e-3), 80)
    lean = np.radians(np.linspace(28.0, 32.0, 81))
    axes = np.stack([np.sin(lean), np.zeros(81), np.cos(lean)], axis=1)
    # the middle of the ball goes along the straight line
    tips = points @ R.T + 5e-3 * (R[:, 2] - axes)
    path = np.concatenate([tips[:1] + 12e-3 * axes[0], tips])
    axis = np.concatenate([axes[:1], axes])
    turning = process.run(stock, window(path, axis=axis[1:], axis_before=axis[:-1]), process.begin())
    force = np.linalg.norm(turning.wrench[31:76, :3], axis=1).mean()
    assert force == pytest.approx(float(np.linalg.norm(cut("ball", 0)["force"])), rel=0.05)
