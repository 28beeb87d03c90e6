"""Steps of an arm with drives: looked at before they are made, and made one after another."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.world.drive_kernels import (
    Aim,
    Drives,
    DriveState,
    Flags,
    LinkBodies,
    StepRoom,
    copy_state,
    feed_forward,
    weigh,
    whole_step,
)


@kernel
def foresee(
    h: float, dt: float, drives: Drives, aim: Aim, state: DriveState, wrench: Array, room: StepRoom, free: Array
) -> None:  # fmt: skip
    """Where links end a step as a function of the wrench F at the tip: joints `free` (j,) and a move of the tip by F.

    That move is `room.response` (6, 6) F. Exact while the motors that are at their limit under `wrench`, the one of the
    step before, stay so. `state` is left as it was; `weigh` and `feed_forward` come first.
    """
    joints = state.q.shape[0]
    effort, load, ends = np.empty(joints), np.empty(6), np.empty((7, joints))
    for c in range(7):
        for i in range(6):
            load[i] = wrench[i] + (1.0 if i == c - 1 else 0.0)
        copy_state(state, room.kept)
        whole_step(h, dt, drives, aim, room.kept, load, room, c > 0, effort)
        for i in range(joints):
            ends[c, i] = room.kept.q[i]
    for i in range(joints):
        free[i] = ends[0, i]
        for c in range(6):
            free[i] -= (ends[c + 1, i] - ends[0, i]) * wrench[c]
    for r in range(6):
        for c in range(6):
            total = 0.0
            for i in range(joints):
                total += room.jacobian[r, i] * (ends[c + 1, i] - ends[0, i])
            room.response[r, c] = total


class DriveOutcome(NamedTuple):
    """What n steps of j joints end with, (n, j) each: links, motors, torques, and motors that were at their limit."""

    links: Array
    motors: Array
    effort: Array
    full: Flags


@kernel
def next_aim(command: Array, dt: float, aim: Aim, last: Array) -> None:
    """Go on to the next command (j,). `last` (j,) is the mean speed of the step before, which gives the speed now.

    The speed at the end of a step is that of its own and the last mean; so a steady acceleration is followed exactly,
    commands are met at the ends of steps, and nothing depends on commands that are still to come.
    """
    for i in range(command.shape[0]):
        aim.q0[i], aim.v0[i] = aim.q1[i], aim.v1[i]
        mean = (command[i] - aim.q1[i]) / dt
        aim.q1[i], aim.v1[i] = command[i], mean + 0.5 * (mean - last[i])
        last[i] = mean


@kernel
def note_outcome(k: int, state: DriveState, room: StepRoom, effort: Array, outcome: DriveOutcome) -> None:
    """Write down how step k ended."""
    for i in range(effort.shape[0]):
        outcome.links[k, i] = state.q[i]
        outcome.motors[k, i] = state.theta[i] - state.sag[i]
        outcome.effort[k, i] = effort[i]
        outcome.full[k, i] = 0
        for part in range(room.full.shape[0]):
            if room.full[part, i] != 0:
                outcome.full[k, i] = 1


@kernel
def drive_along(
    commands: Array, wrench: Array, dt: float, drives: Drives, body: LinkBodies, aim: Aim, last: Array,
    state: DriveState, room: StepRoom, outcome: DriveOutcome,
) -> None:  # fmt: skip
    """Steps through `commands` (n, j) under a wrench (n, 6) that is known beforehand."""
    h, effort = dt / room.full.shape[0], np.empty(commands.shape[1])
    for k in range(commands.shape[0]):
        next_aim(commands[k], dt, aim, last)
        weigh(body, state, room)
        feed_forward(dt, drives, aim, state, room)
        whole_step(h, dt, drives, aim, state, wrench[k], room, False, effort)
        note_outcome(k, state, room, effort, outcome)
