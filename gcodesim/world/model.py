"""The one multibody that Bullet gets: robot and tool merged, without fixed joints.

A link of the model is everything that one driven joint carries, the tool
included; its mass properties are the sum of what rides on it. So a robot with j
joints has j links with any tool, there is nothing between flange and tool that
could give, and Bullet walks no link more than it needs. Inertias are written
about their principal axes, because Bullet only keeps those.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final
from xml.etree import ElementTree as ET

import numpy as np

from gcodesim.arithmetic.elementary import atan2
from gcodesim.arithmetic.matrices import determinant, multiplied, principal_axes
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Inertial
from gcodesim.kinematics.dynamics import bodies
from gcodesim.world.payload import payload_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from gcodesim.world.body import ToolBody

# a joint that carries no mass has no equation of motion; this much is no burden for any motor, and enough for
# the solver to hold a cutting force (with a hundredth of it an arm yielded by 2 mm) [kg], [kg·m²]
LEAST_MASS: Final = 1e-2
LEAST_INERTIA: Final = 1e-5
NOTHING: Final = Inertial(mass=0.0, com=np.zeros(3), inertia=np.zeros((3, 3)))


def principal(inertia: Array) -> tuple[Array, Array]:
    """Moments (3,) of an inertia (3, 3), and the rotation matrix whose columns are its principal axes."""
    moments, axes = principal_axes(inertia)
    if determinant(axes) < 0.0:
        axes[:, 2] = -axes[:, 2]
    return moments, axes


@frozen(eq=False)
class BulletModel:
    """A URDF for Bullet, with links and joints named by place in the joint vector.

    `carrier` is the joint whose link has the flange, and the tip at `p_LT` (3,)
    [m] of that link; -1 when the flange is on the base, where no motor feels it.
    """

    text: str
    carrier: int
    p_LT: Array


def merged_model(chain: Chain, tool: ToolBody | None) -> BulletModel:
    """Robot and tool as one multibody, of masses alone: nothing in this world runs into anything."""
    tree = chain.tree
    masses = bodies(chain, payload_of(tool))
    carrier, X_LF = tree.flange_carrier, tree.flange_offset
    X_LT = X_LF
    if tool is not None:
        X_LT = multiplied(X_LF, tool.X_FT.matrix)
    root = ET.Element("robot", name="machine")
    # the base never moves, so its mass does not matter; Bullet's inverse dynamics is wrong if it has turned axes
    _add_link(root, "base", NOTHING)
    for i in range(len(chain.driven)):
        _add_link(root, f"link{i}", masses[i])
        parent = "base" if tree.parent[i] < 0 else f"link{tree.parent[i]}"
        kind = "prismatic" if tree.prismatic[i] else "continuous"
        _add_joint(root, joint_name(i), kind, parent, f"link{i}", tree.before[i], tree.axis[i])
    return BulletModel(text=ET.tostring(root, encoding="unicode"), carrier=carrier, p_LT=X_LT[:3, 3].copy())


def joint_name(index: int) -> str:
    """The model's name for the joint at `index` of a joint vector."""
    return f"joint{index}"


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(v)) for v in values)


def _rpy(R: Array) -> tuple[float, float, float]:
    """Fixed-axis roll, pitch, yaw [rad] of a rotation matrix; at pitch ±90° the yaw is 0."""
    sine = -R[2, 0]
    cosine = math.hypot(R[0, 0], R[1, 0])
    pitch = float(atan2(sine, cosine))
    if cosine < 1e-9:
        return float(atan2(-R[1, 2], R[1, 1])), pitch, 0.0
    return float(atan2(R[2, 1], R[2, 2])), pitch, float(atan2(R[1, 0], R[0, 0]))


def _add_origin(parent: ET.Element, p: Array, R: Array) -> None:
    ET.SubElement(parent, "origin", xyz=_numbers(p), rpy=_numbers(_rpy(R)))


def _add_link(root: ET.Element, name: str, body: Inertial) -> None:
    link = ET.SubElement(root, "link", name=name)
    inertial = ET.SubElement(link, "inertial")
    if body.mass <= 0.0:
        body = Inertial(mass=LEAST_MASS, com=body.com, inertia=LEAST_INERTIA * np.eye(3))
    moments, axes = principal(body.inertia)
    _add_origin(inertial, body.com, axes)
    ET.SubElement(inertial, "mass", value=repr(float(body.mass)))
    xx, yy, zz = (repr(max(float(m), 0.0)) for m in moments)
    ET.SubElement(inertial, "inertia", ixx=xx, iyy=yy, izz=zz, ixy="0", ixz="0", iyz="0")


def _add_joint(root: ET.Element, name: str, kind: str, parent: str, child: str, X: Array, axis: Array) -> None:
    """A joint without limits: the checks decide where the robot may go, not stops in the world."""
    joint = ET.SubElement(root, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    _add_origin(joint, X[:3, 3], X[:3, :3])
    ET.SubElement(joint, "axis", xyz=_numbers(axis))
    # Bullet treats every pair lower <= upper as stops, so free travel is written the other way round
    ET.SubElement(joint, "limit", lower="1", upper="-1", effort="0", velocity="0")
