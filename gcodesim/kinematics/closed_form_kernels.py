"""Inverse kinematics along a path for arms with a closed form, compiled: which branch goes on from pose to pose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.parallel_axes_kernels import follow as follow_parallel_axes
from gcodesim.kinematics.parallel_axes_kernels import solve as solve_parallel_axes
from gcodesim.kinematics.path_kernels import OK, REACH, SINGULAR, choose, square_distance
from gcodesim.kinematics.plane_kernels import EXISTS, PlaneArm
from gcodesim.kinematics.protocol import Statuses
from gcodesim.kinematics.spherical_wrist_kernels import follow as follow_spherical_wrist
from gcodesim.kinematics.spherical_wrist_kernels import solve as solve_spherical_wrist
from gcodesim.kinematics.tree_kernels import copy_row

SPHERICAL_WRIST, PARALLEL_AXES = 0, 1


@kernel
def solve_family(
    family: int,
    X: Array,
    only: int,
    arm: PlaneArm,
    previous: Array,
    out: Array,
    flags: Indices,
) -> float:
    """`solve` of the family."""
    if family == PARALLEL_AXES:
        return solve_parallel_axes(X, only, arm, previous, out, flags)
    return solve_spherical_wrist(X, only, arm, previous, out, flags)


@kernel(lean=True, inlined=True)
def follow_family(
    family: int, X: Array, branch: int, arm: PlaneArm, lower: Array, upper: Array, previous: Array, out: Array
) -> bool:
    """`follow` of the family."""
    if family == PARALLEL_AXES:
        return follow_parallel_axes(X, branch, arm, lower, upper, previous, out)
    return follow_spherical_wrist(X, branch, arm, lower, upper, previous, out)


class PathRoom(NamedTuple):
    """What `inverse_path` works in: joints of the row before (6,), those of the branches (8, 6) and their flags (8,).

    All joints are `revolute` (6,).
    """

    previous: Array
    candidates: Array
    flags: Indices
    revolute: Indices


@kernel(lean=True)
def fill_path(
    family: int,
    X: Array,
    branch: int,
    arm: PlaneArm,
    lower: Array,
    upper: Array,
    room: PathRoom,
    out: Array,
    status: Statuses,
) -> None:
    """The loop of `inverse_path`, which has made all arrays, so that none is counted at each row."""
    previous, candidates, flags, revolute = room
    for k in range(X.shape[0]):
        if branch >= 0 and follow_family(family, X[k], branch, arm, lower, upper, previous, out[k]):
            status[k] = OK
            copy_row(out[k], previous)
            continue
        # the arm mostly keeps its shoulder and elbow branch; then the other branches need not be computed
        state = REACH
        if branch >= 0:
            apart = solve_family(family, X[k], branch, arm, previous, candidates, flags)
            found, state = choose(candidates, flags, previous, lower, upper, revolute, branch, out[k])
            if state == OK and square_distance(out[k], previous) < 0.25 * apart * apart:
                branch = found
            else:
                state = REACH
        if state == REACH:
            solve_family(family, X[k], -1, arm, previous, candidates, flags)
            branch, state = choose(candidates, flags, previous, lower, upper, revolute, branch, out[k])
        if state == OK and flags[branch] != EXISTS:
            state = SINGULAR
        status[k] = state
        copy_row(out[k], previous)


@kernel
def inverse_path(
    family: int,
    X: Array,
    seed: Array,
    branch: int,
    arm: PlaneArm,
    lower: Array,
    upper: Array,
    out: Array,
    status: Statuses,
) -> None:
    """Joints `out` (n, 6) and `status` (n,) along flange poses X (n, 4, 4), each row nearest to the one before.

    `family` is SPHERICAL_WRIST or PARALLEL_AXES; the other arguments are those of its `solve`.
    `branch` is the one of `seed` when that is a row of the same path, else −1.
    """
    room = PathRoom(np.empty(6), np.empty((8, 6)), np.zeros(8, dtype=np.int64), np.ones(6, dtype=np.int64))
    copy_row(seed, room.previous)
    fill_path(family, X, branch, arm, lower, upper, room, out, status)
