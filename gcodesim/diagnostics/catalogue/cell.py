"""Findings GS7xx."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = ()

# robot descriptions (URDF)
CODES += (
    Code(
        code="GS760",
        severity=Severity.ERROR,
        title="The robot description cannot be read",
        what="The file that `urdf:` names is missing, is not well-formed XML, or is not a URDF.",
        why="Without a description there is no robot that could move.",
        remedy="Check the path and the line named here. A xacro template has to be expanded first: `xacro FILE > robot.urdf`.",
    ),
    Code(
        code="GS761",
        severity=Severity.ERROR,
        title="A mesh of the robot is missing",
        what="A <mesh> names a file that is not there, or a package whose folder is not known.",
        why="The link would be invisible and would collide with nothing.",
        remedy="Correct the file name, or name the folder of a package:// address under `packages:` in the cell.",
    ),
    Code(
        code="GS762",
        severity=Severity.ERROR,
        title="A mesh lies outside the folders that may be read",
        what="A <mesh> names a file outside the cell's folder, its `packages:` and the folders of --allow-path.",
        why="A description from elsewhere must not make gcodesim read any file of this machine.",
        remedy="Move the mesh beside the cell, or allow its folder with --allow-path.",
    ),
    Code(
        code="GS763",
        severity=Severity.WARNING,
        title="A joint has no limits",
        what="A joint has no <limit>, an empty travel, or no speed; what is missing counts as unlimited.",
        why="The program may drive the joint where, or as fast as, the real one cannot go, and nothing would say so.",
        remedy='Write `<limit lower="…" upper="…" velocity="…" effort="…"/>` from the data sheet; rad, m, rad/s, N·m.',
    ),
    Code(
        code="GS764",
        severity=Severity.ERROR,
        title="Links and joints make no tree",
        what="A joint names a link that is not there, two joints hold one link, a name is used twice, or there is not one root.",
        why="The pose of the flange is defined only by one unbroken chain from one base.",
        remedy="Correct the `parent` and `child` of the joints; every link but the base is the child of exactly one joint.",
    ),
    Code(
        code="GS765",
        severity=Severity.ERROR,
        title="A value in the robot description cannot be",
        what="An attribute is not a number or not as many numbers as it should be, a body is unknown, or an axis is zero.",
        why="Guessing a dimension would move the tool somewhere else than on the real robot.",
        remedy="Write plain decimal numbers in m, rad and kg, separated by spaces.",
    ),
    Code(
        code="GS766",
        severity=Severity.ERROR,
        title="A kind of joint that is not simulated",
        what="A joint is floating or planar, or follows another one inside the chain to the flange.",
        why="The flange would not go where the real one goes.",
        remedy="Describe the robot with revolute, continuous, prismatic and fixed joints, each driven by itself.",
    ),
    Code(
        code="GS767",
        severity=Severity.ERROR,
        title="Nothing in the robot description can move",
        what="All joints between the base and the flange are fixed.",
        why="A program needs at least one axis.",
        remedy="Check the joint types, and that a link named `tool0`, `flange` or `tcp` stands at the end of the arm.",
    ),
    Code(
        code="GS768",
        severity=Severity.NOTE,
        title="A joint stands still",
        what="A movable joint is not on the way from the base to the flange (a finger, a second arm); it stays at zero.",
        why="Its link is drawn and collides where it stands at zero.",
        remedy="Nothing, if that is meant; describe a gripper as a tool of its own.",
    ),
    Code(
        code="GS769",
        severity=Severity.NOTE,
        title="A moving link has no mass",
        what="A link that moves has no <inertial>, so joint efforts do not contain its weight and inertia.",
        why="Margins to the torque limits look better than they are.",
        remedy="Add <inertial> with mass, centre of mass and inertia from the maker or an estimate.",
    ),
)
