"""Compiled helpers shared by the inverse kinematics along a path: turns, distances, and the choice of a branch."""

from __future__ import annotations

import math

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices

TURN = 2.0 * math.pi
PER_TURN = 1.0 / TURN
LIMIT_SLACK = 1e-9  # [rad], [m] beyond a limit that still counts as on it: rounding, not motion
TIE = 1e-9  # squared distances closer than this are equal: the lower branch number wins
JUMP = 0.35  # [rad] (20 deg) of one joint between two poses: a change of branch by more is no smooth passage
WINDING = 3.0  # [rad] of one joint between two poses: a turn was unwound

OK, REACH, LIMIT, SINGULAR, FLIP = 0, 1, 2, 3, 4


@kernel
def nearest_turn(angle: float, previous: float, lower: float, upper: float) -> float:
    """The angle plus whole turns that is nearest to `previous` within limits; out of limits when no turn fits."""
    value = angle + TURN * math.floor(0.5 + (previous - angle) * PER_TURN)
    if value > upper + LIMIT_SLACK:
        down = value - TURN * math.ceil((value - upper - LIMIT_SLACK) / TURN)
        if down >= lower - LIMIT_SLACK:
            return down
    elif value < lower - LIMIT_SLACK:
        up = value + TURN * math.ceil((lower - LIMIT_SLACK - value) / TURN)
        if up <= upper + LIMIT_SLACK:
            return up
    return value


@kernel
def choose(
    candidates: Array,
    usable: Indices,
    previous: Array,
    lower: Array,
    upper: Array,
    revolute: Indices,
    last_branch: int,
    out: Array,
) -> tuple[int, int]:
    """The candidate (b, j) nearest to `previous` (j,): its branch and status, joints in `out` (j,).

    Candidates whose `usable` is 0 do not exist. Those within limits go first;
    `last_branch` is the branch of the pose before, or −1 at the start of a path.
    Candidates are turned in place to the turn nearest to `previous`.
    """
    best, best_outside = -1, -1
    least, least_outside = np.inf, np.inf
    for b in range(candidates.shape[0]):
        if usable[b] == 0:
            continue
        distance = 0.0
        inside = True
        for i in range(candidates.shape[1]):
            value = candidates[b, i]
            if revolute[i] == 1:
                value = nearest_turn(value, previous[i], lower[i], upper[i])
                candidates[b, i] = value
            step = value - previous[i]
            distance += step * step
            if value > upper[i] + LIMIT_SLACK or value < lower[i] - LIMIT_SLACK:
                inside = False
            if best >= 0 and (not inside or distance >= least):
                break  # there is a better one already
        if best >= 0 and distance >= least:
            continue
        if inside:
            if distance < least - TIE:
                best, least = b, distance
        elif distance < least_outside - TIE:
            best_outside, least_outside = b, distance
    if best < 0:
        if best_outside < 0:
            out[:] = previous
            return last_branch, REACH
        out[:] = candidates[best_outside]
        return best_outside, LIMIT
    out[:] = candidates[best]
    if last_branch >= 0:
        most = 0.0
        for i in range(out.shape[0]):
            if revolute[i] == 1:
                most = max(most, abs(out[i] - previous[i]))
        if most > WINDING or (best != last_branch and most > JUMP):
            return best, FLIP
    return best, OK
