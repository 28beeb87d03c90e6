"""Parts held by contacts alone: slip begins and goes on as Coulomb's law says, alone and in a run."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import gcodesim
from gcodesim.solids.mass import mass_of_skin
from gcodesim.solids.mesh_file import Triangles
from gcodesim.tools.gripper import PadFaces
from gcodesim.world.contact_hold import ContactHold, Press

MASS, FORCE, FRICTION, DT = 2.0, 40.0, 0.5, 4e-3
PADS = PadFaces(left=-0.02, right=0.02, width=0.02, length=0.04, thickness=0.01)


def _slide(share: float, steps: int) -> np.ndarray:
    """Way (n,) [m] of a block between two pads that is pulled along Z by `share` of what friction holds."""
    block = trimesh.creation.box(extents=(0.04, 0.06, 0.05))
    skin = Triangles(points=np.array(block.vertices), faces=np.array(block.faces, dtype=np.int32))
    X_TP = np.eye(4)
    X_TP[2, 3] = -0.02
    hold = ContactHold(skin, mass_of_skin(skin.points, skin.faces, MASS), X_TP, Press(PADS, FORCE, FRICTION), DT)
    loads = np.tile([0.0, 0.0, share * 2.0 * FRICTION * FORCE], (steps, 1))
    rows, lost = hold.run(0, loads)
    assert lost is None
    again, _ = hold.run(steps // 2, loads[steps // 2 :])  # asked for once more, in parts
    np.testing.assert_array_equal(again, rows[steps // 2 :])
    way: np.ndarray = rows[:, 2, 3] - X_TP[2, 3]
    return way


@pytest.mark.parametrize("share", [0.5, 0.9, 0.97])
def test_below_the_limit_of_friction_it_holds(share: float) -> None:
    assert np.abs(_slide(share, 60)).max() < 2e-5


@pytest.mark.parametrize("share", [1.03, 1.1, 1.5])
def test_above_it_slides_with_what_is_left(share: float) -> None:
    """s = (F - 2 mu N) t²/2m."""
    steps = 60 if share < 1.05 else 25
    way = _slide(share, steps)
    t = DT * steps
    assert way[-1] == pytest.approx(0.5 * (share - 1.0) * 2.0 * FRICTION * FORCE / MASS * t * t, rel=0.05)


CELL = """gcodesim: 1
frames: {table: {in: world, xyz: [550, 0, 200]}}
robots: {arm: {model: kuka_kr10_r1100_2, stiffness: rigid}}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54, spin: 0}
m_codes: {M62 P1: {gripper: close}, M63 P1: {gripper: open}}
loaded_tool: 1
tools:
  1: {type: finger_gripper, length: 120, stroke: 60, force: FORCE N, friction: 0.5, finger_length: 40, hold: contacts}
parts: {block: {box: [40, 40, 60], zero: bottom-center, mass: 2 kg, in: table}}
simulation: {world: bullet}
"""
LIFT = "G21 G90 G94\nG0 X0 Y0 Z100\nG1 Z15 F3000\nM62 P1\nG4 P0.1\nG1 Z60 F1200\nG4 P0.3\nM2\n"


def _run(folder: Path, force: float) -> tuple[list[str], float]:
    """Findings, and how high the block is over the table at the end [m]."""
    (folder / "cell.yaml").write_text(CELL.replace("FORCE", f"{force:g}"))
    (folder / "lift.nc").write_text(LIFT)
    results = gcodesim.simulate(folder / "lift.nc", folder / "cell.yaml", folder / "out")
    block = json.loads((folder / "out" / "results.json").read_text())["parts"]["block"]
    return [finding.code for finding in results.findings], block["z_mm"] * 1e-3 - 0.2


def test_in_a_run_a_block_is_lifted_or_slides_out(tmp_path: Path) -> None:
    """At rest 19.6 N a finger hold 2 kg with a friction of 0.5; the lift starts and stops with 2 % more or less."""
    codes, height = _run(tmp_path, 24.0)
    assert "GS560" not in codes and height == pytest.approx(0.045, abs=3e-4)
    codes, height = _run(tmp_path, 18.0)
    assert height < 0.044  # it has slid, or dropped out
    codes, height = _run(tmp_path, 8.0)
    assert "GS560" in codes and height == pytest.approx(-0.2, abs=5e-3)  # on the floor
