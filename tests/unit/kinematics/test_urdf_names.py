"""Descriptions as others write them: the names of ROS-Industrial, several packages, files from other tools."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.jobs.job import Options
from gcodesim.kinematics import load_urdf
from gcodesim.kinematics.urdf_meshes import near_file
from gcodesim.log.reader import read_messages
from gcodesim.simulation import prepare, run

PLACES = (("0 0 0.4", "0 0 1"), ("0.03 0 0", "0 1 0"), ("0 0 0.5", "0 1 0"), ("0 0 0.04", "1 0 0"))
PLACES += (("0.5 0 0", "0 1 0"), ("0.08 0 0", "1 0 0"))
LIMIT = '<limit lower="-3" upper="3" velocity="3" effort="300"/>'


def link(name: str, inside: str = "") -> str:
    return f'<link name="{name}">{inside}</link>'


def joint(name: str, kind: str, parent: str, child: str, inside: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inside}</joint>'


def industrial_arm(*more: str) -> str:
    """Six joints with the frames of REP 199: base_link, base, flange (X outwards) and tool0 (Z outwards)."""
    parts = [link("base_link"), link("base"), link("flange"), link("tool0")]
    parent = "base_link"
    for number, (xyz, axis) in enumerate(PLACES, 1):
        where = f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>{LIMIT}'
        parts += [link(f"link_{number}"), joint(f"joint_{number}", "revolute", parent, f"link_{number}", where)]
        parent = f"link_{number}"
    half = 1.5707963267948966
    parts += [
        joint("base_link-base", "fixed", "base_link", "base", f'<origin xyz="0 0 0.1" rpy="0 0 {half}"/>'),
        joint("joint_6-flange", "fixed", "link_6", "flange", '<origin xyz="0.05 0 0"/><axis xyz="0 0 0"/>'),
        joint("flange-tool0", "fixed", "flange", "tool0", f'<origin rpy="0 {half} 0"/>'),
    ]
    return "<robot name='arm'>\n" + "\n".join([*parts, *more]) + "\n</robot>\n"


CELL = """gcodesim: 1
robots: {arm: {urdf: arm.urdf, home: [0, 0, 20, 0, 30, 0], base: {xyz: [0, 0, 200]}}}
frames: {mark: {in: arm/base, xyz: [10, 0, 0]}}
work_offsets: {G54: {xyz: [500, 0, 200]}}
tools: {1: {type: flat_end_mill, diameter: 6, flutes: 2, length: 60}}
fixtures: {lamp: {box: [10, 10, 10], in: arm/tool0, xyz: [0, 0, 100]}}
"""
PROGRAM = b"G21 G90 G54\nT1 M6\nG43 H1\nG4 P0.1\nM2\n"


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "arm.urdf").write_text(industrial_arm())
    (tmp_path / "cell.yaml").write_text(CELL)
    loaded = load_cell(tmp_path / "cell.yaml")
    job = prepare(SourceText("p.nc", PROGRAM), loaded, Options(world="kinematic"))
    results, _ = run(job, tmp_path / "out")
    assert results.status == "ok"
    return loaded.cell, job, tmp_path / "out" / "run.mcap"


def test_each_frame_of_the_log_has_one_parent_and_the_name_of_its_link(arm):
    _, _, log = arm
    parents = {}
    for _, message in (*read_messages(log, "/tf_static"), *read_messages(log, "/tf")):
        for one in message.transforms:
            assert parents.setdefault(one.child_frame_id, one.parent_frame_id) == one.parent_frame_id
    assert {"arm/base_link", "arm/base", "arm/flange", "arm/tool0"} <= parents.keys()
    assert parents["arm/base_link"] == "world"
    assert parents["tool"] == "arm/tool0", "the tool hangs on F, not on the flange frame that points elsewhere"


def test_the_base_of_the_control_is_a_fixed_frame(arm):
    cell, job, _ = arm
    assert cell.frames["arm/base"].p == pytest.approx([0, 0, 0.3])
    assert cell.frames["arm/base_link"].p == pytest.approx([0, 0, 0.2])
    assert cell.frames["mark"].p == pytest.approx([0, 0.010, 0.3], abs=1e-12)  # X of `base` is Y of the world
    assert job.shop.scene.at_rest("arm/base").p == pytest.approx([0, 0, 0.3])


def test_what_stands_on_the_flange_stands_on_f(arm):
    _, job, _ = arm
    X_BF = job.shop.kinematics.forward(job.shop.home[None])[0]
    lamp = job.shop.scene.at_rest("fixture/lamp")
    assert lamp.p - [0, 0, 0.2] == pytest.approx(X_BF[:3, 3] + 0.1 * X_BF[:3, 2])


def read(tmp_path, text, **options):
    path = tmp_path / "robot" / "arm.urdf"
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    return load_urdf(path, **options)


def errors(findings):
    return [f for f in findings if f.level is Severity.ERROR]


@pytest.mark.parametrize("axis", ['<axis xyz="0 0 0"/>', "<axis xyz='a b c'/>"])
def test_the_axis_of_a_fixed_joint_means_nothing(tmp_path, axis):
    tip = joint("tip", "fixed", "tool0", "probe", axis)
    chain, findings = read(tmp_path, industrial_arm(link("probe"), tip))
    assert chain is not None and errors(findings) == []


FINGERS = (
    link("hand"),
    link("left"),
    link("right"),
    joint("mount", "fixed", "link_6", "hand"),
    joint("open", "prismatic", "hand", "left", LIMIT),
    joint("follow", "prismatic", "left", "right", f'{LIMIT}<mimic joint="open"/>'),
)


def unnamed(*more: str) -> str:
    """The arm without any link that has the name of a flange."""
    return industrial_arm(*more).replace('"flange"', '"end"').replace('"tool0"', '"face"')


def test_the_end_of_the_chain_is_no_follower_and_a_note_says_which_it_is(tmp_path):
    chain, findings = read(tmp_path, unnamed(*FINGERS))
    assert chain.flange == "face"
    (note,) = [f for f in findings if f.code == "GS771"]
    assert "`face`" in note.message and "`flange: end`" in note.hint


def test_the_cell_names_the_flange(tmp_path):
    (tmp_path / "arm.urdf").write_text(unnamed(*FINGERS))
    (tmp_path / "cell.yaml").write_text("gcodesim: 1\nrobots: {arm: {urdf: arm.urdf, flange: hand}}\n")
    loaded = load_cell(tmp_path / "cell.yaml")
    assert loaded.cell.robots["arm"].chain.flange == "hand"
    assert "GS771" not in [f.code for f in loaded.findings]


@pytest.mark.parametrize(
    ("robot", "code", "hint"),
    [
        ("{urdf: arm.urdf, flange: hnad}", "GS712", "`hand`"),
        ("{model: ur10e, flange: hand}", "GS719", ""),
        ("{urdf: arm.urdf, flange: right}", "GS766", "`flange: left`"),
        ("{urdf: arm.urdf, flange: base}", "GS767", "`flange:`"),
    ],
)
def test_a_flange_that_cannot_be_is_told(tmp_path, robot, code, hint):
    (tmp_path / "arm.urdf").write_text(unnamed(*FINGERS))
    (tmp_path / "cell.yaml").write_text(f"gcodesim: 1\nrobots: {{arm: {robot}}}\n")
    (fault,) = errors(load_cell(tmp_path / "cell.yaml").findings)
    assert fault.code == code and hint in fault.hint


def mesh(name: str) -> str:
    return f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'


def test_packages_are_found_where_ros_has_them(tmp_path):
    for folder in ("robot/meshes", "tools/meshes", "given"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "a.stl").write_bytes(b"")
    names = ("package://robot/meshes/a.stl", "package://tools/meshes/a.stl", "package://own/a.stl")
    names += ("model://meshes/a.stl", "package:///tools/meshes/a.stl")
    bodies = "".join(mesh(name) for name in names)
    text = industrial_arm(link("body", bodies), joint("b", "fixed", "base_link", "body"))
    chain, findings = read(tmp_path, text, packages={"own": tmp_path / "given"})
    assert errors(findings) == []
    found = [shape.placed.solid.source.path.relative_to(tmp_path).as_posix() for shape in chain.shapes()]
    assert found == [
        "robot/meshes/a.stl",
        "tools/meshes/a.stl",
        "given/a.stl",
        "robot/meshes/a.stl",
        "tools/meshes/a.stl",
    ]


def test_a_package_is_not_found_outside_the_folders_that_may_be_read(tmp_path):
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "a.stl").write_bytes(b"")
    inner = tmp_path / "robot"
    text = industrial_arm(link("body", mesh("package://secret/a.stl")), joint("b", "fixed", "base_link", "body"))
    _, findings = read(tmp_path, text, may_read=lambda p: p.resolve().is_relative_to(inner.resolve()))
    assert [f.code for f in errors(findings)] == ["GS761"]


def test_one_finding_for_each_package_that_is_not_known(tmp_path):
    bodies = "".join(mesh(f"package://{name}/{i}.stl") for i in range(3) for name in ("p", "q"))
    _, findings = read(tmp_path, industrial_arm(link("body", bodies), joint("b", "fixed", "base_link", "body")))
    assert [(f.count, f.code) for f in errors(findings)] == [(3, "GS761"), (3, "GS761")]
    assert "packages: {p: folder}" in errors(findings)[0].hint


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("meshes/A.STL", "`meshes/a.stl`"),
        ("meshes\\\\a.stl", "`/`"),
        ("https://example.org/a.stl", "network"),
        ("$(find arm)/a.stl", "xacro"),
        ("nowhere/a.stl", "relative"),
        ("meshes/zzzzzzzz.stl", "take the <mesh> out"),
    ],
)
def test_a_mesh_that_is_not_there_says_what_to_do(tmp_path, name, hint):
    (tmp_path / "robot" / "meshes").mkdir(parents=True)
    (tmp_path / "robot" / "meshes" / "a.stl").write_bytes(b"")
    _, findings = read(tmp_path, industrial_arm(link("body", mesh(name)), joint("b", "fixed", "base_link", "body")))
    (fault,) = errors(findings)
    assert fault.code == "GS761" and hint in fault.hint


@pytest.mark.parametrize(
    ("text", "code", "hint"),
    [
        ("<robot name='r'></robot>", "GS764", "xacro"),
        ("<robot name='r'><link name='a'/></robot>", "GS767", "fixture"),
        ("<robot name='r'><link name='a'/><link name='b'/></robot>", "GS764", "fixed"),
        (industrial_arm().replace('xyz="0 0 0.4"', 'xyz="0, 0, 0.4"'), "GS765", "spaces"),
        (industrial_arm().replace('xyz="0 0 0.4"', 'xyz="0 0 0.4 0"'), "GS765", "exactly 3"),
        (industrial_arm().replace('xyz="0 0 0.4"', 'xyz="$(arg x) 0 0"'), "GS765", "gcodesim[xacro]"),
        (industrial_arm().replace('axis xyz="0 0 1"', 'axis xyz="0 0 0"'), "GS765", "fixed"),
        (industrial_arm().replace('<parent link="link_6"/>', '<parent link="link_7"/>'), "GS764", "`link_6`"),
        ("<robot name='r'><!-- a -- b --></robot>", "GS760", "comment"),
        ("<!-- made by hand -->\n<?xml version='1.0'?>\n<robot/>", "GS760", "before `<?xml"),
        ("<sdf/>", "GS760", "URDF"),
        (
            "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:arm/></robot>",
            "GS760",
            "gcodesim[xacro]",
        ),
    ],
)
def test_what_is_refused_comes_with_a_remedy(tmp_path, text, code, hint):
    chain, findings = read(tmp_path, text)
    assert chain is None
    (fault,) = errors(findings)
    assert fault.code == code and hint in fault.hint


def test_blank_lines_before_the_declaration_are_passed_over_and_counted(tmp_path):
    chain, findings = read(tmp_path, "\n\n<?xml version='1.0'?>\n" + industrial_arm())
    assert chain is not None and errors(findings) == []
    _, findings = read(tmp_path, "\n\n<?xml version='1.0'?>\n<robot name='r'>\n<link/></robot>")
    assert errors(findings)[0].span.line == 5


def test_a_long_chain_of_fixed_links_is_read(tmp_path):
    """One call for each of them would be too deep."""
    count = 3000
    parts = [link(f"l{i}") for i in range(count)]
    parts += [joint(f"f{i}", "fixed", f"l{i}", f"l{i + 1}") for i in range(1, count - 1)]
    parts.append(joint("f0", "revolute", "l0", "l1", LIMIT))
    chain, findings = read(tmp_path, "<robot name='r'>" + "".join(parts) + "</robot>")
    assert errors(findings) == []
    assert len(chain.links) == count and np.array_equal(chain.driven, [0])


def test_a_file_too_large_for_a_description_is_not_read(tmp_path):
    path = tmp_path / "arm.urdf"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    chain, findings = load_urdf(path)
    assert chain is None and [f.code for f in findings] == ["GS760"]


def test_the_mesh_that_may_be_meant_is_named_as_it_has_to_be_written(tmp_path):
    (tmp_path / "a.stl").write_bytes(b"")

    assert near_file(tmp_path / "A.STL", "package://arm/meshes/A.STL") == "did you mean `package://arm/meshes/a.stl`?"
