"""Links of a description with joints at given values, and joints that follow others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.kinematics.posed_links import joint_values, posed_links, travel_of
from gcodesim.kinematics.urdf import load_urdf

LIMIT = '<limit lower="0" upper="0.03" effort="50" velocity="0.1"/>'
FINGERS = f"""<robot name="jaws">
<link name="mount"/><link name="left"/><link name="right"/><link name="hook"/>
<joint name="slide" type="prismatic"><parent link="mount"/><child link="left"/><origin xyz="0 0 0.06"/>
  <axis xyz="1 0 0"/>{LIMIT}</joint>
<joint name="other" type="prismatic"><parent link="mount"/><child link="right"/><origin xyz="0 0 0.06"/>
  <axis xyz="-1 0 0"/>{LIMIT}<mimic joint="slide" multiplier="2" offset="0.001"/></joint>
<joint name="bend" type="revolute"><parent link="left"/><child link="hook"/><origin xyz="0 0 0.02"/>
  <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="other" multiplier="10"/></joint>
</robot>"""


def test_joints_and_followers_of_followers_move_their_links(tmp_path: Path) -> None:
    (tmp_path / "jaws.urdf").write_text(FINGERS)
    chain, findings = load_urdf(tmp_path / "jaws.urdf", robot=False)
    assert chain is not None and not findings
    assert travel_of(chain) == {"slide": (0.0, 0.03)}
    assert joint_values(chain, {"slide": 0.02}) == pytest.approx({"slide": 0.02, "other": 0.041, "bend": 0.41})
    X = posed_links(chain, {"slide": 0.02})
    np.testing.assert_allclose(X["left"].p, [0.02, 0.0, 0.06])
    np.testing.assert_allclose(X["right"].p, [-0.041, 0.0, 0.06])
    np.testing.assert_allclose(X["hook"].p, [0.02, 0.0, 0.08])
    np.testing.assert_allclose(X["hook"].R[:, 2], [np.sin(0.41), 0.0, np.cos(0.41)], atol=1e-15)


def test_what_nothing_moves_is_a_tool_but_no_robot(tmp_path: Path) -> None:
    (tmp_path / "plate.urdf").write_text("<robot name='plate'><link name='plate'/></robot>")
    assert [each.code for each in load_urdf(tmp_path / "plate.urdf")[1]] == ["GS767"]
    chain, findings = load_urdf(tmp_path / "plate.urdf", robot=False)
    assert chain is not None and chain.flange == "plate" and not findings
    assert list(posed_links(chain, {})) == ["plate"]
