"""Compiled helpers shared by the inverse kinematics along a path: turns, distances, and the choice of a branch."""

from __future__ import annotations

import math

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.tree_kernels import copy_row

TURN = 2.0 * math.pi
PER_TURN = 1.0 / TURN
LIMIT_SLACK = 1e-9  # [rad], [m] beyond a limit that still count as on it: rounding, not motion
TIE = 1e-9  # squared distances closer than this are equal: the lower branch number wins
JUMP = 0.35  # [rad] (20 deg) of one joint between two poses: a change of branch by more is not smooth
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
def square_distance(q: Array, previous: Array) -> float:
    """Squared distance of two joint vectors (j,)."""
    total = 0.0
    for i in range(q.shape[0]):
        total += np.square(q[i] - previous[i])
    return total


@kernel(inlined=True)
def is_next(
    angles: tuple[float, float, float, float, float, float],
    previous: Array,
    lower: Array,
    upper: Array,
    near: float,
    out: Array,
) -> bool:
    """Turn six revolute joints nearest to `previous`, into `out` (6,): whether they are the next row of a path.

    That is within limits, closer than the root of `near` [rad²], and no joint jumps.
    """
    distance, most, inside = 0.0, 0.0, True
    for i in range(6):
        value = angles[i] + TURN * math.floor(0.5 + (previous[i] - angles[i]) * PER_TURN)
        step = value - previous[i]
        inside = inside and lower[i] - LIMIT_SLACK <= value <= upper[i] + LIMIT_SLACK
        distance += step * step
        most = max(most, abs(step))
        out[i] = value
    return inside and distance < near and most <= JUMP


@kernel
def longest_turn(q: Array, previous: Array, revolute: Indices) -> float:
    """The greatest step [rad] of a revolute joint from `previous` to q (j,)."""
    most = 0.0
    for i in range(q.shape[0]):
        if revolute[i] == 1:
            most = max(most, abs(q[i] - previous[i]))
    return most


@kernel
def nearest_anywhere(candidates: Array, usable: Indices, previous: Array, revolute: Indices, out: Array) -> int:
    """The candidate nearest to `previous` whatever the limits: its branch, or −1; joints in `out` (j,)."""
    best, least = -1, np.inf
    for b in range(candidates.shape[0]):
        if usable[b] == 0:
            continue
        distance = 0.0
        for i in range(candidates.shape[1]):
            step = candidates[b, i] - previous[i]
            if revolute[i] == 1:
                step -= TURN * math.floor(0.5 + step * PER_TURN)
            distance += step * step
        if distance < least - TIE:
            best, least = b, distance
    if best >= 0:
        for i in range(candidates.shape[1]):
            step = candidates[best, i] - previous[i]
            if revolute[i] == 1:
                step -= TURN * math.floor(0.5 + step * PER_TURN)
            out[i] = previous[i] + step
    return best


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
    """The candidate (b, j) that continues from `previous` (j,): its branch and status; joints in `out` (j,).

    Candidates whose `usable` is 0 do not exist; the others are turned in place.
    `last_branch` is the branch of the pose before, or −1 at the start of a path,
    where any solution within limits will do and the nearest is taken. Along a
    path the arm goes smoothly where it can: beyond a limit (LIMIT) rather than by
    a jump, because a control would stop there; a jump (FLIP) remains where there is no smooth way.
    """
    best, least = -1, np.inf
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
                break
            if distance >= least:
                break
        if inside and distance < least - TIE:
            best, least = b, distance
    if best >= 0:
        copy_row(candidates[best], out)
        most = longest_turn(out, previous, revolute)
        if last_branch < 0 or most <= JUMP or (best == last_branch and most <= WINDING):
            return best, OK
    anywhere = nearest_anywhere(candidates, usable, previous, revolute, out)
    if anywhere < 0:
        copy_row(previous, out)
        return last_branch, REACH
    if best < 0 or longest_turn(out, previous, revolute) <= JUMP:
        return anywhere, LIMIT
    copy_row(candidates[best], out)
    return best, FLIP
