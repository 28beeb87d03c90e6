"""Links on gears that are springs with dampers, under motors that are where they are to be: each step as a linear map.

With e how far links are off their motors, besides what gravity winds up (Spong 1987, eq. 2.14, theta known):

    M e'' + D e' + K e = J' F - M theta'' - (h - g)

A control that turns its motors further by what their motion winds up in the gears leaves J' F alone on the right: then
e is what the process does.

M, h and J are those of the middle of a step, in which the acceleration of the motors changes linearly. A small part of
it is made by the L-stable diagonally implicit method of second order (Alexander 1977), which bears any stiffness. Two
such parts, one after the other, are again a linear map; so a part is doubled until it is the step, which costs a
logarithm of the number of parts. The map is the same for every wrench, so that the cut is solved against it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.processes.swing_kernels import Swings
from gcodesim.world.drive_kernels import (
    Drives,
    DriveState,
    LinkBodies,
    factor_in_place,
    friction_of,
    room_of,
    solve_factored,
    weigh,
)

GAMMA = 1.0 - 0.5 * np.sqrt(2.0)


class MotorWay(NamedTuple):
    """What motors do in n steps: q (n + 1, j) at the ends of steps, the beginning first; speeds `qd` (n + 1, j).

    `before` (j,) is the mean speed of the step before them.
    """

    q: Array
    qd: Array
    before: Array


class StepLoads(NamedTuple):
    """What torques of motors follow from: mass (n, j, j) of the links, and torques `known` (n, j) to the control.

    By these it turns its motors against their gears: gravity, and those of the motion where it feeds them forward.
    """

    mass: Array
    known: Array


class GearRoom(NamedTuple):
    """Room for maps of one step."""

    matrix: Array  # (j, j)
    right: Array  # (j,)
    columns: Array  # (3j + 1, 2j): what becomes of a unit of each number of y, of each torque, and of a ramp
    keep: Array  # (2j, 2j)
    push: Array  # (2j, j)
    slope: Array  # (j,) torque by which that of the motion grows in the step
    steady: Array  # (2j,) what so much torque does in a part, and
    ramp: Array  # (2j,) what it does where it grows from nothing to that
    spare: Array  # (2j,)


@kernel
def gear_room(joints: int) -> GearRoom:
    """Room for `joints`."""
    j = joints
    return GearRoom(
        np.zeros((j, j)), np.zeros(j), np.zeros((3 * j + 1, 2 * j)), np.zeros((2 * j, 2 * j)), np.zeros((2 * j, j)),
        np.zeros(j), np.zeros(2 * j), np.zeros(2 * j), np.zeros(2 * j),
    )  # fmt: skip


@kernel
def pull_of(drives: Drives, e: Array, speed: Array, ahead: float, torque: Array, share: float, room: GearRoom) -> None:
    """Acceleration (j,) at a stage, in `room.right`: gears at e + ahead speed, and a share of a torque (j,)."""
    for i in range(speed.shape[0]):
        room.right[i] = 0.0
        if drives.gear[i] > 0.0:
            room.right[i] = share * torque[i]
            room.right[i] -= drives.gear_damping[i] * speed[i] + drives.gear[i] * (e[i] + ahead * speed[i])
    solve_factored(room.matrix, room.right)


@kernel
def small_part(mass: Array, drives: Drives, h: float, keep: Array, push: Array, room: GearRoom) -> None:
    """The map of a part of `h` seconds: y -> keep y + push torque."""
    joints, step = mass.shape[0], GAMMA * h
    S = room.matrix
    for i in range(joints):
        for k in range(joints):
            moves = drives.gear[i] > 0.0 and drives.gear[k] > 0.0
            S[i, k] = 0.5 * (mass[i, k] + mass[k, i]) if moves else 0.0
        if drives.gear[i] > 0.0:
            S[i, i] += step * drives.gear_damping[i] + step * step * drives.gear[i]
        else:
            S[i, i] = 1.0
    factor_in_place(S)
    unit = np.zeros(joints)
    for c in range(3 * joints + 1):
        y, torque = room.columns[c], c - 2 * joints
        y[:] = 0.0
        if torque < 0:
            y[c] = 1.0
        grows = torque == joints
        for i in range(joints):
            unit[i] = room.slope[i] if grows else (1.0 if i == torque else 0.0)
        e, v = y[:joints], y[joints:]
        pull_of(drives, e, v, step, unit, GAMMA if grows else 1.0, room)
        for i in range(joints):
            e[i] += (h - step) * (v[i] + step * room.right[i])
            v[i] += (h - step) * room.right[i]
        pull_of(drives, e, v, step, unit, 1.0, room)
        for i in range(joints):
            e[i] += step * (v[i] + step * room.right[i])
            v[i] += step * room.right[i]
    for i in range(2 * joints):
        for c in range(2 * joints):
            keep[i, c] = room.columns[c, i]
        room.steady[i], room.ramp[i] = 0.0, room.columns[3 * joints, i]
        for c in range(joints):
            push[i, c] = room.columns[2 * joints + c, i]
            room.steady[i] += push[i, c] * room.slope[c]


@kernel
def double(keep: Array, push: Array, room: GearRoom) -> None:
    """Turn the map of a part into that of two of them."""
    rows, joints = push.shape
    for i in range(rows):  # twice as long, half as steep: a half, and then a half more than it ended with
        room.spare[i] = 0.5 * (room.ramp[i] + room.steady[i])
        for m in range(rows):
            room.spare[i] += 0.5 * keep[i, m] * room.ramp[m]
    for i in range(rows):
        room.ramp[i], room.spare[i] = room.spare[i], room.steady[i]
        for m in range(rows):
            room.spare[i] += keep[i, m] * room.steady[m]
    for i in range(rows):
        room.steady[i] = room.spare[i]
    for i in range(rows):
        for k in range(joints):
            total = push[i, k]
            for m in range(rows):
                total += keep[i, m] * push[m, k]
            room.push[i, k] = total
        for k in range(rows):
            total = 0.0
            for m in range(rows):
                total += keep[i, m] * keep[m, k]
            room.keep[i, k] = total
    for i in range(rows):
        for k in range(joints):
            push[i, k] = room.push[i, k]
        for k in range(rows):
            keep[i, k] = room.keep[i, k]


@kernel
def fill_swings(
    motors: MotorWay, drives: Drives, body: LinkBodies, halvings: int, swings: Swings, loads: StepLoads
) -> None:
    """Fill the maps of n steps, and their `loads`; a step is halved so often into parts. Motors go along cubics."""
    n, joints = swings.drive.shape
    dt = swings.dt
    h = dt / 2.0**halvings
    none = np.zeros(joints)
    state = DriveState(np.empty(joints), np.empty(joints), none, none, none)
    room, maps = room_of(joints, 1), gear_room(joints)
    for k in range(n):
        for i in range(joints):
            state.q[i] = 0.5 * (motors.q[k, i] + motors.q[k + 1, i])
            state.qd[i] = (motors.q[k + 1, i] - motors.q[k, i]) / dt
        weigh(body, state, room)
        for i in range(joints):
            total = room.static[i] - room.bias[i]
            for c in range(joints):
                loads.mass[k, i, c] = room.mass[i, c]
                if drives.ahead:
                    mean = (motors.q[k + 1, c] - motors.q[k, c]) / dt
                    last = (motors.q[k, c] - motors.q[k - 1, c]) / dt if k > 0 else motors.before[c]
                    total -= room.mass[i, c] * (mean - last) / dt
                else:
                    total -= room.mass[i, c] * (motors.qd[k + 1, c] - motors.qd[k, c]) / dt
            loads.known[k, i] = room.static[i] - total if drives.ahead else room.static[i]
            swings.drive[k, i] = 0.0 if drives.ahead else total
            for c in range(6):
                swings.tip[k, c, i] = room.jacobian[c, i]
        for i in range(joints):
            maps.slope[i] = 0.0
            for c in range(0 if drives.ahead else joints):
                ends = motors.qd[k + 1, c] + motors.qd[k, c]
                change = 6.0 * ends - 12.0 * (motors.q[k + 1, c] - motors.q[k, c]) / dt
                maps.slope[i] -= room.mass[i, c] * change / dt
        small_part(room.mass, drives, h, swings.keep[k], swings.push[k], maps)
        for _ in range(halvings):
            double(swings.keep[k], swings.push[k], maps)
        for i in range(2 * joints):
            swings.jerk[k, i] = maps.ramp[i] - 0.5 * maps.steady[i]


@kernel
def motor_efforts(
    motors: MotorWay, drives: Drives, swings: Swings, loads: StepLoads, wrench: Array, effort: Array
) -> int:
    """Mean torques (n, j) of the motors under wrenches (n, 6).

    Returns in how many of the first steps all can give them, also at the ends of steps.
    """
    n, joints = effort.shape
    enough = n
    for k in range(n):
        for i in range(joints):
            turn = (motors.qd[k + 1, i] - motors.qd[k, i]) / swings.dt
            mean = (motors.q[k + 1, i] - motors.q[k, i]) / swings.dt
            rotor = (0.0 if drives.ahead else drives.rotor[i] * turn) + friction_of(i, drives, mean) * mean
            shaft = loads.known[k, i] - swings.drive[k, i]
            for c in range(6):
                shaft -= swings.tip[k, c, i] * wrench[k, c]
            for c in range(joints):
                before = swings.begin[joints + c] if k == 0 else swings.winds[k - 1, joints + c]
                shaft += loads.mass[k, i, c] * (swings.winds[k, joints + c] - before) / swings.dt
            effort[k, i] = shaft + rotor
            end = shaft
            if drives.gear[i] > 0.0:
                end = loads.known[k, i] - drives.gear[i] * swings.winds[k, i]
                end -= drives.gear_damping[i] * swings.winds[k, joints + i]
            if max(abs(effort[k, i]), abs(end + rotor)) > drives.limit[i]:
                enough = min(enough, k)
    return int(enough)
