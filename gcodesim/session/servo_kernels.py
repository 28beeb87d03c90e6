"""Set points of joints that go to a target under limits of speed and acceleration, step by step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]


class JointBounds(NamedTuple):
    """Greatest speed and acceleration (j,) of joints, finite [rad/s, m/s, and per s]."""

    speed: Array
    acceleration: Array


@kernel
def approach(q: Array, qd: Array, target: Array, bounds: JointBounds, dt: float, out: Array) -> None:
    """Rows (n, j) of `out`: where joints at `q` (j,) with speeds `qd` (j,) are after each step; both are moved on.

    Each joint by itself brakes so that steps of falling speed, by a dt less each, end on its target.
    """
    for j in range(len(q)):
        most, change = bounds.speed[j], bounds.acceleration[j] * dt
        for k in range(len(out)):
            left = target[j] - q[j]
            way = abs(left)
            braking = change * (np.sqrt(0.25 + 2.0 * way / (change * dt)) - 0.5)
            wanted = min(most, braking, way / dt)
            if left < 0.0:
                wanted = -wanted
            qd[j] = min(max(wanted, qd[j] - change), qd[j] + change)
            q[j] += qd[j] * dt
            if abs(target[j] - q[j]) <= 1e-12:
                q[j] = target[j]
            out[k, j] = q[j]
