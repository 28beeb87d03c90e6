"""MJCF: links stand where MuJoCo has them; limits, masses and shapes are taken over, and what is missing is said."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcodesim import extras
from gcodesim.cell import load_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.kinematics import kinematics_of
from gcodesim.kinematics.mjcf import load_mjcf
from gcodesim.simulation import prepare
from gcodesim.solids import Mesh, MeshFile

mujoco: Any = pytest.importorskip("mujoco")

ARM = """<mujoco model="bench arm">
  <compiler angle="degree" meshdir="parts"/>
  <asset><mesh name="wedge" file="wedge.stl" scale="0.001 0.001 0.002"/></asset>
  <include file="motors.xml"/>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 .1"/>
    <body name="base" pos="0 0 0.1">
      <geom type="cylinder" size="0.1 0.1" rgba="1 0 0 1"/>
      <body name="shoulder" pos="0 0 0.2" euler="0 0 30">
        <joint name="turn" axis="0 0 1" range="-170 170" ref="20"/>
        <inertial pos="0 0 .1" mass="5" diaginertia=".05 .04 .02" euler="0 90 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 .3" size="0.05"/>
        <body name="upper" pos="0 0.05 0.3">
          <joint name="lift" axis="0 1 1" pos="0.02 0 0.01" range="-100 100" actuatorfrcrange="-80 80"/>
          <joint name="out" type="slide" axis="1 0 0" range="0 0.3" ref="0.1"/>
          <geom type="mesh" mesh="wedge" pos="0.1 0 0" euler="10 20 30"/>
          <geom type="box" size=".02 .03 .1" pos="0 0 .1" mass="1" contype="0" conaffinity="0"/>
          <body name="wrist" pos="0.4 0 0">
            <joint name="roll" axis="1 0 0" pos="0 0 0.05"/>
            <geom type="sphere" size="0.04" pos="0 0 0.05" group="3"/>
            <site name="attachment_site" pos="0.05 0 0.05" euler="0 90 0"/>
            <body name="finger" pos="0 0.02 0">
              <joint name="grip" type="slide" axis="0 1 0" range="0 .02"/><geom type="box" size=".01 .01 .01"/>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
MOTORS = """<mujocoinclude><actuator>
  <motor joint="turn" gear="50" ctrllimited="true" ctrlrange="-2 2"/>
  <position joint="lift" kp="100" forcerange="-60 60"/>
</actuator></mujocoinclude>
"""
CORNERS = np.array([[0, 0, 0], [200, 0, 0], [0, 50, 0], [0, 0, 30]], dtype=np.float32)
SIMPLE = "<mujoco>\n<worldbody>\n<body name='a'>{}<geom size='.1'/></body></worldbody>{}</mujoco>"
HINGE = "<joint name='j' range='-1 1'/>"


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """The file, with what it names."""
    triangles = [CORNERS[list(face)] for face in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))]
    (tmp_path / "parts").mkdir()
    body = b"".join(bytes(12) + np.ascontiguousarray(corners).tobytes() + bytes(2) for corners in triangles)
    (tmp_path / "parts" / "wedge.stl").write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + body)
    (tmp_path / "motors.xml").write_text(MOTORS)
    (tmp_path / "arm.xml").write_text(ARM)
    return tmp_path / "arm.xml"


def refused(tmp_path: Path, text: str, **more: Any) -> list[tuple[str, str]]:
    """The errors about a file; there is no chain."""
    (tmp_path / "robot.xml").write_text(text)
    chain, findings = load_mjcf(tmp_path / "robot.xml", **more)
    assert chain is None
    return [(finding.code, finding.message) for finding in findings if finding.level.word == "error"]


def test_every_link_stands_where_mujoco_has_it(arm: Path) -> None:
    chain, _ = load_mjcf(arm)
    assert chain is not None
    kinematics, model = kinematics_of(chain), mujoco.MjModel.from_xml_path(str(arm))
    data, seen = mujoco.MjData(model), 0
    for q in np.random.default_rng(0).uniform(-1.0, 1.0, (20, 4)):
        data.qpos[:] = 0.0
        for name, value in zip(kinematics.joints.names, q, strict=True):
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        for name, X in zip(kinematics.link_names, kinematics.links(q[None])[0], strict=True):
            if "/" in name:  # between two joints of one body
                continue
            there = data.site(name) if name == "attachment_site" else data.body(name)
            assert X[:3, 3] == pytest.approx(there.xpos, abs=1e-12), name
            assert X[:3, :3] == pytest.approx(there.xmat.reshape(3, 3), abs=1e-12), name
            seen += 1
    assert seen == 20 * 7
    assert kinematics.forward(q[None])[0] == pytest.approx(kinematics.links(q[None])[0][-1])


def test_limits_masses_and_shapes_are_taken_over(arm: Path) -> None:
    chain, findings = load_mjcf(arm)
    assert chain is not None
    joints, links = chain.driven_joints, {link.name: link for link in chain.links}

    assert joints.names == ("turn", "lift", "out", "roll")
    assert joints.lower == pytest.approx([np.radians(-170), np.radians(-100), 0.0, -np.inf])
    assert joints.upper == pytest.approx([np.radians(170), np.radians(100), 0.3, np.inf])
    assert joints.effort.tolist() == [100.0, 60.0, np.inf, np.inf]  # 2 times 50; the lesser of 80 and 60
    heavy = links["shoulder"].inertial
    assert heavy is not None and heavy.mass == 5.0 and heavy.com.tolist() == [0.0, 0.0, 0.1]
    assert heavy.inertia == pytest.approx(np.diag([0.02, 0.04, 0.05]))
    assert links["base"].visuals[0].rgba == (1.0, 0.0, 0.0, 1.0)
    assert (len(links["upper"].visuals), len(links["upper"].collisions)) == (2, 1)
    assert (len(links["wrist"].visuals), len(links["wrist"].collisions)) == (0, 1)
    assert sorted(file.name for file in chain.files) == ["motors.xml", "wedge.stl"]
    codes = [finding.code for finding in findings]
    assert codes == ["GS770", "GS768", "GS763", "GS763"]  # the floor, the finger, travel of `roll`, speeds


def test_a_mesh_lies_where_mujoco_draws_it(arm: Path) -> None:
    chain, _ = load_mjcf(arm)
    assert chain is not None
    drawn = next(s for link in chain.links for s in link.visuals if isinstance(s.solid, Mesh))
    assert isinstance(drawn.solid, Mesh) and isinstance(drawn.solid.source, MeshFile)
    own = drawn.solid.source.read().points @ drawn.X[:3, :3].T + drawn.X[:3, 3]
    model = mujoco.MjModel.from_xml_path(str(arm))
    g = int(np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_MESH)[0])
    R = np.empty(9)
    mujoco.mju_quat2Mat(R, model.geom_quat[g])
    theirs = model.mesh_vert @ R.reshape(3, 3).T + model.geom_pos[g]

    away = np.linalg.norm(own[:, None] - theirs, axis=2)
    assert away.min(axis=1).max() < 1e-7 and away.min(axis=0).max() < 1e-7  # they are single precision


def test_a_cell_runs_it_with_the_speeds_that_the_cell_gives(arm: Path) -> None:
    cell = (
        "gcodesim: 1\nrobots:\n  arm:\n    mjcf: arm.xml\n    flange: wrist\n"
        "    speed: [90 deg/s, 90 deg/s, 200 mm/s, 180 deg/s]\nwork_offsets: {G54: {xyz: [0, 0, 0]}}\n"
    )
    (arm.parent / "cell.yaml").write_text(cell)
    loaded = load_cell(arm.parent / "cell.yaml")
    assert not [f.message for f in loaded.findings if f.level.word == "error"]
    assert not [f for f in loaded.findings if "no speeds" in f.message]
    assert {file.name for file in loaded.files} >= {"arm.xml", "motors.xml", "parts/wedge.stl"}

    job = prepare(SourceText("wait.nc", b"G21 G90 G54\nG4 P0.05\nM2\n"), loaded, Options(world="kinematic"))

    assert job.plan is not None and job.shop is not None
    assert job.shop.kinematics.joints.speed == pytest.approx([np.pi / 2, np.pi / 2, 0.2, np.pi])
    assert job.shop.kinematics.chain.flange == "wrist"


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        ("<mujoco><worldbody>", "GS760", "well-formed"),
        ("<robot name='r'/>", "GS760", "begins with <mujoco>"),
        (SIMPLE.format("<joint turns='1'/>", ""), "GS760", "unrecognized attribute"),
        (SIMPLE.format("<freejoint/>", ""), "GS766", "`free`"),
        (SIMPLE.format("<joint type='ball'/>", ""), "GS766", "`ball`"),
        (SIMPLE.format("", ""), "GS767", "can move"),
        (SIMPLE.format(HINGE, "<equality><connect body1='a' anchor='0 0 0'/></equality>"), "GS766", "loops"),
        (SIMPLE.format(HINGE, "<asset><mesh name='m' file='none.stl'/></asset>"), "GS761", "none.stl"),
        (SIMPLE.format(HINGE, "<include file='gone.xml'/>"), "GS761", "gone.xml"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, text: str, code: str, says: str) -> None:
    found = refused(tmp_path, text)

    assert [each for each, _ in found] == [code] and says in found[0][1], found


def test_no_file_outside_the_folders_is_opened(tmp_path: Path) -> None:
    (tmp_path / "secret.xml").write_text("<mujocoinclude/>")
    (tmp_path / "inside").mkdir()
    text = SIMPLE.format(HINGE, "<include file='../secret.xml'/>")

    found = refused(tmp_path / "inside", text, may_read=lambda file: file.resolve().is_relative_to(tmp_path / "inside"))

    assert [code for code, _ in found] == ["GS762"]


def test_without_the_extra_the_finding_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(extras.EXTRAS, "mjcf", ("mujoco-that-is-not-there",))

    found = refused(tmp_path, SIMPLE.format(HINGE, ""))

    assert [code for code, _ in found] == ["GS760"] and "gcodesim[mjcf]" in found[0][1]
