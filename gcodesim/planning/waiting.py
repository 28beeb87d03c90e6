"""A plan with waits: the same joints at the same places, later."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.trajectory import Samples, Trajectory
from gcodesim.planning.legs import LegJoints
from gcodesim.planning.plan import JointExtremes, JointPath, Plan


@frozen(slots=False, kw_only=False, eq=False)
class LateJoints:
    """Joints that follow a trajectory by its time, asked with the times of one that has waits besides.

    Waits begin at `begins` (w,) [s] of that time and have added up to `late` (w,) [s] when they end.
    """

    own: JointPath
    trajectory: Trajectory
    begins: Array
    late: Array

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [m, rad] at samples in order of time."""
        before = np.concatenate([[0.0], self.late])
        count = np.searchsorted(self.begins, samples.time, side="right")
        time = samples.time - before[count]
        if len(self.begins):  # during a wait, the time at which it began
            last = np.maximum(count - 1, 0)
            held = self.begins[last] - before[last]
            time = np.where(count > 0, np.maximum(time, held), time)
        return self.own.joints(self.trajectory.sample(time))

    def extremes(self) -> JointExtremes:
        """How far each joint goes."""
        return self.own.extremes()


def waiting(plan: Plan, trajectory: Trajectory) -> Plan:
    """`plan` run along `trajectory`, which is its own with longer rests at some of its events."""
    joints = plan.joint_path
    if isinstance(joints, LegJoints):  # which goes by time, not by place
        pairs = zip(plan.trajectory.events, trajectory.events, strict=True)
        rests = [(new.time, new.duration - old.duration) for old, new in pairs if new.duration > old.duration]
        begins, seconds = np.array([time for time, _ in rests]), np.array([wait for _, wait in rests])
        joints = LateJoints(joints, plan.trajectory, begins, np.cumsum(seconds))
    return replace(plan, trajectory=trajectory, joint_path=joints)
