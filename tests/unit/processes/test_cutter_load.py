"""Bending, run-out and chatter of a cutter in a cut, against closed forms; a tool that says nothing is as it was."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.cutter_load import LOAD_COLUMNS, sections_of, tool_compliance
from gcodesim.processes.laws import LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.processes.stability import Mode, lobes
from gcodesim.processes.tool_bending import BeamSection, tip_compliance
from gcodesim.processes.wear import WEAR, worn
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS
from gcodesim.tools.cutter import Dynamics, EdgeLife

LAW = LinearEdge.from_table(600.0, 0.0, 180.0, 0.0)
OMEGA, CHIP, DEPTH = 400.0, 0.05e-3, 3e-3


def mill(**more):
    return TOOLS["flat_end_mill"](diameter=10e-3, flutes=2, helix=0.0, length=50e-3, flute_length=30e-3, **more)


def slot(tool):
    """A slot along +X, half way into a block."""
    feed = CHIP * tool.flutes * OMEGA / (2.0 * math.pi)
    dt = 0.004
    start, end = np.array([5e-3, 10e-3, -DEPTH]), np.array([12e-3, 10e-3, -DEPTH])
    n = max(round(float(np.linalg.norm(end - start)) / feed / dt), 1)
    points = start + np.linspace(0.0, 1.0, n + 1)[:, None] * (end - start)
    window = Window(
        piece_start=points[:-1],
        piece_end=points[1:],
        piece_step=np.arange(n),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=np.tile([feed, 0.0, 0.0], (n, 1)),
        rapid=np.zeros(n, dtype=bool),
        signals={"spindle": np.full(n, OMEGA), "active": np.zeros(n, dtype=bool)},
        dt=dt,
    )
    stock = Stock.box((0.0, 0.0, -20e-3), (30e-3, 20e-3, 0.0), 0.4e-3)
    stock.remove(np.array([[-6e-3, 10e-3, -DEPTH]]), window.piece_start[:1], tool.cutting_shape)
    process = Milling(cutter=tool, law=LAW)
    return process.run(stock, window, process.begin())


def test_a_tool_that_says_nothing_is_as_it_was() -> None:
    found = slot(mill())

    assert Milling.columns_of(mill()) == Milling.writes
    assert not {column.name for column in LOAD_COLUMNS} & set(found.columns)
    assert not found.deflection.any()


def test_the_tip_bends_as_a_cantilever_under_the_force_of_the_cut() -> None:
    """The force acts in the middle of the depth, so the unit load gives its way of the tip."""
    tool = mill(substrate="carbide")
    found = slot(tool)
    late = slice(len(found.deflection) // 2, None)
    force = np.linalg.norm(found.wrench[late, :2], axis=1)
    wanted = force * tip_compliance(sections_of(tool), 600e9, 0.5 * DEPTH)

    assert force.min() > 40.0
    assert found["tool_bend"][late] == pytest.approx(wanted, rel=3e-3)
    assert np.linalg.norm(found.deflection[late], axis=1) == pytest.approx(wanted, rel=0.02, abs=0.3e-6)


def test_a_tool_bends_the_same_way_whichever_way_it_points() -> None:
    tool, force, height = mill(substrate="steel"), np.array([0.0, 30.0, 40.0]), 4e-3
    axis = np.array([[1.0, 0.0, 0.0]])
    wrench = np.array([*force, *np.cross(height * axis[0], force)])
    way = (tool_compliance(tool, axis)[0] * wrench).sum(axis=1)
    push = tip_compliance(sections_of(tool), 210e9)
    # the unit load, less the part below the force, which hardly bends
    assert way == pytest.approx(force * tip_compliance(sections_of(tool), 210e9, height), rel=2e-3, abs=0.01 * push)


def test_sections_are_flutes_and_shank() -> None:
    flutes, shank = sections_of(mill())

    assert flutes == BeamSection(8e-3, 30e-3)
    assert (shank.diameter, shank.length) == (10e-3, pytest.approx(20e-3))


def test_run_out_makes_one_chip_thicker_and_the_peak_with_it() -> None:
    plain, found = slot(mill()), slot(mill(runout=10e-6))
    late = slice(len(found.deflection) // 2, None)

    assert found["tooth_chip"][late] == pytest.approx(plain["chip_thickness"][late] + 20e-6, rel=1e-9)
    assert found["runout_force"][late] == pytest.approx(plain["peak_force"][late] * (70.0 / 50.0), rel=0.01)
    assert (found["runout_force"] == found["peak_force"]).all()
    # what one tooth leaves the other takes, so that a law without exponent has the same mean
    assert found.wrench[late] == pytest.approx(plain.wrench[late], rel=3e-4, abs=0.02)


def test_a_cut_deeper_than_the_limit_of_stability_is_told() -> None:
    mode = Dynamics(frequency=900.0, damping=0.03, stiffness=4e6)
    found = slot(mill(dynamics=mode))
    swing = Mode(frequency=900.0, stiffness=4e6, damping=0.03)
    limit = lobes(swing, swing, ktc=LAW.ktc, ratio=0.3, teeth=2, entry=0.0, exit=math.pi).depth_at(OMEGA)
    late = slice(len(found.deflection) // 2, None)

    assert 0.0 < limit < DEPTH
    assert found["beyond_stable"][late] == pytest.approx(DEPTH - limit, rel=0.02)
    assert not slot(mill(dynamics=Dynamics(frequency=900.0, damping=0.03, stiffness=4e8)))["beyond_stable"].any()


def test_wear_is_time_in_the_cut_over_taylors_life() -> None:
    """v T^n = C: at 2 m/s (120 m/min) with C 400 m/min and n 0.25 an edge lasts (400 / 120)^4 = 123.5 min."""
    cutter = mill(life=EdgeLife(constant=400.0 / 60.0, exponent=0.25))
    found = slot(cutter)
    seconds = 0.004 * np.count_nonzero(found["engaged"])

    assert OMEGA * cutter.radius == 2.0 and seconds > 1.0
    assert found["wear"].sum() == pytest.approx(seconds / (60.0 * (400.0 / 120.0) ** 4), rel=1e-12)
    assert WEAR in Milling.columns_of(cutter) and WEAR not in Milling.columns_of(mill())
    assert not {column.name for column in LOAD_COLUMNS} & set(found.columns)


def test_steps_of_different_length_wear_by_their_time() -> None:
    cutter = mill(life=EdgeLife(constant=5.0, exponent=0.2))
    spindle, cuts = np.array([400.0, 400.0, 0.0, -200.0, 400.0]), np.array([True, False, True, True, True])
    each = worn(cutter, spindle, cuts, 0.5)
    again = worn(cutter, spindle, cuts, np.array([1.0, 1.0, 1.0, 1.0, 0.25]))

    assert (each[[1, 2]] == 0.0).all() and each[3] == pytest.approx(each[0] / 2.0**5)  # half the speed, n = 1/5
    assert again == pytest.approx(each * np.array([2.0, 2.0, 2.0, 2.0, 0.5]))
