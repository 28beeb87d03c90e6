#!/usr/bin/env python3
"""Write the URDFs that ship with gcodesim: `python scripts/make_models.py` renews gcodesim/models/*.urdf.

Dimensions, limits, masses are facts of public robot descriptions and data
sheets, named in each model's `source`. Bodies are boxes and cylinders of our own
that lie within the bounding boxes of the real links. All frames are parallel to
the base frame at zero, so a joint is an offset and an axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).resolve().parent.parent / "gcodesim" / "models"
HALF_PI = math.pi / 2
INERTIA_ASSUMED = "inertia assumed: a solid box of the link's size"
MASS_ASSUMED = "mass and inertia assumed: the arm's mass shared out by size, solid boxes"

Vector = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]


class Axis(NamedTuple):
    """A joint: offset [m] from the one before, axis, travel [deg] or [m], speed per s, effort, acceleration in SI."""

    offset: Vector
    axis: Vector
    lower: float
    upper: float
    speed: float
    effort: float = 0.0
    acceleration: float = 0.0
    name: str = ""
    kind: str = "revolute"


class Block(NamedTuple):
    """A box between two corners [m], link axes."""

    low: Vector
    high: Vector


class Tube(NamedTuple):
    """A cylinder between two points [m], link axes."""

    start: Vector
    end: Vector
    radius: float


@dataclass(frozen=True, kw_only=True)
class Mass:
    """Mass [kg], centre [m], inertia about it (xx, yy, zz, xy, xz, yz) [kg·m²], and what of it is assumed."""

    mass: float
    centre: Vector
    inertia: Six
    remark: str = ""


@dataclass(frozen=True, kw_only=True)
class Model:
    """One URDF."""

    name: str
    source: str
    axes: tuple[Axis, ...]
    flange: Vector
    flange_rpy: Vector
    bodies: tuple[tuple[Block | Tube, ...], ...]  # base first
    masses: tuple[Mass, ...] = ()  # base first
    colour: tuple[float, float, float] = (0.9, 0.45, 0.1)
    table: tuple[Axis, ...] = ()  # joints on the work side
    table_bodies: tuple[tuple[Block | Tube, ...], ...] = ()


def box_mass(
    mass: float, low: Vector, high: Vector, centre: Vector | None = None, remark: str = INERTIA_ASSUMED
) -> Mass:
    """A solid box: m (b² + c²) / 12 about its middle."""
    a, b, c = (h - w for w, h in zip(low, high, strict=True))
    middle = tuple(round((w + h) / 2, 6) for w, h in zip(low, high, strict=True))
    inertia = (mass * (b * b + c * c) / 12, mass * (a * a + c * c) / 12, mass * (a * a + b * b) / 12, 0.0, 0.0, 0.0)
    return Mass(mass=mass, centre=centre or middle, inertia=tuple(float(f"{i:.4g}") for i in inertia), remark=remark)  # type: ignore[arg-type]


def shared_masses(total: float, boxes: list[tuple[Vector, Vector]]) -> tuple[Mass, ...]:
    """The mass of an arm shared out by the volumes of its links' boxes; for arms whose maker says nothing more."""
    volumes = [math.prod(h - w for w, h in zip(low, high, strict=True)) for low, high in boxes]
    return tuple(
        box_mass(float(f"{total * v / sum(volumes):.4g}"), low, high, remark=MASS_ASSUMED)
        for v, (low, high) in zip(volumes, boxes, strict=True)
    )


def n(value: float) -> str:
    """A number as text that reads back to the same bits; no −0."""
    return f"{value + 0.0:.17g}" if float(f"{value:.12g}") != value else f"{value + 0.0:.12g}"


def vector(values: tuple[float, ...]) -> str:
    return " ".join(n(v) for v in values)


def body_lines(body: Block | Tube, tag: str, material: str) -> list[str]:
    if isinstance(body, Block):
        middle = tuple((w + h) / 2 for w, h in zip(body.low, body.high, strict=True))
        size = tuple(h - w for w, h in zip(body.low, body.high, strict=True))
        origin, shape = f'xyz="{rounded(middle)}"', f'<box size="{rounded(size)}"/>'
    else:
        middle = tuple((s + e) / 2 for s, e in zip(body.start, body.end, strict=True))
        dx, dy, dz = (e - s for s, e in zip(body.start, body.end, strict=True))
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        pitch, yaw = math.atan2(math.hypot(dx, dy), dz), math.atan2(dy, dx)
        origin = f'xyz="{rounded(middle)}" rpy="0 {n(pitch)} {n(yaw)}"'
        shape = f'<cylinder radius="{n(body.radius)}" length="{rounded((length,))}"/>'
    paint = f'<material name="{material}"/>' if tag == "visual" else ""
    return [f"    <{tag}><origin {origin}/><geometry>{shape}</geometry>{paint}</{tag}>"]


def rounded(values: tuple[float, ...]) -> str:
    return " ".join(f"{round(v, 6) + 0.0:.6g}" for v in values)


def link_lines(name: str, bodies: tuple[Block | Tube, ...], mass: Mass | None, material: str) -> list[str]:
    lines = [f'  <link name="{name}">']
    if mass is not None:
        if mass.remark:
            lines.append(f"    <!-- {mass.remark} -->")
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        tensor = " ".join(f'{k}="{n(v)}"' for k, v in zip(keys, mass.inertia, strict=True))
        lines.append(
            f'    <inertial><origin xyz="{vector(mass.centre)}"/><mass value="{n(mass.mass)}"/>'
            f"<inertia {tensor}/></inertial>"
        )
    for tag in ("visual", "collision"):
        for body in bodies:
            lines += body_lines(body, tag, material)
    return [*lines, "  </link>"]


def joint_lines(axis: Axis, name: str, parent: str, child: str) -> list[str]:
    angular = axis.kind != "prismatic"
    lower, upper, speed = (math.radians(v) if angular else v for v in (axis.lower, axis.upper, axis.speed))
    travel = "" if axis.kind == "continuous" else f'lower="{n(lower)}" upper="{n(upper)}" '
    more = f' acceleration="{n(axis.acceleration)}"' if axis.acceleration else ""
    return [
        f'  <joint name="{name}" type="{axis.kind}">',
        f'    <parent link="{parent}"/><child link="{child}"/>',
        f'    <origin xyz="{vector(axis.offset)}"/><axis xyz="{vector(axis.axis)}"/>',
        f'    <limit {travel}velocity="{n(speed)}" effort="{n(axis.effort)}"{more}/>',
        "  </joint>",
    ]


def massless(name: str) -> list[str]:
    """A link that is a frame and no body."""
    zeros = " ".join(f'{key}="0"' for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    return [f'  <link name="{name}">', f'    <inertial><mass value="0"/><inertia {zeros}/></inertial>', "  </link>"]


def urdf(model: Model) -> str:
    """The URDF text of a model."""
    masses: list[Mass | None] = [*model.masses] or [None] * (len(model.axes) + 1)
    r, g, b = model.colour
    lines = [
        '<?xml version="1.0"?>',
        "<!-- Written by scripts/make_models.py; do not edit.",
        f"     {model.source}",
        "     Lengths m, angles rad. limit/acceleration is an extension of gcodesim; effort 0 means not known. -->",
        f'<robot name="{model.name}">',
        f'  <material name="paint"><color rgba="{r} {g} {b} 1"/></material>',
        '  <material name="metal"><color rgba="0.35 0.36 0.38 1"/></material>',
        *link_lines("base", model.bodies[0], masses[0], "metal"),
    ]
    parent = "base"
    for index, axis in enumerate(model.axes, start=1):
        name, child = axis.name or f"joint_{index}", f"link_{axis.name or index}"
        last = index == len(model.axes)
        lines += link_lines(child, model.bodies[index], masses[index], "metal" if last else "paint")
        lines += joint_lines(axis, name, parent, child)
        parent = child
    lines += [
        "  <!-- a mass of 0 is written because some readers take 1 kg where nothing is said -->",
        *massless("flange"),
        '  <joint name="flange" type="fixed">',
        f'    <parent link="{parent}"/><child link="flange"/>',
        f'    <origin xyz="{vector(model.flange)}" rpy="{vector(model.flange_rpy)}"/>',
        "  </joint>",
    ]
    if not model.axes[0].name:  # arms: the name by which other programs look for the same frame
        lines += [
            *massless("tool0"),
            '  <joint name="tool0" type="fixed"><parent link="flange"/><child link="tool0"/></joint>',
        ]
    parent = "base"
    for index, axis in enumerate(model.table):
        child = "table" if index == len(model.table) - 1 else f"link_{axis.name}"
        mass = model.masses[len(model.axes) + 1 + index] if model.masses else None
        lines += link_lines(child, model.table_bodies[index], mass, "metal")
        lines += joint_lines(axis, axis.name, parent, child)
        parent = child
    return "\n".join([*lines, "</robot>", ""])


X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_X, _Y, _Z = (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)
ORIGIN = (0.0, 0.0, 0.0)
KUKA_ORANGE = (0.95, 0.42, 0.08)

_KR10_BODIES = (
    (Tube((0, 0, 0), (0, 0, 0.249), 0.11), Block((-0.384, -0.09, 0), (-0.06, 0.09, 0.16))),
    (Tube((0, 0, -0.15), (0, 0, 0.03), 0.11), Tube((0.025, -0.135, 0), (0.025, 0.12, 0), 0.085)),
    (
        Tube((0, -0.125, 0), (0, 0.125, 0), 0.09),
        Block((0.04, -0.07, -0.06), (0.52, 0.07, 0.06)),
        Tube((0.56, -0.115, 0), (0.56, 0.115, 0), 0.07),
    ),
    (Tube((0, -0.07, 0), (0, 0.065, 0), 0.08), Tube((0.02, 0, 0.025), (0.203, 0, 0.025), 0.06)),
    (
        Tube((0.203, 0, 0), (0.44, 0, 0), 0.058),
        Block((0.42, -0.08, -0.045), (0.56, -0.05, 0.045)),
        Block((0.42, 0.05, -0.045), (0.56, 0.08, 0.045)),
    ),
    (Tube((0, -0.049, 0), (0, 0.049, 0), 0.044), Tube((0.02, 0, 0), (0.067, 0, 0), 0.04)),
    (Tube((0.067, 0, 0), (0.09, 0, 0), 0.042),),
)
_KR10_INERTIAS: tuple[tuple[float, Vector, Six], ...] = (
    (16.916, (-0.0371, 0, 0.1086), (0.115, 0.185, 0.156, -0.000388, -0.0171, -0.00048)),
    (8.416, (0.0064, 0.0163, -0.0854), (0.11, 0.0841, 0.0797, 0.00068, 0.0043, 0.00727)),
    (17.837, (0.1912, 0.0155, 0.0047), (0.0928, 0.875, 0.916, 0.0208, -0.00696, -0.000256)),
    (6.075, (0.0439, 0.0182, 0.0125), (0.0194, 0.0446, 0.0494, 0.00292, 0.00216, 0.00091)),
    (5.162, (0.337, 0.0086, 0.0013), (0.0124, 0.0846, 0.0874, 0.00227, -0.00164, -7.98e-05)),
    (1.613, (0.0093, 0.024, -0.0008), (0.00201, 0.00194, 0.00247, 0.000241, 1.82e-05, -1.04e-05)),
    (0.734, (0.0733, 0, 0), (0.000296, 0.000183, 0.000182, -6.82e-21, -1.39e-20, 5e-07)),
)
_KR10_MASSES = tuple(Mass(mass=m, centre=c, inertia=i) for m, c, i in _KR10_INERTIAS)

KR10 = Model(
    name="kuka_kr10_r1100_2",
    source="KUKA KR 10 R1100-2: kinematics, masses, limits as in kuka_agilus_support, kroshu/kuka_robot_descriptions.",
    colour=KUKA_ORANGE,
    axes=(
        Axis((0, 0, 0.4), _Z, -170, 170, 300, 288.4, 10.065),
        Axis((0.025, 0, 0), Y, -190, 45, 225, 312.0, 1.725),
        Axis((0.56, 0, 0), Y, -120, 156, 330, 119.8, 2.686),
        Axis((0, 0, 0.025), _X, -185, 185, 360, 46.1, 56.49),
        Axis((0.515, 0, 0), Y, -120, 120, 360, 41.6, 49.23),
        Axis(ORIGIN, _X, -350, 350, 433, 28.0, 125.45),
    ),
    flange=(0.09, 0, 0),
    flange_rpy=(0, HALF_PI, 0),
    bodies=_KR10_BODIES,
    masses=_KR10_MASSES,
)

KR10_SIXX = Model(
    name="kuka_kr10_r1100_sixx",
    source="KUKA KR 10 R1100 sixx: kinematics and limits as in kuka_kr10_support of ros-industrial/kuka_experimental; "
    "bodies and masses of its successor.",
    colour=KUKA_ORANGE,
    axes=(
        Axis((0, 0, 0.4), _Z, -170, 170, 300),
        Axis((0.025, 0, 0), Y, -190, 45, 225),
        Axis((0.56, 0, 0), Y, -120, 156, 225),
        Axis((0, 0, 0.035), _X, -185, 185, 381),
        Axis((0.515, 0, 0), Y, -120, 120, 311),
        Axis(ORIGIN, _X, -350, 350, 492),
    ),
    flange=(0.08, 0, 0),
    flange_rpy=(0, HALF_PI, 0),
    bodies=(*_KR10_BODIES[:6], (Tube((0.06, 0, 0), (0.08, 0, 0), 0.042),)),
    masses=tuple(
        Mass(
            mass=m.mass,
            centre=m.centre,
            inertia=m.inertia,
            remark="assumed: mass and inertia of the KR 10 R1100-2",
        )
        for m in _KR10_MASSES
    ),
)

KR210 = Model(
    name="kuka_kr210_r2700_2",
    source="KUKA KR 210 R2700-2: kinematics, masses, limits as in kuka_quantec_support of "
    "kroshu/kuka_robot_descriptions; centres of mass corrected by those of the KR 240 R2900-2.",
    colour=KUKA_ORANGE,
    axes=(
        Axis((0, 0, 0.645), _Z, -185, 185, 116.8, 7290, 1.983),
        Axis((0.33, 0, 0), Y, -140, -5, 111.4, 8910, 1.263),
        Axis((1.15, 0, 0), Y, -120, 168, 112, 6988.8, 2.565),
        Axis((0, 0, 0.115), _X, -350, 350, 179, 2274.3, 7.039),
        Axis((1.22, 0, 0), Y, -125, 125, 172, 1398.3, 1.764),
        Axis(ORIGIN, _X, -350, 350, 220, 781.6, 1.873),
    ),
    flange=(0.215, 0, 0),
    flange_rpy=(0, HALF_PI, 0),
    bodies=(
        (Tube((0, 0, 0), (0, 0, 0.342), 0.36), Block((-0.744, -0.3, 0), (-0.2, 0.3, 0.25))),
        (
            Tube((0, 0, -0.3), (0, 0, -0.05), 0.36),
            Block((-0.1, -0.36, -0.25), (0.5, -0.16, 0.17)),
            Tube((0.33, -0.35, 0), (0.33, -0.05, 0), 0.17),
        ),
        (
            Tube((0, -0.39, 0), (0, 0.01, 0), 0.19),
            Block((0.05, -0.35, -0.13), (1.1, -0.13, 0.13)),
            Tube((1.15, -0.39, 0), (1.15, 0.01, 0), 0.17),
        ),
        (
            Tube((0, -0.13, 0), (0, 0.19, 0), 0.138),
            Block((-0.39, -0.16, 0.0), (0.1, 0.16, 0.25)),
            Tube((0, 0, 0.115), (0.86, 0, 0.115), 0.13),
        ),
        (
            Tube((0.868, 0, 0), (1.09, 0, 0), 0.1),
            Block((1.05, -0.1, -0.09), (1.304, -0.06, 0.09)),
            Block((1.05, 0.06, -0.09), (1.304, 0.1, 0.09)),
        ),
        (Tube((0, -0.12, 0), (0, 0.16, 0), 0.1), Tube((0.05, 0, 0), (0.17, 0, 0), 0.08)),
        (Tube((0.17, 0, 0), (0.213, 0, 0), 0.065),),
    ),
    masses=(
        box_mass(225.96, (-0.744, -0.42, 0), (0.366, 0.42, 0.342), (-0.0595, 0.0022, 0.2033)),
        box_mass(363.07, (-0.527, -0.37, -0.419), (0.51, 0.268, 0.178), (0.029, -0.012, -0.105)),
        box_mass(232.06, (-0.194, -0.402, -0.202), (1.32, 0.019, 0.268), (0.487, -0.19, 0.002)),
        box_mass(190.33, (-0.399, -0.361, -0.138), (0.878, 0.196, 0.257), (0.174, -0.039, 0.076)),
        box_mass(42.412, (0.868, -0.1, -0.1), (1.304, 0.1, 0.1), (1.026, 0.019, 0)),
        box_mass(16.992, (-0.103, -0.121, -0.104), (0.193, 0.167, 0.103), (0.062, 0.041, 0)),
        box_mass(6.6, (0.17, -0.065, -0.065), (0.213, 0.065, 0.065), (0.195, 0, 0)),
    ),
)

_WRIST = 0.06  # radius of the UR10e's wrist links [m], own estimate like its other radii
UR10E = Model(
    name="ur10e",
    source="Universal Robots UR10e in the controller's base frame: kinematics, masses and limits as in "
    "UniversalRobots/Universal_Robots_ROS2_Description config/ur10e.",
    colour=(0.7, 0.74, 0.78),
    axes=(
        Axis(ORIGIN, Z, -360, 360, 120, 330),
        Axis((0, 0, 0.1807), _Y, -360, 360, 120, 330),
        Axis((-0.6127, 0, 0), _Y, -360, 360, 180, 150),
        Axis((-0.57155, 0, 0), _Y, -360, 360, 180, 54),
        Axis((0, -0.17415, 0), _Z, -360, 360, 180, 54),
        Axis((0, 0, -0.11985), _Y, -360, 360, 180, 54),
    ),
    flange=(0, -0.11655, 0),
    flange_rpy=(HALF_PI, 0, 0),
    bodies=(
        (Tube(ORIGIN, (0, 0, 0.08), 0.095),),
        (Tube((0, 0, 0.085), (0, 0, 0.27), 0.09), Tube((0, 0, 0.1807), (0, -0.11, 0.1807), 0.085)),
        (
            Tube((0, -0.1, 0), (0, -0.26, 0), 0.085),
            Tube((0, -0.176, 0), (-0.6127, -0.176, 0), 0.07),
            Tube((-0.6127, -0.1, 0), (-0.6127, -0.25, 0), 0.072),
        ),
        (
            # 0.137 back from the upper arm, which is 0.176 to the side; wrist 1 goes out to 0.174 again
            Tube((0, -0.112, 0), (0, 0.03, 0), 0.068),
            Tube((0, -0.039, 0), (-0.57155, -0.039, 0), 0.055),
            Tube((-0.57155, -0.09, 0), (-0.57155, 0.02, 0), 0.058),
        ),
        (Tube((0, -0.08, 0), (0, -0.23, 0), 0.055), Tube((0, -0.17415, 0), (0, -0.17415, -0.055), 0.055)),
        (Tube((0, 0, -0.06), (0, 0, -0.175), 0.055), Tube((0, 0, -0.11985), (0, -0.06, -0.11985), 0.055)),
        (Tube((0, -0.06, 0), (0, -0.11655, 0), 0.045),),
    ),
    masses=(
        box_mass(
            4.0, (-0.095, -0.095, 0), (0.095, 0.095, 0.08), remark="mass doubted by its source; " + INERTIA_ASSUMED
        ),
        box_mass(7.369, (-0.085, -0.095, 0.085), (0.085, 0.085, 0.27), (0.021, -0.027, 0.1807)),
        box_mass(13.051, (-0.68, -0.25, -0.075), (0.08, -0.1, 0.075), (-0.2327, -0.158, 0)),
        box_mass(3.989, (-0.63, -0.105, -0.06), (0.06, 0.025, 0.06), (-0.33155, -0.068, 0)),
        box_mass(2.1, (-_WRIST, -0.23, -_WRIST), (_WRIST, -0.1, _WRIST), (0, -0.18115, -0.018)),
        box_mass(1.98, (-_WRIST, -_WRIST, -0.175), (_WRIST, _WRIST, -0.055), (0, -0.018, -0.11285)),
        box_mass(0.615, (-0.045, -0.11655, -0.045), (0.045, -0.06, 0.045), (0, -0.09055, 0)),
    ),
)

IRB1200 = Model(
    name="abb_irb1200_5_90",
    source="ABB IRB 1200-5/0.9: kinematics, masses, limits as in abb_irb1200_support, ros-industrial/abb_experimental.",
    colour=(0.9, 0.9, 0.88),
    axes=(
        Axis((0, 0, 0.3991), Z, -170, 170, 288),
        Axis(ORIGIN, Y, -100, 130, 240),
        Axis((0, 0, 0.448), Y, -200, 70, 300),
        Axis((0, 0, 0.042), X, -270, 270, 400),
        Axis((0.451, 0, 0), Y, -130, 130, 405),
        Axis(ORIGIN, X, -360, 360, 600),
    ),
    flange=(0.082, 0, 0),
    flange_rpy=(0, HALF_PI, 0),
    bodies=(
        (Tube(ORIGIN, (0, 0, 0.19), 0.1), Block((-0.22, -0.09, 0), (0, 0.09, 0.13))),
        (Tube((0, 0, -0.2), (0, 0, 0), 0.1), Tube((0, -0.1, 0), (0, 0.1, 0), 0.09)),
        (
            Tube((0, -0.095, 0), (0, 0.095, 0), 0.088),
            Block((-0.075, -0.085, 0.04), (0.075, 0.085, 0.4)),
            Tube((0, -0.09, 0.448), (0, 0.09, 0.448), 0.075),
        ),
        (Tube((0, -0.07, 0), (0, 0.07, 0), 0.07), Tube((0, 0, 0.042), (0.22, 0, 0.042), 0.065)),
        (Tube((0.22, 0, 0), (0.39, 0, 0), 0.05), Block((0.37, -0.055, -0.035), (0.48, -0.035, 0.035))),
        (Tube((0, -0.035, 0), (0, 0.035, 0), 0.036), Tube((0.02, 0, 0), (0.068, 0, 0), 0.03)),
        (Tube((0.068, 0, 0), (0.082, 0, 0), 0.025),),
    ),
    masses=(
        box_mass(13.774, (-0.22, -0.1, 0), (0.1, 0.1, 0.19), (-0.029, 0.0006, 0.1127)),
        box_mass(11.842, (-0.1, -0.1, -0.2), (0.1, 0.1, 0.09), (0.0009, -0.0006, -0.0629)),
        box_mass(17.539, (-0.085, -0.095, -0.088), (0.085, 0.095, 0.523), (-0.0009, -0.0005, 0.2501)),
        box_mass(7.464, (-0.07, -0.07, -0.07), (0.22, 0.07, 0.107), (0.0996, 0.0011, 0.0323)),
        box_mass(2.744, (0.22, -0.055, -0.05), (0.48, 0.05, 0.05), (0.3817, 0.0013, 0.0052)),
        box_mass(0.63, (-0.036, -0.035, -0.036), (0.068, 0.035, 0.036), (0.0112, -0.0011, 0.0001)),
        box_mass(0.137, (0.068, -0.025, -0.025), (0.082, 0.025, 0.025), (0.0749, -0.0002, 0)),
    ),
)

_IRB6700_BOXES = [
    ((-0.627, -0.36, 0.0), (0.377, 0.36, 0.373)),
    ((-0.411, -0.456, -0.565), (0.531, 0.355, 0.235)),
    ((-0.259, -0.425, -0.185), (0.241, -0.08, 1.283)),
    ((-0.28, -0.271, -0.174), (0.234, 0.315, 0.371)),
    ((-0.277, -0.198, -0.132), (1.282, 0.193, 0.132)),
    ((-0.168, -0.1, -0.109), (0.165, 0.1, 0.095)),
    ((0.164, -0.1, -0.1), (0.2, 0.1, 0.1)),
]
IRB6700 = Model(
    name="abb_irb6700_200_260",
    source="ABB IRB 6700-200/2.60: kinematics and limits as in abb_irb6700_support of ros-industrial/abb_experimental.",
    colour=(0.95, 0.5, 0.15),
    axes=(
        Axis((0, 0, 0.78), Z, -170, 170, 110),
        Axis((0.32, 0, 0), Y, -65, 85, 110),
        Axis((0, 0, 1.125), Y, -180, 70, 110),
        Axis((0, 0, 0.2), X, -300, 300, 190),
        Axis((1.1425, 0, 0), Y, -130, 130, 150),
        Axis(ORIGIN, X, -360, 360, 210),
    ),
    flange=(0.2, 0, 0),
    flange_rpy=(0, HALF_PI, 0),
    bodies=(
        (Tube(ORIGIN, (0, 0, 0.25), 0.36), Block((-0.62, -0.3, 0), (-0.1, 0.3, 0.25))),
        (
            Tube((0, 0, -0.53), (0, 0, -0.2), 0.35),
            Block((-0.1, -0.1, -0.3), (0.5, 0.3, 0.2)),
            Tube((0.32, -0.1, 0), (0.32, 0.35, 0), 0.2),
        ),
        (
            Tube((0, -0.42, 0), (0, -0.09, 0), 0.18),
            Block((-0.13, -0.38, 0), (0.13, -0.14, 1.125)),
            Tube((0, -0.42, 1.125), (0, -0.09, 1.125), 0.155),
        ),
        (Tube((0, -0.1, 0), (0, 0.31, 0), 0.17), Block((-0.25, -0.2, 0.03), (0.2, 0.25, 0.36))),
        (
            Tube((-0.27, 0, 0), (1.0, 0, 0), 0.125),
            Block((0.95, -0.19, -0.11), (1.27, -0.11, 0.11)),
            Block((0.95, 0.11, -0.11), (1.27, 0.19, 0.11)),
        ),
        (Tube((0, -0.1, 0), (0, 0.1, 0), 0.1), Tube((0.03, 0, 0), (0.164, 0, 0), 0.085)),
        (Tube((0.164, 0, 0), (0.2, 0, 0), 0.1),),
    ),
    masses=shared_masses(1250.0, _IRB6700_BOXES),
)

_M20_BOXES = [
    ((-0.19, -0.17, 0.0), (0.173, 0.173, 0.322)),
    ((-0.164, -0.163, -0.217), (0.264, 0.252, 0.117)),
    ((-0.128, -0.277, -0.128), (0.128, -0.062, 0.872)),
    ((-0.095, -0.115, -0.08), (0.358, 0.154, 0.353)),
    ((0.224, -0.119, -0.075), (0.91, 0.055, 0.075)),
    ((-0.065, -0.056, -0.062), (0.086, 0.056, 0.062)),
    ((0.061, -0.031, -0.031), (0.1, 0.031, 0.031)),
]
M20IA = Model(
    name="fanuc_m20ia",
    source="FANUC M-20iA: kinematics and limits as in fanuc_m20ia_support of ros-industrial/fanuc.",
    colour=(0.95, 0.8, 0.1),
    axes=(
        Axis((0, 0, 0.525), Z, -170, 170, 195),
        Axis((0.15, 0, 0), Y, -100, 160, 175),
        Axis((0, 0, 0.79), _Y, -185, 273.12, 180),
        Axis((0, 0, 0.25), _X, -200, 200, 360),
        Axis((0.835, 0, 0), _Y, -140, 140, 360),
        Axis(ORIGIN, _X, -270, 270, 550),
    ),
    flange=(0.1, 0, 0),
    flange_rpy=(math.pi, -HALF_PI, 0),
    bodies=(
        (Tube(ORIGIN, (0, 0, 0.31), 0.165),),
        (
            Tube((0, 0, -0.21), (0, 0, -0.05), 0.16),
            Block((-0.05, -0.06, -0.15), (0.25, 0.2, 0.1)),
            Tube((0.15, -0.06, 0), (0.15, 0.24, 0), 0.11),
        ),
        (
            Tube((0, -0.27, 0), (0, -0.065, 0), 0.12),
            Block((-0.08, -0.23, 0), (0.08, -0.09, 0.79)),
            Tube((0, -0.26, 0.79), (0, -0.065, 0.79), 0.08),
        ),
        (Tube((0, -0.1, 0), (0, 0.15, 0), 0.079), Block((-0.08, -0.09, 0.02), (0.25, 0.12, 0.34))),
        (Tube((0.224, 0, 0), (0.75, 0, 0), 0.055), Block((0.7, -0.11, -0.07), (0.9, -0.056, 0.07))),
        (Tube((0, -0.055, 0), (0, 0.055, 0), 0.06), Tube((0.02, 0, 0), (0.061, 0, 0), 0.04)),
        (Tube((0.061, 0, 0), (0.1, 0, 0), 0.031),),
    ),
    masses=shared_masses(250.0, _M20_BOXES),
)

_TX2_BOXES = [
    ((-0.195, -0.131, 0.0), (0.16, 0.131, 0.251)),
    ((-0.126, -0.125, -0.233), (0.17, 0.162, 0.12)),
    ((-0.123, 0.157, -0.124), (0.123, 0.294, 0.52)),
    ((-0.092, -0.105, -0.13), (0.092, 0.154, 0.156)),
    ((-0.088, -0.085, 0.151), (0.07, 0.085, 0.483)),
    ((-0.045, -0.039, -0.055), (0.043, 0.039, 0.089)),
    ((-0.04, -0.038, 0.085), (0.039, 0.039, 0.1)),
]
TX2 = Model(
    name="staubli_tx2_90",
    source="Staubli TX2-90: kinematics and limits as in staubli_tx2_90_support of ros-industrial/staubli_experimental.",
    colour=(0.93, 0.85, 0.45),
    axes=(
        Axis((0, 0, 0.478), Z, -180, 180, 265, 318),
        Axis((0.05, 0, 0), Y, -130, 147.5, 210, 166),
        Axis((0, 0.05, 0.425), Y, -145, 145, 315, 76),
        Axis(ORIGIN, Z, -270, 270, 450, 34),
        Axis((0, 0, 0.425), Y, -115, 140, 370, 29),
        Axis(ORIGIN, Z, -270, 270, 630, 11),
    ),
    flange=(0, 0, 0.1),
    flange_rpy=ORIGIN,
    bodies=(
        (Tube(ORIGIN, (0, 0, 0.245), 0.13), Block((-0.195, -0.09, 0), (-0.05, 0.09, 0.12))),
        (Tube((0, 0, -0.23), (0, 0, -0.03), 0.12), Tube((0.05, -0.12, 0), (0.05, 0.16, 0), 0.11)),
        (
            Tube((0, 0.16, 0), (0, 0.29, 0), 0.12),
            Block((-0.085, 0.17, 0), (0.085, 0.28, 0.425)),
            Tube((0, 0.16, 0.425), (0, 0.29, 0.425), 0.095),
        ),
        (Tube((0, -0.1, 0), (0, 0.105, 0), 0.092), Tube((0, 0, 0), (0, 0, 0.15), 0.085)),
        (
            Tube((0, 0, 0.151), (0, 0, 0.37), 0.075),
            Block((-0.045, -0.08, 0.33), (0.045, -0.042, 0.47)),
            Block((-0.045, 0.042, 0.33), (0.045, 0.08, 0.47)),
        ),
        (Tube((0, -0.038, 0), (0, 0.038, 0), 0.043), Tube((0, 0, 0.02), (0, 0, 0.085), 0.036)),
        (Tube((0, 0, 0.085), (0, 0, 0.1), 0.038),),
    ),
    # shared out by size, the arm could not carry itself: its shell is wide, its forearm light
    masses=tuple(
        box_mass(mass, low, high, remark="mass and inertia assumed: 114 kg, most of it near the base, solid boxes")
        for mass, (low, high) in zip((45.0, 25.0, 22.0, 12.0, 6.0, 3.0, 1.0), _TX2_BOXES, strict=True)
    ),
)

LATHE = Model(
    name="lathe_xz",
    source="A typical two-axis lathe, nobody's product; base M on the spindle nose, work turns about Z at X0.",
    colour=(0.75, 0.78, 0.82),
    axes=(
        Axis(ORIGIN, X, -0.03, 0.25, 0.25, 0.0, 3.0, "X", "prismatic"),
        Axis(ORIGIN, Z, 0.0, 1.1, 0.4, 0.0, 3.0, "Z", "prismatic"),
    ),
    flange=ORIGIN,
    flange_rpy=(math.pi, 0, 0),
    bodies=(
        (
            Block((-0.35, -0.2, -0.5), (0.2, 0.2, -0.06)),
            Tube((0, 0, -0.06), (0, 0, 0), 0.08),
            Block((-0.35, -0.2, -0.5), (-0.25, 0.2, 1.2)),
        ),
        (Block((0.16, -0.06, 0.12), (0.24, 0.06, 1.2)),),
        (Block((0.03, -0.06, 0.0), (0.16, 0.06, 0.12)),),
    ),
    masses=(
        box_mass(1800.0, (-0.35, -0.2, -0.5), (0.2, 0.2, 1.2), remark="mass and inertia assumed"),
        box_mass(150.0, (0.16, -0.06, 0.12), (0.24, 0.06, 1.2)),
        box_mass(80.0, (0.03, -0.06, 0.0), (0.16, 0.06, 0.12)),
    ),
)

LATHE_C = Model(
    name="lathe_xyzc",
    source="A typical lathe with a C axis, a Y axis and driven tools, nobody's product; base M on the spindle nose.",
    colour=(0.75, 0.78, 0.82),
    axes=(
        Axis(ORIGIN, X, -0.05, 0.25, 0.25, 0.0, 3.0, "X", "prismatic"),
        Axis(ORIGIN, Y, -0.05, 0.05, 0.2, 0.0, 3.0, "Y", "prismatic"),
        Axis(ORIGIN, Z, 0.0, 1.1, 0.4, 0.0, 3.0, "Z", "prismatic"),
    ),
    flange=ORIGIN,
    flange_rpy=(math.pi, 0, 0),
    bodies=(
        (
            Block((-0.4, -0.25, -0.5), (0.2, 0.25, -0.06)),
            Block((-0.4, -0.25, -0.5), (-0.3, 0.25, 1.2)),
        ),
        (Block((0.2, -0.11, 0.12), (0.28, 0.11, 1.2)),),
        (Block((0.16, -0.06, 0.12), (0.2, 0.06, 0.5)),),
        (Block((0.03, -0.06, 0.0), (0.16, 0.06, 0.12)),),
    ),
    table=(Axis(ORIGIN, Z, 0, 0, 600, 0.0, math.radians(3000), "C", "continuous"),),
    table_bodies=((Tube((0, 0, -0.06), ORIGIN, 0.08),),),
    masses=(
        box_mass(2000.0, (-0.4, -0.25, -0.5), (0.2, 0.25, 1.2), remark="mass and inertia assumed"),
        box_mass(200.0, (0.2, -0.11, 0.12), (0.28, 0.11, 1.2), remark="mass and inertia assumed"),
        box_mass(60.0, (0.16, -0.06, 0.12), (0.2, 0.06, 0.5), remark="mass and inertia assumed"),
        box_mass(80.0, (0.03, -0.06, 0.0), (0.16, 0.06, 0.12), remark="mass and inertia assumed"),
        box_mass(60.0, (-0.08, -0.08, -0.06), (0.08, 0.08, 0.0), remark="mass and inertia assumed"),
    ),
)

GANTRY = Model(
    name="gantry_xyz",
    source="A typical three-axis router, nobody's product; base M at the travel corner, flange on the spindle nose.",
    colour=(0.75, 0.78, 0.82),
    axes=(
        Axis(ORIGIN, X, 0, 1.2, 0.5, 0.0, 3.0, "X", "prismatic"),
        Axis(ORIGIN, Y, 0, 0.8, 0.5, 0.0, 3.0, "Y", "prismatic"),
        Axis(ORIGIN, Z, -0.4, 0, 0.25, 0.0, 2.0, "Z", "prismatic"),
    ),
    flange=ORIGIN,
    flange_rpy=(math.pi, 0, 0),
    bodies=(
        (Block((-0.35, -0.2, -0.9), (1.35, 1.0, -0.75)),),
        (
            Block((-0.25, -0.2, -0.75), (-0.13, -0.15, 0.3)),
            Block((-0.25, 0.95, -0.75), (-0.13, 1.0, 0.3)),
            Block((-0.25, -0.2, 0.1), (-0.13, 1.0, 0.3)),
        ),
        (Block((-0.13, -0.08, 0.05), (-0.06, 0.08, 0.4)),),
        (Block((-0.06, -0.06, 0.08), (0.0, 0.06, 0.35)), Tube((0, 0, 0), (0, 0, 0.35), 0.045)),
    ),
    masses=(
        box_mass(600.0, (-0.35, -0.2, -0.9), (1.35, 1.0, -0.75), remark="mass and inertia assumed"),
        box_mass(120.0, (-0.25, -0.2, -0.75), (-0.13, 1.0, 0.3)),
        box_mass(45.0, (-0.13, -0.08, 0.05), (-0.06, 0.08, 0.4)),
        box_mass(20.0, (-0.06, -0.06, 0.0), (0.045, 0.06, 0.35)),
    ),
)

TRUNNION = Model(
    name="mill_xyzac_trunnion",
    source="A typical small five-axis mill with tilting rotary table, nobody's product; base M at the table face.",
    colour=(0.75, 0.78, 0.82),
    axes=(
        Axis(ORIGIN, X, -0.25, 0.25, 0.5, 0.0, 4.0, "X", "prismatic"),
        Axis(ORIGIN, Y, -0.2, 0.2, 0.5, 0.0, 4.0, "Y", "prismatic"),
        Axis(ORIGIN, Z, 0.0, 0.4, 0.5, 0.0, 3.0, "Z", "prismatic"),
    ),
    flange=ORIGIN,
    flange_rpy=(math.pi, 0, 0),
    bodies=(
        (Block((-0.5, -0.4, -0.5), (0.5, 0.9, -0.35)), Block((-0.35, 0.65, -0.35), (0.35, 0.9, 0.9))),
        (Block((-0.2, 0.55, 0.35), (0.2, 0.65, 0.85)),),
        (Block((-0.12, 0.1, 0.4), (0.12, 0.55, 0.8)),),
        (Block((-0.09, -0.09, 0.15), (0.09, 0.1, 0.55)), Tube(ORIGIN, (0, 0, 0.15), 0.045)),
    ),
    table=(
        Axis((0, 0.02, -0.06), X, -120, 120, 150, 0.0, math.radians(300), "A"),
        Axis((0, -0.02, 0.06), Z, 0, 0, 300, 0.0, math.radians(600), "C", "continuous"),
    ),
    table_bodies=(
        (
            Block((-0.2, -0.12, -0.06), (0.2, 0.08, 0.015)),
            Tube((-0.3, 0, 0), (-0.2, 0, 0), 0.06),
            Tube((0.2, 0, 0), (0.3, 0, 0), 0.06),
        ),
        (Tube((0, 0, -0.04), ORIGIN, 0.1),),
    ),
    masses=(
        box_mass(1500.0, (-0.5, -0.4, -0.5), (0.5, 0.9, -0.35), remark="mass and inertia assumed"),
        box_mass(150.0, (-0.2, 0.55, 0.35), (0.2, 0.65, 0.85), remark="mass and inertia assumed"),
        box_mass(120.0, (-0.12, 0.1, 0.4), (0.12, 0.55, 0.8), remark="mass and inertia assumed"),
        box_mass(60.0, (-0.09, -0.09, 0.0), (0.09, 0.1, 0.55), remark="mass and inertia assumed"),
        box_mass(40.0, (-0.2, -0.12, -0.06), (0.2, 0.08, 0.015), remark="mass and inertia assumed"),
        box_mass(10.0, (-0.1, -0.1, -0.04), (0.1, 0.1, 0.0), remark="mass and inertia assumed"),
    ),
)

MODELS = (KR10, KR210, UR10E, GANTRY, LATHE, LATHE_C, IRB1200, IRB6700, M20IA, TX2, KR10_SIXX, TRUNNION)


def main() -> None:
    FOLDER.mkdir(parents=True, exist_ok=True)
    for model in MODELS:
        (FOLDER / f"{model.name}.urdf").write_text(urdf(model), encoding="utf-8")


if __name__ == "__main__":
    main()
