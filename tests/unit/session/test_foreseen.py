"""Steps that wait are known before they are run where nothing is felt: to the bit what the run then does."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gcodesim
from gcodesim.session import MisuseError, OpenCell
from gcodesim.session.foreseen import ForeseenSteps
from gcodesim.world.led import LedWorld

CELL = """\
gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]GEARS}
frames: {table: {in: world, xyz: [600, 0, 300]}}
stock: {plate: {box: [20, 16, 10], in: table, resolution: 0.5, zero: top-front-left}}
parts: {cube: {box: [20, 20, 20], in: table, xyz: [0, 60, 0], mass: 2 kg}}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54}
tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 3}
  2: {type: extruder, bead_width: 6, bead_height: 3}
  3: {type: finger_gripper, stroke: 60, force: 60 N, friction: 0.5, length: 120}
  4: {type: extruder, bead_width: 6, bead_height: 3, load: {force: [0, 0, -20 N]}}
magazine: {change_time: 0.5 s}
simulation: {world: WORLD}
"""
DOWN = [1.0, 0.0, 0.0, 0.0]
MACHINES = [
    pytest.param("kinematic", ", stiffness: rigid", id="kinematic"),
    pytest.param("bullet", ", stiffness: rigid", id="bullet"),
    pytest.param("kinematic", ", controller: {type: pd, bandwidth: 10 Hz}", id="kinematic, a servo"),
    pytest.param("bullet", "", id="bullet, gears"),
]
SEEN = ("position", "velocity", "effort", "reaction")


def _nothing(cell: OpenCell) -> None:
    """The flange is bare."""


def _holding(number: int) -> Callable[[OpenCell], None]:
    def hold(cell: OpenCell) -> None:
        cell.tool(number).couple(cell.robot())

    return hold


def _pulled(cell: OpenCell) -> None:
    cell.tool(2).couple(cell.robot())
    cell.tool(2).apply_tcp_force([5.0, 0.0, -30.0])


def _at_the_stock(cell: OpenCell) -> None:
    cell.tool(1).couple(cell.robot())
    cell.robot().move_to([0.61, -0.008, 0.3005], DOWN)


def _with_a_cube(cell: OpenCell) -> None:
    arm, gripper = cell.robot(), cell.tool(3)
    gripper.couple(arm)
    arm.move_to([0.61, 0.07, 0.31], DOWN)
    gripper.close()
    cell.step(0.3)


def _closed_loop(
    cell_text: str, tmp_path: Path, setting_out: Callable[[OpenCell], None]
) -> tuple[list[Any], Any, int, int]:
    """What is seen in a loop over drawn targets, the results, and how many steps had been run and had passed."""
    (tmp_path / "cell.yaml").write_text(cell_text)
    rng = np.random.default_rng(5)
    seen: list[Any] = []
    with gcodesim.open_cell(tmp_path / "cell.yaml", out=tmp_path / "out", force=True) as cell:
        arm = cell.robot()
        setting_out(cell)
        home = arm.joint_state.position
        for seconds in rng.choice([0.004, 0.008, 0.02], 40):
            arm.set_joint_position(home + rng.uniform(-0.02, 0.02, len(home)))
            cell.step(float(seconds))
            state = arm.joint_state
            seen.append([*(getattr(state, name) for name in SEEN), *arm.endeffector_pose, np.array(cell.time)])
        run, passed = cell._done_steps, cell._done_steps + cell._waiting_steps
    return seen, cell.results, run, passed


@pytest.mark.parametrize(("world", "gears"), MACHINES)
@pytest.mark.parametrize(
    ("setting_out", "foresees"),
    [
        pytest.param(_nothing, True, id="no tool"),
        pytest.param(_holding(2), True, id="extruder"),
        pytest.param(_holding(1), True, id="mill far from all stock"),
        pytest.param(_at_the_stock, False, id="mill at the stock"),
        pytest.param(_holding(3), True, id="gripper with nothing"),
        pytest.param(_with_a_cube, False, id="gripper with a part"),
        pytest.param(_holding(4), False, id="load of the tool"),
        pytest.param(_pulled, False, id="pulled at"),
    ],
)
def test_what_is_foreseen_is_what_the_run_does(
    setting_out: Callable[[OpenCell], None],
    foresees: bool,
    world: str,
    gears: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cell = CELL.replace("GEARS", gears).replace("WORLD", world)
    seen, results, run, passed = _closed_loop(cell, tmp_path, setting_out)
    monkeypatch.setattr(ForeseenSteps, "last", lambda *given, **besides: None)
    told, same, all_run, all_passed = _closed_loop(cell, tmp_path, setting_out)

    assert all_run == all_passed == passed
    assert (run < passed - 50) == foresees  # those of a tool change are run before
    for now, then in zip(seen, told, strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(now, then, strict=True))
    assert results.joints == same.joints
    assert [(found.code, found.span) for found in results.findings] == [(f.code, f.span) for f in same.findings]


def test_a_state_goes_on_from_steps_that_were_run(tmp_path: Path) -> None:
    (tmp_path / "cell.yaml").write_text(CELL.replace("GEARS", "").replace("WORLD", "kinematic"))
    states = []
    for runs in (False, True):
        with gcodesim.open_cell(tmp_path / "cell.yaml") as cell:
            arm = cell.robot()
            arm.set_joint_position({arm.joint_names[0]: 0.4})
            cell.step(0.1)
            if runs:
                assert not cell.findings  # runs all that waits
            cell.step(0.05)
            states.append(arm.joint_state)
    for name in SEEN:
        assert np.array_equal(getattr(states[0], name), getattr(states[1], name)), name
    assert np.abs(states[0].velocity).max() > 0.1


def test_a_fault_of_the_run_is_raised_once_and_nobody_waits_for_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Leaving the `with` statement waited for ever for a run that had ended."""
    (tmp_path / "cell.yaml").write_text(CELL.replace("GEARS", "").replace("WORLD", "kinematic"))

    def fails(*given: object) -> None:
        raise ZeroDivisionError("a fault of ours")

    monkeypatch.setattr(LedWorld, "run", fails)
    with pytest.raises(ZeroDivisionError), gcodesim.open_cell(tmp_path / "cell.yaml") as cell:
        cell.step(0.1)
        cell.robot().joint_state  # noqa: B018
    with pytest.raises(MisuseError, match="closed"):
        cell.step(0.1)
