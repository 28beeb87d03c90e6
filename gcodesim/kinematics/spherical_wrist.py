"""Six-axis arms with a spherical wrist: closed form, all eight branches."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gcodesim.frames import Array
from gcodesim.kinematics.chain import Chain
from gcodesim.kinematics.machine import Machine, poses
from gcodesim.kinematics.path_kernels import JUMP
from gcodesim.kinematics.protocol import Reason, Status, Statuses
from gcodesim.kinematics.reasons import jump_reason, limit_reason
from gcodesim.kinematics.spherical_wrist_kernels import NEAR, inverse_path, solve
from gcodesim.kinematics.zero_axes import intersection, zero_axes

_SQUARE = 1e-9  # [-] and [m]: how exactly axes have to be square, parallel and through one point


@dataclass(frozen=True, kw_only=True, eq=False)
class SphericalWrist(Machine):
    """An arm whose axis 2 is square to axis 1, axis 3 parallel to axis 2, and axes 4, 5, 6 square through one point.

    Signs of axes, offsets between them and the zero pose are free: KUKA's
    inverted axes, an offset elbow, a lateral offset as on Staubli's arms. Branch
    number = 4 (wrist centre behind axis 1) + 2 (elbow the other way) + 1 (wrist
    turned over).
    """

    arm: Array
    R_PB: Array
    R_EP: Array
    R_FE: Array

    @staticmethod
    def of(chain: Chain) -> SphericalWrist | None:
        """The closed form of `chain`, or None when its geometry is another one."""
        tree = chain.tree
        if list(tree.parent) != [-1, 0, 1, 2, 3, 4] or tree.prismatic.any() or not tree.path.all():
            return None
        o, u, X_BF = zero_axes(chain)
        centre = intersection(o[3:], u[3:], _SQUARE)
        square = (u[0] @ u[1], u[3] @ u[4], u[4] @ u[5])
        if centre is None or max(map(abs, square)) > _SQUARE or np.linalg.norm(np.cross(u[1], u[2])) > _SQUARE:
            return None
        R_PB = np.array([np.cross(u[1], u[0]), u[1], u[0]])
        origin = o[0] + u[0] * (u[0] @ (o[1] - o[0]))
        to_elbow, to_wrist = R_PB @ (o[2] - o[1]), R_PB @ (centre - o[2])
        if min(math.hypot(v[0], v[2]) for v in (to_elbow, to_wrist)) < _SQUARE:
            return None
        R_BE = np.array([np.cross(u[4], u[3]), u[4], u[3]]).T
        zero5 = math.atan2(u[4] @ np.cross(u[3], u[5]), u[3] @ u[5])
        c, s = math.cos(zero5), math.sin(zero5)
        arm = [
            *origin,
            *(X_BF[:3, :3].T @ (centre - X_BF[:3, 3])),
            R_PB[0] @ (o[1] - origin),
            R_PB[1] @ (centre - origin),
            to_elbow[2],
            to_elbow[0],
            to_wrist[2],
            to_wrist[0],
            np.sign(u[1] @ u[2]),
            zero5,
        ]
        return SphericalWrist(
            chain=chain,
            arm=np.array(arm),
            R_PB=R_PB,
            R_EP=np.ascontiguousarray(R_BE.T @ R_PB.T),
            R_FE=np.ascontiguousarray(X_BF[:3, :3].T @ R_BE @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])),
        )

    @property
    def reach(self) -> float:
        """Greatest distance [m] of the wrist centre from joint 2."""
        return math.hypot(self.arm[8], self.arm[9]) + math.hypot(self.arm[10], self.arm[11])

    def wrist_centre(self, X_BF: Array) -> Array:
        """Wrist centre (n, 3) in B of flange poses (n, 4, 4)."""
        X = poses(X_BF)
        centre: Array = X[:, :3, 3] + X[:, :3, :3] @ self.arm[3:6]
        return centre

    def inverse(self, X_BF: Array, seed: Array) -> tuple[Array, Statuses]:
        """Joints (n, 6) and status (n,) along flange poses (n, 4, 4), continuous from `seed` (6,) on."""
        X = poses(X_BF)
        q, status = np.empty((len(X), 6)), np.empty(len(X), dtype=np.uint8)
        start = np.array(seed, dtype=np.float64)
        limits = self.joints.lower, self.joints.upper
        inverse_path(X, start, self.arm, self.R_PB, self.R_EP, self.R_FE, *limits, q, status)
        return q, status

    def branches(self, X_BF: Array) -> Array:
        """The joint vectors (b, 6) of one pose (4, 4) in branch order, angles within ±π; missing branches drop out."""
        out, flags = np.empty((8, 6)), np.zeros(8, dtype=np.int64)
        solve(poses(X_BF)[0], self.arm, self.R_PB, self.R_EP, self.R_FE, np.zeros(6), np.empty((3, 3, 3)), out, flags)
        found: Array = out[flags > 0]
        return found - 2.0 * np.pi * np.rint(found / (2.0 * np.pi))

    def reason(self, X_BF: Array, previous: Array, status: int) -> Reason:
        """The facts behind a status: distances from joint 2 and axis 1, the joint over its limit, the singular axes."""
        q = self.inverse(X_BF, previous)[0][0]
        if status == Status.REACH:
            return self._out_of_reach(X_BF)
        if status == Status.LIMIT:
            return limit_reason(self.joints, q)
        if status == Status.FLIP:
            return jump_reason(self.joints, q, previous, JUMP)
        return self._singular(q)

    def _out_of_reach(self, X_BF: Array) -> Reason:
        arm = self.arm
        w = self.R_PB @ (self.wrist_centre(X_BF)[0] - arm[:3])
        radius, lateral = math.hypot(w[0], w[1]), abs(arm[7])
        if radius < lateral:
            what = "wrist centre distance from axis 1"
            return Reason(status=Status.REACH, what=what, value=radius, limit=lateral, unit="m")
        forward = math.sqrt(radius * radius - lateral * lateral)
        distances = [math.hypot(reach - arm[6], w[2]) for reach in (forward, -forward)]
        least = abs(math.hypot(arm[8], arm[9]) - math.hypot(arm[10], arm[11]))
        limit = least if max(distances) < least else self.reach
        what = "wrist centre distance from joint 2"
        return Reason(status=Status.REACH, what=what, value=min(distances), limit=limit, unit="m")

    def _singular(self, q: Array) -> Reason:
        """The smallest of the three distances from singular."""
        centre = self.wrist_centre(self.forward(q))[0]
        w = self.R_PB @ (centre - self.arm[:3])
        radius2 = w[0] ** 2 + w[1] ** 2 - self.arm[7] ** 2
        bend = self.arm[12] * q[2] + math.atan2(self.arm[11], self.arm[10]) - math.atan2(self.arm[9], self.arm[8])
        found = [
            (abs(math.sin(q[4] + self.arm[13])), "angle between axes 4 and 6", "rad", 4),
            (abs(math.sin(bend)), "angle of the elbow from stretched", "rad", 2),
            (math.sqrt(max(0.0, radius2)), "wrist centre distance from the plane of axis 1", "m", 0),
        ]
        value, what, unit, joint = min(found, key=lambda f: f[0])
        return Reason(status=Status.SINGULAR, what=what, value=value, limit=NEAR, unit=unit, joint=joint)
