"""A smooth way through joint vectors: a cubic spline, run from rest to rest as fast as speeds and accelerations allow.

de Boor 1978, chapter IV: the slopes at the inner knots follow from continuous second derivatives; at both ends the
second derivative is zero. Knots are as far apart as the slowest joint needs for the way between them at full speed. The
times are the least that there are (`path_timing_kernels`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.planning.path_timing_kernels import fastest, seconds_along

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints

_MOST: Final = 1e6  # [rad/s, m/s, and per s] where a description names no limit
_STILL: Final = 1e-9  # [s] between knots that do not differ
_PARTS: Final = 48  # of the way between two knots, in each of which the acceleration along it is constant
_INSIDE: Final = (0.25, 0.5, 0.75)  # shares of such a part at which limits are looked at


class TipPace(NamedTuple):
    """How far the tip of the tool has `gone` at each of some joint vectors (n,) [m], and its greatest speed [m/s]."""

    gone: Array
    feed: float


@frozen(eq=False)
class JointSpline:
    """Joint vectors `q` (n, j) at the places `knots` (n,), with `slopes` (n, j) there.

    At `times` (m,) [s] it is at the places `grid` (m,), at `speeds` (m,) [1/s]; in between these change evenly.
    """

    knots: Array
    q: Array
    slopes: Array
    grid: Array
    times: Array
    speeds: Array

    @staticmethod
    def through(q: Array, joints: Joints, along: TipPace | None = None) -> JointSpline:
        """The spline through `q` (n, j), n at least 2; vectors that repeat the one before are left out.

        With `along` the tip is no faster than that, and a last column of the spline is how far it has come [m].
        """
        speed = np.minimum(np.asarray(joints.speed, dtype=float), _MOST)
        acceleration = np.minimum(np.asarray(joints.acceleration, dtype=float), _MOST)
        if along is not None:
            q = np.column_stack([q, along.gone])
            speed, acceleration = np.append(speed, along.feed), np.append(acceleration, _MOST)
        wait = (np.abs(np.diff(q, axis=0)) / speed).max(axis=1)
        q = q[np.concatenate([[True], wait > _STILL])]
        u = np.concatenate([[0.0], np.cumsum(wait[wait > _STILL])])
        if len(q) == 1:
            return JointSpline(knots=u, q=q, slopes=np.zeros_like(q), grid=u, times=u, speeds=np.zeros(1))
        slopes = _slopes(u, q)
        grid = _grid(u)
        first, second = _derivatives(u, q, slopes, grid)
        reach, times = np.empty(len(grid)), np.empty(len(grid))
        fastest(grid, first, second, _most(u, q, slopes, grid, speed), acceleration, reach)
        reach = reach / max(_beyond(u, q, slopes, grid, reach, acceleration), 1.0)
        seconds_along(grid, reach, times)
        return JointSpline(knots=u, q=q, slopes=slopes, grid=grid, times=times, speeds=np.sqrt(reach))

    @property
    def duration(self) -> float:
        return float(self.times[-1])

    def at(self, t: Array) -> Array:
        """Joint vectors (m, j) at times (m,) [s]; at rest before the first and after the last."""
        if len(self.q) == 1:
            return np.repeat(self.q, len(t), axis=0)
        t = np.clip(t, 0.0, self.duration)
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        share = (t - self.times[k]) / np.maximum(self.times[k + 1] - self.times[k], 1e-300)
        pace = self.speeds[k] + 0.5 * share * (self.speeds[k + 1] - self.speeds[k])  # on average since the grid point
        mean = 0.5 * (self.speeds[k] + self.speeds[k + 1])
        way = share * pace / np.maximum(mean, 1e-300)
        return _values(self.knots, self.q, self.slopes, self.grid[k] + way * (self.grid[k + 1] - self.grid[k]))


def _grid(u: Array) -> Array:
    """Places (m,) between knots (n,), the closer to each other the nearer to both ends of the way."""
    share = np.arange(_PARTS) / _PARTS
    shares = np.tile(share, (len(u) - 1, 1))
    shares[0] *= shares[0]
    back = 1.0 - shares[-1]
    shares[-1] = 1.0 - back * back if len(u) > 2 else share * share * (3.0 - 2.0 * share)
    return np.append((u[:-1, None] + shares * np.diff(u)[:, None]).ravel(), u[-1])


def _values(u: Array, q: Array, slopes: Array, place: Array) -> Array:
    """Joint vectors (m, j) at places (m,) of the spline."""
    k, h, s = _within(u, place)
    back = 1.0 - s
    found: Array = (
        (1.0 + 2.0 * s) * back * back * q[k]
        + s * back * back * h * slopes[k]
        + s * s * (3.0 - 2.0 * s) * q[k + 1]
        - s * s * back * h * slopes[k + 1]
    )
    return found


def _derivatives(u: Array, q: Array, slopes: Array, place: Array) -> tuple[Array, Array]:
    """First and second derivatives (m, j) at places (m,) of the spline."""
    k, h, s = _within(u, place)
    rise, m0, m1 = (q[k + 1] - q[k]) / h, slopes[k], slopes[k + 1]
    begin, end = (6.0 * rise - 4.0 * m0 - 2.0 * m1) / h, (2.0 * m0 + 4.0 * m1 - 6.0 * rise) / h
    return m0 + h * s * (begin + 0.5 * s * (end - begin)), begin + s * (end - begin)


def _within(u: Array, place: Array) -> tuple[NDArray[np.intp], Array, Array]:
    """Between which knots places (m,) are, how far (m, 1) these are apart, and the share (m, 1) of that."""
    k = np.clip(np.searchsorted(u, place, side="right") - 1, 0, len(u) - 2)
    h = (u[k + 1] - u[k])[:, None]
    return k, h, (place - u[k])[:, None] / h


def _most(u: Array, q: Array, slopes: Array, grid: Array, speed: Array) -> Array:
    """The greatest s'² (m,) at grid points with which no joint is too fast up to the points beside them."""
    step = np.diff(grid)
    at = [_derivatives(u, q, slopes, place)[0] for place in (grid[:-1], *(grid[:-1] + s * step for s in _INSIDE))]
    at.append(_derivatives(u, q, slopes, grid[1:])[0])
    part = (np.abs(np.array(at)).max(axis=0) / speed).max(axis=1)
    beside = np.maximum(np.append(part, 0.0), np.append(0.0, part))
    most: Array = 1.0 / (np.maximum(beside, 1e-12) * np.maximum(beside, 1e-12))
    return most


def _beyond(u: Array, q: Array, slopes: Array, grid: Array, reach: Array, acceleration: Array) -> float:
    """By what share s'² (m,) is too much for an acceleration between grid points, where none was looked at."""
    step, along = np.diff(grid), 0.5 * np.diff(reach) / np.diff(grid)
    worst = 0.0
    for share in _INSIDE:
        first, second = _derivatives(u, q, slopes, grid[:-1] + share * step)
        x = (reach[:-1] + share * np.diff(reach))[:, None]
        worst = max(worst, float((np.abs(first * along[:, None] + second * x) / acceleration).max()))
    return worst


def _slopes(u: Array, q: Array) -> Array:
    """Slopes (n, j) of the spline without second derivative at both ends; a tridiagonal system, by elimination."""
    h = np.diff(u)[:, None]
    rise = np.diff(q, axis=0) / h
    n = len(q)
    slopes, right = np.zeros_like(q), np.zeros_like(q)
    pivot = np.zeros((n, 1))
    pivot[0], right[0] = 2.0, 3.0 * rise[0]
    above = np.ones((n, 1))  # beside the pivots, as they are above them
    for k in range(1, n):
        if k < n - 1:
            low, middle, above[k] = h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1]
            known = 3.0 * (h[k] * rise[k - 1] + h[k - 1] * rise[k])
        else:
            low, middle, known = np.ones(1), 2.0, 3.0 * rise[-1]
        share = low / pivot[k - 1]
        pivot[k] = middle - share * above[k - 1]
        right[k] = known - share * right[k - 1]
    slopes[-1] = right[-1] / pivot[-1]
    for k in range(n - 2, -1, -1):
        slopes[k] = (right[k] - above[k] * slopes[k + 1]) / pivot[k]
    return slopes
