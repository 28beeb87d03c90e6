"""A smooth way through joint vectors: a cubic spline from rest to rest, as fast as speeds and accelerations allow.

de Boor 1978, chapter IV: the slopes at the inner knots follow from continuous second derivatives; those at the ends are
zero here. Knots are as far apart as the slowest joint needs for the way between them at full speed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.frames import Array
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints

_MOST = 1e6  # [rad/s, m/s, and per s] where a description names no limit
_STILL = 1e-9  # [s] between knots that do not differ


@frozen(eq=False)
class JointSpline:
    """Joint vectors `q` (n, j) at `times` (n,) [s], with `slopes` (n, j) there."""

    times: Array
    q: Array
    slopes: Array

    @staticmethod
    def through(q: Array, joints: Joints) -> JointSpline:
        """The spline through `q` (n, j), n at least 2; vectors that repeat the one before are left out."""
        speed = np.minimum(np.asarray(joints.speed, dtype=float), _MOST)
        acceleration = np.minimum(np.asarray(joints.acceleration, dtype=float), _MOST)
        wait = (np.abs(np.diff(q, axis=0)) / speed).max(axis=1)
        q = q[np.concatenate([[True], wait > _STILL])]
        u = np.concatenate([[0.0], np.cumsum(wait[wait > _STILL])])
        if len(q) == 1:
            return JointSpline(times=u, q=q, slopes=np.zeros_like(q))
        slopes = _slopes(u, q)
        first, second = _extremes(u, q, slopes)
        scale = max(float((first / speed).max()), float(np.sqrt((second / acceleration).max())), 1e-9)
        return JointSpline(times=u * scale, q=q, slopes=slopes / scale)

    @property
    def duration(self) -> float:
        return float(self.times[-1])

    def at(self, t: Array) -> Array:
        """Joint vectors (m, j) at times (m,) [s]; at rest before the first and after the last."""
        if len(self.q) == 1:
            return np.repeat(self.q, len(t), axis=0)
        t = np.clip(t, 0.0, self.duration)
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.q) - 2)
        h = (self.times[k + 1] - self.times[k])[:, None]
        s = (t - self.times[k])[:, None] / h
        back = 1.0 - s
        found: Array = (
            (1.0 + 2.0 * s) * back * back * self.q[k]
            + s * back * back * h * self.slopes[k]
            + s * s * (3.0 - 2.0 * s) * self.q[k + 1]
            - s * s * back * h * self.slopes[k + 1]
        )
        return found


def _slopes(u: Array, q: Array) -> Array:
    """Slopes (n, j) of the spline that is at rest at both ends; a tridiagonal system, solved by elimination."""
    h = np.diff(u)[:, None]
    rise = np.diff(q, axis=0) / h
    n = len(q)
    slopes = np.zeros_like(q)
    pivot, right = np.zeros((n, 1)), np.zeros_like(q)
    for k in range(1, n - 1):
        low, high = h[k], h[k - 1]
        known = 3.0 * (low * rise[k - 1] + high * rise[k])
        share = low / pivot[k - 1] if k > 1 else 0.0
        pivot[k] = 2.0 * (low + high) - share * (h[k - 2] if k > 1 else 0.0)
        right[k] = known - share * right[k - 1]
    for k in range(n - 2, 0, -1):
        slopes[k] = (right[k] - h[k - 1] * slopes[k + 1]) / pivot[k]
    return slopes


def _extremes(u: Array, q: Array, slopes: Array) -> tuple[Array, Array]:
    """The greatest first and second derivative (j,), by amount: the second is linear between knots."""
    h = np.diff(u)[:, None]
    rise, m0, m1 = np.diff(q, axis=0) / h, slopes[:-1], slopes[1:]
    begin, end = (6.0 * rise - 4.0 * m0 - 2.0 * m1) / h, (2.0 * m0 + 4.0 * m1 - 6.0 * rise) / h
    bend = end - begin
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.clip(np.where(bend != 0.0, -begin / bend, 0.0), 0.0, 1.0)
    inner = m0 + h * (begin * s + 0.5 * bend * s * s)
    first: Array = np.maximum(np.abs(slopes).max(axis=0), np.abs(inner).max(axis=0))
    second: Array = np.maximum(np.abs(begin), np.abs(end)).max(axis=0)
    return first, second
