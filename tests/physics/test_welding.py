"""Arc welding in whole runs: section, height and heat by closed forms, on slopes and in grooves, and wrong use."""

import math

import numpy as np
import pytest

from gcodesim.material.crown import Crown, melt_onto
from gcodesim.material.stock import Stock
from gcodesim.units import MM, MM3
from tests.physics.runs import run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {in: world, xyz: [400, 300, -200]}}
stock: {min: [-20, -20, -5], max: [120, 20, 0], in: G54, resolution: 0.25}
tools:
  1: {type: welding_torch, wire_speed: 8 m/min, voltage: 22 V, current: 180 A, length: 120}
m_codes:
  M10: {tool: activate}
  M11: {tool: deactivate}
"""
RUN = "G21 G90 G61\nT1 M6\nG43 H1\nG0 X0 Y0\nG0 Z2\nM10\nG1 X100 F500\nM11\nG0 Z40\nM2\n"
WIRE = 0.25 * math.pi * 1.2**2  # mm²
SECTION = 0.97 * WIRE * 8000.0 / 500.0  # mm²


def test_section_height_and_heat_are_those_of_the_closed_forms():
    ran = run_texts(RUN, CELL)
    tool = ran.results.as_json()["tools"][0]
    width = math.sqrt(1.5 * 3.0 * SECTION)

    assert ran.misuse == []
    assert ran.stock.deposited / MM3 == pytest.approx(SECTION * 100.0, rel=5e-3)
    assert tool["max_weld_width_mm"] == pytest.approx(width, rel=1e-3)
    assert tool["max_weld_height_mm"] == pytest.approx(1.5 * SECTION / width, rel=1e-3)
    assert tool["max_heat_per_length_J_m"] == pytest.approx(0.8 * 22.0 * 180.0 / (500.0 / 60e3), rel=1e-3)
    assert tool["wire_mm3"] == pytest.approx(tool["spatter_mm3"] / 0.03, rel=1e-6)
    assert ran.stock.deposited / MM3 == pytest.approx(0.97 * tool["wire_mm3"], rel=1e-6)
    (placed,) = ran.shop.stocks.values()
    top = placed.stock.intervals_at(50 * MM, 0.0)[-1][1]
    assert top / MM == pytest.approx(1.5 * SECTION / width, rel=0.02)


def test_a_word_sets_the_speed_of_the_wire():
    cell = CELL + "signals: {wire_speed: {word: S, per: 1 m/min}}\n"
    slow, fast = (run_texts(RUN.replace("M10", f"S{s}\nM10"), cell).stock.deposited for s in (4, 8))
    assert fast == pytest.approx(2.0 * slow, rel=1e-9)


def melted(stock, z, reach=10.0):
    x = np.linspace(0.0, 30.0, 121) * MM
    way = np.column_stack([x[:-1], np.zeros(120), np.full(120, z), x[1:], np.zeros(120), np.full(120, z)])
    return melt_onto(stock, Crown(way, np.full(120, 5.0 * MM3), np.full(120, 8.0 * MM), reach * MM))


def test_volume_is_conserved_or_told_as_lost():
    stock = Stock.box((0.0, -0.02, -0.01), (0.02, 0.02, 0.0), 0.25 * MM)
    before = stock.volume
    done = melted(stock, 1.0 * MM)

    assert (done.volume + done.lost).sum() / MM3 == pytest.approx(600.0, rel=1e-12)
    assert stock.volume - before == pytest.approx(done.volume.sum(), rel=1e-9)
    assert done.lost.sum() / MM3 == pytest.approx(200.0, rel=0.01)  # a third of the way lies beside the plate


def test_a_second_bead_lies_on_the_first_one():
    stock = Stock.box((-0.01, -0.02, -0.01), (0.05, 0.02, 0.0), 0.25 * MM)
    tops = []
    for k in range(3):
        melted(stock, (3.0 * k + 1.0) * MM)
        tops.append(stock.intervals_at(15 * MM, 0.0)[-1][1] / MM)
    height = 1.5 * 600.0 / 30.0 / 8.0
    assert tops == pytest.approx([height, 2 * height, 3 * height], rel=0.02)


def test_nothing_is_welded_out_of_reach():
    stock = Stock.box((-0.01, -0.02, -0.01), (0.05, 0.02, 0.0), 0.25 * MM)
    assert melted(stock, 15.0 * MM).volume.sum() == 0.0


@pytest.mark.parametrize(
    ("program", "cell", "told"),
    [
        (RUN.replace("M11\nG0 Z40", "G0 Z40\nM11"), CELL, ["GS525", "GS526"]),
        (RUN.replace("G0 Z2", "G0 Z25"), CELL, ["GS526"]),
        (RUN, CELL.replace("length: 120", "length: 120, bead_width: 4"), ["GS527"]),
    ],
)
def test_wrong_use_is_told(program, cell, told):
    assert [code for code, _ in run_texts(program, cell).misuse] == told


def test_an_arm_welds_as_a_gantry_does():
    arm = CELL.replace("machine: gantry_xyz", "robots:\n  arm: {model: kuka_kr10_r1100_2, base: {in: world}, home: "
                       "[0, -90, 90, 0, 90, 0]}").replace("[400, 300, -200]", "[600, -50, 300]")  # fmt: skip
    gantry, ran = run_texts(RUN, CELL), run_texts(RUN, arm)
    assert ran.stock.deposited == pytest.approx(gantry.stock.deposited, rel=0.02)
    assert ran.misuse == []
