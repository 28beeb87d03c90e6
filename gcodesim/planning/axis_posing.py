"""Posing of machines whose joints are the axes of the program."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import AXIS_LETTERS, Axes
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend import along_limits, blend
from gcodesim.motion.curves import Curves
from gcodesim.motion.pieces import AxisLimits, Pieces
from gcodesim.motion.printer_law import as_printed, is_printed, without_blending
from gcodesim.motion.tool_path import Commanded, ToolPath
from gcodesim.motion.trajectory import Samples
from gcodesim.planning.bent_ways import report_bent_rapids
from gcodesim.planning.feeds import report_fast_feeds
from gcodesim.planning.moments import PathFindings
from gcodesim.planning.plan import JointExtremes, JointPath
from gcodesim.planning.posing import Posed
from gcodesim.planning.travel import TravelEnds, axis_ranges, report_missing_axes, report_travel

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints
    from gcodesim.kinematics.protocol import Kinematics


def axes_of_joints(names: Sequence[str]) -> NDArray[np.intp]:
    """Which axis of x y z a b c each joint is, by the last letter of its name; ValueError when it is not an axis."""
    return np.array([AXIS_LETTERS.index(name[-1].upper()) for name in names], dtype=np.intp)


def axes_at(names: Sequence[str], q: Array) -> Axes:
    """Values of x y z a b c when the joints called `names` stand at `q` (j,); 0 where there is no such axis."""
    at = [0.0] * 6
    for axis, value in zip(axes_of_joints(names), q, strict=True):
        at[axis] = float(value)
    return (at[0], at[1], at[2], at[3], at[4], at[5])


def limits_of_axes(joints: Joints) -> AxisLimits:
    """Speed, acceleration and jerk by axis; axes that the machine does not have are unlimited."""
    axes = axes_of_joints(joints.names)
    speed, acceleration, jerk = np.full((3, 6), np.inf)
    speed[axes], acceleration[axes], jerk[axes] = joints.speed, joints.acceleration, joints.jerk
    return AxisLimits(speed=speed, acceleration=acceleration, jerk=jerk)


@frozen(slots=False, kw_only=False, eq=False)
class AxisJoints:
    """Joints that are axes: control point plus the active offset."""

    pieces: Pieces
    axes: NDArray[np.intp]
    start: Array

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [m, rad]."""
        pieces = self.pieces
        if not len(pieces):
            return np.tile(self.start[self.axes], (len(samples), 1))
        # the offset of the row that the piece belongs to: while the machine stands, `row` is already the next row
        offset = offsets(pieces.path, pieces.row_first[samples.piece])
        q: Array = (samples.position + offset)[:, self.axes]
        return q

    def extremes(self) -> JointExtremes:
        """How far each axis goes on the programmed path."""
        path = self.pieces.path
        if not len(path):
            at, none = self.start[self.axes], np.zeros(len(self.axes), dtype=np.int64)
            return JointExtremes(at, at, none, none)
        low, high = axis_ranges(path)
        first = path.start[0] + offsets(path)[0]
        low[0], high[0] = np.minimum(low[0], first), np.maximum(high[0], first)
        low, high = low[:, self.axes], high[:, self.axes]
        return JointExtremes(low.min(axis=0), high.max(axis=0), low.argmin(axis=0), high.argmax(axis=0))


def offsets(path: ToolPath, rows: NDArray[np.intp] | NDArray[np.int32] | None = None) -> Array:
    """The tool length offset of `rows`, default all of them, (n, 6) [m, rad]."""
    state = path.state if rows is None else path.state[rows]
    table = np.array([s.offset for s in path.states], dtype=float).reshape(-1, 6)
    offset: Array = table.take(state, axis=0)
    return offset


@frozen
class AxisPosing:
    """The joints are the axes of the program, found by their letters: control point plus the active offset.

    `independent_rapids`: in a G0 each axis goes at its own top speed, so the path is not a straight line.
    """

    independent_rapids: bool = False

    @property
    def understands(self) -> frozenset[Commanded]:
        return frozenset((Commanded.AXES,))

    def start(self, kinematics: Kinematics, home: Array) -> Axes:
        """Where the control point stands at `home` (j,), without tool offset."""
        return axes_at(kinematics.joints.names, home)

    def pose(self, path: ToolPath, kinematics: Kinematics, home: Array, findings: PathFindings) -> Posed:
        """Limits of the axes act along the direction of motion; positions outside the travel are reported."""
        joints = kinematics.joints
        axes = axes_of_joints(joints.names)
        limits = limits_of_axes(joints)
        report_missing_axes(path, axes, findings)
        report_travel(path, axes, TravelEnds.of(joints), findings)
        report_fast_feeds(path, along_limits(Curves.of(path), limits)[0], limits.speed, findings)
        printed = is_printed(path, soft=bool(np.isfinite(joints.jerk).any()))
        if printed:
            path = without_blending(path)
        pieces = blend(path, limits, independent_rapids=self.independent_rapids, sampled=not printed, early=not printed)
        if printed:
            pieces = as_printed(pieces)
        report_bent_rapids(pieces, findings)
        return Posed(pieces, AxisJoints(pieces, axes, np.array(axes_at(joints.names, home))))

    def after(self, leg: JointPath, path: ToolPath, home: Array) -> AxisPosing:
        """The same posing: there is no choice that would have to be kept."""
        return self
