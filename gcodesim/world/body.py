"""Plain data about bodies: the robot, and the tool on its flange. SI throughout."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.controllers.controller import Controller
from gcodesim.controllers.ideal import Ideal
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.solids import Box, Cylinder, Placed, Sphere, widest

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
    if tool.tcp is not None:
        return _bent(tool)
    return ToolBody(
        name=tool.name,
        length=length,
        mass=inertia.mass,
        com=(0.0, 0.0, length - inertia.center),
        inertia=(inertia.transverse, inertia.transverse, inertia.axial, 0.0, 0.0, 0.0),
        solids=tuple(primitive.placed.at(tool.X_FT) for primitive in tool.primitives),
    )


def _bent(tool: Tool) -> ToolBody:
    """A tool whose tip is not straight out of the flange."""
    X_FT, inertia = tool.X_FT, tool.inertia
    own = np.diag([inertia.transverse, inertia.transverse, inertia.axial])
    x, y, z = X_FT.apply(np.array([0.0, 0.0, -inertia.center])).tolist()
    R = X_FT.R
    xx, yy, zz, xy, xz, yz = multiplied(R, own, R.T)[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist()
    return ToolBody(
        name=tool.name,
        length=tool.true_length,
        mass=inertia.mass,
        com=(x, y, z),
        inertia=(xx, yy, zz, xy, xz, yz),
        solids=tuple(primitive.placed.at(X_FT) for primitive in tool.primitives),
        tip=X_FT,
    )


Primitive = Box | Cylinder | Sphere
"""Solids that the physics engine knows besides meshes."""


def centred(placed: Placed) -> tuple[Primitive, Pose]:
    """A solid in a form that the physics engine knows, and where its middle is.

    Other bodies of revolution are replaced by the cylinder of their greatest radius.
    """
    solid = placed.solid
    if not isinstance(solid, Box | Cylinder | Sphere):
        low, high = solid.bounds
        solid = Cylinder(radius=widest(solid), bottom=low[2], top=high[2])
    return solid, Placed(solid, placed.X).X_middle
