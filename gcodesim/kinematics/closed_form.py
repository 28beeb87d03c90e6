"""The common part of closed forms of six-axis arms: geometry in the plane of the arm, path, branches, reasons."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import atan2, sin
from gcodesim.arithmetic.matrices import applied, dot, multiplied
from gcodesim.frames import Array, rotation_about
from gcodesim.frozen import frozen
from gcodesim.kinematics.branch_kernels import branches_of_poses
from gcodesim.kinematics.chain import Chain, Indices
from gcodesim.kinematics.closed_form_kernels import inverse_path, solve_family
from gcodesim.kinematics.machine import Machine, poses
from gcodesim.kinematics.path_kernels import JUMP, nearest_anywhere
from gcodesim.kinematics.plane_kernels import NEAR, PlaneArm
from gcodesim.kinematics.protocol import Reason, Status, Statuses
from gcodesim.kinematics.reasons import jump_reason, limit_reason

SQUARE = 1e-9  # [-] and [m]: how exactly axes have to be square, parallel and through one point


def six_in_a_row(chain: Chain) -> bool:
    """Six driven revolute joints, each on the one before, and the flange on the last."""
    tree = chain.tree
    return list(tree.parent) == [-1, 0, 1, 2, 3, 4] and not tree.prismatic.any() and bool(tree.path.all())


def angle_about(axis: Array, start: Array, end: Array) -> float:
    """Angle [rad] from `start` to `end`, unit vectors square to `axis`, right-handed about it."""
    return atan2(dot(axis, np.cross(start, end)), dot(start, end))


@frozen(slots=False, eq=False)
class ClosedForm(Machine):
    """A six-axis arm with eight closed-form branches."""

    arm: PlaneArm
    family: ClassVar[int]
    centre_name: ClassVar[str]
    wrist_name: ClassVar[str]
    has_wrist_centre: ClassVar[bool] = False

    @staticmethod
    def plane_arm(o: Array, u: Array, X_BF: Array, centre: Array, joints: Array, first: Array) -> PlaneArm | None:
        """The arm in its plane, or None when two joints of the plane coincide.

        `o`, `u` (6, 3) are points and directions of the axes at zero, `joints`
        (k, 3) the points in the plane of the arm after joint 2, `first` (3,) the
        axis about which the rotation that is left turns first.
        """
        R_PB = np.array([np.cross(u[1], u[0]), u[1], u[0]])
        origin = o[0] + u[0] * dot(u[0], o[1] - o[0])
        steps = [applied(R_PB, b - a) for a, b in zip([o[1], *joints[:-1]], joints, strict=True)]
        if min(math.hypot(v[0], v[2]) for v in steps[:2]) < SQUARE:
            return None
        R_BE = np.array([np.cross(u[4], first), u[4], first]).T
        zero = angle_about(u[4], first, u[5])
        p_FC = applied(X_BF[:3, :3].T, centre - X_BF[:3, 3])
        x2, lateral = dot(R_PB[0], o[1] - origin), dot(R_PB[1], centre - origin)
        a, b, c = [*steps, np.zeros(3)][:3]
        R_FE = multiplied(X_BF[:3, :3].T, rotation_about(u[4], zero), R_BE)
        return PlaneArm(
            p_BP=origin,
            p_FC=np.array(p_FC),
            x2=float(x2),
            lateral=float(lateral),
            upper_z=float(a[2]),
            upper_x=float(a[0]),
            fore_z=float(b[2]),
            fore_x=float(b[0]),
            last_z=float(c[2]),
            last_x=float(c[0]),
            sign3=float(np.sign(dot(u[1], u[2]))),
            sign4=float(np.sign(dot(u[1], u[3]))),
            zero6=float(zero),
            upper_length=math.hypot(a[2], a[0]),
            fore_length=math.hypot(b[2], b[0]),
            straight=atan2(a[0], a[2]) - atan2(b[0], b[2]),
            R_PB=R_PB,
            R_EP=np.ascontiguousarray(multiplied(R_BE.T, R_PB.T)),
            R_FE=np.ascontiguousarray(R_FE),
        )

    @property
    def reach(self) -> float:
        """Greatest length [m] of the two long links together, from joint 2."""
        return self.arm.upper_length + self.arm.fore_length

    def centre(self, X_BF: Array) -> Array:
        """The point (n, 3) in B where the last axes meet, of flange poses (n, 4, 4)."""
        X = poses(X_BF)
        found: Array = X[:, :3, 3] + applied(X[:, :3, :3], self.arm.p_FC)
        return found

    def inverse(self, X_BF: Array, seed: Array, *, on_path: bool = False) -> tuple[Array, Statuses]:
        """Joints (n, 6) and status (n,) along flange poses (n, 4, 4), continuous from `seed` (6,) on."""
        X = poses(X_BF)
        q, status = np.empty((len(X), 6)), np.empty(len(X), dtype=np.uint8)
        start = np.array(seed, dtype=np.float64)
        limits = self.joints.lower, self.joints.upper
        branch = self._branch_of(start) if on_path else -1
        inverse_path(self.family, X, start, branch, self.arm, *limits, q, status)
        return q, status

    def _solve(self, X_BF: Array, previous: Array) -> tuple[Array, Indices]:
        """The eight joint vectors (8, 6) of one pose (4, 4) and their flags (8,)."""
        out, flags = np.empty((8, 6)), np.zeros(8, dtype=np.int64)
        X = poses(X_BF)[0]
        solve_family(self.family, X, -1, self.arm, previous, out, flags)
        return out, flags

    def _branch_of(self, q: Array) -> int:
        """The branch on which joints q (6,) are."""
        out, flags = self._solve(self.forward(q), q)
        return nearest_anywhere(out, flags, q, np.ones(6, dtype=np.int64), np.empty(6))

    def branches(self, X_BF: Array) -> Array:
        """The joint vectors (b, 6) of one pose (4, 4) in branch order, angles within ±π; missing branches drop out."""
        out, flags = self._solve(X_BF, np.zeros(6))
        found: Array = out[flags > 0]
        return found - 2.0 * np.pi * np.rint(found / (2.0 * np.pi))

    def branches_along(self, X_BF: Array) -> tuple[Array, NDArray[np.bool_]]:
        """All joint vectors (n, 8, 6) of poses (n, 4, 4) in branch order, and which of them exist (n, 8)."""
        X = poses(X_BF)
        out, flags = np.zeros((len(X), 8, 6)), np.zeros((len(X), 8), dtype=np.int64)
        branches_of_poses(self.family, X, self.arm, out, flags)
        return out, flags > 0

    def reason(self, X_BF: Array, previous: Array, status: int) -> Reason:
        """The facts behind a status: distances from joint 2 and axis 1, the joint over its limit, the singular axes."""
        q = self.inverse(X_BF, previous, on_path=True)[0][0]
        if status == Status.REACH:
            return self._out_of_reach(X_BF)
        if status == Status.LIMIT:
            return limit_reason(self.joints, q)
        if status == Status.FLIP:
            return jump_reason(self.joints, q, previous, JUMP)
        return self._singular(q)

    def _elbow_ends(self, X_BF: Array) -> list[tuple[float, float]]:
        """Vectors z, x [m] in the plane of the arm that the two long links would have to span, one a branch."""
        raise NotImplementedError

    def _out_of_reach(self, X_BF: Array) -> Reason:
        arm = self.arm
        w = applied(arm.R_PB, self.centre(X_BF)[0] - arm.p_BP)
        radius, lateral = math.hypot(w[0], w[1]), abs(arm.lateral)
        if radius < lateral:
            what = f"{self.centre_name} distance from axis 1"
            return Reason(status=Status.REACH, what=what, value=radius, limit=lateral, unit="m")
        distances = [math.hypot(*end) for end in self._elbow_ends(X_BF)]
        least = abs(arm.upper_length - arm.fore_length)
        value, limit = (max(distances), least) if max(distances) < least else (min(distances), self.reach)
        what = f"{self.centre_name} distance from joint 2"
        return Reason(status=Status.REACH, what=what, value=value, limit=limit, unit="m")

    def _singular(self, q: Array) -> Reason:
        """The smallest of the three distances from singular."""
        arm = self.arm
        w = applied(arm.R_PB, self.centre(self.forward(q))[0] - arm.p_BP)
        forward = math.sqrt(max(0.0, w[0] * w[0] + w[1] * w[1] - arm.lateral * arm.lateral))
        bend = arm.sign3 * q[2] - arm.straight
        found = [
            (abs(sin(q[4] + arm.zero6)), self.wrist_name, "rad", 4),
            (abs(sin(bend)), "angle of the elbow from straight", "rad", 2),
            (forward, f"{self.centre_name} distance from above axis 1", "m", 0),
        ]
        value, what, unit, joint = min(found, key=lambda f: f[0])
        return Reason(status=Status.SINGULAR, what=what, value=value, limit=NEAR, unit=unit, joint=joint)
