"""The chip of a tool that gives way: how far it advances and where to, and what of its force no chip changes."""

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.advance_kernels import HELD, LEAST, MOST, edge_wrench, solve_advance, turn_travel
from gcodesim.processes.force_kernels import RESULT, TORQUE, cutting_force
from gcodesim.processes.laws import LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.tools import TOOLS


@pytest.mark.parametrize("exponent", [1.0, 0.74, 0.5])
@pytest.mark.parametrize("asked", [0.02, 1.0, 2.5])
@pytest.mark.parametrize(("rubbed", "pushed"), [(0.0, -300e-6), (-40e-6, -100e-6), (30e-6, -60e-6), (-80e-6, -1e-6)])
@pytest.mark.parametrize("bent", [0.0, -70e-6, -250e-6])
def test_advance_balances_feed_and_retreat(bent, rubbed, pushed, asked, exponent):
    """Where the balance lies within bounds it is met; else the bound on its side comes out."""
    feed = 13e-6
    a = solve_advance(rubbed, pushed, bent, feed, asked, exponent)
    excess = bent + (a - 1.0) * feed - rubbed - pushed * (a / asked) ** exponent

    assert LEAST <= a <= MOST
    if a > 1.001 * LEAST and a < 0.999 * MOST:
        assert excess == pytest.approx(0.0, abs=1e-4 * feed)
    else:
        assert (excess > 0.0) == (a < 1.0)


def test_chips_that_pull_are_taken_at_the_feed():
    assert solve_advance(-50e-6, 20e-6, -10e-6, 13e-6, 0.5, 0.74) == 1.0


@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill", "bull_nose_end_mill"])
def test_edge_wrench_is_the_force_without_a_chip(kind):
    """Summed row by row from the contact, it is what `cutting_force` gives for a chip of no thickness."""
    more = {"corner_radius": 2e-3} if kind.startswith("bull") else {}
    law = LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8)
    process = Milling(cutter=TOOLS[kind](diameter=10e-3, **more), law=law)
    tool, edge, laws, table, circle, _, rows, weights, force, sums, _ = process._packed
    stock = Stock.box((0.0, 0.0, -20e-3), (60e-3, 40e-3, 0.0), 0.5e-3)
    tip, found, none, fixed = np.array([29.9e-3, 1e-3, -4e-3]), np.zeros(RESULT), np.zeros(RESULT), np.zeros(TORQUE + 1)

    def ask(chip, result):
        return cutting_force(
            stock.lo, stock.hi, stock.count, stock.grid, tool, edge, laws, table, circle, tip, 0.8, 0.6, 1.0, 0.0,
            chip, 0.0, rows, weights, force, sums, result,
        )  # fmt: skip

    ask(0.0, none)
    used = ask(50e-6, found)
    edge_wrench(tool, laws, circle, 0.8, 0.6, rows, weights, used, fixed)

    assert np.linalg.norm(found[:3]) > 1.2 * np.linalg.norm(none[:3]) > 0.0
    assert fixed == pytest.approx(none[: TORQUE + 1], rel=1e-9, abs=1e-12)


WAY = 13e-6
SLOT = np.radians(106.7)  # from the travel to the force of a slot in steel


def direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("radius", [25e-3, -25e-3, 0.1])
def test_a_tool_on_an_arc_lags_by_its_bend_against_the_travel(radius):
    """The bend turns with the travel: d delta = travel - feed, so that sin(lag) = b / R of an arc of radius R."""
    size, travel = 2e-3, direction(0.0)
    for step in range(4000):
        feed = direction(step * WAY / radius)
        psi = np.arctan2(travel[1], travel[0])
        lag = np.arctan2(travel[0] * feed[1] - travel[1] * feed[0], travel @ feed)
        # of a force that keeps its size, the advance follows from the part of the balance along the bend
        advance = np.cos(lag - SLOT) / np.cos(SLOT)
        turn_travel(travel, feed, size * direction(psi + SLOT), advance, WAY)

    assert np.sin(lag) == pytest.approx(-size * np.cos(SLOT) / radius, rel=1e-6)


@pytest.mark.parametrize("advance", [LEAST, 1.0, MOST])
@pytest.mark.parametrize("angle", [0.1, 1.0, 2.0, 3.1, np.pi])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_tool_arrives_in_the_new_direction(side, angle, advance):
    """Over some lengths of its bend, whatever its advance; and never by a leap."""
    size, travel, feed = 1e-3, direction(0.0), direction(side * angle)
    steps = 0
    while steps < 40.0 * size / WAY:
        steps += 1
        before = travel.copy()
        psi = np.arctan2(travel[1], travel[0])
        cosine = turn_travel(travel, feed, size * direction(psi + side * SLOT), advance, WAY)
        assert np.hypot(*travel) == pytest.approx(1.0)
        assert np.arccos(np.clip(before @ travel, -1.0, 1.0)) <= (MOST + 1.0) * WAY / size + 1e-6
        if cosine == 1.0:
            break
    assert steps > 1
    assert (travel == feed).all() or cosine > 0.999


def test_a_tool_that_is_not_held_back_turns_at_once():
    for bend in ([0.0, 1e-3, 0.0], [0.5e-3, 0.0, 0.0], [-0.9 * HELD * WAY, 1e-3, 0.0]):
        travel = direction(0.0)
        assert turn_travel(travel, direction(1.5), np.array(bend), 1.0, WAY) == 1.0
        assert (travel == direction(1.5)).all()
