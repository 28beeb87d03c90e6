"""Any serial arm: numeric inverse kinematics, compiled, with a warm start along a path."""

from __future__ import annotations

import math
from functools import cached_property
from itertools import pairwise

import numpy as np

from gcodesim.arithmetic.elementary import power, sin
from gcodesim.arithmetic.matrices import least_gains, norm
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain
from gcodesim.kinematics.machine import Machine, poses
from gcodesim.kinematics.path_kernels import JUMP
from gcodesim.kinematics.protocol import Reason, Status, Statuses
from gcodesim.kinematics.reasons import jump_reason, limit_reason
from gcodesim.kinematics.serial_kernels import PIVOT, all_solutions, inverse_path

_STARTS = 64  # starts of a full search: finds all eight branches of a UR10e in 99 % of poses
_SAME = 1e-6  # [rad], [m] below which two solutions are one


def spread(lower: Array, upper: Array, count: int) -> Array:
    """Points (count, j) spread evenly over a box: Roberts' additive sequence (2018), a golden ratio of j dimensions."""
    dimension = len(lower)
    ratio = 2.0
    for _ in range(60):  # the root of x**(j + 1) = x + 1
        ratio = power(1.0 + ratio, 1.0 / (dimension + 1))
    step = np.array([power(ratio, -i) for i in range(1, dimension + 1)])
    unit = (0.5 + np.arange(1.0, count + 1.0)[:, None] * step) % 1.0
    points: Array = lower + unit * (upper - lower)
    return points


@frozen(slots=False, eq=False)
class SerialArm(Machine):
    """A chain of any number of joints. Fewer than six reach only the poses they can; more take the shortest way."""

    @staticmethod
    def of(chain: Chain) -> SerialArm | None:
        """Any chain will do."""
        return SerialArm(chain=chain)

    @cached_property
    def starts(self) -> Array:
        """Where a search begins (s, j): spread over the travel, over one turn or 1 m where that is unlimited."""
        joints = self.joints
        half = np.where([kind == "prismatic" for kind in joints.kinds], 0.5, np.pi)
        lower = np.where(np.isfinite(joints.lower), np.maximum(joints.lower, -half), -half)
        upper = np.where(np.isfinite(joints.upper), np.minimum(joints.upper, half), half)
        wide = lower < upper
        return spread(np.where(wide, lower, joints.lower), np.where(wide, upper, joints.upper), _STARTS)

    def inverse(self, X_BF: Array, seed: Array, *, on_path: bool = False) -> tuple[Array, Statuses]:
        """Joints (n, j) and status (n,) along flange poses (n, 4, 4), continuous from `seed` (j,) on."""
        targets, joints = poses(X_BF), self.joints
        q, status = np.empty((len(targets), len(joints))), np.empty(len(targets), dtype=np.uint8)
        start = np.array(seed, dtype=np.float64)
        inverse_path(targets, start, int(on_path), self.starts, joints.lower, joints.upper, self.chain.tree, q, status)
        return q, status

    def branches(self, X_BF: Array) -> Array:
        """The different joint vectors (b, j) of one pose (4, 4) that a search finds, in the order of its starts."""
        tree, starts = self.chain.tree, self.starts
        out, found = np.empty_like(starts), np.zeros(len(starts), dtype=np.int64)
        all_solutions(poses(X_BF)[0], starts, tree, out, found)
        revolute = tree.prismatic == 0
        kept: list[Array] = []
        for q in out[found == 1]:
            q = np.where(revolute, q - 2.0 * np.pi * np.rint(q / (2.0 * np.pi)), q)
            differences = (np.abs(np.where(revolute, sin(0.5 * (q - other)), q - other)).max() for other in kept)
            if all(d > _SAME for d in differences):
                kept.append(q)
        return np.array(kept).reshape(-1, starts.shape[1])

    def reason(self, X_BF: Array, previous: Array, status: int) -> Reason:
        """The facts behind a status: how far the flange stays away, the joint over its limit, the jump."""
        q = self.inverse(X_BF, previous, on_path=True)[0][0]
        if status == Status.REACH:
            return self._out_of_reach(X_BF)
        if status == Status.LIMIT:
            return limit_reason(self.joints, q)
        if status == Status.FLIP:
            return jump_reason(self.joints, q, previous, JUMP)
        J = self.jacobian(q)[0]
        least = float(least_gains(J))
        return Reason(
            status=Status.SINGULAR, what="smallest gain of the Jacobian", value=least, limit=math.sqrt(PIVOT), unit="-"
        )

    def _out_of_reach(self, X_BF: Array) -> Reason:
        """Distance of the flange from the first joint that it turns about, against the sum of the link lengths.

        Within that sum it says nothing, and `what` is None.
        """
        tree = self.chain.tree
        on = np.flatnonzero(tree.path)
        frames = self._poses(np.zeros((1, len(tree.path))), on, np.broadcast_to(np.eye(4), (len(on), 4, 4)).copy())[0]
        flange = self.forward(np.zeros((1, len(tree.path))))[0, :3, 3]
        points = [*frames[:, :3, 3], flange]
        limit = float(sum(norm(b - a) for a, b in pairwise(points)))
        limit += sum(float(self.joints.upper[i] - self.joints.lower[i]) for i in on if tree.prismatic[i])
        distance = norm(poses(X_BF)[0, :3, 3] - points[0])
        what = f"flange distance from {self.joints.names[int(on[0])]}" if distance > limit else None
        return Reason(status=Status.REACH, what=what, value=distance, limit=limit, unit="m")
