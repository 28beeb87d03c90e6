"""Numeric inverse kinematics along a path: warm start, other starts where that fails, compiled."""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices, Tree
from gcodesim.kinematics.newton_kernels import newton, room_for
from gcodesim.kinematics.path_kernels import FLIP, JUMP, LIMIT, LIMIT_SLACK, OK, REACH, SINGULAR, nearest_turn
from gcodesim.kinematics.protocol import Statuses
from gcodesim.kinematics.tree_kernels import copy_row

GOOD = 1e-9  # [m], [rad] of residual that counts as reached
PIVOT = 1e-11  # relative pivot of J Jᵀ below which the arm counts as singular
STILL = 1e-9  # [rad], [m] from row to row, within which an arm stands: its joints are to stay as they are
SEARCH_EVERY = 64  # consecutive rows out of reach after which all starts are tried again: a long way outside is cheap


@kernel
def settle(
    q: Array, previous: Array, lower: Array, upper: Array, prismatic: Indices, on: bool
) -> tuple[bool, float, float]:
    """Turn revolute joints nearest to `previous`, in place: within limits?, squared distance, longest turn.

    A turn within limits is preferred to a nearer one, unless the joint goes `on` along a path.
    """
    inside, distance, most = True, 0.0, 0.0
    for i in range(q.shape[0]):
        if prismatic[i] == 0:
            if on:
                q[i] = nearest_turn(q[i], previous[i], -np.inf, np.inf)
            else:
                q[i] = nearest_turn(q[i], previous[i], lower[i], upper[i])
            most = max(most, abs(q[i] - previous[i]))
        distance += np.square(q[i] - previous[i])
        if q[i] > upper[i] + LIMIT_SLACK or q[i] < lower[i] - LIMIT_SLACK:
            inside = False
    return inside, distance, most


@kernel
def farthest(q: Array, previous: Array) -> float:
    """The greatest step of a joint, revolute or not, from `previous` to q (j,)."""
    most = 0.0
    for i in range(q.shape[0]):
        most = max(most, abs(q[i] - previous[i]))
    return most


@kernel
def inverse_path(
    targets: Array,
    seed: Array,
    on_path: int,
    starts: Array,
    lower: Array,
    upper: Array,
    tree: Tree,
    out: Array,
    status: Statuses,
) -> None:
    """Joints `out` (n, j) and `status` (n,) along poses `targets` (n, 4, 4) of the flange.

    Each row starts where the two before it lead, which mostly takes one step less than to start from the one before;
    that is next. The first row, and a row where both fail, tries all `starts` (s, j) and takes the solution nearest to
    the row before. `on_path` = 1 when `seed` is a row of the same path, so that no path begins here.
    """
    count, prismatic = seed.shape[0], tree.prismatic
    room = room_for(count)
    previous, q, best, step = np.empty(count), np.empty(count), np.empty(count), np.zeros(count)
    copy_row(seed, previous)
    lost, most = 0, 0.0
    for k in range(targets.shape[0]):
        going = k > 0 or on_path == 1
        moves = 0
        for i in range(count):
            q[i] = previous[i] + step[i]
            if step[i] != 0.0:
                moves = 1  # where it leads may be near enough; a step says besides whether the arm is singular there
        residual, pivot = newton(targets[k], q, tree, room, moves)
        if moves == 1 and (residual >= GOOD or farthest(q, previous) > JUMP):
            copy_row(previous, q)
            residual, pivot = newton(targets[k], q, tree, room, 0)
        state, least = REACH, np.inf
        if residual < GOOD:
            inside, least, most = settle(q, previous, lower, upper, prismatic, going)
            if inside or (going and most <= JUMP):
                state = OK if inside else LIMIT
        # along a path the smooth continuation is taken; otherwise the nearest solution within limits of a search
        if not going or (state == REACH and lost % SEARCH_EVERY == 0) or (state == OK and most > JUMP):
            copy_row(q, best)
            found = state
            for s in range(starts.shape[0]):
                copy_row(starts[s], q)
                miss, pivot2 = newton(targets[k], q, tree, room, 0)
                if miss > GOOD:
                    continue
                inside, distance, turn = settle(q, previous, lower, upper, prismatic, False)
                if found == REACH or (inside and found == LIMIT) or (inside == (found == OK) and distance < least):
                    found = OK if inside else LIMIT
                    least, most, pivot = distance, turn, pivot2
                    copy_row(q, best)
            copy_row(best, q)
            state = found
            if state == OK and going and most > JUMP:
                state = FLIP
        if state == OK and count >= 6 and pivot < PIVOT:  # with fewer joints J Jᵀ is never regular
            state = SINGULAR
        if state == REACH:
            copy_row(previous, q)
        lost = lost + 1 if state == REACH else 0
        status[k] = state
        smooth = k > 0 and state != REACH and STILL < farthest(q, previous) <= JUMP
        for i in range(count):
            step[i] = q[i] - previous[i] if smooth else 0.0
        copy_row(q, out[k])
        copy_row(q, previous)


@kernel
def all_solutions(target: Array, starts: Array, tree: Tree, out: Array, found: Indices) -> None:
    """Where each of the `starts` (s, j) leads: joints `out` (s, j), and `found` (s,) 1 where the pose was reached."""
    room = room_for(starts.shape[1])
    for s in range(starts.shape[0]):
        copy_row(starts[s], out[s])
        miss, _ = newton(target, out[s], tree, room, 0)
        found[s] = 1 if miss < GOOD else 0
