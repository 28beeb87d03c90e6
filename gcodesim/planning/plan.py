"""The result of planning a tool path on a machine: where every joint is at any time, and what does not fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.diagnostics import Findings
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import ToolPath
from gcodesim.motion.trajectory import Samples, Trajectory

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics


class JointPath(Protocol):
    """How joints follow a trajectory."""

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [m, rad] at samples in order of time."""
        ...

    def extremes(self) -> JointExtremes:
        """How far each joint goes."""
        ...


@frozen(kw_only=False, eq=False)
class JointExtremes:
    """Least and greatest value (j,) of every joint on the path [m, rad], and the rows where they are."""

    least: Array
    most: Array
    row_of_least: NDArray[np.int64]
    row_of_most: NDArray[np.int64]


@frozen(slots=False, kw_only=False, eq=False)
class Plan:
    """A trajectory with the joints that follow it, and the findings.

    `tool_frames` maps a tool number to X_FT; tools that are not in it have their
    tip at the flange.
    """

    trajectory: Trajectory
    findings: Findings
    kinematics: Kinematics
    joint_path: JointPath
    tool_frames: Mapping[int, Pose] = field(default_factory=dict)

    @property
    def path(self) -> ToolPath:
        """The tool path as it is run; for an arm, moves that turn the tool first may be inserted."""
        return self.trajectory.path

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [m, rad] at `samples`, which are in order of time."""
        return self.joint_path.joints(samples)

    def extremes(self) -> JointExtremes:
        """How far each joint goes, with rows."""
        return self.joint_path.extremes()

    def tip(self, q: Array, row: NDArray[np.int64]) -> Array:
        """X_BT (n, 4, 4): where the tip of the tool of each `row` (n,) is when the joints are at `q` (n, j)."""
        X_BF = self.kinematics.forward(q)
        state = self.path.state[row] if len(self.path) else np.zeros(len(q), dtype=np.int32)
        tools = np.array([s.tool for s in self.path.states])[state]
        X_BT = X_BF.copy()
        for number, X_FT in self.tool_frames.items():
            here = tools == number
            X_BT[here] = multiplied(X_BF[here], X_FT.matrix)
        return X_BT
