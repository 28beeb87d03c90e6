"""Prints in whole runs: volume, beads on what lies below, what is told, and the time law against closed forms."""

import math
from itertools import pairwise

import numpy as np
import pytest

from gcodesim.canon import Extrude
from gcodesim.canon.printing import MotionLimits
from gcodesim.diagnostics import Span
from gcodesim.material import shape
from gcodesim.material.stock import Stock
from gcodesim.material.strand import CARRY, FilamentStrand, carried, lay_strand
from gcodesim.motion.printer_law import filament_time
from gcodesim.rs274.marlin.limits import MARLIN_LIMITS
from gcodesim.units import MM, MM3
from tests.physics.runs import run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
dialect: marlin
work_offsets: {G54: {in: world, xyz: [400, 300, -200]}}
stock: {min: [0, 0, -5], max: [120, 60, 0], in: G54, resolution: 0.5}
tools:
  0: {type: extruder, bead_width: 6, bead_height: 3, length: 40}
"""
AREA = 0.25 * math.pi * 1.75**2  # of the filament [mm²]
BEAD = (6.0 - 3.0) * 3.0 + 0.25 * math.pi * 9.0  # [mm²]


def bead_e(length, share=1.0):
    """E [mm] for a bead of 6 x 3 mm over a length [mm]."""
    return share * BEAD * length / AREA


def straight(x, y, z, width, height, volume, cell=0.25):
    """A strand along X from 0 to `x` on a plate of 40 x 20 mm, laid at height `z`: the stock, and what became of it."""
    stock = Stock.box((-5 * MM, -10 * MM, -2 * MM), (35 * MM, 10 * MM, 0.0), cell * MM)
    points = np.column_stack([np.linspace(0.0, x, 61), np.full(61, y), np.full(61, z)]) * MM
    each = np.full(60, volume / 60 * MM3)
    sizes = np.full(60, width * MM), np.full(60, height * MM)
    before = stock.volume
    laid = lay_strand(stock, FilamentStrand(points[:-1], points[1:], each, *sizes), np.full(CARRY, np.inf))
    assert stock.volume - before == pytest.approx(laid.volume.sum(), rel=1e-9)
    return stock, laid


@pytest.mark.parametrize(
    ("width", "height", "flow"), [(6, 3, 1.0), (6, 3, 0.4), (6, 3, 1.7), (2, 1, 1.0), (0.6, 0.3, 1.0)]
)
def test_volume_is_conserved_whatever_the_bead(width, height, flow):
    section = ((width - height) * height + 0.25 * math.pi * height**2) * flow
    _, laid = straight(30.0, 0.0, height, width, height, section * 30.0)

    assert laid.volume.sum() == pytest.approx(section * 30.0 * MM3, rel=1e-9)
    assert laid.support.all()


@pytest.mark.parametrize("gap", [0.0, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("paste", [False, True])
def test_a_bed_that_is_thinner_than_the_bead_carries_it(gap, paste):
    """Also where the nozzle is pressed down, so that the bed lies within the bead's own layer; not beside a hole."""
    stock = Stock.box((-5 * MM, -10 * MM, -1 * MM), (35 * MM, 10 * MM, 0.0), 0.25 * MM)
    hole = np.array([[45.0, -40.0, -2.0], [45.0, 40.0, -2.0]]) * MM  # from X15 on
    stock.remove(hole[:1], hole[1:], shape.flat(60 * MM, 30 * MM))
    points = np.column_stack([np.linspace(0.0, 30.0, 61), np.zeros(61), np.full(61, gap)]) * MM
    starts, ends = points[:-1], points[1:]
    if paste:
        support = carried(stock, starts, ends, 6 * MM, 3 * MM)
    else:
        sizes = np.full(60, 6 * MM), np.full(60, 3 * MM)
        support = lay_strand(
            stock, FilamentStrand(starts, ends, np.full(60, 8.0 * MM3), *sizes), np.full(CARRY, np.inf)
        ).support

    assert support[:29].all() and not support[31:].any()


@pytest.mark.parametrize("gap", [2.0, 3.0, 4.0])
def test_width_follows_from_flow_and_the_gap_below(gap):
    """The bead of a given section is wider where the nozzle is lower: A = (w - h) h + pi h² / 4."""
    stock, laid = straight(30.0, 0.0, gap, 6.0, 3.0, BEAD * 30.0)
    wanted = BEAD / gap + (1.0 - 0.25 * math.pi) * gap
    rows = np.array([stock.intervals_at(15 * MM, y * MM)[-1][1] > 0.05 * MM for y in np.arange(-9.9, 9.9, 0.05)])

    assert np.median(laid.width) == pytest.approx(wanted * MM, rel=0.02)
    assert rows.sum() * 0.05 == pytest.approx(wanted, abs=0.5)


def test_a_wall_on_the_border_of_columns_has_smooth_sides():
    """Rounding puts the nozzle now in one column, now in its neighbour; what overflows must not lie ahead of it."""
    stock = Stock.box((-10 * MM, -10 * MM, -2 * MM), (40 * MM, 10 * MM, 0.0), 1.0 * MM)
    carry, noise = np.full(CARRY, np.inf), np.random.default_rng(3).choice([-1e-17, 0.0, 1e-17], 301)
    for layer in range(1, 7):
        points = np.column_stack([np.linspace(0.0, 30.0, 301) * MM, noise, np.full(301, 3.0 * layer * MM)])
        each, sizes = np.full(300, BEAD * 0.1 * MM3), (np.full(300, 6.0 * MM), np.full(300, 3.0 * MM))
        laid = lay_strand(stock, FilamentStrand(points[:-1], points[1:], each, *sizes), carry)

        assert laid.width == pytest.approx(np.full(300, 6.0 * MM), rel=1e-5)
    for y in (-3.5, 3.5):
        assert stock.intervals_at(15.5 * MM, y * MM)[-1][1] == 0.0
    for y in (-2.5, 2.5):  # round sides: none is a thin fin
        assert all(high - low > 1.0 * MM for low, high in stock.intervals_at(15.5 * MM, y * MM))


def test_what_finds_no_room_goes_sideways_and_then_up():
    _, once = straight(30.0, 0.0, 3.0, 6.0, 3.0, BEAD * 30.0)
    stock, much = straight(30.0, 0.0, 3.0, 6.0, 3.0, 6.0 * BEAD * 30.0)

    assert once.above.sum() < 1e-3 * once.volume.sum()
    assert much.volume.sum() == pytest.approx(6.0 * BEAD * 30.0 * MM3, rel=1e-9)
    assert much.above.sum() > 0.1 * much.volume.sum()
    assert stock.extent()[1][2] > 3.1 * MM


def test_beside_the_plate_nothing_is_kept_and_all_is_told():
    _, laid = straight(60.0, 0.0, 3.0, 6.0, 3.0, BEAD * 60.0)

    assert (laid.volume + laid.beside).sum() == pytest.approx(BEAD * 60.0 * MM3, rel=1e-9)
    assert laid.beside.sum() == pytest.approx(BEAD * 25.0 * MM3, rel=0.02)


BLOBS = """M83
G28
G1 X10 Y30 Z3 F6000
G1 E20 F600
G1 X40 F6000
G1 E-5 F1200
G1 X60 E3 F1200
G1 E5 F1200
G1 Z20 F6000
G1 E7 F600
"""
"""A blob of 20 mm of filament; 5 mm drawn back, of which 3 come forward on the way and 2 at rest, so 3 more are a blob;
7 mm into the air."""


def test_what_comes_out_at_rest_is_a_blob_or_falls():
    ran = run_texts(BLOBS, CELL)
    (tool,) = ran.results.tools

    assert ran.stock.deposited / MM3 == pytest.approx(23.0 * AREA, rel=1e-4)
    assert tool["blobs_mm3"] == pytest.approx(ran.stock.deposited / MM3, rel=1e-6)
    assert tool["fallen_mm3"] == pytest.approx(7.0 * AREA, rel=1e-4)
    assert tool["laid_length_mm"] == 0.0
    assert [(f.code, f.span.line, f.count) for f in ran.results.findings if f.code == "GS519"] == [("GS519", 4, 2)]


def test_a_blob_is_a_disc_below_the_nozzle_and_then_a_dome():
    at = np.array([[15.0, 0.0, 3.0]]) * MM
    size = np.full(1, 6.0 * MM), np.full(1, 3.0 * MM)
    for volume, radius, top in ((400.0, math.sqrt(400.0 / math.pi / 3.0), 3.0), (6000.0, 18.0, 6.0)):
        stock = Stock.box((-5 * MM, -20 * MM, -2 * MM), (35 * MM, 20 * MM, 0.0), 0.5 * MM)
        laid = lay_strand(stock, FilamentStrand(at, at, np.full(1, volume * MM3), *size), np.full(CARRY, np.inf))
        at_x = [stock.intervals_at(x * MM, 0.1 * MM)[-1][1] > 0.05 * MM for x in np.arange(-4.9, 34.9, 0.1)]

        assert laid.volume[0] == pytest.approx(volume * MM3, rel=1e-9)
        assert sum(at_x) * 0.05 == pytest.approx(radius, abs=0.5)
        assert stock.extent()[1][2] >= (top - 1e-6) * MM


def test_a_pump_goes_on_while_the_nozzle_stands():
    """It is switched on, and off again before the next move."""
    cell = CELL.replace("dialect: marlin\n", "").replace("length: 40}", "length: 40, flow: 100 mm^3/s}")
    cell += "signals: {active: {word: M62 P0}}\n"
    text = "G21 G90\nT1 M6\nG43 H1\nG0 X30 Y30 Z20\nG1 Z3 F1000\nM64 P0\nG4 P2\nM65 P0\nG0 Z20\nM2\n"
    ran = run_texts(text, cell.replace("  0: {", "  1: {"))

    assert ran.stock.deposited / MM3 == pytest.approx(200.0, rel=1e-3)
    assert [(f.code, f.span.line) for f in ran.results.findings if f.code == "GS519"] == [("GS519", 7)]
    assert ran.misuse == []


def test_little_flow_is_told():
    """Scenario 12: E100 over 100 mm with beads of 6 x 3 mm."""
    ran = run_texts("M83\nG28\nG1 X10 Y30 Z3 F6000\nG1 X110 E100 F1200\n", CELL)

    assert ran.stock.deposited / MM3 == pytest.approx(100.0 * AREA, rel=1e-4)
    assert ran.misuse == [("GS524", 4)]
    assert "ask for 16.1 mm²" in ran.bad[0].message and "85% less" in ran.bad[0].message


def test_too_little_and_too_much_are_told_each_for_itself():
    """Of a print with both the mean is right, and says nothing."""
    text = "M83\nG28\nG1 X10 Y20 Z3 F6000\nG1 X110 E350 F1200\nG1 Y40 F6000\nG1 X10 E1050 F1200\n"
    ran = run_texts(text, CELL)

    told = [(f.span.line, f.message) for f in ran.bad if f.code == "GS524"]
    assert [line for line, _ in told] == [4, 6]
    assert "less flows" in told[0][1] and "more flows" in told[1][1]


def test_what_lies_beside_the_plate_is_blamed_on_the_line_that_lays_it():
    ran = run_texts(f"M83\nG28\nG1 X10 Y30 Z3 F6000\nG1 X310 E{bead_e(300.0):.4f} F1200\n", CELL)

    assert [(f.code, f.span.line, f.count) for f in ran.bad] == [("GS522", 4, 1)]


def wall(layers, missing=()):
    lines = ["M83", "G28", "M104 S200", "M106 S255"]
    for layer in range(layers):
        if layer in missing:
            continue
        e = bead_e(80.0)
        lines += [f"G1 Z{3 * layer + 13} F6000", "G1 X20 Y30", f"G1 Z{3 * layer + 3}", f"G1 X100 E{e:.4f} F1200"]
    return "\n".join([*lines, ""])


def test_a_layer_over_air_is_found_at_its_first_line():
    sound, hollow = run_texts(wall(3), CELL), run_texts(wall(4, missing=(1,)), CELL)

    assert sound.misuse == []
    assert hollow.misuse == [("GS520", 12)]
    assert hollow.bad[0].value == pytest.approx(80.0, abs=1.0)
    assert hollow.stock.deposited / MM3 == pytest.approx(3 * BEAD * 80.0, rel=1e-4)
    assert {entry["word"] for entry in hollow.results.not_simulated} == {"M104", "M106"}
    layers = hollow.results.as_json()["printing"]["layers"]
    assert [layer["z_mm"] for layer in layers] == [3, 9, 12]
    assert all(layer["time_s"] > 4.0 for layer in layers)


def test_a_bridge_rests_on_both_ends():
    """Two blocks of one layer and a bead over the gap between them."""
    e = bead_e(20.0)
    text = f"M83\nG28\nG1 X10 Y30 Z3 F6000\nG1 X30 E{e:.4f} F1200\nG1 X60 F6000\nG1 X80 E{e:.4f} F1200\n"
    block = bead_e(14.0)
    text += f"G1 Z6 F6000\nG1 X12\nG1 X26 E{block:.4f} F1200\nG1 X64 E{bead_e(38.0):.4f}\nG1 X78 E{block:.4f}\n"
    ran = run_texts(text, CELL)
    (bridge,) = [f for f in ran.results.findings if f.code == "GS521"]

    assert ran.misuse == []
    assert bridge.span.line == 10
    assert bridge.value == pytest.approx(30.0, abs=1.5)


def test_a_print_is_milled_afterwards():
    """What was laid is stock like any other."""
    cell = CELL.replace("length: 40}", "length: 40}\n  1: {type: flat_end_mill, diameter: 4, length: 40}")
    lines = wall(2).replace("T0", "").splitlines()
    ran = run_texts("\n".join([*lines, "T1", "G1 Z20 F6000", "G1 X10 Y30", "G1 Z5", "G1 X110 F600", ""]), cell)

    removed = next(tool for tool in ran.results.tools if tool["number"] == 1)["removed_mm3"]
    assert removed == pytest.approx(4.0 * 1.0 * 80.0, rel=0.08)


# -- a pump, or a bead of fixed size, switched by M-codes

PUMP = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {in: world, xyz: [400, 300, -200]}}
stock: {min: [0, 0, -5], max: [120, 60, 0], in: G54, resolution: 0.5}
tools:
  1: {type: extruder, bead_width: 6, bead_height: 3, length: 40}
m_codes:
  M10: {tool: activate}
  M11: {tool: deactivate}
"""


def beads(*heights, feed=1200):
    """A bead along X for each height, switched by M10 and M11."""
    lines = ["G21 G90 G61", "T1 M6", "G43 H1"]
    for z in heights:
        lines += ["G0 Z40", "G0 X20 Y30", f"G0 Z{z}", "M10", f"G1 X100 F{feed}", "M11"]
    return "\n".join([*lines, "G0 Z40", "M2", ""])


def test_a_bead_of_fixed_size_over_air_is_found():
    sound, hollow = run_texts(beads(3, 6, 9), PUMP), run_texts(beads(3, 9, 12), PUMP)

    assert sound.misuse == []
    assert hollow.misuse == [("GS520", 14)]
    assert hollow.bad[0].value == pytest.approx(80.0, abs=1.0)


@pytest.mark.parametrize("share", [1.0, 0.5])
def test_what_a_pump_gives_is_flow_times_time(share):
    flow = share * BEAD * 20.0  # mm³/s for the named bead at 20 mm/s
    ran = run_texts(beads(3, 6), PUMP.replace("length: 40}", f"length: 40, flow: {flow:.6f} mm^3/s}}"))
    on = 2.0 * (80.0 / 20.0 + 20.0 / 1000.0)  # about, with ramps

    assert ran.stock.deposited / MM3 == pytest.approx(flow * on, rel=0.03)
    assert ran.stock.deposited / MM3 == pytest.approx(ran.results.tools[0]["extruded_mm3"], rel=5e-3)
    assert ran.misuse == ([] if share == 1.0 else [("GS524", 8)])


def test_a_word_sets_the_flow_of_a_pump():
    cell = PUMP + "signals: {flow: {word: M67 E0, per: 1 mm^3/s}}\n"
    slow = run_texts(beads(3).replace("M10", "M67 E0 Q160\nM10"), cell)
    fast = run_texts(beads(3).replace("M10", "M67 E0 Q320\nM10"), cell)

    assert fast.stock.deposited == pytest.approx(2.0 * slow.stock.deposited, rel=1e-6)


def test_what_flows_over_goes_to_the_nearest_place():
    """A nozzle that stands still makes a round blob: as wide one way as the other."""
    stock = Stock.box((-20 * MM, -20 * MM, -2 * MM), (20 * MM, 20 * MM, 0.0), 0.25 * MM)
    points = np.column_stack([np.linspace(0.0, 0.5, 11), np.zeros(11), np.full(11, 3.0)]) * MM
    each, sizes = np.full(10, 60.0 * MM3), (np.full(10, 6.0 * MM), np.full(10, 3.0 * MM))
    lay_strand(stock, FilamentStrand(points[:-1], points[1:], each, *sizes), np.full(CARRY, np.inf))
    points = stock.surface().vertices
    raised = points[points[:, 2] > 0.1 * MM]
    low, high = raised[:, :2].min(axis=0), raised[:, :2].max(axis=0)

    assert stock.volume / MM3 == pytest.approx(3200.0 + 600.0, rel=1e-9)
    assert (high - low)[0] == pytest.approx((high - low)[1], rel=0.1)
    assert (high - low)[0] == pytest.approx(math.sqrt(4.0 * 600.0 / 3.0 / math.pi) * MM, rel=0.15)


def test_a_wall_turns_round_without_losing_volume():
    rng = np.random.default_rng(7)
    points = np.column_stack(
        [60 + np.cumsum(rng.uniform(-6, 6, 80)) * 0.3, 30 + np.cumsum(rng.uniform(-6, 6, 80)) * 0.2]
    )
    lines = ["M83", "G28", f"G1 X{points[0, 0]:.3f} Y{points[0, 1]:.3f} Z3 F6000"]
    for (x0, y0), (x, y) in pairwise(points):
        lines.append(f"G1 X{x:.3f} Y{y:.3f} E{bead_e(math.hypot(x - x0, y - y0), 0.4):.4f} F1200")
    ran = run_texts("\n".join([*lines, ""]), CELL)

    printing = ran.results.as_json()["printing"]
    assert ran.stock.deposited / MM3 == pytest.approx(printing["laid_mm3"], rel=1e-5)


# -- time

SOFT = "M201 X1000 Y1000 Z1000 E100000\nM203 X500 Y500 Z500 E1000\nM204 P500 T500 R1000\n"


def time_of(text):
    return run_texts(SOFT + text, CELL).results.times


@pytest.mark.parametrize(("way", "feed"), [(100.0, 50.0), (4.0, 50.0), (60.0, 200.0)])
def test_one_move_is_a_trapezoid(way, feed):
    """t = L/v + v/a, or 2 sqrt(L/a) where v is not reached."""
    times = time_of(f"G1 X10 Z9 F6000\nG4 P0\nM400\nM0\nG1 X{10 + way} F{60 * feed}\n")
    both = time_of("G1 X10 Z9 F6000\nG4 P0\nM400\nM0\n")
    wanted = way / feed + feed / 500.0 if way >= feed**2 / 500.0 else 2.0 * math.sqrt(way / 500.0)

    assert times.feed - both.feed == pytest.approx(wanted, rel=1e-6)


def corner_time(words, way, speed, acceleration=500.0):
    """Two moves of `way` at a right angle: measured time, and that with `speed` [mm/s] in the corner."""
    start = time_of(f"{words}\nG1 X10 Y10 Z9 F6000\nM0\n").feed
    took = time_of(f"{words}\nG1 X10 Y10 Z9 F6000\nM0\nG1 X{10 + way} F6000\nG1 Y{10 + way}\n").feed - start
    peak = math.sqrt(acceleration * way + 0.5 * speed**2)
    if peak <= 100.0:
        half = (peak + peak - speed) / acceleration
    else:
        ramps = (100.0**2 + 100.0**2 - speed**2) / (2.0 * acceleration)
        half = (100.0 + 100.0 - speed) / acceleration + (way - ramps) / 100.0
    return took, 2.0 * half


def test_corners_by_jerk_deviation_and_square_corner_velocity():
    """Jerk: each axis changes its speed by v. Deviation d: v² = a d s / (1 - s), s = sin 45°; Klipper's is v itself."""
    s = math.sqrt(0.5)
    for words, speed in (
        ("M205 X8 Y8 Z1 E5", 8.0),
        ("M205 J0.05", math.sqrt(500.0 * 0.05 * s / (1.0 - s))),
        ("SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=7", 7.0),
    ):
        took, wanted = corner_time(words, 30.0, speed)
        assert took == pytest.approx(wanted, rel=1e-6), words


def test_a_planner_that_sees_few_moves_ahead_is_slower():
    """20 mm in chords of 0.05 mm: with 16 moves in hand it has to be able to stop within 15 of them."""
    text = "G1 X10 Z9 F12000\nM0\n" + "".join(f"G1 X{10 + 0.05 * k:.2f} F12000\n" for k in range(1, 1201))
    slow = time_of(text).feed - time_of("G1 X10 Z9 F12000\nM0\n").feed

    assert slow > 0.97 * 60.0 / math.sqrt(2.0 * 500.0 * 15 * 0.05)


def test_filament_alone_takes_a_trapezoid():
    limits: MotionLimits = MARLIN_LIMITS._replace(jerk=(0, 0, 0, 0), retracting=1.0, acceleration=(1, 1, 1, 1))
    event = Extrude(span=Span(""), length=-0.002, feed=0.02, limits=limits)

    assert filament_time(event) == pytest.approx(0.002 / 0.02 + 0.02 / 1.0)


def test_the_model_alone_is_compared_with_what_the_slicer_says_of_it():
    """Code at the start and the end is left out where the slicer tells the time of its model apart."""
    model = "; FEATURE: Outer wall\nG1 X40 Y30 E2 F1200\nG1 X80 Y30 E2\nG1 X80 Y50 E2\n"
    around = "; FEATURE: Custom\nG4 S9\nG1 X10 Y10 Z3 F6000\n"
    says = "; BambuStudio 02.06.00.51\n; model printing time: 4s; total estimated time: 4m 30s\n"
    printing = run_texts(f"{says}G21\nG90\nM83\n{around}{model}{around}", CELL).results.printing
    alone = run_texts(f"G21\nG90\nM83\n{around}{model}", CELL).results.printing

    wall = next(each for each in printing["features"] if each["feature"] == "Outer wall")
    assert printing["model_time_s"] == wall["time_s"] < 7.0
    assert (printing["slicer_model_time_s"], printing["slicer_time_s"]) == (4.0, 270.0)
    assert "model_time_s" not in alone
