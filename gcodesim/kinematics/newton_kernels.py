"""One numeric solution: damped Newton steps from a start to a pose, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Tree
from gcodesim.kinematics.tree_kernels import fill_jacobian, joint_frames, place

DONE = 1e-11  # [m], [rad] of residual at which the steps end: further ones would only change rounding
STEPS = 50  # steps before a start is given up
LONGEST = 0.5  # [rad], [m] of the longest step of one joint: keeps a distant start from jumping over branches
DAMPING = 1e-2  # times the squared residual: Newton at the end, careful far away
PATIENCE = 6  # steps in which the residual falls by less than a hundredth, after which the pose counts as out of reach
LEAST_DAMPING = 1e-14  # share of the trace: keeps the matrix regular where the arm is singular


class NewtonRoom(NamedTuple):
    """What Newton steps of j joints work in.

    Joint `frames` (j, 4, 4), `jacobian` (6, j), the equations A y = e with A (6, 6), e (6,), and the pose X (4, 4).
    """

    frames: Array
    jacobian: Array
    A: Array
    e: Array
    X: Array


@kernel
def room_for(count: int) -> NewtonRoom:
    """Room for an arm of `count` joints."""
    return NewtonRoom(np.empty((count, 4, 4)), np.empty((6, count)), np.empty((6, 6)), np.empty(6), np.empty((4, 4)))


@kernel(lean=True)
def pose_error(X: Array, target: Array, e: Array) -> float:
    """Displacement `e` (6,) from X to target (4, 4), position then rotation vector, base axes; returns the largest.

    The rotation vector comes from the skew part and the trace of R_target R_Xᵀ and is exact below half a turn.
    """
    for r in range(3):
        e[r] = target[r, 3] - X[r, 3]
    wx, wy, wz, trace = 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        a0, a1, a2 = X[0, k], X[1, k], X[2, k]
        b0, b1, b2 = target[0, k], target[1, k], target[2, k]
        wx += a1 * b2 - a2 * b1
        wy += a2 * b0 - a0 * b2
        wz += a0 * b1 - a1 * b0
        trace += a0 * b0 + a1 * b1 + a2 * b2
    sine, cosine = 0.5 * math.sqrt(wx * wx + wy * wy + wz * wz), 0.5 * (trace - 1.0)
    if sine > 1e-9:
        scale = 0.5 * atan2(sine, cosine) / sine
        e[3], e[4], e[5] = wx * scale, wy * scale, wz * scale
    elif cosine > 0.0:
        e[3], e[4], e[5] = 0.5 * wx, 0.5 * wy, 0.5 * wz
    else:  # half a turn: the skew part is gone; a turn about X's own first axis leads away from there
        e[3], e[4], e[5] = X[0, 0] * math.pi, X[1, 0] * math.pi, X[2, 0] * math.pi
    most = 0.0
    for r in range(6):
        most = max(most, abs(e[r]))
    return most


@kernel(lean=True)
def solve_square(A: Array, x: Array) -> float:
    """Solve A y = x in place, A (6, 6) symmetric positive, by Cholesky; returns the least pivot over its diagonal."""
    least = 1.0
    for i in range(6):
        own = A[i, i]
        for k in range(i):
            total = A[i, k]
            for m in range(k):
                total -= A[i, m] * A[k, m]
            A[i, k] = total / A[k, k]
        total = own
        for m in range(i):
            total -= A[i, m] * A[i, m]
        ratio = total / own
        if ratio < least:
            least = ratio
        A[i, i] = math.sqrt(max(total, 1e-16 * own))
    for i in range(6):
        total = x[i]
        for m in range(i):
            total -= A[i, m] * x[m]
        x[i] = total / A[i, i]
    for i in range(5, -1, -1):
        total = x[i]
        for m in range(i + 1, 6):
            total -= A[m, i] * x[m]
        x[i] = total / A[i, i]
    return least


@kernel(lean=True)
def newton(target: Array, q: Array, tree: Tree, room: NewtonRoom, least: int) -> tuple[float, float]:
    """Drive q (j,), in place, to the pose `target` (4, 4) of the flange, in `least` steps at least.

    Returns the residual and the smallest pivot of J Jᵀ (0: singular). Steps are
    Jᵀ (J Jᵀ + λ)⁻¹ e (Wampler 1986), the shortest ones where there are more
    joints than needed.
    """
    parent, before, axis, prismatic, path = tree.parent, tree.before, tree.axis, tree.prismatic, tree.path
    carrier, offset = tree.flange_carrier, tree.flange_offset
    frames, J, A, e, X = room
    count = q.shape[0]
    pivot = 1.0
    residual, least_residual, waited = np.inf, np.inf, 0
    for number in range(STEPS):
        joint_frames(q, parent, before, axis, prismatic, frames)
        place(frames, carrier, offset, X)
        residual = pose_error(X, target, e)
        if residual < DONE and number >= least:
            break
        if residual < 0.99 * least_residual:
            least_residual, waited = residual, 0
        else:
            waited += 1
            if waited > PATIENCE:
                break
        fill_jacobian(frames, axis, prismatic, path, X[0, 3], X[1, 3], X[2, 3], J)
        trace = 0.0
        for r in range(6):
            for k in range(r + 1):
                total = 0.0
                for i in range(count):
                    total += J[r, i] * J[k, i]
                A[r, k] = total
            trace += A[r, r]
        damping = DAMPING * residual * residual + LEAST_DAMPING * trace
        for r in range(6):
            A[r, r] += damping
        pivot = solve_square(A, e)
        longest = 0.0
        for i in range(count):
            step = 0.0
            for r in range(6):
                step += J[r, i] * e[r]
            J[0, i] = step
            longest = max(longest, abs(step))
        scale = min(1.0, LONGEST / (longest + 1e-300))
        for i in range(count):
            q[i] += scale * J[0, i]
    return residual, pivot
