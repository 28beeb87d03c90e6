"""Plain data about bodies: the robot, and the tool on its flange. SI throughout."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.controllers.controller import Controller
from gcodesim.controllers.ideal import Ideal
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Inertial
from gcodesim.kinematics.dynamics import merge
from gcodesim.solids import Box, Cylinder, Hulls, Mesh, Placed, Sphere, widest
from gcodesim.tools.body import mass_properties

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Chain
    from gcodesim.tools.tool import Tool

Vector = tuple[float, float, float]
# xx, yy, zz, xy, xz, yz [kg·m²]
Inertia = tuple[float, float, float, float, float, float]


@frozen(eq=False)
class ToolBody:
    """A tool as a rigid body on the flange F, Z out of the flange.

    `length` [m] from the flange to the tip along Z, unless its tip is at `tip` of F;
    `mass` [kg]; `com` [m] centre of mass seen from F; `inertia` [kg·m²] about
    it in axes of F; `solids` in F are what can be seen of it.
    """

    name: str
    length: float
    mass: float = 0.0
    com: Vector = (0.0, 0.0, 0.0)
    inertia: Inertia = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    solids: tuple[Placed, ...] = ()
    tip: Pose | None = None

    @property
    def X_FT(self) -> Pose:
        """Pose of the tip T seen from the flange."""
        if self.tip is not None:
            return self.tip
        return Pose.from_xyz_rpy((0.0, 0.0, self.length))


@frozen(eq=False)
class RobotBody:
    """A robot or machine tool: its chain, where its root is in W, and what its motors can deliver.

    `effort` (j,) limits the motors of the driven joints [N·m, N], inf is
    unlimited; None takes the limits of the chain. `controller` is how its motors follow the command; with an ideal one
    `stiffness` (j,) of the gears [N·m/rad, N/m], None where they are rigid, is a matter of the process alone.
    """

    chain: Chain
    X_WB: Pose = field(default_factory=Pose.identity)
    effort: tuple[float, ...] | None = None
    stiffness: tuple[float, ...] | None = None
    controller: Controller = field(default_factory=Ideal)

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
    if tool.body is not None or tool.X_FN is not None:
        return _of_any_shape(tool)
    return ToolBody(
        name=tool.name,
        length=length,
        mass=inertia.mass,
        com=(0.0, 0.0, length - inertia.center),
        inertia=(inertia.transverse, inertia.transverse, inertia.axial, 0.0, 0.0, 0.0),
        solids=tuple(primitive.placed.at(tool.X_FT) for primitive in tool.primitives),
    )


def _of_any_shape(tool: Tool) -> ToolBody:
    """A tool that is bent, or has a body of its own."""
    X_FT = tool.X_FT
    whole = merge([*round_masses(tool), *([] if tool.body is None else tool.body.inertials)])
    share = 1.0 if tool.mass is None or whole.mass <= 0.0 else tool.mass / whole.mass
    x, y, z = whole.com.tolist()
    xx, yy, zz, xy, xz, yz = (share * whole.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]).tolist()
    return ToolBody(
        name=tool.name,
        length=tool.true_length,
        mass=share * whole.mass,
        com=(x, y, z),
        inertia=(xx, yy, zz, xy, xz, yz),
        solids=tuple(placed.at(X_FT) for _, placed in tool.drawn()),
        tip=X_FT,
    )


def round_masses(tool: Tool) -> list[tuple[Inertial, Array]]:
    """The simple bodies of a tool as one of steel, and X_FT."""
    own = mass_properties(tool.round_parts)
    com = np.array([0.0, 0.0, -own.center])
    return [(Inertial(mass=own.mass, com=com, inertia=np.diag([own.transverse] * 2 + [own.axial])), tool.X_FT.matrix)]


Primitive = Box | Cylinder | Sphere
"""Solids that the physics engine knows besides meshes."""


def centred(placed: Placed) -> tuple[Primitive, Pose]:
    """A solid in a form that the physics engine knows, and where its middle is.

    Other bodies of revolution are replaced by the cylinder of their greatest radius, meshes by the box around them.
    """
    solid = placed.solid
    if isinstance(solid, Mesh | Hulls):
        low, high = solid.bounds
        solid = Box(lower=low, upper=high)
    if not isinstance(solid, Box | Cylinder | Sphere):
        low, high = solid.bounds
        solid = Cylinder(radius=widest(solid), bottom=low[2], top=high[2])
    return solid, Placed(solid, placed.X).X_middle
