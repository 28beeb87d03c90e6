"""Which posing the machine of a shop needs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import applied, dot, norm
from gcodesim.cell.arm_point import attitude_of
from gcodesim.frames import Array
from gcodesim.kinematics.attitude import Words
from gcodesim.kinematics.branch_names import branches_named
from gcodesim.kinematics.tool_point import ToolPoint
from gcodesim.planning.axis_attitude import AxisAttitude
from gcodesim.planning.axis_posing import AxisPosing
from gcodesim.planning.posing import Posing
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.planning.fixed_attitude import FixedAttitude


def posing_of(shop: Shop) -> Posing:
    """A machine whose joints are the axes is commanded by them; an arm holds the tool as the cell says."""
    if shop.mover.joints_are_axes:
        independent = shop.mover.rapids == "independent"
        tool = ToolPoint.of(shop.kinematics)
        if tool is None:
            return AxisPosing(independent_rapids=independent)
        return AxisAttitude(tool=tool, independent_rapids=independent)
    return _fixed_attitude(shop)


def _fixed_attitude(shop: Shop) -> FixedAttitude:
    """The frame O for every work system, in base axes: T's Z is along the axis that the cell names."""
    from gcodesim.planning.fixed_attitude import FixedAttitude

    own = shop.cell.channels[shop.channel].orientation
    R_BW = shop.X_WB.inverse().R
    frames = {
        system: _upright(applied(R_BW, shop.placement.tool_axis(own, system)), shop, system)
        for system in shop.placement.work_offsets
    }
    law = attitude_of(shop.cell, shop.channel, shop.placement)
    words = isinstance(law, Words)
    X_BP = {system: shop.X_BM @ X_MP for system, X_MP in shop.placement.work_offsets.items()}
    spin = None if own is None else own.spin
    if spin is None and isinstance(law, Words) and len(law.turns) == len("ABC"):
        spin = 0.0
    return FixedAttitude(
        frames=frames,
        upright=frames[1],
        spin=spin,
        X_BM=shop.X_BM,
        branches=_branches(shop),
        law=law,
        words_lean=words,
        axes={system: X.R if words else shop.X_BM.R for system, X in X_BP.items()},
    )


def _branches(shop: Shop) -> tuple[int, ...] | None:
    """Those that `configuration` of the robot allows; None where it says nothing."""
    from gcodesim.kinematics.closed_form import ClosedForm

    robot = shop.cell.robots.get(shop.name)
    if robot is None or not robot.configuration or not isinstance(shop.kinematics, ClosedForm):
        return None
    return branches_named(shop.kinematics.arm, robot.configuration)


def _upright(axis_B: Array, shop: Shop, system: int) -> Array:
    """Axes of the frame O (3, 3) whose −Z is the tool axis; its X is as near as possible to that of the work system."""
    z = -axis_B / norm(axis_B)
    R_BP = (shop.X_BM @ shop.placement.work_offsets[system]).R
    x = R_BP[:, 0] - dot(R_BP[:, 0], z) * z
    if norm(x) < 1e-6:
        x = R_BP[:, 1] - dot(R_BP[:, 1], z) * z
    x = x / norm(x)
    return np.column_stack([x, np.cross(z, x), z])
