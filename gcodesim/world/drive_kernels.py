"""Motors, gears and links of an arm in short steps: motors obey a law, gears are springs with dampers, links have mass.

Spong 1987 (eq. 2.14): links q with mass matrix M(q), rotors theta (as seen from the links) with inertia B, gears with
stiffness K and damping D between them, tau the motors, c friction:

    M(q) q'' + h(q, q') = K (theta - q) + D (theta' - q') + J' F
    B theta'' + c(theta') = tau - K (theta - q) - D (theta' - q')

A step of the simulation is divided into parts of at most `SHORTEST`; M, h and J are those of its beginning. Each part
is a linearly implicit Euler step: gears, friction and the servo stiffness of `pd` count with their values at its end,
so that no stiffness can make it unstable. Where the process pushes, the end of the step is an affine function of its
wrench; `foresight_kernels.foresee` gives that function, so that tool and process can be solved together.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Tree
from gcodesim.kinematics.dynamics_kernels import MovedBodies, efforts_along
from gcodesim.kinematics.tree_kernels import fill_jacobian, joint_frames, place

Flags = NDArray[np.int64]

PLACED, SERVO, COMPUTED, GIVEN = 0, 1, 2, 3
"""Laws of motors: they stand where they are to stand; PD; PD with all torques of the model fed forward; a torque that
somebody else computes."""

CREEP = 1e-3
"""[rad/s, m/s] Below this speed Coulomb friction grows with the speed, so that a joint may come to rest."""

BRAKE = 0.5
"""Share of what its motor has left with which a late joint counts on being braked."""


class Drives(NamedTuple):
    """What moves j joints; (j,) each. A stiffness of 0 is a rigid gear; no limit is infinite.

    `stiffness` and `damping` are those of servos [N·m/rad, N·m·s/rad]. `ahead`: motors turn further by what the torque
    of the commanded motion winds up in the gears, not by gravity's alone; and `limit` and efforts are those of joints,
    to which what a rotor needs to follow its command comes on top, as where nobody asks about rotors.
    """

    law: int
    rotor: Array
    gear: Array
    gear_damping: Array
    limit: Array
    coulomb: Array
    viscous: Array
    stiffness: Array
    damping: Array
    ahead: bool


class LinkBodies(NamedTuple):
    """The links as rigid bodies: see `efforts_along`. `tip` (4, 4) rides on the joint that carries the flange."""

    gravity: Array
    moved: MovedBodies
    tree: Tree
    tip: Array


class DriveState(NamedTuple):
    """(j,) each: links q, qd; rotors theta, thetad; `sag` is how far known gravity winds up the gears."""

    q: Array
    qd: Array
    theta: Array
    thetad: Array
    sag: Array


class Aim(NamedTuple):
    """Where a step begins and ends by command, (j,) each: joints and their speeds, and torques fed forward."""

    q0: Array
    q1: Array
    v0: Array
    v1: Array
    forward: Array


class StepRoom(NamedTuple):
    """What holds during one step of m parts of `h` seconds, and room to work in."""

    mass: Array  # (j, j) of the links
    bias: Array  # (j,) gravity, Coriolis and centrifugal
    static: Array  # (j,) gravity alone
    jacobian: Array  # (6, j) of the tip
    frames: Array  # (j, 4, 4)
    place: Array  # (4, 4)
    rows: Array  # (5, j + 2, j) of `efforts_along`: q, qd, qdd, none, out
    push: Array  # (j + 2, 6) zeros
    matrix: Array  # (j, j)
    right: Array  # (j,)
    speed: Array  # (j,) qd at the end of a part
    motor: Array  # (j,) torque of motors
    shaft: Array  # (j,) torque that gears hand on to links
    full: Flags  # (m, j) motors at their limit: -1, 1
    kept: DriveState
    response: Array  # (6, 6)
    wind: Array  # (j,) by which sag grows in this step


@kernel
def room_of(joints: int, parts: int) -> StepRoom:
    """Room for `joints` and `parts`."""
    j = joints
    kept = DriveState(np.zeros(j), np.zeros(j), np.zeros(j), np.zeros(j), np.zeros(j))
    return StepRoom(
        np.zeros((j, j)), np.zeros(j), np.zeros(j), np.zeros((6, j)), np.zeros((j, 4, 4)), np.zeros((4, 4)),
        np.zeros((5, j + 2, j)), np.zeros((j + 2, 6)), np.zeros((j, j)), np.zeros(j), np.zeros(j), np.zeros(j),
        np.zeros(j), np.zeros((parts, j), dtype=np.int64), kept, np.zeros((6, 6)), np.zeros(j),
    )  # fmt: skip


@kernel
def copy_state(source: DriveState, target: DriveState) -> None:
    """Copy all numbers of a state."""
    for i in range(source.q.shape[0]):
        target.q[i], target.qd[i] = source.q[i], source.qd[i]
        target.theta[i], target.thetad[i] = source.theta[i], source.thetad[i]
        target.sag[i] = source.sag[i]


@kernel
def weigh(body: LinkBodies, state: DriveState, room: StepRoom) -> None:
    """Mass matrix, bias, gravity and Jacobian where the links are: columns of M as efforts of unit accelerations."""
    joints = state.q.shape[0]
    q, qd, qdd, out = room.rows[0], room.rows[1], room.rows[2], room.rows[4]
    for k in range(joints + 2):
        for i in range(joints):
            q[k, i] = state.q[i]
            qd[k, i] = state.qd[i] if k == 0 else 0.0
            qdd[k, i] = 1.0 if k == i + 2 else 0.0
    efforts_along(q, qd, qdd, room.push, body.gravity, body.moved, body.tree, body.tip, out)
    for i in range(joints):
        room.bias[i], room.static[i] = out[0, i], out[1, i]
        for k in range(joints):
            room.mass[i, k] = out[k + 2, i] - out[1, i]
    tree, X = body.tree, room.place
    joint_frames(state.q, tree.parent, tree.before, tree.axis, tree.prismatic, room.frames)
    place(room.frames, tree.flange_carrier, body.tip, X)
    fill_jacobian(room.frames, tree.axis, tree.prismatic, tree.path, X[0, 3], X[1, 3], X[2, 3], room.jacobian)


@kernel
def mean_pull(i: int, dt: float, aim: Aim) -> float:
    """Acceleration [rad/s²] by command from the step before to this one, by their mean speeds; see `next_aim`."""
    return float(2.0 * (aim.v1[i] - (aim.q1[i] - aim.q0[i]) / dt) / dt)


@kernel
def feed_forward(dt: float, drives: Drives, aim: Aim, state: DriveState, room: StepRoom) -> None:
    """What a control adds in a step because it knows its robot: torques, and how far it turns motors against gears.

    All know gravity; with `COMPUTED` and `ahead` all torques of the commanded motion, at the joints and speeds of the
    state (PD+, Paden and Panja 1988: computed torque whose loop does not pass through the mass matrix, so that it is
    stable with gears that are springs too). `weigh` comes first.
    """
    joints = state.q.shape[0]
    for i in range(joints):
        torque = 0.0
        if drives.law == COMPUTED or drives.ahead:
            torque = room.bias[i] - room.static[i]
            for k in range(joints):
                torque += room.mass[i, k] * (mean_pull(k, dt, aim) if drives.ahead else (aim.v1[k] - aim.v0[k]) / dt)
        if drives.law == COMPUTED:
            aim.forward[i] = torque + drives.rotor[i] * (aim.v1[i] - aim.v0[i]) / dt
        sag = (room.static[i] + torque) / drives.gear[i] if drives.gear[i] > 0.0 else 0.0
        room.wind[i] = sag - state.sag[i]


@kernel
def factor_in_place(A: Array) -> None:
    """Factor a symmetric positive A (n, n), of which the lower half is read and replaced (Cholesky)."""
    n = A.shape[0]
    for i in range(n):
        for k in range(i + 1):
            total = A[i, k]
            for m in range(k):
                total -= A[i, m] * A[k, m]
            if i == k:
                A[i, i] = np.sqrt(max(total, 1e-300))
            else:
                A[i, k] = total / A[k, k]


@kernel
def solve_factored(A: Array, b: Array) -> None:
    """Solve A x = b for a matrix that `factor_in_place` has factored; x is left in `b` (n,)."""
    n = b.shape[0]
    for i in range(n):
        total = b[i]
        for m in range(i):
            total -= A[i, m] * b[m]
        b[i] = total / A[i, i]
    for i in range(n - 1, -1, -1):
        total = b[i]
        for m in range(i + 1, n):
            total -= A[m, i] * b[m]
        b[i] = total / A[i, i]


@kernel
def placed_speed(
    i: int, drives: Drives, state: DriveState, before: float, after: float, h: float, room: StepRoom
) -> float:
    """Speed of a motor that is to go from `before` to `after` in a part; a late one catches up so that it can brake."""
    late = before - state.theta[i]
    catch = abs(late) / h
    spare = max(drives.limit[i] - abs(room.bias[i]), 0.1 * drives.limit[i])
    if spare < np.inf:
        catch = min(catch, np.sqrt(2.0 * BRAKE * spare / max(room.mass[i, i] + drives.rotor[i], 1e-12) * abs(late)))
    return float((after - before) / h + (catch if late > 0.0 else -catch))


@kernel
def aimed(i: int, t: float, dt: float, aim: Aim) -> tuple[float, float, float]:
    """Position, speed and acceleration by command of a joint at `t` of its step: a cubic through both ends."""
    x = t / dt
    d = aim.q1[i] - aim.q0[i]
    a, b = aim.v0[i] * dt, aim.v1[i] * dt
    c2, c3 = 3.0 * d - 2.0 * a - b, a + b - 2.0 * d
    return (
        aim.q0[i] + x * (a + x * (c2 + x * c3)),
        (a + x * (2.0 * c2 + 3.0 * x * c3)) / dt,
        (2.0 * c2 + 6.0 * x * c3) / (dt * dt),
    )


@kernel
def part_step(
    part: int, h: float, dt: float, drives: Drives, aim: Aim, state: DriveState, wrench: Array, room: StepRoom,
    frozen: bool,
) -> None:  # fmt: skip
    """One part of a step. Motors at their limit go to `room.full`; `frozen`: they are those that stand there."""
    joints = state.q.shape[0]
    parts = dt / h
    full = room.full[part]
    if drives.law == GIVEN:
        for i in range(joints):
            room.motor[i] = aim.forward[i]
    if not frozen:
        for i in range(joints):
            full[i] = 0
    for _ in range(joints + 1):
        assemble(part, h, dt, parts, drives, aim, state, wrench, room)
        changed = settle_part(part, h, dt, parts, drives, aim, state, wrench, room, frozen)
        if not changed:
            break
    for i in range(joints):
        state.qd[i] = room.speed[i]
        state.q[i] += h * room.speed[i]
        state.theta[i] += h * state.thetad[i]
        state.sag[i] += room.wind[i] / parts
        if drives.gear[i] == 0.0:
            state.theta[i], state.thetad[i] = state.q[i], state.qd[i]


@kernel
def friction_of(i: int, drives: Drives, speed: float) -> float:
    """Friction [N·m·s/rad, N·s/m] of a motor as a damper at `speed`: Coulomb and viscous."""
    return float(drives.coulomb[i] / max(abs(speed), CREEP) + drives.viscous[i])


@kernel
def rotor_ahead(i: int, dt: float, drives: Drives, aim: Aim) -> float:
    """Torque [N·m] that the rotor takes to follow its command, where that is no matter of the limit."""
    return float(drives.rotor[i] * mean_pull(i, dt, aim)) if drives.ahead else 0.0


@kernel
def motor_row(
    i: int, part: int, h: float, dt: float, drives: Drives, aim: Aim, state: DriveState, room: StepRoom
) -> tuple[float, float]:
    """b and r of a motor's part: b theta'_end = r - h (torque of the gear)."""
    b = drives.rotor[i] + h * friction_of(i, drives, state.thetad[i])
    r = drives.rotor[i] * state.thetad[i]
    side = room.full[part, i]
    if side != 0:
        return b, r + h * (side * drives.limit[i] + rotor_ahead(i, dt, drives, aim))
    if drives.law == SERVO or drives.law == COMPUTED:
        q, v, _ = aimed(i, (part + 1) * h, dt, aim)
        target = q + state.sag[i]
        k, d = drives.stiffness[i], drives.damping[i]
        b += h * d + h * h * k
        r += h * (room.static[i] + aim.forward[i] + k * (target - state.theta[i]) + d * v)
        return b, r
    return b, r + h * room.motor[i]


@kernel
def placed_from(
    i: int, part: int, h: float, dt: float, parts: float, drives: Drives, aim: Aim, state: DriveState, room: StepRoom
) -> float:
    """Speed in a part of a motor whose law is PLACED."""
    before, _, _ = aimed(i, part * h, dt, aim)
    after, _, _ = aimed(i, (part + 1) * h, dt, aim)
    wound = state.sag[i] + room.wind[i] / parts
    return float(placed_speed(i, drives, state, before + state.sag[i], after + wound, h, room))


@kernel
def assemble(
    part: int, h: float, dt: float, parts: float, drives: Drives, aim: Aim, state: DriveState, wrench: Array,
    room: StepRoom,
) -> None:  # fmt: skip
    """Set up and solve the equations of the links: `room.speed` at the end of the part."""
    joints = state.q.shape[0]
    A, right, J = room.matrix, room.right, room.jacobian
    for i in range(joints):
        total = -room.bias[i]
        for c in range(6):
            total += J[c, i] * wrench[c]
        total *= h
        for k in range(joints):
            A[i, k] = room.mass[i, k]
            total += room.mass[i, k] * state.qd[k]
        right[i] = total
    for i in range(joints):
        spring = drives.gear[i] * (state.theta[i] - state.q[i])
        s = h * drives.gear_damping[i] + h * h * drives.gear[i]
        if drives.law == PLACED and room.full[part, i] == 0:
            if s > 0.0:
                A[i, i] += s
                right[i] += h * spring + s * placed_from(i, part, h, dt, parts, drives, aim, state, room)
            continue
        b, r = motor_row(i, part, h, dt, drives, aim, state, room)
        if s > 0.0:
            A[i, i] += s * b / (b + s)
            right[i] += h * spring + s * (r - h * spring) / (b + s)
        else:
            A[i, i] += b
            right[i] += r
    for i in range(joints):  # joints whose speed is known
        if drives.law == PLACED and room.full[part, i] == 0 and drives.gear[i] == 0.0:
            speed = placed_from(i, part, h, dt, parts, drives, aim, state, room)
            for k in range(joints):
                right[k] -= A[k, i] * speed
                A[k, i], A[i, k] = 0.0, 0.0
            A[i, i], right[i] = 1.0, speed
    for i in range(joints):
        for k in range(i):  # Cholesky reads one half; rounding of efforts must not matter
            A[i, k] = 0.5 * (A[i, k] + A[k, i])
    for i in range(joints):
        room.speed[i] = right[i]
    factor_in_place(A)
    solve_factored(A, room.speed)


@kernel
def settle_part(
    part: int, h: float, dt: float, parts: float, drives: Drives, aim: Aim, state: DriveState, wrench: Array,
    room: StepRoom, frozen: bool,
) -> bool:  # fmt: skip
    """Speeds of motors, torques of motors and shafts once the links' speeds are known.

    Returns whether a motor is beyond its limit: then `room.full` says so, nothing has changed, and the part is to be
    solved again.
    """
    joints = state.q.shape[0]
    changed = False
    for i in range(joints):
        spring = drives.gear[i] * (state.theta[i] - state.q[i])
        s = h * drives.gear_damping[i] + h * h * drives.gear[i]
        side = room.full[part, i]
        if drives.law == PLACED and side == 0:
            if s > 0.0:
                speed = placed_from(i, part, h, dt, parts, drives, aim, state, room)
                shaft = spring + s / h * (speed - room.speed[i])
            else:
                speed = room.speed[i]
                shaft = room.bias[i]
                for c in range(6):
                    shaft -= room.jacobian[c, i] * wrench[c]
                for k in range(joints):
                    shaft += room.mass[i, k] * (room.speed[k] - state.qd[k]) / h
            motor = shaft + drives.rotor[i] * (speed - state.thetad[i]) / h
            motor += friction_of(i, drives, state.thetad[i]) * speed - rotor_ahead(i, dt, drives, aim)
        else:
            b, r = motor_row(i, part, h, dt, drives, aim, state, room)
            if s > 0.0:
                speed = (r - h * spring + s * room.speed[i]) / (b + s)
                shaft = spring + s / h * (speed - room.speed[i])
            else:
                speed = room.speed[i]
                shaft = (r - b * speed) / h
            if side != 0:
                motor = side * drives.limit[i]
            elif drives.law == SERVO or drives.law == COMPUTED:
                q, v, _ = aimed(i, (part + 1) * h, dt, aim)
                late = q + state.sag[i] - state.theta[i] - h * speed
                motor = room.static[i] + aim.forward[i] + drives.stiffness[i] * late + drives.damping[i] * (v - speed)
            else:
                motor = aim.forward[i]
        if not frozen and side == 0 and abs(motor) > drives.limit[i]:
            room.full[part, i] = 1 if motor > 0.0 else -1
            changed = True
        room.shaft[i] = shaft
        if not changed:
            room.right[i] = speed
            room.motor[i] = motor
    if not changed:
        for i in range(joints):
            state.thetad[i] = room.right[i]
    return changed


@kernel
def whole_step(
    h: float, dt: float, drives: Drives, aim: Aim, state: DriveState, wrench: Array, room: StepRoom, frozen: bool,
    effort: Array,
) -> None:  # fmt: skip
    """All parts of a step under `wrench` (6,) at the tip, base axes; `effort` (j,) is the mean of the motors."""
    parts = room.full.shape[0]
    for i in range(effort.shape[0]):
        effort[i] = 0.0
    for part in range(parts):
        part_step(part, h, dt, drives, aim, state, wrench, room, frozen)
        for i in range(effort.shape[0]):
            effort[i] += room.motor[i] / parts
