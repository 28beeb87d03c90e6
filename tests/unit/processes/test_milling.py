"""Milling over windows: when it acts, when it does not, and what it reports."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gcodesim.material.lattice import ensure_lattice
from gcodesim.material.stock import Stock
from gcodesim.processes.laws import Kienzle, LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS
from gcodesim.tools.sections import Holder

STEEL = Kienzle.from_table(2500.0, 0.26)
ALUMINIUM = LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8)
OMEGA = 400.0


def box(resolution=0.5e-3):
    return Stock.box((0.0, 0.0, -20e-3), (60e-3, 40e-3, 0.0), resolution)


def tool(**more):
    return TOOLS["flat_end_mill"](number=1, diameter=10e-3, **more)


def window(points, **more):
    """One piece a step along `points` (n + 1, 3) [m], 10 ms each."""
    points = np.asarray(points, dtype=float)
    n = len(points) - 1
    columns = {
        "piece_start": points[:-1],
        "piece_end": points[1:],
        "piece_step": np.arange(n),
        "axis": np.tile([0.0, 0.0, 1.0], (n, 1)),
        "velocity": np.diff(points, axis=0) / 0.01,
        "rapid": np.zeros(n, dtype=bool),
        "signals": {"spindle": np.full(n, OMEGA), "active": np.zeros(n, dtype=bool)},
        "dt": 0.01,
    }
    return Window(**(columns | more))


def line(a, b, steps):
    return np.asarray(a) + np.linspace(0.0, 1.0, steps + 1)[:, None] * (np.asarray(b) - np.asarray(a))


SLOT = line((-8e-3, 20e-3, -3e-3), (20e-3, 20e-3, -3e-3), 140)


def run(points=SLOT, *, stock=None, process=None, state=None, **more):
    process = process or Milling(cutter=tool(), law=STEEL)
    stock = stock if stock is not None else box()
    return process.run(stock, window(points, **more), state or process.begin()), stock


def test_without_stock_nothing_happens():
    process = Milling(cutter=tool(), law=STEEL)
    found = process.run(None, window(SLOT), process.begin())

    assert not found.wrench.any()
    assert not found["removed"].any()


def test_in_air_everything_is_exactly_zero():
    found, stock = run(SLOT + np.array([0.0, 0.0, 10e-3]))

    assert not found.wrench.any()
    assert not found["engaged"].any()
    assert not found.deflection.any()
    assert stock.volume == pytest.approx(60e-3 * 40e-3 * 20e-3, rel=1e-12)


def test_sliding_on_the_surface_is_no_cut():
    found, _ = run(SLOT + np.array([0.0, 0.0, 3e-3]))

    assert not found["engaged"].any()
    assert not found.wrench.any()


def test_following_the_own_slot_is_no_cut():
    """A spring pass, off the grid, with a law that has edge forces: exactly zero."""
    for y in (20.0e-3, 20.13e-3, 19.61e-3):
        path = line((-8e-3, y, -3e-3), (20e-3, y, -3e-3), 140)
        process = Milling(cutter=tool(), law=ALUMINIUM)
        stock = box()
        first, _ = run(path, stock=stock, process=process)
        again, _ = run(path, stock=stock, process=process)

        assert first.wrench.any()
        assert not again["removed"].any()
        inside = path[:-1, 0] < 12e-3  # further on it comes near the end of the slot
        assert not again.wrench[inside].any()


@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill"])
@pytest.mark.parametrize("drop", [0.0, 2e-3])
def test_running_into_the_end_of_an_own_slot_is_no_cut(kind, drop):
    """The wall at its end stands where the first pass left it: looking ahead must not make a force of it."""
    process = Milling(cutter=TOOLS[kind](diameter=10e-3), law=ALUMINIUM)
    path = line((-8e-3, 20.1e-3, -3e-3), (20e-3, 20.1e-3, -3e-3 - drop), 140)
    stock = box()
    first, _ = run(path, stock=stock, process=process)
    again, _ = run(path, stock=stock, process=process)

    assert first.wrench[-1].any()
    assert not again.wrench.any()


@pytest.mark.parametrize("angle", [0.0, 2.0])
def test_forces_in_axes_of_the_tool_go_with_the_feed(angle):
    """A full slot: the work holds the tool back; turned with the path, the parts stay the same."""
    heading = np.array([np.cos(angle), np.sin(angle), 0.0])
    middle = np.array([30e-3, 20e-3, -3e-3])
    found, _ = run(line(middle - 45e-3 * heading, middle, 300))
    wrench, late = found.wrench, slice(-20, None)

    assert found["feed_force"] == pytest.approx(wrench[:, :3] @ heading)
    assert found["side_force"] == pytest.approx(wrench[:, :3] @ np.cross((0.0, 0.0, 1.0), heading))
    assert np.array_equal(found["axial_force"], wrench[:, 2])
    assert (found["feed_force"][late] < 0.0).all()


def test_force_stands_when_the_tool_stands():
    """A dwell in the cut: no chip, the edge still rubs; a law without edge forces gives zero."""
    still = np.repeat(SLOT[-1:], 11, axis=0)
    for law, rubs in ((STEEL, False), (ALUMINIUM, True)):
        process = Milling(cutter=tool(), law=law)
        stock, state = box(), process.begin()
        process.run(stock, window(SLOT), state)
        found = process.run(stock, window(still), state)

        assert found.wrench.any() == rubs
        assert not found["chip_thickness"].any()
        assert np.isfinite(found.wrench).all()
        assert found["removed"].sum() == 0.0


def test_steps_without_pieces_stand_still():
    process = Milling(cutter=tool(), law=ALUMINIUM)
    stock, state = box(), process.begin()
    process.run(stock, window(SLOT), state)
    empty = np.zeros((0, 3))
    found = process.run(
        stock,
        replace(
            window(SLOT[:6]), piece_start=empty, piece_end=empty, piece_step=np.zeros(0, int), velocity=np.zeros((5, 3))
        ),
        state,
    )

    assert found["engaged"].all()
    assert not found["removed"].any()


@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill", "bull_nose_end_mill"])
@pytest.mark.parametrize("resolution", [0.3e-3, 0.5e-3, 1e-3])
def test_a_slot_feels_one_force_wherever_it_lies_on_the_grid(kind, resolution):
    """From step to step and in every direction, seen along its own feed: only rounding changes it."""
    more = {"corner_radius": 2e-3} if kind.startswith("bull") else {}
    process = Milling(cutter=TOOLS[kind](diameter=10e-3, **more), law=ALUMINIUM)
    seen = []
    for angle in (0.0, 17.0, 45.0, 90.0, 143.0):
        u = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle)), 0.0])
        middle = np.array([30e-3, 20e-3, -2e-3])
        path = line(middle - 60e-3 * u, middle + 5e-3 * u, 325)
        found, _ = run(path, stock=box(resolution), process=process)
        fx, fy, fz = found.wrench[-25:, :3].T
        seen.append(np.column_stack([fx * u[0] + fy * u[1], fy * u[0] - fx * u[1], fz]))
    forces = np.concatenate(seen)

    assert np.linalg.norm(forces[0]) > 50.0
    assert np.ptp(forces, axis=0).max() < 1e-9 * np.linalg.norm(forces[0])


@pytest.mark.parametrize(("spindle", "cut"), [(0.0, "stopped_cut"), (-OMEGA, "reversed_cut")])
def test_wrong_spindle_removes_without_force_and_is_told(spindle, cut):
    found, _ = run(signals={"spindle": np.full(140, spindle), "active": np.zeros(140, dtype=bool)})
    good, _ = run()

    assert not found.wrench.any()
    assert not found["power"].any()
    assert found["removed"].sum() == pytest.approx(good["removed"].sum())
    assert np.array_equal(found[cut], found["removed"])
    assert not good["stopped_cut"].any() and not good["reversed_cut"].any()


def test_rapid_removes_without_force():
    found, _ = run(rapid=np.ones(140, dtype=bool))
    good, _ = run()

    assert found["removed"].sum() == pytest.approx(good["removed"].sum())
    assert not found.wrench.any()
    assert not found["stopped_cut"].any()
    assert np.array_equal(found["rapid_cut"], found["removed"])
    assert not good["rapid_cut"].any() and not good["rapid_bound"].any()


def test_tool_put_into_stock_cuts_nothing_until_it_has_left():
    inside = line((20e-3, 20e-3, -3e-3), (30e-3, 20e-3, -3e-3), 20)
    out = line((30e-3, 20e-3, -3e-3), (30e-3, 20e-3, 5e-3), 20)
    back = line((30e-3, 20e-3, 5e-3), (30e-3, 20e-3, -1e-3), 20)
    found, _ = run(np.vstack([inside, out[1:], back[1:]]))

    assert found["inside"][:20].all()
    assert not found["removed"][:40].any()
    assert not found.wrench[:40].any()
    assert not found["inside"][41:].any()
    assert found["removed"][40:].sum() == pytest.approx(math.pi * 25e-6 * 1e-3, rel=0.02)


def test_starting_on_the_surface_is_not_inside():
    found, _ = run(line((30e-3, 20e-3, 0.0), (30e-3, 20e-3, -1e-3), 10))

    assert not found["inside"].any()
    assert found["removed"].sum() > 0.0


def test_shank_and_holder_tell_how_deep():
    slim = tool(length=30e-3, flute_length=5e-3, holder=Holder(diameter=40e-3, length=20e-3))
    deep = line((-30e-3, 20e-3, -8e-3), (10e-3, 20e-3, -8e-3), 100)
    found, _ = run(deep, process=Milling(cutter=slim, law=STEEL))

    assert found["shank_depth"].max() == pytest.approx(3e-3, abs=1e-6)
    assert not found["holder_depth"].any()

    short = tool(length=12e-3, holder=Holder(diameter=40e-3, length=20e-3))
    plunge = line((30e-3, 20e-3, 5e-3), (30e-3, 20e-3, -15e-3), 100)
    found, _ = run(plunge, process=Milling(cutter=short, law=STEEL))

    assert found["holder_depth"].max() == pytest.approx(3e-3, abs=1e-6)
    assert not found["shank_depth"].any()


def test_a_shank_as_wide_as_the_flutes_does_not_rub_in_its_own_slot():
    slim = tool(length=30e-3, flute_length=4e-3)
    paths = [line((-8e-3, 20e-3, -z), (30e-3, 20e-3, -z), 90) for z in (3e-3, 6e-3, 9e-3)]
    stock, process = box(), Milling(cutter=slim, law=STEEL)
    depths = [run(path, stock=stock, process=process)[0]["shank_depth"].max() for path in paths]

    assert depths == [0.0, 0.0, 0.0]


def test_a_leaning_tool_without_a_law_removes_without_force():
    axis = np.tile([math.sin(0.1), 0.0, math.cos(0.1)], (140, 1))
    found, stock = run(axis=axis, process=Milling(cutter=tool()))

    assert found["removed"].sum() == pytest.approx(60e-3 * 40e-3 * 20e-3 - stock.volume, rel=1e-9)
    assert found["engaged"].any() and not found.wrench.any() and not found.deflection.any()


def test_upright_cuts_and_a_leaning_one_between_them_are_felt():
    """The tool leans in the middle third of a slot; all that is removed is what the stock loses."""
    lean = np.concatenate([np.zeros(50), np.full(40, 0.1), np.zeros(50)])
    axis = np.stack([np.zeros(140), np.sin(lean), np.cos(lean)], axis=1)
    found, stock = run(axis=axis, axis_before=np.concatenate([axis[:1], axis[:-1]]))
    felt = np.linalg.norm(found.wrench[:, :3], axis=1) > 0.0

    assert felt[40:].all()
    assert found["removed"].sum() == pytest.approx(60e-3 * 40e-3 * 20e-3 - stock.volume, rel=1e-9)
    plain, _ = run()
    assert np.array_equal(found["removed"][:50], plain["removed"][:50])


@pytest.mark.parametrize("gap", [1e-3, 30e-3])
def test_a_tool_that_leans_beside_its_stock_needs_no_columns_across(gap):
    """An arm turns its wrist in a rapid: all is as in a stock that has columns in three directions already."""
    axis = np.tile([0.0, math.sin(0.3), math.cos(0.3)], (40, 1))
    beside = line((50e-3, 45e-3 + gap, -5e-3), (10e-3, 45e-3 + gap, -5e-3), 40)
    seen = {}
    for is_plain in (True, False):
        stock, process = box(), Milling(cutter=tool(), law=STEEL)
        state = process.begin()
        run(stock=stock, process=process, state=state)
        if not is_plain:
            ensure_lattice(stock)
        found, _ = run(beside, stock=stock, process=process, state=state, axis=axis, rapid=np.ones(40, dtype=bool))
        assert not any(np.any(column) for column in found.columns.values())
        assert not found.wrench.any() and not found.deflection.any()
        assert (stock.columns_along == 1) == is_plain
        seen[is_plain] = state.values
    if gap > 10e-3:  # nearer the laws look at what is ahead, though nothing comes of it
        np.testing.assert_allclose(seen[True], seen[False], rtol=0.0, atol=1e-15)


def test_a_leaning_tool_that_stands_in_material_cuts_nothing_until_it_has_left():
    axis = np.tile([0.0, math.sin(0.1), math.cos(0.1)], (60, 1))
    points = np.concatenate([line((20e-3, 20e-3, -3e-3), (20e-3, 20e-3, 10e-3), 30), SLOT[70:100]])
    found, _ = run(points, axis=axis[: len(points) - 1])

    assert found["inside"][0] and not found["removed"][:7].any()
    assert not found["inside"][-1]


def test_a_shank_that_runs_into_stock_while_its_tool_leans_is_told():
    axis = np.tile([math.sin(0.2), 0.0, math.cos(0.2)], (90, 1))
    slim = tool(length=30e-3, flute_length=4e-3)
    deep, _ = run(line((-18e-3, 20e-3, -9e-3), (12e-3, 20e-3, -9e-3), 90), axis=axis, process=Milling(cutter=slim))
    shallow, _ = run(line((-18e-3, 20e-3, -2e-3), (12e-3, 20e-3, -2e-3), 90), axis=axis, process=Milling(cutter=slim))

    assert deep["shank_depth"].max() > 1e-3
    assert shallow["shank_depth"].max() == 0.0


def test_windows_may_be_cut_anywhere():
    """One window, or the same steps one at a time: the same results to the last bit."""
    whole, _ = run(compliance=np.tile(np.eye(6) * 1e-6, (140, 1, 1)))
    process = Milling(cutter=tool(), law=STEEL)
    stock, state = box(), process.begin()
    full = window(SLOT, compliance=np.tile(np.eye(6) * 1e-6, (140, 1, 1)))
    rows = []
    for k in range(140):
        step = slice(k, k + 1)
        part = replace(
            full,
            piece_start=full.piece_start[step],
            piece_end=full.piece_end[step],
            piece_step=np.zeros(1, dtype=int),
            axis=full.axis[step],
            velocity=full.velocity[step],
            rapid=full.rapid[step],
            signals={name: values[step] for name, values in full.signals.items()},
            compliance=full.compliance[step],
        )
        rows.append(process.run(stock, part, state))

    assert np.array_equal(np.concatenate([row.wrench for row in rows]), whole.wrench)
    assert np.array_equal(np.concatenate([row["removed"] for row in rows]), whole["removed"])
    assert np.array_equal(np.concatenate([row.deflection for row in rows]), whole.deflection)


def test_columns_that_need_room_grow_in_the_middle_of_a_window():
    """A short cutter deep in the stock splits columns; growing must not repeat or lose a step."""
    short = tool(length=60e-3, flute_length=2e-3)
    process = Milling(cutter=short, law=STEEL)
    stock = box()
    path = line((-8e-3, 20e-3, -8e-3), (20e-3, 20e-3, -8e-3), 140)
    before = stock.volume
    assert len(stock.intervals_at(10e-3, 20e-3)) == 1

    found, _ = run(path, stock=stock, process=process)

    assert len(stock.intervals_at(10e-3, 20e-3)) == 2
    assert found["removed"].sum() == pytest.approx(before - stock.volume, rel=1e-9)
    assert found["removed"].sum() == pytest.approx(2e-3 * (20e-3 * 10e-3 + math.pi / 8 * 1e-4), rel=0.02)


def test_no_law_removes_all_the_same():
    with_law, _ = run()
    without, _ = run(process=Milling(cutter=tool()))

    assert without["removed"].sum() == pytest.approx(with_law["removed"].sum())
    assert not without.wrench.any()
    assert without["engaged"].any()


def test_a_left_hand_helix_changes_the_peak_only():
    right, _ = run(process=Milling(cutter=tool(helix=0.5), law=STEEL))
    left, _ = run(process=Milling(cutter=tool(helix=-0.5), law=STEEL))

    assert left.wrench == pytest.approx(right.wrench)


@pytest.mark.parametrize(("flutes", "depth", "steps"), [(6, 1e-3, 400), (4, 8e-3, 140)])
def test_no_peak_is_below_its_mean(flutes, depth, steps):
    """A slot as wide as the cutter: a steep helix makes the force nearly even, and it grows while the cutter enters."""
    slot = line((-8e-3, 20e-3, -depth), (20e-3, 20e-3, -depth), steps)
    found, _ = run(slot, process=Milling(cutter=tool(flutes=flutes, helix=0.8), law=STEEL))
    force = np.sqrt(np.square(found.wrench[:, :3]).sum(axis=1))

    assert force.max() > 100.0
    assert (found["peak_force"] >= force * (1.0 - 1e-12)).all()
    assert (found["peak_torque"] >= found["torque"]).all()


def test_half_out_of_the_stock_finite():
    """Along the edge and over the corner: no NaN, force falls to zero."""
    path = np.vstack([line((50e-3, -1e-3, -3e-3), (70e-3, -1e-3, -3e-3), 100)])
    approach = line((50e-3, -10e-3, -3e-3), (50e-3, -1e-3, -3e-3), 40)
    found, _ = run(np.vstack([approach, path[1:]]), process=Milling(cutter=tool(), law=ALUMINIUM))

    assert np.isfinite(found.wrench).all()
    assert found.wrench[60].any()
    assert not found.wrench[-1].any()
