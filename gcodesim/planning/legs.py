"""The plans of the legs of one program as one plan."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.diagnostics import Findings
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.joining import joined
from gcodesim.motion.trajectory import Samples
from gcodesim.planning.plan import JointExtremes, JointPath, Plan


@frozen(slots=False, kw_only=False, eq=False)
class LegJoints:
    """Joints along several legs: each asks its own plan. Leg i begins at `begins[i]` [s] with row `rows[i]`."""

    legs: tuple[Plan, ...]
    begins: tuple[float, ...]
    rows: tuple[int, ...]
    known: tuple[int, JointExtremes] | None = None
    """How far joints go in so many of the first legs, where somebody has asked."""

    @staticmethod
    def of(plan: Plan) -> LegJoints:
        """The joints of a plan that may already have several legs."""
        return plan.joint_path if isinstance(plan.joint_path, LegJoints) else LegJoints((plan,), (0.0,), (0,))

    def then(self, leg: Plan, begin: float, row: int) -> LegJoints:
        """The same with a further leg, which begins at `begin` [s] with row `row`."""
        known = (len(self.legs), self._extremes) if "_extremes" in vars(self) else self.known
        return LegJoints((*self.legs, leg), (*self.begins, begin), (*self.rows, row), known)

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [m, rad] at samples in order of time."""
        time = samples.time
        leg = np.maximum(np.searchsorted(self.begins, time, side="right") - 1, 0)
        parts = [np.zeros((0, len(self.legs[0].kinematics.joints)))]
        for index in distinct(leg).tolist():
            plan = self.legs[index]
            parts.append(plan.joints(plan.trajectory.sample(time[leg == index] - self.begins[index])))
        return np.concatenate(parts)

    def extremes(self) -> JointExtremes:
        """How far each joint goes in any leg; rows are numbered over all legs."""
        return self._extremes

    @cached_property
    def _extremes(self) -> JointExtremes:
        """Legs whose extremes are known are not asked again, or many short legs would take a time that grows as their

        number squared.
        """
        count, before = self.known or (0, None)
        each = [*([] if before is None else [before]), *(plan.extremes() for plan in self.legs[count:])]
        least, most = np.array([e.least for e in each]), np.array([e.most for e in each])
        low, high = least.argmin(axis=0), most.argmax(axis=0)
        at = np.arange(least.shape[1])
        rows = np.array([*([] if before is None else [0]), *self.rows[count:]])
        row_of_least = np.array([e.row_of_least for e in each])[low, at] + rows[low]
        row_of_most = np.array([e.row_of_most for e in each])[high, at] + rows[high]
        return JointExtremes(least[low, at], most[high, at], row_of_least, row_of_most)


def followed_by(before: Plan, leg: Plan) -> Plan:
    """`before`, then `leg`, which begins where and when `before` ends; times of findings count from the start."""
    path = before.path.then(leg.path)
    begin = before.trajectory.duration
    joints: JointPath = LegJoints.of(before).then(leg, begin, len(before.path))
    findings = Findings()
    findings.extend(before.findings)
    findings.extend(replace(f, time=None if f.time is None else f.time + begin) for f in leg.findings)
    trajectory = joined(before.trajectory, leg.trajectory, path)
    return Plan(trajectory, findings, before.kinematics, joints, before.tool_frames)
