"""Poses and figures from comparing them, for all log instants of a window at once."""

from __future__ import annotations

from math import sqrt
from typing import Any

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel


@kernel(lean=True)
def write_poses(X: Any, which: Any, first: int, out: Any) -> None:
    """Poses `X[:, which]` (n, m, 4, 4) as rows x y z qx qy qz qw, into `out` (n, f, 7) from column `first` on.

    `frames.quaternion_from_rotation`, one by one: from the largest component (Shepperd 1978), canonical.
    """
    for i in range(X.shape[0]):
        for k in range(len(which)):
            pose, row = X[i, which[k]], out[i, first + k]
            m00, m11, m22 = pose[0, 0], pose[1, 1], pose[2, 2]
            xx, yy, zz = 1.0 + m00 - m11 - m22, 1.0 - m00 + m11 - m22, 1.0 - m00 - m11 + m22
            ww = 1.0 + m00 + m11 + m22
            yz, zx, xy = pose[2, 1] + pose[1, 2], pose[0, 2] + pose[2, 0], pose[1, 0] + pose[0, 1]
            wx, wy, wz = pose[2, 1] - pose[1, 2], pose[0, 2] - pose[2, 0], pose[1, 0] - pose[0, 1]
            if xx >= yy and xx >= zz and xx >= ww:
                x, y, z, w = xx, xy, zx, wx
            elif yy >= zz and yy >= ww:
                x, y, z, w = xy, yy, yz, wy
            elif zz >= ww:
                x, y, z, w = zx, yz, zz, wz
            else:
                x, y, z, w = wx, wy, wz, ww
            length = sqrt(x * x + y * y + z * z + w * w)
            x, y, z, w = x / length, y / length, z / length, w / length
            if w < 0.0 or (w == 0.0 and (x < 0.0 or (x == 0.0 and (y < 0.0 or (y == 0.0 and z < 0.0))))):
                x, y, z, w = -x, -y, -z, -w
            row[0], row[1], row[2] = pose[0, 3], pose[1, 3], pose[2, 3]
            row[3], row[4], row[5], row[6] = x + 0.0, y + 0.0, z + 0.0, w + 0.0  # + 0.0 turns -0.0 into 0.0


@kernel(lean=True)
def bend(X_WB: Any, deflection: Any, X: Any) -> None:
    """Poses `X` (n, 4, 4) in B, moved and turned by `deflection` (n, 6) in B about their origins, become poses in W.

    The turn is a rotation vector [rad] (Rodrigues 1840); zero leaves a pose unchanged.
    """
    for i in range(X.shape[0]):
        pose, bent = X[i], deflection[i]
        x, y, z = bent[3], bent[4], bent[5]
        angle = sqrt(x * x + y * y + z * z)
        if angle > 0.0:
            x, y, z = x / angle, y / angle, z / angle
            cosine, s = cos_sin(angle)
            v = 1.0 - cosine
            for c in range(3):
                p0, p1, p2 = pose[0, c], pose[1, c], pose[2, c]
                along = v * (x * p0 + y * p1 + z * p2)
                pose[0, c] = p0 + s * (y * p2 - z * p1) - v * p0 + along * x
                pose[1, c] = p1 + s * (z * p0 - x * p2) - v * p1 + along * y
                pose[2, c] = p2 + s * (x * p1 - y * p0) - v * p2 + along * z
        for r in range(3):
            pose[r, 3] += bent[r]
        for c in range(4):
            p0, p1, p2 = pose[0, c], pose[1, c], pose[2, c]
            for r in range(3):
                pose[r, c] = X_WB[r, 0] * p0 + X_WB[r, 1] * p1 + X_WB[r, 2] * p2
        for r in range(3):
            pose[r, 3] += X_WB[r, 3]


@kernel(lean=True)
def compare(target: Any, actual: Any, part: Any, errors: Any, local: Any) -> None:
    """Of poses (n, 4, 4) in W: distance [m] and angle [rad] from `target` to `actual`, into `errors` (n, 2), and the

    place of `actual` in axes of `part`, into `local` (n, 3). The angle is exact where it is small, too.
    """
    for i in range(len(target)):
        a, b, p = target[i], actual[i], part[i]
        dx, dy, dz = b[0, 3] - a[0, 3], b[1, 3] - a[1, 3], b[2, 3] - a[2, 3]
        errors[i, 0] = sqrt(dx * dx + dy * dy + dz * dz)
        x = a[0, 2] * b[0, 1] + a[1, 2] * b[1, 1] + a[2, 2] * b[2, 1]  # of the rotation from `target` to `actual`
        x -= a[0, 1] * b[0, 2] + a[1, 1] * b[1, 2] + a[2, 1] * b[2, 2]
        y = a[0, 0] * b[0, 2] + a[1, 0] * b[1, 2] + a[2, 0] * b[2, 2]
        y -= a[0, 2] * b[0, 0] + a[1, 2] * b[1, 0] + a[2, 2] * b[2, 0]
        z = a[0, 1] * b[0, 0] + a[1, 1] * b[1, 0] + a[2, 1] * b[2, 0]
        z -= a[0, 0] * b[0, 1] + a[1, 0] * b[1, 1] + a[2, 0] * b[2, 1]
        trace = 0.0
        for c in range(3):
            trace += a[0, c] * b[0, c] + a[1, c] * b[1, c] + a[2, c] * b[2, c]
        errors[i, 1] = atan2(0.5 * sqrt(x * x + y * y + z * z), 0.5 * (trace - 1.0))
        dx, dy, dz = b[0, 3] - p[0, 3], b[1, 3] - p[1, 3], b[2, 3] - p[2, 3]
        for c in range(3):
            local[i, c] = p[0, c] * dx + p[1, c] * dy + p[2, c] * dz


@kernel(lean=True)
def most_used(value: Any, middle: Any, limit: Any, out: Any) -> None:
    """The greatest share (n,) that any of `value` (n, j) takes of its `limit` (j,) on either side of `middle` (j,).

    A limit of 0 or infinity means no limit.
    """
    for i in range(len(value)):
        most = 0.0
        for j in range(len(limit)):
            if limit[j] > 0.0:
                most = max(most, abs(value[i, j] - middle[j]) / limit[j])
        out[i] = most
