"""Mean forces and peaks along ways at the default grid, against fine sums over the exact shape that was cut before."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.laws import Kienzle
from gcodesim.processes.milling import Milling
from gcodesim.processes.window import ProcessStep, Window
from gcodesim.tools import TOOLS
from gcodesim.units import DEG
from tests.physics.swept_cut import Pass, loads

STEEL = Kienzle.from_table(2500.0, 0.26)
D, OMEGA, CHIP, FLUTES = 10e-3, 400.0, 0.05e-3, 3
SPEED = CHIP * FLUTES * OMEGA / (2.0 * math.pi)
STEP = SPEED * 4e-3  # at the default rate
ROUND = {"bull_nose_end_mill": {"corner_radius": 2e-3}}
FREE = 2.0


def mill(kind):
    return TOOLS[kind](diameter=D, flutes=FLUTES, **ROUND.get(kind, {}))


def block(cells=24):
    return Stock.box((-40e-3, -40e-3, -20e-3), (40e-3, 40e-3, 0.0), D / cells)


def cut(stock, cutter, law, corners) -> tuple[np.ndarray, ProcessStep]:
    """Mill on straight lines between `corners` (m, 3): places (n + 1, 3) at which steps end, and what was found."""
    places = [corners[:1]]
    for a, b in itertools.pairwise(corners):
        number = max(1, math.ceil(float(np.linalg.norm(b - a)) / STEP - 1e-9))
        places.append(a + (np.arange(1, number + 1) / number)[:, None] * (b - a))
    at = np.concatenate(places)
    ways = np.diff(at, axis=0)
    window = Window(
        piece_start=at[:-1],
        piece_end=at[1:],
        piece_step=np.arange(len(ways)),
        axis=np.tile([0.0, 0.0, 1.0], (len(ways), 1)),
        velocity=SPEED * ways / np.linalg.norm(ways, axis=1)[:, None],
        rapid=np.zeros(len(ways), dtype=bool),
        signals={"spindle": np.full(len(ways), OMEGA), "active": np.zeros(len(ways), dtype=bool)},
        dt=4e-3,
        turn=turn_of(ways),
    )
    process = Milling(cutter=cutter, law=law)
    state = process.begin()
    state.values[2] = FREE  # it stands in the cut that it has made
    return at, process.run(stock, window, state)


def turn_of(ways):
    """`Window.turn` of steps along ways (n, 3) [m] without corners."""
    ends, headings = np.cumsum(np.linalg.norm(ways, axis=1)), np.unwrap(np.arctan2(ways[:, 1], ways[:, 0]))
    begins = np.concatenate([[0.0], ends[:-1]])

    def turn(onward):
        first = np.searchsorted(ends, np.minimum(begins, ends[-1] - onward), side="right")
        last = np.minimum(np.searchsorted(ends, begins[first] + onward, side="right"), len(ends) - 1)
        return (headings[last] - headings[first]) / (begins[last] - begins[first])

    return turn


def placed(points, angle=0.3, off=(0.13e-3, 0.21e-3)):
    """Points (n, 3) turned about Z, and put anywhere on the grid."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = np.asarray(points, dtype=float).T
    return np.stack([c * x - s * y + off[0], s * x + c * y + off[1], z], axis=1)


def compare(cutter, way, passes, looks, off, peak_off):
    """Mill along `way` in a block that `passes` have cut, and hold what is felt at `looks` [of the way] to the sums."""
    stock = block()
    for one in passes:
        cut(stock, one.cutter, None, one.places)
    at, found = cut(stock, cutter, STEEL, way)
    for look in looks:
        k = int(look * (len(at) - 1))
        heading = (at[k + 1] - at[k]) / np.linalg.norm(at[k + 1] - at[k])
        wanted = loads(cutter, STEEL, CHIP, 0.5 * (at[k] + at[k + 1]), heading, passes, angles=720, count=24)

        assert np.linalg.norm(found.wrench[k, :3]) == pytest.approx(wanted.size, rel=off)
        assert found["torque"][k] == pytest.approx(wanted.torque, rel=off)
        assert found["peak_force"][k] == pytest.approx(wanted.peak_force, rel=peak_off)
        assert found["peak_torque"][k] == pytest.approx(wanted.peak_torque, rel=peak_off)


@pytest.mark.parametrize("slope", [3.0, 20.0])
@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill", "bull_nose_end_mill"])
def test_a_tool_that_rises_out_of_a_slot(kind, slope):
    """Material is asked for ahead, where the top of a raw block is not higher: 10 to 40 % of the force were missing."""
    cutter, run = mill(kind), min(16e-3, 5e-3 / math.tan(slope * DEG))
    deep = -0.5e-3 - run * math.tan(slope * DEG)
    standing = Pass(cutter, placed([(-run, 0.0, 5e-3), (-run, 0.0, deep)]))

    compare(cutter, placed([(-run, 0.0, deep), (0.0, 0.0, -0.5e-3)]), [standing], (0.4, 0.6, 0.8), 0.015, 0.03)


def test_a_tool_that_rises_along_a_floor_that_rises_feels_only_what_it_cuts():
    """A layer of half a millimetre that lies parallel to the way: ahead it is higher, and so is its top."""
    cutter, slope = mill("flat_end_mill"), math.tan(10.0 * DEG)
    wide = TOOLS["flat_end_mill"](diameter=40e-3, flutes=FLUTES)
    passes = [Pass(wide, placed([(-30e-3, 0.0, -8e-3), (30e-3, 0.0, -8e-3 + 60e-3 * slope)]))]
    # its front edge, 20 mm before its tip, has left the floor
    way = placed([(x, 0.0, -8e-3 + (x + 10e-3) * slope - 1e-3) for x in (-12e-3, -4e-3)])

    compare(cutter, way, passes, (0.6, 0.95), 0.03, 0.07)


@pytest.mark.parametrize("side", [1.0, pytest.param(-1.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("slope", "width"), [(3.0, 1e-3), (3.0, 2.7e-3), (15.0, 1.8e-3)])
@pytest.mark.parametrize("kind", ["flat_end_mill"])
def test_a_tool_that_falls_beside_a_deeper_cut(kind, slope, width, side):
    """Its bottom cuts a strip up to the wall: columns show that softly, and 2 to 13 % of the force were missing."""
    cutter = mill(kind)
    deeper = Pass(cutter, placed([(-20e-3, side * width, -8e-3), (20e-3, side * width, -8e-3)]))
    way = placed([(-4e-3, 0.0, -0.5e-3), (4e-3, 0.0, -0.5e-3 - 8e-3 * math.tan(slope * DEG))])

    stock = block()
    cut(stock, cutter, None, deeper.places)
    at, found = cut(stock, cutter, STEEL, way)
    for look in (0.55, 0.75, 0.95):
        k = int(look * (len(at) - 1))
        heading = (at[k + 1] - at[k]) / np.linalg.norm(at[k + 1] - at[k])
        passes = [deeper, Pass(cutter, at[[0, k]])]
        wanted = loads(cutter, STEEL, CHIP, 0.5 * (at[k] + at[k + 1]), heading, passes, angles=720, count=24)

        assert np.linalg.norm(found.wrench[k, :3]) == pytest.approx(wanted.size, rel=0.025)
        assert found["torque"][k] == pytest.approx(wanted.torque, rel=0.025)
        assert found["peak_force"][k] == pytest.approx(wanted.peak_force, rel=0.13)


@pytest.mark.parametrize("side", [1.0, pytest.param(-1.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("kind", "slope", "width"),
    [("ball_end_mill", 3.0, 2.7e-3), ("ball_end_mill", 15.0, 2.7e-3), ("bull_nose_end_mill", 15.0, 0.4e-3)],
)
def test_a_round_tool_that_falls_beside_a_deeper_cut(kind, slope, width, side):
    """Of a narrow strip a ball on a way of 3 deg felt 1 to 36 %, on one of 15 deg 79 to 90 %, and a bull nose 62 %."""
    cutter = mill(kind)
    deeper = Pass(cutter, placed([(-20e-3, side * width, -8e-3), (20e-3, side * width, -8e-3)]))
    way = placed([(-4e-3, 0.0, -0.5e-3), (4e-3, 0.0, -0.5e-3 - 8e-3 * math.tan(slope * DEG))])

    stock = block()
    cut(stock, cutter, None, deeper.places)
    at, found = cut(stock, cutter, STEEL, way)
    for look in (0.75, 0.95):
        k = int(look * (len(at) - 1))
        heading = (at[k + 1] - at[k]) / np.linalg.norm(at[k + 1] - at[k])
        passes = [deeper, Pass(cutter, at[[0, k]])]
        wanted = loads(cutter, STEEL, CHIP, 0.5 * (at[k] + at[k + 1]), heading, passes, angles=720, count=24)

        assert np.linalg.norm(found.wrench[k, :3]) == pytest.approx(wanted.size, rel=0.05)
        assert found["torque"][k] == pytest.approx(wanted.torque, rel=0.05)
        assert found["peak_force"][k] == pytest.approx(wanted.peak_force, rel=0.2)


def test_a_convex_arc_is_felt_all_along() -> None:
    """For up to half a millimetre at a time nothing was felt, where a wall passed between two places of two looks."""
    cutter, radius, wide = mill("flat_end_mill"), 12e-3, 1e-3

    def arc(r, begin, end):
        t = np.linspace(begin, end, int((end - begin) * r / 40e-6))
        return placed(np.stack([r * np.cos(t), r * np.sin(t), np.full(len(t), -3e-3)], axis=1), 0.0, (0.1e-3, 0.13e-3))

    stock, earlier = block(), Pass(cutter, arc(radius + wide, -0.8, 2.5))
    cut(stock, cutter, None, earlier.places)
    at, found = cut(stock, cutter, STEEL, arc(radius, 0.0, 1.4))
    heading = (at[-1] - at[-2]) / np.linalg.norm(at[-1] - at[-2])
    wanted = loads(cutter, STEEL, CHIP, at[-2], heading, [earlier], angles=720, count=24)
    force = np.linalg.norm(found.wrench[200:, :3], axis=1)

    assert np.median(force) == pytest.approx(wanted.size, rel=0.02)
    assert force.min() > 0.7 * wanted.size
    assert force.max() < 1.05 * wanted.size


def felt(kind, way, earlier, steps=slice(-200, None)):
    """Mean force, torque and peak of the last steps of a way beside an earlier pass, each by the sums at its end."""
    cutter, stock = mill(kind), block()
    before = Pass(cutter, earlier)
    cut(stock, cutter, None, before.places)
    at, found = cut(stock, cutter, STEEL, way)
    heading = (at[-1] - at[-2]) / np.linalg.norm(at[-1] - at[-2])
    wanted = loads(cutter, STEEL, CHIP, at[-1], heading, [before], angles=1440, count=24)
    force = np.linalg.norm(found.wrench[steps, :3], axis=1)
    return (
        float(force.mean()) / wanted.size,
        float(found["torque"][steps].mean()) / wanted.torque,
        float(found["peak_force"][steps].mean()) / wanted.peak_force,
    )


def along_line(width, depth, angle, side=1.0):
    """A way (2, 3) [m], and an earlier one so far beside it."""
    way = placed([(-12e-3, 0.0, -depth), (-6e-3, 0.0, -depth)], angle)
    return way, placed([(-16e-3, side * width, -depth), (16e-3, side * width, -depth)], angle)


def along_arc(width, depth, radius, turn=1.0):
    """The same on arcs around one centre; the earlier one is farther out, or in where `width` is below 0."""

    def arc(r, begin, end):
        t = turn * np.linspace(begin, end, int((end - begin) * r / 40e-6))
        return placed(np.stack([r * np.cos(t), r * np.sin(t), np.full(len(t), -depth)], axis=1), 0.0)

    whole = min(1.4, 12e-3 / radius)
    return arc(radius, 0.0, whole), arc(radius + width, -0.9, whole + 1.2)


@pytest.mark.parametrize(("width", "angle", "side"), [(0.2e-3, 0.3, 1.0), (0.5e-3, 0.8, -1.0), (1.2e-3, 2.0, 1.0)])
@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill", "bull_nose_end_mill"])
def test_a_thin_cut_is_felt(kind, width, angle, side):
    """A strip one cell wide at the rim of round ends was not looked at: 0.5 mm lost 40 %, 0.2 mm 85 %."""
    force, torque, peak = felt(kind, *along_line(width, 2e-3, angle, side))

    assert force == pytest.approx(1.0, abs=0.02)
    assert torque == pytest.approx(1.0, abs=0.02)
    assert peak == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("width", [-1.5e-3, -0.5e-3, 0.5e-3, 1.5e-3])
@pytest.mark.parametrize("kind", ["ball_end_mill", "bull_nose_end_mill"])
def test_a_cut_along_an_arc_is_felt(kind, width):
    """What is beside it was looked for straight ahead: up to 30 % too much outside, up to 95 % too little inside."""
    force, torque, peak = felt(kind, *along_arc(width, 3e-3, 8e-3))

    assert force == pytest.approx(1.0, abs=0.035)
    assert torque == pytest.approx(1.0, abs=0.035)
    assert peak == pytest.approx(1.0, abs=0.09)


@pytest.mark.parametrize("angle", [0.3, 0.785, 1.3])
def test_a_level_strip_is_felt_at_each_step(angle):
    """Where a column was taken for a landing, or the tool's own front for the wall, a step had 4 to 16 % too little."""
    cutter, stock = mill("flat_end_mill"), block()
    way, before = along_line(1e-3, 2e-3, angle)
    cut(stock, cutter, None, before)
    at, found = cut(stock, cutter, STEEL, np.array([way[0], way[0] + 3.0 * (way[1] - way[0])]))
    heading = (at[-1] - at[-2]) / np.linalg.norm(at[-1] - at[-2])
    wanted = loads(cutter, STEEL, CHIP, at[-1], heading, [Pass(cutter, before)], angles=1440, count=24)
    share = np.linalg.norm(found.wrench[100:, :3], axis=1) / wanted.size

    assert share.min() > 0.98
    assert share.max() < 1.02


@pytest.mark.parametrize("slope", [3.0, 20.0])
def test_a_tool_that_rises_beside_a_wall_is_felt_at_each_step(slope):
    """A wall between two columns was taken for a floor that rises: every fifth step had 5 to 15 % too little."""
    cutter, run = mill("flat_end_mill"), 10e-3
    deep = -1e-3 - run * math.tan(slope * DEG)
    stock = block()
    cut(stock, cutter, None, placed([(-20e-3, 1e-3, -9e-3), (20e-3, 1e-3, -9e-3)]))
    at, found = cut(stock, cutter, STEEL, placed([(-run, 0.0, deep), (0.0, 0.0, -1e-3)]))

    force, down = np.linalg.norm(found.wrench[:, :3], axis=1)[60:-20], -at[60:-21, 2]
    share = force / np.polyval(np.polyfit(down, force, 1), down)  # the strip is as wide all along, so as high as deep
    assert share.min() > 0.98
    assert share.max() < 1.02


def pocket_corner(radius, wide, inner):
    """A way (n, 3) [m] along the walls of a pocket's corner, with an arc in it, and an earlier one so `wide` inside."""

    def around(off, r):
        t = np.linspace(-0.5 * np.pi, 0.0, max(2, int(0.5 * np.pi * r / 40e-6)))
        turn = np.stack([-off - r + r * np.cos(t), off + r + r * np.sin(t)], axis=1)
        flat = np.concatenate([[[-14e-3, off]], turn, [[-off, 14e-3]]])
        return placed(np.column_stack([flat, np.full(len(flat), -4e-3)]))

    return around(0.0, radius), around(wide, inner)


@pytest.mark.parametrize(("radius", "wide"), [(3e-3, 2e-3), (6e-3, 2e-3), (2e-3, 1e-3)])
def test_a_line_behind_an_arc_is_felt(radius, wide):
    """It was felt as if the way went on turning: half of the force, or nothing at all behind an arc of 2 mm."""
    way, earlier = pocket_corner(radius, wide, max(radius - wide, 1e-3))
    cutter, stock = mill("flat_end_mill"), block()
    cut(stock, cutter, None, earlier)
    at, found = cut(stock, cutter, STEEL, way)
    passed = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(at, axis=0), axis=1))])
    behind = int(np.searchsorted(passed, passed[-1] - np.linalg.norm(way[-1] - way[-2]) + 0.4e-3))
    heading = (at[behind + 1] - at[behind]) / np.linalg.norm(at[behind + 1] - at[behind])
    own = Pass(cutter, np.concatenate([way[:1], at[behind - 100 : behind + 1]]))
    wanted = loads(cutter, STEEL, CHIP, at[behind], heading, [Pass(cutter, earlier), own], angles=720, count=16)

    assert np.linalg.norm(found.wrench[behind, :3]) == pytest.approx(wanted.size, rel=0.02)
    assert found["peak_force"][behind] == pytest.approx(wanted.peak_force, rel=0.05)


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.785])
@pytest.mark.parametrize("beyond", [0.0, 1e-3])
def test_a_level_is_cut_up_to_the_wall_of_earlier_ones(angle, beyond):
    """Where earlier levels have ended the mill felt their wall over a cell and a half before it: four times the force.

    It feels all of it where it goes on into that wall, and from the step in which it comes there.
    """
    cutter, stock, end = mill("flat_end_mill"), block(), 6e-3
    for level in (-2e-3, -4e-3, -6e-3):
        cut(stock, cutter, None, placed([(-20e-3, 0.0, level), (end, 0.0, level)], angle))
    cut(stock, cutter, None, placed([(-20e-3, 0.0, -8e-3), (0.0, 0.0, -8e-3)], angle))
    at, found = cut(stock, cutter, STEEL, placed([(0.0, 0.0, -8e-3), (end + beyond, 0.0, -8e-3)], angle))
    force, steps = np.linalg.norm(found.wrench[:, :3], axis=1), int(end / (end + beyond) * (len(at) - 1))
    level = float(np.median(force[20 : steps - 1]))

    assert force[20 : steps - 1].min() > 0.99 * level
    assert force[20 : steps - 1].max() < 1.1 * level  # it was four times as much
    if beyond > 0.0:
        assert force[steps + 2 :] == pytest.approx(np.full(len(force) - steps - 2, 4.0 * level), rel=0.01)


@pytest.mark.parametrize("turn", [-60.0, -90.0, -135.0])
def test_a_corner_in_the_full_is_felt_as_the_walls_are(turn):
    """Behind a corner of a slot the mill felt walls a cell away from it: 28 % too much at 90 deg, 70 % at 135 deg."""
    cutter, stock = mill("flat_end_mill"), block()
    way = placed(
        [(-20e-3, 0.0, -3e-3), (0.0, 0.0, -3e-3), (8e-3 * math.cos(turn * DEG), 8e-3 * math.sin(turn * DEG), -3e-3)]
    )
    before = Pass(cutter, way[:2])
    cut(stock, cutter, None, before.places)
    at, found = cut(stock, cutter, STEEL, way[1:])
    heading = (at[1] - at[0]) / np.linalg.norm(at[1] - at[0])
    shares = []
    for k in (2, 5, 10, 20, 30, 40, 60, 80, 100, 120, 150, 180):
        own = Pass(cutter, at[[0, k]])
        wanted = loads(cutter, STEEL, CHIP, 0.5 * (at[k] + at[k + 1]), heading, [before, own], angles=1440, count=4)
        shares.append(np.linalg.norm(found.wrench[k, :3]) / wanted.size)
        assert found["peak_force"][k] == pytest.approx(wanted.peak_force, rel=0.05)

    assert shares == pytest.approx(np.ones(len(shares)), abs=0.12)
    assert np.mean(shares) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_a_mill_that_enters_a_block_feels_what_it_has_reached(angle):
    """Contact began a cell and a half before the rim was there: 54 % too much force a millimetre into the block."""
    cutter, stock = mill("flat_end_mill"), Stock.box((0.0, -40e-3, -20e-3), (60e-3, 40e-3, 0.0), D / 24)
    side = TOOLS["flat_end_mill"](diameter=80e-3, flutes=FLUTES)
    free = Pass(side, np.array([(-40e-3, y, -20e-3) for y in (-30e-3, 30e-3)]))
    way = np.array([(-6e-3, 0.13e-3, -3e-3), (3e-3, 0.13e-3 + 9e-3 * math.tan(angle), -3e-3)])
    at, found = cut(stock, cutter, STEEL, way)
    heading = (at[1] - at[0]) / np.linalg.norm(at[1] - at[0])
    shares = []
    for reached in (0.3e-3, 0.5e-3, 0.7e-3, 0.9e-3, 1.1e-3, 1.5e-3, 2e-3, 3e-3, 4e-3):
        k = int(np.searchsorted(at[:, 0], reached - 0.5 * D))
        own = Pass(cutter, at[[0, k]])
        wanted = loads(cutter, STEEL, CHIP, 0.5 * (at[k] + at[k + 1]), heading, [free, own], angles=1440, count=4)
        shares.append(np.linalg.norm(found.wrench[k, :3]) / wanted.size)

    assert shares == pytest.approx(np.ones(len(shares)), abs=0.12)
    assert np.mean(shares) == pytest.approx(1.0, abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_drawn_cuts(seed):
    """Any kind, width, depth, direction, on lines and on arcs both ways; one, a flat mill on a line, is 5.03 % low."""
    rng = np.random.default_rng(seed)
    kind = ("flat_end_mill", "ball_end_mill", "bull_nose_end_mill")[seed % 3]
    width, depth = rng.uniform(0.3e-3, 4e-3), rng.uniform(0.5e-3, 6e-3)
    if seed % 2:
        cuts = along_line(width, depth, rng.uniform(0.0, 6.28), rng.choice([-1.0, 1.0]))
    else:
        outer = rng.choice([-1.0, 1.0])
        cuts = along_arc(outer * width, depth, rng.uniform(8e-3, 20e-3), rng.choice([-1.0, 1.0]))
    force, torque, peak = felt(kind, *cuts)

    assert force == pytest.approx(1.0, abs=0.055)
    assert torque == pytest.approx(1.0, abs=0.055)
    assert peak == pytest.approx(1.0, abs=0.12)
