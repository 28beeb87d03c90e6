"""Plain data about bodies: the robot, the tool on its flange, what stands around them. SI throughout."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.frames import Array, Pose

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Chain
    from gcodesim.tools.body import Primitive
    from gcodesim.tools.tool import Tool

Vector = tuple[float, float, float]
# xx, yy, zz, xy, xz, yz [kg·m²]
Inertia = tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Box:
    """A box of edge lengths `size` [m]; its middle stands at `X` of the body."""

    size: Vector
    X: Pose = field(default_factory=Pose.identity)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cylinder:
    """A cylinder along Z of `X`; its middle stands at `X` of the body [m]."""

    radius: float
    length: float
    X: Pose = field(default_factory=Pose.identity)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sphere:
    """A sphere with its middle at `X` of the body [m]."""

    radius: float
    X: Pose = field(default_factory=Pose.identity)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mesh:
    """Triangles `faces` (k, 3) over `vertices` (m, 3) [m]; only for bodies that never move. It is a shell."""

    vertices: Array
    faces: Array
    X: Pose = field(default_factory=Pose.identity)


Shape = Box | Cylinder | Sphere | Mesh


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StaticBody:
    """Something that stands in the cell and can be run into: a table, a fixture. `X_WS` places it in W."""

    name: str
    shapes: tuple[Shape, ...]
    X_WS: Pose = field(default_factory=Pose.identity)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToolBody:
    """A tool as a rigid body on the flange F, Z out of the flange.

    `length` [m] from the flange to the tip along Z, so X_FT has no turn;
    `mass` [kg]; `com` [m] centre of mass seen from F; `inertia` [kg·m²] about
    it in axes of F; `shapes` in F, what can be run into something.
    """

    name: str
    length: float
    mass: float = 0.0
    com: Vector = (0.0, 0.0, 0.0)
    inertia: Inertia = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    shapes: tuple[Box | Cylinder | Sphere, ...] = ()

    @property
    def X_FT(self) -> Pose:
        """Pose of the tip T seen from the flange."""
        return Pose.from_xyz_rpy((0.0, 0.0, self.length))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RobotBody:
    """A robot or machine tool: its chain, where its root stands in W, and what its motors can give.

    `effort` (j,) limits the motors of the driven joints [N·m, N], inf is
    unlimited; None takes the limits of the chain.
    """

    chain: Chain
    X_WB: Pose = field(default_factory=Pose.identity)
    effort: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if not self.chain.driven:
            raise ValueError("a robot needs at least one driven joint")
        if self.effort is not None and len(self.effort) != len(self.chain.driven):
            raise ValueError(f"{len(self.effort)} effort limits for {len(self.chain.driven)} joints")
        if not (self.effort_limit > 0.0).all():
            raise ValueError(f"effort limits have to be positive: {self.effort_limit.tolist()}")

    @property
    def effort_limit(self) -> Array:
        """Limits in force (j,), inf where unlimited [N·m, N]."""
        if self.effort is None:
            return self.chain.driven_joints.effort
        return np.array(self.effort, dtype=float)


def tool_body(tool: Tool) -> ToolBody:
    """The body of a tool of the cell: solids and mass, from heights above the tip into the flange frame."""
    length, inertia = tool.true_length, tool.inertia
    return ToolBody(
        name=tool.name,
        length=length,
        mass=inertia.mass,
        com=(0.0, 0.0, length - inertia.center),
        inertia=(inertia.transverse, inertia.transverse, inertia.axial, 0.0, 0.0, 0.0),
        shapes=tuple(_solid(primitive, length) for primitive in tool.primitives),
    )


def _solid(primitive: Primitive, length: float) -> Cylinder | Sphere:
    """A solid on the tool axis; a cone stands as the cylinder of its greater radius."""
    X = Pose.from_xyz_rpy((0.0, 0.0, length - 0.5 * (primitive.bottom + primitive.top)))
    if primitive.kind == "sphere":
        return Sphere(radius=primitive.radius, X=X)
    radius = max(primitive.radius, primitive.radius_bottom)
    return Cylinder(radius=radius, length=primitive.top - primitive.bottom, X=X)
