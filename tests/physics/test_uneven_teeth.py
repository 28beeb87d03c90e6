"""Run-out, uneven pitches, helices that differ and compression edges: against what teeth leave of a surface in turn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.constant_cut import ConstantCut, RunOut, end_mill_forces, tooth_chips
from gcodesim.processes.laws import Kienzle, LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS
from gcodesim.units import DEG

STEEL = Kienzle.from_table(2500.0, 0.26, 0.4, 0.15)
ALUMINIUM = LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8)
D, AP, AE, CHIP, OMEGA = 10e-3, 4e-3, 3e-3, 0.05e-3, 400.0

TEETH = {
    "runout": {"runout": 20e-6, "runout_angle": 0.4},
    "pitches": {"pitches": (80 * DEG, 100 * DEG, 80 * DEG, 100 * DEG)},
    "helices": {"helices": (30 * DEG, 35 * DEG, 30 * DEG, 35 * DEG)},
    "up_cut": {"up_cut": 2.5e-3},
    "all": {
        "runout": 10e-6,
        "pitches": (85 * DEG, 95 * DEG, 88 * DEG, 92 * DEG),
        "helices": (38 * DEG, 41 * DEG, 38 * DEG, 41 * DEG),
        "up_cut": 3e-3,
    },
}
LAWS = pytest.mark.parametrize("law", [STEEL, ALUMINIUM], ids=["kienzle", "linear"])
KINDS = pytest.mark.parametrize("teeth", list(TEETH))


def mill(teeth="", kind="flat_end_mill", **more):
    tool = TOOLS[kind](diameter=D, flutes=4, length=60e-3, flute_length=30e-3, **TEETH.get(teeth, {}), **more)
    assert not tool.problems()
    return tool


def run_out_of(tool):
    return RunOut(offset=tool.runout, angle=tool.runout_angle) if tool.runout else None


def steps_of_a_turn(tool, law, cut, slices=40, angles=720, turns=3):
    """Forces (angles, 3) in K in the last of some turns, and greatest chips of the teeth (flutes,).

    Each slice of each tooth stands where the turning tool has it, and takes what stands out of the surface that all
    before it have left: nothing of pitches or of what a tooth leaves for the next is put in.
    """
    dz = cut.ap / slices
    z = (np.arange(slices) + 0.5) * dz
    first, last = cut.limits(tool.diameter)
    starts = np.cumsum([0.0, *(tool.pitches or [2 * math.pi / 4] * 4)[:3]])
    helices = tool.helices or (tool.helix,) * 4
    height = z if tool.up_cut is None else np.where(z < tool.up_cut, z, 2 * tool.up_cut - z)
    late = np.array([2 * math.tan(h) / tool.diameter * height for h in helices])
    sense = np.ones(slices) if tool.up_cut is None else np.where(z < tool.up_cut, 1.0, -1.0)
    out = tool.runout or 0.0
    bins = np.arange(angles)
    step = 2 * math.pi / angles
    surface = np.full((angles, slices), -1.0)  # farthest radius beyond R, less the feed, that a tooth has had there
    force, most = np.zeros((angles, 3)), np.zeros(4)
    (kt, pt, et), (kn, pn, en), (ka, pa, ea) = law.packed
    at = starts[:, None] - late  # of four teeth in all slices: no two of them are at one place of the surface at a time
    grown, slice_ = out * np.cos(tool.runout_angle - at), np.arange(slices)
    for turn in range(turns):
        for i in bins:
            fed = 4 * CHIP * (turn + i / angles)
            k = np.round(((i * step + at) % (2 * math.pi)) / step).astype(int) % angles
            reach = grown + fed * np.sin(k * step)
            left = surface[k, slice_]
            chip = np.maximum(reach - left, 0.0)
            surface[k, slice_] = np.maximum(reach, left)
            if turn < turns - 1:
                continue
            cuts = (k * step >= first) & (k * step <= last) & (chip > 0.0)
            most = np.maximum(most, np.where(cuts, chip, 0.0).max(axis=1))
            ft = np.where(cuts, kt * chip**pt + et, 0.0)
            fn = np.where(cuts, kn * chip**pn + en, 0.0)
            fa = np.where(cuts, ka * chip**pa + ea, 0.0) * sense
            sine, cosine = np.sin(k * step), np.cos(k * step)
            force[i] = dz * np.array([(-ft * cosine - fn * sine).sum(), (ft * sine - fn * cosine).sum(), -fa.sum()])
    return force, most


@LAWS
@KINDS
def test_calculator_takes_what_is_left_of_the_surface(teeth, law) -> None:
    tool = mill(teeth)
    cut = ConstantCut(mode="up", ap=AP, ae=AE, feed_per_tooth=CHIP, spindle=OMEGA)
    found = end_mill_forces(tool, law, cut, run_out=run_out_of(tool))
    force, most = steps_of_a_turn(tool, law, cut)

    size = np.linalg.norm(found.force)
    assert found.force == pytest.approx(force.mean(axis=0), abs=0.006 * size)
    assert found.peak == pytest.approx(np.linalg.norm(force, axis=1).max(), rel=0.015)
    assert tooth_chips(tool, cut, run_out_of(tool)) == pytest.approx(most, rel=0.01, abs=0.4e-6)


@LAWS
@KINDS
@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill", "bull_nose_end_mill"])
def test_run_in_stock_is_the_calculator(kind, teeth, law) -> None:
    """Mean, peak and greatest chip of a tool that stands half in a wall; as even teeth are, to 0.2 %."""
    tool = mill(teeth, kind, **({"corner_radius": 1e-3} if kind == "bull_nose_end_mill" else {}))
    found = standing_in_a_wall(tool, law)
    cut = ConstantCut(mode="down", ap=AP, ae=0.5 * D, feed_per_tooth=CHIP, spindle=OMEGA)
    wanted = end_mill_forces(tool, law, cut, run_out=run_out_of(tool))
    chip = tooth_chips(tool, cut, run_out_of(tool)).max()

    assert found.wrench[0, :3] == pytest.approx(wanted.force, abs=2e-3 * np.linalg.norm(wanted.force))
    assert found["torque"][0] == pytest.approx(wanted.torque, rel=2e-3)
    assert found["peak_force"][0] == pytest.approx(wanted.peak, rel=2e-3)
    assert found["peak_torque"][0] == pytest.approx(wanted.peak_torque, rel=2e-3)
    assert found["chip_thickness"][0] == pytest.approx(chip, rel=0.012)


def standing_in_a_wall(tool, law):
    """The step of a tool that goes along a wall, half of it inside."""
    stock = Stock.box((0.0, -20e-3, -20e-3), (40e-3, 0.0, 0.0), D / 40)
    feed, dt = CHIP * 4 * OMEGA / (2 * math.pi), 0.001
    points = np.array([[10e-3, 0.0, -AP], [10e-3 + feed * dt, 0.0, -AP]])
    window = Window(
        piece_start=points[:1],
        piece_end=points[1:],
        piece_step=np.zeros(1, dtype=int),
        axis=np.array([[0.0, 0.0, 1.0]]),
        velocity=np.array([[feed, 0.0, 0.0]]),
        rapid=np.zeros(1, dtype=bool),
        signals={"spindle": np.full(1, OMEGA), "active": np.zeros(1, dtype=bool)},
        dt=dt,
    )
    process = Milling(cutter=tool, law=law)
    state = process.begin()
    state.values[2] = 2.0  # free: it stands in the cut that it has made
    return process.run(stock, window, state)


@LAWS
def test_teeth_that_are_said_to_be_even_have_the_bits_of_those_that_are(law) -> None:
    plain = standing_in_a_wall(mill(), law)
    told = standing_in_a_wall(mill(pitches=(0.5 * math.pi,) * 4, helices=(30 * DEG,) * 4, runout=0.0), law)

    assert (told.wrench == plain.wrench).all() and told["peak_force"] == plain["peak_force"]


def test_compression_edges_pull_below_and_push_above() -> None:
    """The axial force of both parts adds up: none where both are as high, and it turns over beyond."""
    cuts = {height: standing_in_a_wall(mill(up_cut=height), ALUMINIUM).wrench[0, 2] for height in (1e-3, 2e-3, 3e-3)}
    up, down = (standing_in_a_wall(mill(helix=helix), ALUMINIUM).wrench[0, 2] for helix in (30 * DEG, -30 * DEG))

    assert up < -10.0 and down == pytest.approx(-up, rel=1e-12)
    assert cuts[2e-3] == pytest.approx(0.0, abs=1e-9 * abs(up))
    assert (cuts[3e-3], cuts[1e-3]) == (pytest.approx(0.5 * up, rel=1e-4), pytest.approx(0.5 * down, rel=1e-4))


def test_a_tooth_that_stands_in_takes_nothing() -> None:
    """60 um of run-out at 50 um a tooth: the first stands 60 um before the one ahead, which leaves it 110 in the middle
    of a slot; the next takes 150 - 60 of what the first has left; the other two pass through air."""
    tool = mill(runout=60e-6, helix=0.0)
    cut = ConstantCut(mode="slot", ap=AP, ae=D, feed_per_tooth=CHIP, spindle=OMEGA)

    assert tooth_chips(tool, cut, run_out_of(tool)) == pytest.approx([110e-6, 90e-6, 0.0, 0.0], abs=1e-12)


def test_a_soft_tool_that_runs_out_bends_as_one_that_does_not() -> None:
    """8 um of run-out at chips that begin at nothing: one tooth takes all and the other does not even rub.

    Taken for rubbing, its edge left less than nothing for the chips, and the tip flew off, here by 5 mm.
    """
    bends = []
    for more in ({}, {"runout": 8e-6}):
        tool = TOOLS["lollipop_mill"](
            diameter=8e-3, neck_diameter=4e-3, flute_length=7.5e-3, length=60e-3, flutes=2, substrate="carbide", **more
        )
        stock = Stock.box((0.0, 0.0, -12e-3), (20e-3, 30e-3, 0.0), 0.25e-3)
        n, speed = 1000, 400e-3 / 60.0
        way = np.linspace([10e-3, -8e-3, -9e-3], [10e-3, 4e-3, -9e-3], n + 1)
        window = Window(
            piece_start=way[:-1],
            piece_end=way[1:],
            piece_step=np.arange(n),
            axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
            velocity=np.tile([0.0, speed, 0.0], (n, 1)),
            rapid=np.zeros(n, dtype=bool),
            signals={"spindle": np.full(n, 733.0), "active": np.zeros(n, dtype=bool)},
            dt=12e-3 / n / speed,
        )
        process = Milling(cutter=tool, law=ALUMINIUM)
        found = process.run(stock, window, process.begin())
        bends.append(float(found["tool_bend"].max()))

    assert 0.5e-3 < bends[0] < 2e-3
    assert bends[1] == pytest.approx(bends[0], rel=0.15)
