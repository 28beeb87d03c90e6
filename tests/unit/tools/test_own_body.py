"""Tools with a body of their own: from a mesh, or from a URDF with fingers that move."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import gcodesim
from gcodesim.cell.loader import load_cell
from gcodesim.jobs.results import Results
from gcodesim.recorder.bodies import tool_shapes
from gcodesim.tools.tool import Tool
from gcodesim.world import tool_body

LIMIT = '<limit lower="0" upper="0.03" effort="50" velocity="0.1"/>'
JAWS = f"""<robot name="jaws">
<material name="blue"><color rgba="0.1 0.2 0.6 1"/></material>
<link name="mount"><inertial><origin xyz="0 0 0.03"/><mass value="0.7"/>
  <inertia ixx="5e-4" iyy="5e-4" izz="5e-4" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><origin xyz="0 0 0.03"/><geometry><box size="0.06 0.08 0.06"/></geometry><material name="blue"/></visual>
</link>
<link name="left"><visual><origin xyz="0.005 0 0.03"/><geometry><box size="0.01 0.02 0.06"/></geometry></visual>
  <inertial><mass value="0.15"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="right"><visual><origin xyz="-0.005 0 0.03"/><geometry><box size="0.01 0.02 0.06"/></geometry></visual>
  <inertial><mass value="0.15"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"/>
<joint name="slide" type="prismatic"><parent link="mount"/><child link="left"/><origin xyz="0 0 0.06"/>
  <axis xyz="1 0 0"/>{LIMIT}</joint>
<joint name="other" type="prismatic"><parent link="mount"/><child link="right"/><origin xyz="0 0 0.06"/>
  <axis xyz="-1 0 0"/>{LIMIT}<mimic joint="slide"/></joint>
<joint name="to_tip" type="fixed"><parent link="mount"/><child link="tip"/><origin xyz="0 0 0.12"/></joint>
</robot>"""
CELL = """gcodesim: 1
frames: {table: {in: world, xyz: [550, 0, 200]}}
robots: {arm: {model: kuka_kr10_r1100_2}}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54, spin: 0}
loaded_tool: 1
tools:
  1: TOOL
simulation: {world: WORLD}
"""
CODES = "m_codes: {M62 P1: {gripper: close}, M63 P1: {gripper: open}}\n"
GRIPPER = "{type: finger_gripper, length: 120, stroke: 60, force: 60 N, body: {urdf: jaws.urdf, tip: tip}}"
PARTS = """fixtures: {slab: {box: [300, 300, 20], zero: top-center, in: table}}
parts: {block: {box: [40, 40, 40], zero: bottom-center, mass: 0.5 kg, friction: 0.5, in: table}}
"""
LIFT = "G21 G90 G94\nG0 X0 Y0 Z100\nG1 Z5 F6000\nM62 P1\nG4 P0.2\nG1 Z60\nM2\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "jaws.urdf").write_text(JAWS)
    trimesh.creation.box(extents=(80.0, 60.0, 100.0)).export(tmp_path / "head.stl")
    return tmp_path


def _tool(folder: Path, text: str) -> Tool:
    (folder / "cell.yaml").write_text(CELL.replace("TOOL", text).replace("WORLD", "kinematic"))
    loaded = load_cell(folder / "cell.yaml")
    assert loaded.cell is not None, list(loaded.findings)
    return loaded.cell.tools[1]


def _codes(folder: Path, text: str) -> list[str]:
    (folder / "cell.yaml").write_text(CELL.replace("TOOL", text).replace("WORLD", "kinematic"))
    return [finding.code for finding in load_cell(folder / "cell.yaml").findings]


def test_fingers_follow_the_opening(folder: Path) -> None:
    gripper = _tool(folder, GRIPPER)
    np.testing.assert_allclose(gripper.X_FT.p, [0.0, 0.0, 0.12])
    for opening in (0.0, 0.5, 1.0):
        parts = dict(gripper.drawn(opening))
        assert set(parts) == {"mount", "left", "right"}  # none of the simple fingers
        assert parts["left"].X.p[0] == pytest.approx(0.005 + 0.03 * opening)
        assert parts["right"].X.p[0] == pytest.approx(-0.005 - 0.03 * opening)
        assert parts["mount"].X.p[2] == pytest.approx(-0.09)
    assert gripper.color_of("mount") == (0.1, 0.2, 0.6, 1.0)
    shut = _tool(folder, GRIPPER.replace("tip: tip", "tip: tip, opens: lower"))
    assert dict(shut.drawn(1.0))["left"].X.p[0] == pytest.approx(0.005)
    assert len(tool_shapes(gripper, 0.5)) == 3


def test_masses_are_those_of_the_description(folder: Path) -> None:
    body = tool_body(_tool(folder, GRIPPER))
    assert body.mass == pytest.approx(1.0)
    assert body.com == pytest.approx((0.0, 0.0, 0.7 * 0.03 + 0.3 * 0.06))
    heavy = tool_body(_tool(folder, GRIPPER.replace("force", "mass: 2 kg, force")))
    assert heavy.mass == pytest.approx(2.0) and heavy.com == pytest.approx(body.com)
    assert heavy.inertia == pytest.approx(tuple(2.0 * value for value in body.inertia))


def test_a_mesh_hangs_where_the_cell_says_and_weighs_as_steel(folder: Path) -> None:
    mill = "{type: flat_end_mill, diameter: 8, length: 40, tcp: {xyz: [0, 0, 140]}, BODY}"
    tool = _tool(folder, mill.replace("BODY", "body: {mesh: head.stl, unit: mm, xyz: [0, 0, 50]}"))
    assert {part for part, _ in tool.drawn()} == {"cutting", "body"}
    placed = dict(tool.drawn())["body"]
    np.testing.assert_allclose(placed.X.p, [0.0, 0.0, -0.09])
    steel = 7850.0 * (0.08 * 0.06 * 0.1 + np.pi * 0.004**2 * 0.04)
    assert tool_body(tool).mass == pytest.approx(steel, rel=1e-6)


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ("{}", "GS705"),
        ("{mesh: head.stl, unit: mm, urdf: jaws.urdf}", "GS719"),
        ("{mesh: head.stl}", "GS717"),
        ("{mesh: none.stl, unit: mm}", "GS714"),
        ("{mesh: jaws.urdf, unit: mm}", "GS716"),
        ("{mesh: head.stl, unit: mm, tip: tip}", "GS719"),
        ("{urdf: jaws.urdf, unit: mm}", "GS719"),
        ("{urdf: jaws.urdf, tip: tipp}", "GS712"),
        ("{urdf: jaws.urdf, connector: base}", "GS712"),
        ("{urdf: jaws.urdf, tip_axis: -Z}", "GS719"),
        ("{urdf: head.stl}", "GS760"),
    ],
)
def test_what_is_wrong_with_a_body_is_a_finding(folder: Path, body: str, code: str) -> None:
    assert code in _codes(folder, f"{{type: flat_end_mill, diameter: 8, body: {body}}}")


def test_a_tip_is_given_once(folder: Path) -> None:
    twice = GRIPPER.replace("body:", "tcp: {xyz: [0, 0, 100]}, body:")
    assert "GS720" in _codes(folder, twice)


@pytest.mark.parametrize("axis", ["X", "Y", "Z", "-X", "-Y", "-Z"])
def test_the_tip_points_along_the_axis_of_its_link_that_the_cell_names(folder: Path, axis: str) -> None:
    """T stays where the link is, right-handed, and shares an axis with it besides."""
    tool = _tool(folder, GRIPPER.replace("tip: tip", f"tip: tip, tip_axis: {axis}"))
    expected = np.zeros(3)
    expected["XYZ".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0

    assert tool.X_FT.p == pytest.approx([0.0, 0.0, 0.12])
    assert tool.X_FT.R[:, 2].tolist() == expected.tolist()
    assert np.linalg.det(tool.X_FT.R) == pytest.approx(1.0)
    assert tool.X_FT.R[0, 0] == 1.0 or tool.X_FT.R[1, 1] == 1.0


def _run(folder: Path, tool: str, program: str, world: str = "kinematic", more: str = CODES + PARTS) -> Results:
    (folder / "cell.yaml").write_text(CELL.replace("TOOL", tool).replace("WORLD", world) + more)
    (folder / "p.nc").write_text(program)
    return gcodesim.simulate(folder / "p.nc", folder / "cell.yaml", folder / "out")


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_gripper_from_a_urdf_lifts_and_is_seen(folder: Path, world: str) -> None:
    results = _run(folder, GRIPPER, LIFT, world)
    assert not [finding for finding in results.findings if finding.level.name == "ERROR"]
    held = json.loads((folder / "out" / "results.json").read_text())["parts"]["block"]
    assert held["held_by"] == "arm T1"


def test_a_body_from_a_mesh_hits_a_fixture(folder: Path) -> None:
    """The mill passes the post, the head above it does not."""
    mill = (
        "{type: flat_end_mill, diameter: 8, length: 60, tcp: {xyz: [0, 0, 160]},"
        " body: {mesh: head.stl, unit: mm, xyz: [0, 0, 50]}}"
    )
    post = "fixtures: {post: {box: [20, 20, 100], zero: bottom-center, in: table, xyz: [30, 60, 0]}}\n"
    program = "G21 G90 G94\nG0 X0 Y-60 Z80\nG1 Z20 F3000\nG1 Y130\nG0 Z150\nM2\n"
    results = _run(folder, mill, program, more=post)
    hits = [finding for finding in results.findings if finding.code == "GS305"]
    assert len(hits) == 1 and "the body of T1 hits post" in hits[0].message and hits[0].span.line == 4
    assert not [f for f in _run(folder, mill, program.replace("Z20", "Z70"), more=post).findings if f.code == "GS305"]
