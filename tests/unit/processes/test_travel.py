"""The chip of a tool that gives way: how far it advances and where to, and what of its force no chip changes."""

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.edge_kernels import Heading
from gcodesim.processes.force_kernels import RESULT, TORQUE, cutting_force
from gcodesim.processes.laws import LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.processes.travel_kernels import (
    LEAST,
    MOST,
    Travel,
    Wrenches,
    edge_wrench,
    follow_travel,
    solve_travel,
)
from gcodesim.tools import TOOLS

WAY = 13e-6


def direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def turned(wrench, angle):
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    return np.concatenate([turn @ wrench[:2], wrench[2:3], turn @ wrench[3:5], wrench[5:6]])


def machine(rng, scale):
    """Translation rows (3, 6) of a compliance: symmetric and positive in its 3 x 3, with some of the moments."""
    shape = rng.normal(size=(3, 3))
    return np.hstack([(shape @ shape.T + 2.0 * np.eye(3)) * scale, rng.normal(size=(3, 3)) * scale])


def ask(compliance, edges, chips, left, feed, travel, asked, exponent, level=1.0, climb=0.0, begin=None):
    begin, travel = travel if begin is None else begin, travel.copy()
    step = Travel(
        compliance, left, begin, feed, travel, float(level), float(climb), WAY, exponent, moves=np.empty((6, 3))
    )
    return solve_travel(step, Wrenches(edges, chips), float(asked)), travel


@pytest.mark.parametrize("exponent", [1.0, 0.74])
@pytest.mark.parametrize("slope", [0.0, 0.5, -0.5])
@pytest.mark.parametrize("scale", [1e-9, 1e-7, 1e-5])
def test_the_way_of_the_tip_is_that_of_command_and_bend(scale, slope, exponent):
    """left + C W(travel, advance) = advance way travel, along and across; forces as of a cut, the feed somewhere."""
    rng = np.random.default_rng([round(exponent * 100), round(slope * 10) + 10])
    free = 0
    for _ in range(60):
        compliance = machine(rng, scale)
        heading, feed = direction(rng.uniform(-np.pi, np.pi)), direction(rng.uniform(-np.pi, np.pi))
        asked, level, climb = rng.uniform(0.3, 2.0), np.cos(slope), np.sin(slope)
        chips = 100.0 * np.array([-1.0, rng.uniform(-1, 1), -0.2 * np.sign(slope), *rng.normal(size=3) * 0.02])
        chips, edges = (turned(part, np.arctan2(heading[1], heading[0])) for part in (chips, 0.2 * chips))
        before = compliance @ (0.9 * chips + edges) * rng.uniform(0.8, 1.1)
        left = WAY * np.array([*(level * feed), climb]) - before
        advance, travel = ask(compliance, edges, chips, left, feed, heading, asked, exponent, level, climb)

        assert np.hypot(*travel) == pytest.approx(1.0)
        assert LEAST <= advance <= MOST
        at_end = min(np.linalg.norm(travel - feed), np.linalg.norm(travel - heading)) < 1e-9
        if advance in (LEAST, 1.0, MOST) or at_end:
            continue  # something holds it, or pulls: see the tests below
        free += 1
        angle = np.arctan2(heading[0] * travel[1] - heading[1] * travel[0], heading @ travel)
        goes = left + compliance @ turned(edges + (advance / asked) ** exponent * chips, angle)
        small = 1e-4 * WAY * max(advance, 1.0) + 1e-6 * np.linalg.norm(before)
        assert travel[0] * goes[1] - travel[1] * goes[0] == pytest.approx(0.0, abs=small)
        assert level * (travel @ goes[:2]) + climb * goes[2] == pytest.approx(advance * WAY, abs=small)
    assert free >= 10


def test_a_stiff_machine_goes_where_it_is_told():
    rng = np.random.default_rng(3)
    feed = direction(1.0)
    chips = np.array([-50.0, 80.0, -20.0, 0.0, 0.0, 0.0])
    left = np.array([*(WAY * feed), 0.0])
    advance, travel = ask(machine(rng, 1e-14), 0.2 * chips, chips, left, feed, direction(0.0), 0.7, 0.74)
    assert advance == pytest.approx(1.0, abs=1e-4)
    assert travel == pytest.approx(feed, abs=1e-4)


def test_what_pulls_is_taken_at_the_command():
    """Chips that pull along the feed are those of the feed; a force that turns it on and on leaves it in the feed."""
    compliance = np.hstack([np.eye(3) * 1e-6, np.zeros((3, 3))])
    feed, left = direction(0.0), np.array([WAY, 0.0, 0.0])
    pulls = np.array([30.0, 80.0, 0.0, 0.0, 0.0, 0.0])
    assert ask(compliance, np.zeros(6), pulls, left, feed, direction(0.2), 0.5, 0.74) == (1.0, pytest.approx(feed))
    pushes, rubs = np.array([-10.0, 80.0, 0.0, 0.0, 0.0, 0.0]), np.array([40.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    advance, travel = ask(compliance, rubs, pushes, left, feed, direction(0.2), 0.5, 0.74)
    assert travel == pytest.approx(feed)
    assert LEAST <= advance <= MOST


def test_a_plunge_advances_along_its_axis():
    """Straight down there is no direction to turn; the advance balances feed and retreat."""
    compliance = np.hstack([np.eye(3) * 1e-6, np.zeros((3, 3))])
    chips, edges = np.array([3.0, 1.0, 60.0, 0.0, 0.0, 0.0]), np.array([0.0, 0.0, 5.0, 0.0, 0.0, 0.0])
    left = np.array([0.0, 0.0, -WAY - 50e-6])
    advance, travel = ask(compliance, edges, chips, left, direction(0.7), direction(0.7), 1.0, 0.74, 0.0, -1.0)
    assert travel == pytest.approx(direction(0.7))
    assert left[2] + 5e-6 + 60e-6 * advance**0.74 == pytest.approx(-advance * WAY, abs=1e-4 * WAY)


def test_the_wrench_follows_the_travel():
    compliance = np.hstack([np.diag([2e-6, 3e-6, 1e-6]), np.zeros((3, 3))])
    feed, travel = direction(0.8), direction(0.0)
    edges = np.array([-5.0, 9.0, -1.0, 0.1, 0.2, 0.3, 0.3])
    result = np.array([-45.0, 70.0, -12.0, 0.5, -0.4, 1.3, 1.3])
    edges_before, wrench = edges.copy(), result.copy()
    left = np.array([*(WAY * feed), 0.0]) - compliance @ wrench[:6]
    chips = np.empty(6)
    step = Travel(compliance, left, direction(0.0), feed, travel, 1.0, 0.0, WAY, 0.74, moves=np.empty((6, 3)))
    advance, ratio = follow_travel(step, Wrenches(edges, chips), 1.0, result)
    angle = np.arctan2(travel[1], travel[0])

    assert 0.0 < angle < 0.8
    assert edges[:6] == pytest.approx(turned(edges_before[:6], angle))
    assert chips == pytest.approx(turned((wrench - edges_before)[:6], angle) * advance**0.74)
    assert result[:6] == pytest.approx(edges[:6] + chips)
    assert result[TORQUE] == pytest.approx(0.3 + advance**0.74)
    assert ratio == pytest.approx(np.linalg.norm(result[:3]) / np.linalg.norm(wrench[:3]))


def test_the_travel_stays_between_where_it_went_and_the_feed():
    """Where force would turn it back, or past the feed, it is at that end; so it never weaves about a straight line."""
    rng = np.random.default_rng(11)
    ends = 0
    for _ in range(300):
        begin, turn = direction(rng.uniform(-np.pi, np.pi)), rng.uniform(-3.1, 3.1)
        asked = rng.uniform(0.0, 1.0) * turn
        first = np.arctan2(begin[1], begin[0])
        chips = turned(np.array([-100.0, rng.uniform(-200, 200), 0.0, 0.0, 0.0, 0.0]), first + asked)
        compliance = machine(rng, 1e-6)
        feed = direction(first + turn)
        left = np.array([*(WAY * feed), 0.0]) - compliance @ chips * rng.uniform(0.5, 1.5)
        _, travel = ask(compliance, 0.2 * chips, chips, left, feed, direction(first + asked), 1.0, 0.74, begin=begin)
        done = np.arctan2(begin[0] * travel[1] - begin[1] * travel[0], begin @ travel)
        assert -1e-9 <= done * np.sign(turn) <= abs(turn) + 1e-9
        ends += abs(done) < 1e-9 or (travel == feed).all()
    assert 5 < ends < 295


def test_a_tool_on_an_arc_lags_by_its_bend_against_the_travel():
    """The bend turns with the travel: d delta = travel - feed, so that sin(lag) = b / R of an arc of radius R."""
    compliance = np.hstack([np.eye(3) * 2e-5, np.zeros((3, 3))])
    chips, edges, radius = np.array([-30.0, 40.0, 0.0, 0.0, 0.0, 0.0]), np.array([-5.0, 5.0, 0.0, 0.0, 0.0, 0.0]), 25e-3
    bend, travel, advance = compliance @ (chips + edges), direction(0.0), 1.0
    for step in range(6000):
        feed, begin = direction(step * WAY / radius), travel.copy()
        left = np.array([*(WAY * feed), 0.0]) - bend
        turn = np.arctan2(travel[1], travel[0])
        asked = turned(chips, turn) * advance**0.74
        advance, travel = ask(
            compliance, turned(edges, turn), asked, left, feed, travel, advance, 0.74, begin=begin
        )  # fmt: skip
        turn = np.arctan2(travel[1], travel[0])
        bend = compliance @ turned(edges + chips * advance**0.74, turn)
    lag = np.arctan2(travel[0] * feed[1] - travel[1] * feed[0], travel @ feed)
    assert np.sin(lag) == pytest.approx(-(bend[:2] @ travel) / radius, rel=2e-3)


@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill", "bull_nose_end_mill"])
def test_edge_wrench_is_the_force_without_a_chip(kind):
    """Summed row by row from the contact, it is what `cutting_force` gives for a chip of no thickness."""
    more = {"corner_radius": 2e-3} if kind.startswith("bull") else {}
    law = LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8)
    process = Milling(cutter=TOOLS[kind](diameter=10e-3, **more), law=law)
    teeth, room, heading = process.packed_tool.teeth, process._room, Heading(0.8, 0.6, 1.0, 0.0, 0.0)
    stock = Stock.box((0.0, 0.0, -20e-3), (60e-3, 40e-3, 0.0), 0.5e-3)
    tip, found, none, fixed = np.array([29.9e-3, 1e-3, -4e-3]), np.zeros(RESULT), np.zeros(RESULT), np.zeros(TORQUE + 1)

    def cut(chip, result):
        return cutting_force(stock.view((0.0, 0.0, 1.0)), teeth, tip, heading, chip, 0.0, room, result)

    cut(0.0, none)
    used = cut(50e-6, found)
    edge_wrench(teeth, heading, room, used, fixed)

    assert np.linalg.norm(found[:3]) > 1.2 * np.linalg.norm(none[:3]) > 0.0
    assert fixed == pytest.approx(none[: TORQUE + 1], rel=1e-9, abs=1e-12)
