"""Poses in monogram notation: `X_WT` is the pose of frame T seen from frame W.

Adjacent letters cancel: ``X_WT = X_WB @ X_BF @ X_FT``. Quaternions are arrays
x, y, z, w of unit length, stored with w >= 0 (w = 0: the first component that
is not zero is positive).
"""

from __future__ import annotations

from typing import Final

import numpy as np

from gcodesim.arithmetic import Array as Array
from gcodesim.arithmetic.elementary import cos_sin
from gcodesim.arithmetic.matrices import applied, multiplied, norms
from gcodesim.frozen import frozen

WORLD: Final = "world"
"""The root of all frames."""


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """Rotation matrix (3, 3) of rotations about the fixed X, then Y, then Z axis [rad]; the order of URDF."""
    cr, sr = cos_sin(roll)
    cp, sp = cos_sin(pitch)
    cy, sy = cos_sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rotation_about(axis: Array, angle: float) -> Array:
    """Rotation matrix (3, 3) by `angle` [rad] about the unit vector `axis` (Rodrigues 1840)."""
    x, y, z = axis
    cosine, sine = cos_sin(angle)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    R: Array = np.eye(3) + sine * skew + (1.0 - cosine) * multiplied(skew, skew)
    return R


def canonical_quaternion(q: Array) -> Array:
    """Quaternions (..., 4) of unit length with w >= 0; ties are decided by the first non-zero component."""
    q = q / norms(q)[..., None]
    sign = np.ones(q.shape[:-1])
    undecided = np.ones(q.shape[:-1], dtype=bool)
    for column in (3, 0, 1, 2):
        value = q[..., column]
        sign = np.where(undecided & (value < 0.0), -1.0, sign)
        undecided &= value == 0.0
    return q * sign[..., None] + 0.0  # + 0.0 turns -0.0 into 0.0


def quaternion_from_rotation(R: Array) -> Array:
    """Canonical quaternions (..., 4), x y z w, of rotation matrices (..., 3, 3).

    The largest component is found from the diagonal first, so no precision is
    lost near half turns (Shepperd 1978).
    """
    R = np.asarray(R, dtype=float)
    m00, m11, m22 = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    squares = np.stack(
        [1.0 + m00 - m11 - m22, 1.0 - m00 + m11 - m22, 1.0 - m00 - m11 + m22, 1.0 + m00 + m11 + m22], axis=-1
    )
    yz, zx, xy = R[..., 2, 1] + R[..., 1, 2], R[..., 0, 2] + R[..., 2, 0], R[..., 1, 0] + R[..., 0, 1]
    wx, wy, wz = R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]
    rows = np.stack(
        [
            np.stack([squares[..., 0], xy, zx, wx], axis=-1),
            np.stack([xy, squares[..., 1], yz, wy], axis=-1),
            np.stack([zx, yz, squares[..., 2], wz], axis=-1),
            np.stack([wx, wy, wz, squares[..., 3]], axis=-1),
        ],
        axis=-2,
    )
    best = np.argmax(squares, axis=-1)
    q = np.take_along_axis(rows, best[..., None, None], axis=-2)[..., 0, :]
    return canonical_quaternion(q)


def rotation_from_quaternion(q: Array) -> Array:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4), x y z w."""
    q = np.asarray(q, dtype=float)
    q = q / norms(q)[..., None]
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=-1),
            np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=-1),
            np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=-1),
        ],
        axis=-2,
    )


@frozen(kw_only=False, eq=False)
class Pose:
    """A rigid transform: position `p` (3,) [m] and rotation matrix `R` (3, 3)."""

    p: Array
    R: Array

    @staticmethod
    def identity() -> Pose:
        return Pose(np.zeros(3), np.eye(3))

    @staticmethod
    def from_xyz_rpy(xyz: tuple[float, float, float], rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Pose:
        """Pose at `xyz` [m], turned by fixed-axis roll, pitch, yaw [rad]."""
        return Pose(np.array(xyz, dtype=float), rotation_from_rpy(*rpy))

    @staticmethod
    def from_matrix(X: Array) -> Pose:
        """Pose of a homogeneous matrix (4, 4)."""
        return Pose(np.array(X[:3, 3]), np.array(X[:3, :3]))

    @property
    def q(self) -> Array:
        """Canonical quaternion (4,), x y z w."""
        return quaternion_from_rotation(self.R)

    @property
    def matrix(self) -> Array:
        """Homogeneous matrix (4, 4)."""
        X = np.eye(4)
        X[:3, :3] = self.R
        X[:3, 3] = self.p
        return X

    def __matmul__(self, other: Pose) -> Pose:
        return Pose(self.p + applied(self.R, other.p), multiplied(self.R, other.R))

    def inverse(self) -> Pose:
        return Pose(-applied(self.R.T, self.p), self.R.T.copy())

    def rotate(self, vectors: Array) -> Array:
        """Vectors (..., 3) of the inner frame, in axes of the outer one."""
        return applied(self.R, vectors)

    def apply(self, points: Array) -> Array:
        """Points (..., 3) of the inner frame, in the outer one."""
        return applied(self.R, points) + self.p

    def box(self, low: Array, high: Array) -> tuple[Array, Array]:
        """The box in axes of the outer frame around one of the inner: corners (..., 3), which may be infinite."""
        with np.errstate(invalid="ignore"):
            one, other = (np.where(self.R == 0.0, 0.0, self.R * np.asarray(end)[..., None, :]) for end in (low, high))
        least, most = np.minimum(one, other), np.maximum(one, other)
        a, b = (part[..., 0] + part[..., 1] + part[..., 2] + self.p for part in (least, most))
        return a, b
