"""What words of printers do to time and volume in whole runs, each against a closed form."""

from __future__ import annotations

import math

import pytest

from gcodesim.units import MM, MM3
from tests.physics.runs import height_at, run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
dialect: marlin
work_offsets: {G54: {in: world, xyz: [400, 300, -200]}}
stock: {min: [0, 0, -5], max: [150, 60, 0], in: G54, resolution: 0.5}
tools:
  0: {type: extruder, bead_width: 6, bead_height: 3, length: 40}
  1: {type: extruder, bead_width: 6, bead_height: 3, length: 40}
"""
TOOL = "  1: {type: extruder, bead_width: 6, bead_height: 3, "
SOFT = "M201 X1000 Y1000 Z1000 E100000\nM203 X500 Y500 Z500 E1000\nM204 P500 T500 R1000\nM205 X8 Y8 Z1 E0\nM83\n"
START = "G1 X10 Y10 Z9 F6000\nM0\n"
AREA = 0.25 * math.pi * 1.75**2  # of the filament [mm²]


def seconds(words: str, move: str) -> float:
    """What a move from rest to rest takes behind some words."""
    whole = run_texts(f"{SOFT}{words}\n{START}{move}\nM0\n", CELL).results.times
    before = run_texts(f"{SOFT}{words}\n{START}", CELL).results.times
    return float(whole.feed - before.feed)


def trapezoid(way: float, speed: float, acceleration: float) -> float:
    """L/v + v/a, or 2 sqrt(L/a) where v is not reached [mm, s]."""
    if way < speed * speed / acceleration:
        return 2.0 * math.sqrt(way / acceleration)
    return way / speed + speed / acceleration


@pytest.mark.parametrize(
    ("words", "move", "wanted"),
    [
        ("", "G1 X110 F3000", trapezoid(100.0, 50.0, 500.0)),
        ("M220 S50", "G1 X110 F3000", trapezoid(100.0, 25.0, 500.0)),
        ("M220 S200", "G1 X110 F3000", trapezoid(100.0, 100.0, 500.0)),
        ("M203 X30", "G1 X110 F3000", trapezoid(100.0, 30.0, 500.0)),
        ("M203 X30", "G1 X40 Y50 F6000", trapezoid(50.0, 50.0, 500.0)),  # X goes three fifths of the way
        ("M203 E2", "G1 X110 E10 F3000", trapezoid(100.0, 20.0, 500.0)),  # E goes a tenth of it
        ("M201 X200", "G1 X110 F3000", trapezoid(100.0, 50.0, 200.0)),
        ("M201 X200", "G1 X40 Y50 F3000", trapezoid(50.0, 50.0, 1000.0 / 3.0)),
        ("M204 T300", "G1 X110 F3000", trapezoid(100.0, 50.0, 300.0)),
        ("M204 T300", "G1 X110 E10 F3000", trapezoid(100.0, 50.0, 500.0)),  # that of travel does not count
        ("M204 P800", "G1 X110 E10 F3000", trapezoid(100.0, 50.0, 800.0)),
        ("M204 S250", "G1 X110 E10 F3000", trapezoid(100.0, 50.0, 250.0)),
    ],
)
def test_a_move_takes_the_time_that_words_leave_it(words: str, move: str, wanted: float) -> None:
    assert seconds(words, move) == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize(
    ("words", "share"), [("", 1.0), ("M221 S50", 0.5), ("M221 S120", 1.2), ("M220 S50", 1.0), ("M106 S255", 1.0)]
)
def test_the_volume_is_that_of_the_filament_times_the_flow(words: str, share: float) -> None:
    ran = run_texts(f"{SOFT}{words}\nG1 X20 Y30 Z3 F6000\nG1 X120 E400 F1200\nG1 Z20\n", CELL)

    assert ran.stock.deposited / MM3 == pytest.approx(share * 400.0 * AREA, rel=1e-4)


def test_a_fan_changes_nothing_but_what_is_told() -> None:
    fan = run_texts(f"{SOFT}M106 S255\nG1 X20 Y30 Z3 F6000\nG1 X120 E400 F1200\nM107\nG1 Z20\n", CELL)
    none = run_texts(f"{SOFT}G1 X20 Y30 Z3 F6000\nG1 X120 E400 F1200\nG1 Z20\n", CELL)

    assert fan.results.times.feed == none.results.times.feed
    assert {entry["word"] for entry in fan.results.not_simulated} == {"M106", "M107"}
    assert [f.code for f in fan.results.findings if f.span.line in (6, 9)] == ["GS922", "GS922"]


def test_retraction_by_the_firmware_takes_its_time_and_its_lift() -> None:
    """M207 S F Z: filament and lift, each a trapezoid of its own; G11 the same back, with what M208 adds."""
    words = "M207 S2 F1200 Z0.4\nM208 S0.1 F600"
    filament = trapezoid(2.0, 20.0, 1000.0) + trapezoid(2.1, 10.0, 1000.0)
    whole = run_texts(f"{SOFT}{words}\n{START}G10\nG11\nM0\n", CELL).results.times
    before = run_texts(f"{SOFT}{words}\n{START}M0\n", CELL).results.times

    lifts = whole.feed + whole.rapid - before.feed - before.rapid
    assert whole.total - before.total > filament
    assert whole.total - before.total == pytest.approx(filament + lifts, rel=1e-6)


def test_what_was_drawn_back_lays_nothing_and_comes_out_again() -> None:
    laid = [
        run_texts(f"{SOFT}G1 X20 Y30 Z3 F6000\n{way}G1 Z20\n", CELL).stock.deposited
        for way in (
            "G1 X120 E400 F1200\n",
            "M207 S2 F1200\nM208 S0 F1200\nG1 X70 E200 F1200\nG10\nG11\nG1 X120 E200 F1200\n",
        )
    ]
    assert laid[1] == pytest.approx(laid[0], rel=1e-4)


ASIDE = "length: 40, tcp: {xyz: [12, 7, 40]}"  # seen from the flange, whose Y points to -Y of the machine


@pytest.mark.parametrize(
    ("place", "words", "stray"),
    [
        ("length: 40", "T1", (0, 0)),
        ("length: 40", "M218 T1 X12 Y-7\nT1", (0, 0)),  # M218 alone says where the nozzle is
        (ASIDE, "M218 T1 X12 Y-7\nT1", (0, 0)),
        (ASIDE, "M218 T1 X10 Y-7\nT1", (2, 0)),  # it is 2 mm farther than M218 says
    ],
)
def test_another_nozzle_lays_its_bead_where_the_program_says(
    place: str, words: str, stray: tuple[float, float]
) -> None:
    bead = "G1 X20 Y30 Z3 F6000\nG1 X120 E400 F1200\nG1 Z20\n"
    one = run_texts(f"{SOFT}{bead}", CELL)
    cell = CELL.replace("  1: {type: extruder, bead_width: 6, bead_height: 3, length: 40", f"{TOOL}{place}")
    other = run_texts(f"{SOFT}{words}\n{bead}", cell)

    for x, y in ((25.0, 30.0), (60.0, 30.0), (60.0, 28.0), (60.0, 34.0), (117.0, 30.0), (60.0, 23.0), (16.0, 30.0)):
        there = height_at(other, (x + stray[0]) * MM, (y + stray[1]) * MM)
        assert there == pytest.approx(height_at(one, x * MM, y * MM), abs=1e-6), (x, y)
    assert height_at(one, 60.0 * MM, 30.0 * MM) > 2.9 * MM
    assert other.stock.deposited == pytest.approx(one.stock.deposited, rel=1e-6)
