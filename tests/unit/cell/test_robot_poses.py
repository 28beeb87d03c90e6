"""Joints that have a name in the cell."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import gcodesim
from gcodesim.cell.loader import read_cell
from gcodesim.cli import main
from gcodesim.diagnostics import SourceText
from gcodesim.session import MisuseError

CELL = "gcodesim: 1\nrobots:\n  arm:\n    model: ur10e\n{keys}"
POSES = """    poses:
      ready: [0, -100, 90, 0, 45, 10 deg]
      pick up: [0.1, -1.5, 1, 0, 1, 0 rad]
"""


def loaded(keys: str):
    return read_cell(SourceText("cell.yaml", CELL.format(keys=keys).encode()), Path("cell.yaml"))


def test_a_pose_is_where_the_arm_starts() -> None:
    cell = loaded(POSES + "    home: ready\n").cell

    assert cell is not None
    assert cell.robots["arm"].home == pytest.approx(np.radians([0, -100, 90, 0, 45, 10]))
    assert cell.robots["arm"].poses["pick up"] == (0.1, -1.5, 1.0, 0.0, 1.0, 0.0)


@pytest.mark.parametrize(
    ("keys", "code", "message"),
    [
        (POSES + "    home: redy\n", "GS712", "no pose `redy`"),
        ("    home: ready\n", "GS712", "no pose `ready`"),
        ("    poses: {ready: [0, 1]}\n", "GS706", "pose `ready` has 2 entries; the robot has 6 joints"),
        ("    poses: {ready: [0, 0, 400, 0, 0, 0]}\n", "GS723", "pose `ready` of joint"),
        ("    poses: {ready: [0, 0, x, 0, 0, 0]}\n", "GS707", "`x`"),
        ("    poses: [0, 0]\n", "GS706", "joints by the name of a pose"),
    ],
)
def test_faults(keys: str, code: str, message: str) -> None:
    (finding,) = loaded(keys).findings
    assert finding.code == code
    assert message in finding.message


def test_a_session_goes_to_poses_by_their_names(tmp_path: Path) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(CELL.format(keys=POSES))
    with gcodesim.open_cell(path, world="kinematic") as cell:
        arm = cell.robot()
        arm.move_joints("pick up", "ready")

        assert arm.joint_state.position == pytest.approx(np.radians([0, -100, 90, 0, 45, 10]))
        assert list(arm.poses) == ["ready", "pick up"]
        with pytest.raises(MisuseError, match="has no pose `away`; it has ready, pick up"):
            arm.move_joints("away")


def test_cell_show_tells_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(CELL.format(keys=POSES))

    assert main(["cell", "show", str(path), "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["cell"]["robots"]["arm"]["poses"]["ready"] == [0, -100, 90, 0, 45, 10]
    assert main(["cell", "show", str(path)]) == 0
    assert "ready: [0 deg, -100 deg," in capsys.readouterr().out
