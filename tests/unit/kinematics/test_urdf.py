"""Any user's URDF: what is read from it, and which finding a fault gives at which place."""

import numpy as np
import pytest

from gcodesim.diagnostics import Severity, code_of
from gcodesim.kinematics import load_urdf
from gcodesim.solids import Cylinder, Sphere

LINKS = '<link name="a"/><link name="b"/>'
LIMIT = '<limit lower="-1" upper="1" velocity="2" effort="3"/>'
JOINT = f'<joint name="j" type="revolute"><parent link="a"/><child link="b"/>{LIMIT}</joint>'


def read(tmp_path, text, **options):
    path = tmp_path / "arm.urdf"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return load_urdf(path, **options)


def robot(*parts):
    return "<robot name='r'>\n" + "\n".join(parts) + "\n</robot>\n"


def codes(findings, least=Severity.NOTE):
    return [f.code for f in findings if f.level >= least]


def test_joint_values(tmp_path):
    origin = '<origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><axis xyz="0 0 2"/>'
    chain, findings = read(tmp_path, robot(LINKS, JOINT.replace("<limit", origin + "<limit")))
    assert codes(findings, Severity.WARNING) == []
    (joint,) = chain.joints
    assert joint.axis == pytest.approx([0, 0, 1])
    assert joint.X[:3, 3] == pytest.approx([1, 2, 3])
    assert joint.X[:3, 0] == pytest.approx([0, 1, 0])
    assert (joint.lower, joint.upper, joint.speed, joint.effort) == (-1, 1, 2, 3)
    assert chain.flange == "b"


def test_our_own_attribute_gives_the_acceleration(tmp_path):
    chain, _ = read(tmp_path, robot(LINKS, JOINT.replace("effort", 'acceleration="7" effort')))
    assert chain.driven_joints.acceleration == pytest.approx([7.0])
    assert not chain.driven_joints.assumed_acceleration[0]


def test_continuous_joint_has_no_travel_limit(tmp_path):
    chain, findings = read(tmp_path, robot(LINKS, JOINT.replace("revolute", "continuous")))
    assert np.isinf(chain.driven_joints.upper[0]) and chain.driven_joints.speed[0] == 2
    assert codes(findings, Severity.WARNING) == []


def test_bodies_keep_their_pose_size_and_colour(tmp_path):
    body = (
        '<link name="b"><visual><origin xyz="0 0 0.5"/><geometry><capsule radius="0.1" length="0.6"/></geometry>'
        '<material name="blue"/></visual>'
        '<collision><geometry><box size="1 2 3"/></geometry></collision></link>'
    )
    colour = '<material name="blue"><color rgba="0 0 1 1"/></material>'
    chain, _ = read(tmp_path, robot(colour, '<link name="a"/>', body, JOINT))
    shapes = chain.shapes()
    ball, rod = Sphere(radius=0.1), Cylinder(radius=0.1, bottom=-0.3, top=0.3)
    assert [(s.link, s.placed.solid) for s in shapes] == [(1, rod), (1, ball), (1, ball)]
    assert shapes[0].rgba == (0, 0, 1, 1)
    assert sorted(s.placed.X.p[2] for s in shapes) == pytest.approx([0.2, 0.5, 0.8])
    assert [s.placed.solid.size for s in chain.shapes("collision")] == [(1, 2, 3)]


def test_inertia_is_turned_into_link_axes(tmp_path):
    body = (
        '<link name="b"><inertial><origin xyz="0 1 0" rpy="0 0 1.5707963267948966"/><mass value="2"/>'
        '<inertia ixx="1" iyy="2" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )
    chain, findings = read(tmp_path, robot('<link name="a"/>', body, JOINT))
    inertial = chain.links[1].inertial
    assert inertial.mass == 2 and inertial.com == pytest.approx([0, 1, 0])
    assert np.diag(inertial.inertia) == pytest.approx([2, 1, 3])
    assert codes(findings) == ["GS771"]


@pytest.mark.parametrize(
    "names, flange",
    [
        (("a", "b", "flange", "tool0"), "tool0"),
        (("a", "tool0", "b", "c"), "tool0"),
        (("a", "flange", "b", "c"), "flange"),
        (("a", "b", "c", "d"), "d"),
    ],
)
def test_flange_is_the_link_of_that_name_or_the_end_of_the_chain(tmp_path, names, flange):
    links = [f'<link name="{n}"/>' for n in names]
    joints = [
        f'<joint name="j{i}" type="revolute"><parent link="{names[i]}"/><child link="{names[i + 1]}"/>{LIMIT}</joint>'
        for i in range(3)
    ]
    chain, _ = read(tmp_path, robot(*links, *joints))
    assert chain.flange == flange
    assert len(chain.driven) == names.index(flange)


def test_order_of_elements_does_not_matter(tmp_path):
    second = '<joint name="k" type="prismatic"><parent link="b"/><child link="c"/>' + LIMIT + "</joint>"
    chain, _ = read(tmp_path, robot(second, '<link name="c"/>', JOINT, LINKS))
    assert chain.driven_joints.names == ("j", "k")
    assert chain.driven_joints.kinds == ("revolute", "prismatic")
    assert chain.link_names == ("a", "b", "c")


def test_finger_that_follows_stands_still_and_is_named(tmp_path):
    finger = (
        '<joint name="f" type="prismatic"><parent link="b"/><child link="c"/><mimic joint="j" multiplier="-1"/></joint>'
    )
    links = LINKS + '<link name="c"/><link name="tool0"/>'
    end = '<joint name="e" type="fixed"><parent link="b"/><child link="tool0"/></joint>'
    chain, findings = read(tmp_path, robot(links, JOINT, finger, end))
    assert chain.driven_joints.names == ("j",)
    assert "GS768" in codes(findings)
    assert next(j for j in chain.joints if j.name == "f").mimic == ("j", -1.0, 0.0)


MASS = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
COVER = '<joint name="k" type="fixed"><parent link="b"/><child link="c"/></joint>'


@pytest.mark.parametrize("cover, expected", [("", ["GS769"]), (MASS, [])])
def test_moving_link_without_mass_is_noted_unless_something_fixed_to_it_has_one(tmp_path, cover, expected):
    _, findings = read(tmp_path, robot(LINKS, f'<link name="c">{cover}</link>', JOINT, COVER))
    assert codes(findings) == ["GS771", *expected]


def test_links_without_mass_are_told_of_together(tmp_path):
    second = JOINT.replace('"j"', '"k"').replace('"b"', '"c"').replace('"a"', '"b"')
    _, findings = read(tmp_path, robot(LINKS, '<link name="c"/>', JOINT, second))
    (told,) = [finding for finding in findings if finding.code == "GS769"]
    assert told.message == "2 links have no mass, and joint efforts leave them out: `b`, `c`"


BROKEN = {
    "not closed": ("<robot>\n <link name='a'>\n</robot>", "GS760", 3),
    "empty": ("", "GS760", 1),
    "another format": ("<sdf/>", "GS760", 1),
    "xacro": ("<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:macro name='m'/></robot>", "GS760", 1),
    "bomb": ("<!DOCTYPE r [<!ENTITY a 'aaaa'>]><robot>&a;</robot>", "GS760", 1),
    "number": (robot(LINKS, JOINT.replace('"-1"', '"1_0"')), "GS765", 3),
    "infinite": (robot(LINKS, JOINT.replace('"-1"', '"1e999"')), "GS765", 3),
    "two numbers": (robot(LINKS, JOINT.replace("<limit", '<origin xyz="1 2"/><limit')), "GS765", 3),
    "no direction": (robot(LINKS, JOINT.replace("<limit", '<axis xyz="0 0 0"/><limit')), "GS765", 3),
    "unknown body": (
        robot('<link name="a"><visual>\n<geometry><cone/></geometry></visual></link><link name="b"/>', JOINT),
        "GS765",
        3,
    ),
    "no body": (robot('<link name="a"><visual/></link><link name="b"/>', JOINT), "GS765", 2),
    "negative mass": (
        robot('<link name="a"/>', '<link name="b"><inertial><mass value="-1"/></inertial></link>', JOINT),
        "GS765",
        3,
    ),
    "floating": (robot(LINKS, JOINT.replace("revolute", "floating")), "GS766", 3),
    "follower in the chain": (robot(LINKS, JOINT.replace("<limit", '<mimic joint="x"/><limit')), "GS766", 3),
    "link not there": (robot(LINKS, JOINT.replace('child link="b"', 'child link="x"')), "GS764", 3),
    "two parents": (robot(LINKS, JOINT, JOINT.replace('"j"', '"k"')), "GS764", 4),
    "two roots": (robot(LINKS, '<link name="c"/>', JOINT), "GS764", 1),
    "ring": (
        robot(LINKS, JOINT, '<joint name="k" type="fixed"><parent link="b"/><child link="a"/></joint>'),
        "GS764",
        1,
    ),
    "same link name": (robot(LINKS, '<link name="a"/>', JOINT), "GS764", 3),
    "same joint name": (
        robot(
            LINKS, '<link name="c"/>', JOINT, JOINT.replace('"a"', '"b"', 1).replace('child link="b"', 'child link="c"')
        ),
        "GS764",
        5,
    ),
    "nothing moves": (robot(LINKS, JOINT.replace("revolute", "fixed")), "GS767", 1),
}


@pytest.mark.parametrize("kind", sorted(BROKEN))
def test_fault_gives_its_code_and_line_and_no_chain(tmp_path, kind):
    text, code, line = BROKEN[kind]
    chain, findings = read(tmp_path, text)
    assert chain is None
    errors = [f for f in findings if f.level is Severity.ERROR]
    assert [(f.code, f.span.file, f.span.line) for f in errors] == [(code, "arm.urdf", line)]
    assert code_of(code).remedy


def test_file_that_is_not_there(tmp_path):
    chain, findings = load_urdf(tmp_path / "no.urdf")
    assert chain is None and codes(findings) == ["GS760"]


def test_all_faults_are_reported_at_once(tmp_path):
    text = robot(LINKS, JOINT.replace('"-1"', '"x"').replace('"1"', '"y"').replace("revolute", "prismatic"))
    _, findings = read(tmp_path, text)
    assert codes(findings, Severity.ERROR) == ["GS765", "GS765"]


@pytest.mark.parametrize(
    "joint",
    [
        JOINT.replace(LIMIT, ""),
        JOINT.replace('lower="-1" upper="1"', ""),
        JOINT.replace('velocity="2"', ""),
        JOINT.replace('velocity="2"', 'velocity="0"'),
    ],
)
def test_missing_limits_are_a_warning_and_count_as_unlimited(tmp_path, joint):
    chain, findings = read(tmp_path, robot(LINKS, joint))
    assert codes(findings, Severity.WARNING) == ["GS763"]
    joints = chain.driven_joints
    assert np.isinf(joints.upper[0]) or np.isinf(joints.speed[0])


MESH = (
    '<link name="a"><visual><geometry><mesh filename="{}" scale="0.001 0.001 0.001"/></geometry></visual></link>'
    '<link name="b"/>'
)


def test_mesh_beside_the_urdf_and_in_a_package(tmp_path):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "a.stl").write_bytes(b"")
    for name in ("meshes/a.stl", "package://arm/a.stl"):
        chain, findings = read(tmp_path, robot(MESH.format(name), JOINT), packages={"arm": tmp_path / "meshes"})
        assert codes(findings, Severity.WARNING) == []
        (shape,) = chain.shapes()
        file = shape.placed.solid.source
        assert file.scale == (0.001,) * 3
        assert (
            [p.resolve() for p in chain.files] == [(tmp_path / "meshes" / "a.stl").resolve()] == [file.path.resolve()]
        )


def test_missing_mesh_names_line_and_path_tried(tmp_path):
    chain, findings = read(tmp_path, robot("<!-- -->", MESH.format("meshes/no.stl"), JOINT))
    assert chain is None
    (finding,) = [f for f in findings if f.code == "GS761"]
    assert finding.span.line == 3
    assert "tried `meshes/no.stl`" in finding.message


def test_unknown_package_names_those_that_are_known(tmp_path):
    _, findings = read(tmp_path, robot(MESH.format("package://x/a.stl"), JOINT), packages={"arm": tmp_path})
    (finding,) = [f for f in findings if f.code == "GS761"]
    assert "`x`" in finding.message and "`arm`" in finding.hint


def test_mesh_outside_the_folders_that_may_be_read(tmp_path):
    (tmp_path / "secret.stl").write_bytes(b"")
    inner = tmp_path / "cell"
    inner.mkdir()
    _, findings = read(
        inner,
        robot(MESH.format("../secret.stl"), JOINT),
        may_read=lambda p: p.resolve().is_relative_to(inner.resolve()),
    )
    assert codes(findings, Severity.ERROR) == ["GS762"]


def test_latin_1_with_its_declaration(tmp_path):
    text = ("<?xml version='1.0' encoding='ISO-8859-1'?>\n" + robot("<!-- Stäubli -->", LINKS, JOINT)).encode("latin-1")
    chain, _ = read(tmp_path, text)
    assert chain is not None
