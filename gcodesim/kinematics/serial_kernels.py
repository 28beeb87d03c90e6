"""Numeric inverse kinematics along a path: warm start, other starts where that fails, compiled."""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.newton_kernels import newton
from gcodesim.kinematics.path_kernels import FLIP, JUMP, LIMIT, LIMIT_SLACK, OK, REACH, SINGULAR, WINDING, nearest_turn
from gcodesim.kinematics.protocol import Statuses

GOOD = 1e-9  # [m], [rad] of residual that counts as reached
PIVOT = 1e-11  # relative pivot of J Jᵀ below which the arm counts as singular
SEARCH_EVERY = 64  # rows out of reach in a row after which all starts are tried again: a long way outside stays cheap


@kernel
def settle(q: Array, previous: Array, lower: Array, upper: Array, prismatic: Indices) -> tuple[bool, float, float]:
    """Turn revolute joints nearest to `previous`, in place: within limits?, squared distance, longest turn."""
    inside, distance, most = True, 0.0, 0.0
    for i in range(q.shape[0]):
        if prismatic[i] == 0:
            q[i] = nearest_turn(q[i], previous[i], lower[i], upper[i])
            most = max(most, abs(q[i] - previous[i]))
        distance += (q[i] - previous[i]) ** 2
        if q[i] > upper[i] + LIMIT_SLACK or q[i] < lower[i] - LIMIT_SLACK:
            inside = False
    return inside, distance, most


@kernel
def inverse_path(
    targets: Array,
    free: int,
    seed: Array,
    starts: Array,
    lower: Array,
    upper: Array,
    parent: Indices,
    before: Array,
    axis: Array,
    prismatic: Indices,
    path: Indices,
    carrier: int,
    offset: Array,
    out: Array,
    status: Statuses,
) -> None:
    """Joints `out` (n, j) and `status` (n,) along poses `targets` (n, 4, 4) of the rider at `offset` on `carrier`.

    Each row starts from the one before. The first row, and a row where that
    fails, tries all `starts` (s, j) and takes the solution nearest to the row
    before. With `free` = 1 the turn about the rider's Z is left open.
    """
    count = seed.shape[0]
    frames, J, A = np.empty((count, 4, 4)), np.empty((6, count)), np.empty((6, 6))
    X, e = np.empty((4, 4)), np.empty(6)
    previous, q, best = seed.copy(), np.empty(count), np.empty(count)
    lost, outside = 0, False
    for k in range(targets.shape[0]):
        q[:] = previous
        residual, pivot = newton(
            targets[k], free, q, parent, before, axis, prismatic, path, carrier, offset, frames, J, A, X, e
        )
        inside, least, most = settle(q, previous, lower, upper, prismatic)
        state = REACH
        if residual < GOOD:
            state = OK if inside else LIMIT
        if state == REACH:
            search = lost % SEARCH_EVERY == 0
        else:
            search = k == 0 or most > JUMP or (state == LIMIT and not outside)
        if search:
            best[:] = q
            for s in range(starts.shape[0]):
                q[:] = starts[s]
                miss, pivot2 = newton(
                    targets[k], free, q, parent, before, axis, prismatic, path, carrier, offset, frames, J, A, X, e
                )
                if miss > GOOD:
                    continue
                fits, distance, turn = settle(q, previous, lower, upper, prismatic)
                if state == REACH or (fits and state == LIMIT) or (fits == (state == OK) and distance < least):
                    state = OK if fits else LIMIT
                    least, most, pivot = distance, turn, pivot2
                    best[:] = q
            q[:] = best
        if state == OK and k > 0 and (most > WINDING or (search and most > JUMP)):
            state = FLIP
        elif state == OK and count >= 6 and pivot < PIVOT:  # with fewer joints J Jᵀ never is regular
            state = SINGULAR
        if state == REACH:
            q[:] = previous
        lost = lost + 1 if state == REACH else 0
        outside = state == LIMIT
        status[k] = state
        out[k] = q
        previous[:] = q


@kernel
def all_solutions(
    target: Array,
    starts: Array,
    parent: Indices,
    before: Array,
    axis: Array,
    prismatic: Indices,
    path: Indices,
    carrier: int,
    offset: Array,
    out: Array,
    found: Indices,
) -> None:
    """Where each of the `starts` (s, j) leads: joints `out` (s, j), and `found` (s,) 1 where the pose was reached."""
    count = starts.shape[1]
    frames, J, A = np.empty((count, 4, 4)), np.empty((6, count)), np.empty((6, 6))
    X, e = np.empty((4, 4)), np.empty(6)
    for s in range(starts.shape[0]):
        out[s] = starts[s]
        miss, _ = newton(target, 0, out[s], parent, before, axis, prismatic, path, carrier, offset, frames, J, A, X, e)
        found[s] = 1 if miss < GOOD else 0
