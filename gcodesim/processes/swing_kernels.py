"""Milling with a tip that swings on the gears of its machine: masses, gears and the cut, step by step in one call.

The links of an arm hang on its motors by gears that are springs with dampers (Spong 1987). As long as no motor is at
its limit, how far each gear is wound up, and how fast that changes, is an affine function of the wrench at the tip in
each step. `Swings` are these functions; `balance_kernels` solves tip and cut together.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.kernels import Field, Scratch, coarsest, scratch
from gcodesim.processes.arrival_kernels import SPRING
from gcodesim.processes.balance_kernels import FreeCut, Give, balance
from gcodesim.processes.engagement_kernels import Room
from gcodesim.processes.force_kernels import RESULT
from gcodesim.processes.milling_kernels import (
    ENGAGED,
    KNOWN,
    LEAST_SPEED,
    SHARP,
    STATE,
    TURN,
    WRENCH,
    Bench,
    MillingTool,
    Motion,
    State,
    Way,
    follow_turn,
    mill_steps,
    new_trial,
    state_of,
)

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Swings(NamedTuple):
    """How j gears wind up in n steps of `dt` [s]: y is how far links are off their motors and how fast, both (j,).

    Under torques `drive` of the motion and J' W of a wrench W at the tip a step ends with y = keep y + push (drive +
    J' W) + jerk, where `jerk` is what a change of the acceleration adds. `tip` (n, 6, j) is J in the axes in which
    wrenches are given. `winds` are the y at the ends of steps.
    """

    dt: float
    keep: Array  # (n, 2j, 2j)
    push: Array  # (n, 2j, j)
    drive: Array  # (n, j) [N·m, N]
    jerk: Array  # (n, 2j)
    tip: Array  # (n, 6, j)
    begin: Array  # (2j,) y at the beginning of the first step
    winds: Array  # (n, 2j)


class SwingParts(NamedTuple):
    """The parts (m,) of n steps, see `Turns`: the `step` (m,) of each, and the `share` (m,) of it that the part takes.

    `told` (m, 3) [m/s] is the velocity of the command, and `begin` (m, 3) [m] where it begins; `piece_share` (c, 2)
    where in its step each piece begins and ends; `feels` (m,): there are pieces, and there may be chips.
    """

    step: Indices
    share: Array
    told: Array
    begin: Array
    piece_share: Array
    feels: NDArray[np.bool_]


TOLD = 8
"""Numbers that are kept of the commanded way: its turn, see `State`, and its level direction."""

KEPT = STATE + 6 + TOLD
"""Numbers that milling keeps: those of `State`, the mean wrench of the step before, and the commanded way."""

STOP = 18
"""Numbers that `mill_swinging` keeps where it has to stop."""


class SwingRoom(NamedTuple):
    """Room for one step: y alone (2j,), torques (j,), the response (3, 6) of the tip to a wrench, and others."""

    alone: Array
    torque: Array
    lever: Array  # (3, j)
    response: Array
    before: Array  # (3,)
    gone: Array  # (1,) share of the step that is done
    off: Array  # (3,) [m] by which the cut has put the tip elsewhere so far in the step
    wrench: Array  # (6,) mean of the step, as far as it is done
    last: Array  # (6,) of the part before
    v: Array  # (3,) [m/s] of the tip
    chips: Array  # (3,) [m/s]
    values: Array  # (STATE,)
    ends: Array  # (2, 3)
    more: Array  # (3, 6)
    way: Array  # (TOLD,) of the command


@kernel
def swing_room(joints: int, stop: Array, way: Array) -> SwingRoom:
    """Room for `joints`; what a stop in the middle of a step must not forget is in `stop` (STOP,)."""
    return SwingRoom(
        np.zeros(2 * joints), np.zeros(joints), np.zeros((3, joints)), np.zeros((3, 6)), np.zeros(3),
        stop[2:3], stop[3:6], stop[6:12], stop[12:18], np.zeros(3), np.zeros(3), np.zeros(STATE), np.zeros((2, 3)),
        np.zeros((3, 6)), way,
    )  # fmt: skip


@kernel
def follow_told(begin: Array, told: Array, turn: float, cell: float, way: Array, values: Array) -> None:
    """Renew the commanded `way` (TOLD,) with a part from `begin` (3,) on at the velocity `told` (3,) [m/s].

    `turn` [1/m] is how much it turns, NaN where that has to be followed; it becomes that of `values` (STATE,), whose
    feed, which follows the tip over a cell, turns with the command: so the look ahead goes round the bore that is cut.
    The way of a tip that swings turns by what nobody commands.
    """
    state, x, y = state_of(values), way[6], way[7]
    flat = np.sqrt(told[0] * told[0] + told[1] * told[1])
    if flat > LEAST_SPEED:
        way[6], way[7] = told[0] / flat, told[1] / flat
    feed_x, feed_y = state.feed[0], state.feed[1]
    for i in range(6):
        state.turn[i] = way[i]
    state.feed[0], state.feed[1] = way[6], way[7]
    if np.isnan(turn):
        follow_turn(begin, x, y, cell, state)
    else:
        state.turn[TURN], state.turn[KNOWN] = turn, 0.0
    for i in range(6):
        way[i] = state.turn[i]
    c, s = x * way[6] + y * way[7], x * way[7] - y * way[6]
    if c < SHARP:
        c, s = 1.0, 0.0
    state.feed[0], state.feed[1] = c * feed_x - s * feed_y, s * feed_x + c * feed_y


@kernel(lean=True)
def swing_alone(swings: Swings, k: int, y: Array, alone: Array) -> None:
    """The gears (2j,) at the end of step k, without a wrench, from `y` (2j,) at its beginning."""
    joints = swings.drive.shape[1]
    for i in range(2 * joints):
        total = swings.jerk[k, i]
        for c in range(2 * joints):
            total += swings.keep[k, i, c] * y[c]
        for c in range(joints):
            total += swings.push[k, i, c] * swings.drive[k, c]
        alone[i] = total


@kernel(lean=True)
def swing_under(swings: Swings, k: int, wrench: Array, torque: Array, alone: Array, y: Array) -> None:
    """The gears `y` (2j,) at the end of step k under a mean `wrench` (6,): `alone` and what it adds."""
    joints = swings.drive.shape[1]
    for i in range(joints):
        torque[i] = 0.0
        for c in range(6):
            torque[i] += swings.tip[k, c, i] * wrench[c]
    for i in range(2 * joints):
        total = alone[i]
        for c in range(joints):
            total += swings.push[k, i, c] * torque[c]
        y[i] = total


@kernel
def swing_along(swings: Swings, wrench: Array) -> None:
    """Fill `swings.winds` (n, 2j) under wrenches (n, 6) that are known beforehand."""
    joints = swings.drive.shape[1]
    alone, torque, y = np.empty(2 * joints), np.empty(joints), swings.begin.copy()
    for k in range(swings.drive.shape[0]):
        swing_alone(swings, k, y, alone)
        swing_under(swings, k, wrench[k], torque, alone, swings.winds[k])
        for i in range(2 * joints):
            y[i] = swings.winds[k, i]


@kernel(lean=True)
def give_way(swings: Swings, k: int, y: Array, room: SwingRoom) -> None:
    """How step k goes alone: `room.alone`, where its tip begins, and in `room.response` how it moves under a wrench."""
    joints = swings.drive.shape[1]
    swing_alone(swings, k, y, room.alone)
    for r in range(3):
        room.before[r] = 0.0
        for i in range(joints):
            room.before[r] += swings.tip[k, r, i] * y[i]
            room.lever[r, i] = 0.0
            for c in range(joints):
                room.lever[r, i] += swings.tip[k, r, c] * swings.push[k, c, i]
        for c in range(6):
            room.response[r, c] = 0.0
            for i in range(joints):
                room.response[r, c] += room.lever[r, i] * swings.tip[k, c, i]


@kernel(lean=True)
def begin_step(
    swings: Swings, k: int, motion: Motion, parts: SwingParts, first: int, felt: Array, room: SwingRoom
) -> None:
    """Put the pieces of step k, whose first part is `first`, where the tip goes alone; velocities of parts follow.

    `felt` (6,) is the mean wrench of the step before.
    """
    joints, last = swings.drive.shape[1], first + 1
    while last < parts.step.shape[0] and parts.step[last] == k:
        last += 1
    for r in range(3):
        end = 0.0
        for i in range(joints):
            end += swings.tip[k, r, i] * room.alone[i]
        way = end - room.before[r]
        for piece in range(motion.first_piece[first], motion.first_piece[last]):
            motion.starts[piece, r] += room.before[r] + parts.piece_share[piece, 0] * way
            motion.ends[piece, r] += room.before[r] + parts.piece_share[piece, 1] * way
        for part in range(first, last):
            motion.velocity[part, r] += way / swings.dt
        room.off[r] = 0.0
    room.gone[0] = 0.0
    for c in range(6):
        room.last[c], room.wrench[c] = felt[c], 0.0


@kernel
def solve_part(
    field: Field, tool: MillingTool, motion: Motion, part: int, told: Array, pace: tuple[float, float], room: SwingRoom,
    bench: Room, result: Array,
) -> bool:  # fmt: skip
    """Solve tip and cut in one part: `room.v` and `room.chips` (3,) [m/s], and the wrench in `result`.

    `told` (3,) [m/s] is the velocity of the command, `pace` the time [s] of the step and the share of it that the part
    takes. Returns whether the tool feels anything.
    """
    dt, share = pace
    state = state_of(room.values)
    feed = np.array([1.0, 0.0]) if state.feed[0] == 0.0 and state.feed[1] == 0.0 else state.feed.copy()
    first, last = motion.first_piece[part], motion.first_piece[part + 1] - 1
    for r in range(3):
        room.ends[0, r] = motion.starts[first, r] + state.delta[r]
        room.ends[1, r] = motion.ends[last, r] + state.delta[r]
        room.v[r] = motion.velocity[part, r]
        for c in range(6):
            room.more[r, c] = room.response[r, c] / dt
            room.v[r] += room.more[r, c] * room.last[c]
    rate = motion.spindle[part] * tool.teeth.number / (2.0 * np.pi)
    time = dt * share
    cut = FreeCut(room.ends, rate, told, feed, coarsest(field) / time, time)
    give = Give(motion.velocity[part].copy(), room.more)
    return balance(field, tool, cut, give, bench, room.values, room.v, room.chips, result)


@kernel
def lead_part(
    field: Field, tool: MillingTool, motion: Motion, part: int, told: Array, dt: float, parts: SwingParts,
    room: SwingRoom, bench: Room, result: Array,
) -> None:  # fmt: skip
    """Let one part go as tip and cut decide; the wrench that it feels is `room.last`."""
    share, a, b = parts.share[part], motion.first_piece[part], motion.first_piece[part + 1]
    for piece in range(a, b):
        for r in range(3):
            motion.starts[piece, r] += room.off[r]
            motion.ends[piece, r] += room.off[r]
    feels = parts.feels[part]
    if feels:
        follow_told(parts.begin[part], told, motion.turn[part], coarsest(field), room.way, room.values)
    if not feels or not solve_part(field, tool, motion, part, told, (dt, share), room, bench, result):
        room.last[:] = 0.0
        return
    for r in range(3):
        more = room.v[r] - motion.velocity[part, r]
        for piece in range(a, b):
            motion.starts[piece, r] += dt * (parts.piece_share[piece, 0] - room.gone[0]) * more
            motion.ends[piece, r] += dt * (parts.piece_share[piece, 1] - room.gone[0]) * more
        room.off[r] += dt * share * more
        motion.velocity[part, r] = room.chips[r]
    for c in range(6):
        room.last[c] = result[c]


@kernel(lean=True)
def take_over(part: int, parts: SwingParts, room: SwingRoom, out: Array) -> None:
    """Write down the wrench of a part that was cut, if it did cut, and add it to the mean of the step."""
    if out[part, ENGAGED] == 0.0:
        room.last[:] = 0.0
    for c in range(6):
        out[part, WRENCH + c] = room.last[c]
        room.wrench[c] += parts.share[part] * room.last[c]


@kernel
def cut_part(
    field: Field, tool: MillingTool, motion: Motion, part: int, bench: Bench, way: Way, spare: Scratch, state: State,
    out: Array,
) -> bool:  # fmt: skip
    """Cut one part along its pieces; False when a column had no room."""
    a, b, here = motion.first_piece[part], motion.first_piece[part + 1], slice(part, part + 1)
    alone = Motion(
        motion.starts[a:b], motion.ends[a:b], np.array([0, b - a]), motion.axis[here], motion.velocity[here],
        motion.turn[here], motion.spindle[here], motion.rapid[here], motion.compliance[:0],
    )  # fmt: skip
    return mill_steps(field, tool, alone, bench, way, spare, state, out[here]) == 1


@kernel
def mill_swinging(
    field: Field, tool: MillingTool, motion: Motion, parts: SwingParts, swings: Swings, stop: Array, bench: Room,
    values: Array, out: Array,
) -> int:  # fmt: skip
    """Run the m parts of n steps of a machine whose gears swing; returns m, or the part for which a column had no room.

    In that case give columns more and call again. `motion` is that of the command, without compliance; it becomes that
    of the tip. `stop` (STOP,) is for `mill_swinging` alone; zeros at first. values (KEPT,); out (m, OUTPUTS). All in S.
    """
    joints, m = swings.drive.shape[1], parts.step.shape[0]
    room, result, spare = swing_room(joints, stop, values[STATE + 6 : KEPT]), np.zeros(RESULT), scratch(field)
    desk = Bench(bench, new_trial(), np.zeros(RESULT))
    way = Way(np.empty(3), np.empty(3), np.empty(3), np.empty(3))
    state, felt, told, y = state_of(values), values[STATE : STATE + 6], np.empty(3), np.empty(2 * joints)
    state.felt[SPRING] = coarsest(field)
    resumed = stop[0] > 0.0
    for part in range(int(stop[1]), m):
        k = parts.step[part]
        begins = part == 0 or parts.step[part - 1] != k
        if begins or resumed:
            for i in range(2 * joints):
                y[i] = swings.begin[i] if k == 0 else swings.winds[k - 1, i]
            give_way(swings, k, y, room)
        if not resumed:
            if begins:
                begin_step(swings, k, motion, parts, part, felt, room)
            for r in range(3):
                told[r] = parts.told[part, r]
            for c in range(STATE):
                room.values[c] = values[c]
            lead_part(field, tool, motion, part, told, swings.dt, parts, room, bench, result)
        resumed = False
        if not cut_part(field, tool, motion, part, desk, way, spare, state, out):
            stop[0], stop[1] = 1.0, float(part)
            return part
        take_over(part, parts, room, out)
        room.gone[0] += parts.share[part]
        if part + 1 == m or parts.step[part + 1] != k:
            for c in range(6):
                felt[c] = room.wrench[c]
            swing_under(swings, k, felt, room.torque, room.alone, y)
            for i in range(2 * joints):
                swings.winds[k, i] = y[i]
    return int(m)
