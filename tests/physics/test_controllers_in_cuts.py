"""Whole runs of arms whose motors and gears give way: what they cut, and what a controller makes of the force."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

from gcodesim.units import MM
from tests.physics.runs import run_texts

ROOT = Path(__file__).parents[2]

ARM = """
gcodesim: 1
frames: {table: {in: world, xyz: [560, -40, 350]}}
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]MORE}
work_offsets: {G54: {in: table, xyz: [0, 0, 20]}}
orientation: {tool_axis: -Z of G54, spin: free}
stock: {box: [60, 60, 20], in: table, zero: bottom-front-left, material: MATERIAL, resolution: 0.5}
tools:
  1: {type: flat_end_mill, diameter: DIAMETER, flutes: 2, length: 60}
"""
SLOT = (
    "G21 G90 G17 G94 G64 P0.05\nT1 M6\nG43 H1\nS8000 M3\nG0 X-10 Y30\nG0 Z-{depth}\nG1 X30 F{feed}\nG0 Z20\nM5\nM30\n"
)


def arm(controller: str, material: str = "al6082_t6", diameter: float = 8.0) -> str:
    more = f", controller: {{type: {controller}}}" if controller else ""
    return ARM.replace("MORE", more).replace("MATERIAL", material).replace("DIAMETER", str(diameter))


def test_a_settled_cut_bends_moving_gears_as_it_bends_those_without_mass(tmp_path: Path) -> None:
    """Force and bend of the second half of a slot, where nothing changes any more: J K^-1 J' F to 1 %."""
    found = {}
    for controller in ("ideal", "flexible", ""):
        ran = run_texts(SLOT.format(depth=2, feed=900), arm(controller), tmp_path / f"out{controller}", world="bullet")
        accuracy = ran.results.path_accuracy
        assert accuracy is not None
        found[controller] = (ran.stock.removed, accuracy["rms_mm"])
    assert found["flexible"] == pytest.approx(found["ideal"], rel=0.01)
    assert found[""] == pytest.approx(found["ideal"], rel=0.01)


def test_a_cut_that_is_too_heavy_does_not_fling_the_arm_about() -> None:
    """A slot of 12 mm, 8 mm deep, in al7075 at 2 m/min: the wrist has not the torque for it.

    Chips are those of the way that the tip really takes. With chips of the command, a force that nothing made
    pulled the arm away, by 40 mm.
    """
    ran = run_texts(SLOT.format(depth=8, feed=2000), arm("ideal", "al7075_t6_a", 12.0), world="bullet")
    accuracy = ran.results.path_accuracy

    assert "GS230" in {finding.code for finding in ran.results.findings}
    assert accuracy is not None and accuracy["AT_mm"] < 3.0
    assert ran.results.tools[0]["max_force_N"] < 900.0


HELD: dict[str, str] = {"20 ms": "log: {period: 20 ms}\n", "1 s": "log: {period: 1 s}\n"}


def test_motors_at_their_limit_and_gears_that_move_do_not_ask_how_a_run_is_divided(tmp_path: Path) -> None:
    """The same slot with gears as `bullet` has them. Joint 3 cannot hold the arm, which sinks into the material.

    The period of the log divides the run into windows of other lengths. Where a motor came to its limit, the whole
    window was done again in another way; and forces had a share of those of the last cut that was tried.
    """
    told = {}
    for period, log in HELD.items():
        cell = arm("", "al7075_t6_a", 12.0) + log
        results = run_texts(SLOT.format(depth=8, feed=2000), cell, tmp_path / period[:2], world="bullet").results
        assert {"GS230", "GS518"} <= {finding.code for finding in results.findings}
        removed = {name: stock.removed for name, stock in results.stocks.items()}
        told[period] = (results.path_accuracy, results.tools, results.joints, removed)
    first, second = told.values()
    assert first == second


def test_an_arm_that_its_motors_cannot_hold_stays_behind_its_command_and_no_more() -> None:
    """Of 40 mm it lacks at most those. With rotors that weigh nothing it was thrown about, by 150 mm."""
    ran = run_texts(SLOT.format(depth=8, feed=2000), arm("", "al7075_t6_a", 12.0), world="bullet")
    accuracy = ran.results.path_accuracy
    assert accuracy is not None and accuracy["AT_mm"] < 40.0
    assert ran.results.tools[0]["max_force_N"] < 1500.0


def test_moving_gears_bear_a_bore_that_gears_without_mass_bear(tmp_path: Path) -> None:
    """A helix into full material at 250 Hz. With speeds and climbs of the command it threw the arm about, by 39 mm."""
    program = (
        "G21 G90 G17 G94 G64 P0.02\nT1 M6\nG43 H1\nS9500 M3\nG0 X20 Y30\nG0 Z1\nG1 Z-1 F500\n"
        "G3 X20 Y30 Z-9 I-4 J0 P3 F900\nG0 Z20\nM5\nM30\n"
    )
    force, error = {}, {}
    for controller in ("ideal", "flexible"):
        ran = run_texts(program, arm(controller), tmp_path / f"out{controller}")
        accuracy = ran.results.path_accuracy
        assert accuracy is not None
        force[controller], error[controller] = ran.results.tools[0]["max_force_N"], accuracy["AT_mm"]
    assert force["flexible"] < 1.2 * force["ideal"]
    assert error["flexible"] < 1.2 * error["ideal"]


def test_a_deep_bore_weighs_on_moving_gears_no_more_than_on_those_without_mass(tmp_path: Path) -> None:
    """Mean force in the lower half of a helix, whose wall stands around the whole flute: turns cut what they cut.

    Material is looked for a cell ahead. Along the tangent that is within the wall of the bore, the more of it the
    deeper: with that, the force of gears that move grew by half until the bore was 18 mm deep.
    """
    program = (
        "G21 G90 G17 G94 G64 P0.02\nT1 M6\nG43 H1\nS9500 M3\nG0 X20 Y30\nG0 Z1\nG1 Z-1 F500\n"
        "G3 X20 Y30 Z-18 I-4 J0 P7 F900\nG0 Z20\nM5\nM30\n"
    )
    force = {}
    for controller in ("ideal", "flexible, gear_damping: 8 ms"):
        ran = run_texts(program, arm(controller), tmp_path / f"out{len(controller)}")
        wrench = np.linalg.norm(ran.column("/wrench", "force.x", "force.y"), axis=1)
        deep = ran.column("/motion", "z_m")[:, 0] < -9.0 * MM
        force[controller] = wrench[deep & (wrench > 0.0)].mean()
    plain, moving = force.values()
    assert moving == pytest.approx(plain, rel=0.1)


def test_a_controller_that_measures_the_milling_force_halves_the_error_of_the_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "programs"))
    script = importlib.import_module("force_control")
    plain, stiffened = (script.cut(own) for own in script.CONTROLLERS)

    assert plain["rms_mm"] > 0.05
    assert stiffened["rms_mm"] < 0.5 * plain["rms_mm"]
    assert stiffened["AT_engaged_mm"] < 0.8 * plain["AT_engaged_mm"]
