"""How the tip of a machine that is free to give way goes through a step, and what it feels on that way.

Links have inertia and motors have limits: under the wrench W of the cut the tip moves by C W besides what it would do
alone, so that its velocity is v = v_alone + C W(v) / dt, while W depends on that velocity: on its direction, up and
down too, and on its size, which is the chip. Nothing is taken from the command. The level part is solved by Broyden's
method (1965); in each of its rounds the part along the tool's axis, on which the bottom of a cutter depends by a jump,
is solved alone.

The jump: edges that come down cut and rub, edges that go up do neither. A tool that its floor carries does not come
down; what it feels is that mixture of both which keeps it there, as a body rests with dry friction. The bottom of a
cutter is hollow, though: one that is fed level may sink on a slope of `HOLLOW`, since its foremost corner makes the
floor, and does so until it is bent as far as its force along the axis bends it.

A tip that swings by less than a cell goes, for all that the stock can tell, where it went: where teeth meet material
follows the way over the last cell, and chips are as thick as the tip goes along it.

Where the tip is counts as well: a wall pushes it away in the step in which it comes there. Material is looked up where
the step begins, and by as much beside it as the tip goes off its command in the step. With the place at the beginning
alone a wall would be felt a step late, which drives a tip away from it and back, the farther the longer the step.

Two bounds keep a tip that is thrown about from being driven by its own cut. Chips that pull the tool on are no thicker
than commanded: teeth that pull would else pull the harder the faster it goes. And no chip is thicker than `MOST` of the
commanded one, or `THICK` of the radius: a tooth that met more would stall or break.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.material.kernels import Field, coarsest, top_nearby
from gcodesim.processes.arrival_kernels import SPRING, note_step
from gcodesim.processes.edge_kernels import LEAST_ADVANCE, Array, Heading
from gcodesim.processes.engagement_kernels import Room
from gcodesim.processes.force_kernels import RESULT, TORQUE, Teeth, cutting_force
from gcodesim.processes.milling_kernels import (
    CUTTING,
    FREE,
    FREEDOM,
    LEAST_LEVEL,
    LEAST_SPEED,
    TURN,
    MillingTool,
    Way,
    flat_way,
    may_feel,
    state_of,
)
from gcodesim.processes.travel_kernels import MOST

THICK = 0.02  # radii
THINNEST = 1.0e-9  # [m]
HOLLOW = 0.03  # tangent of the angle by which the bottom of an end mill is hollow; 1 to 3 degrees are usual (by memory)
RESTS = 2.0e-4  # share of its level speed at which a tool comes down at least that does not rest on its floor
ROUNDS, LOOKS = 12, 24  # of Broyden's method; for the speed along the axis
CLOSE, CLOSE_SPEED = 1.0e-3, 1.0e-6  # share of the speed, and speed [m/s], up to which all is solved
LEAST_CHANGE = 0.1  # of the derivative, beside that of a tip that feels nothing, for which Broyden's method learns


class FreeCut(NamedTuple):
    """A cutter in a part of a step. `ends` (2, 3) [m]: where it begins and would end alone; `teeth_rate` [1/s].

    `told` (3,) is the commanded velocity [m/s], `feed` (2,) the level direction in which the tool has cut so far; it
    holds on to that with `hold` [m/s], a cell in the `time` [s] of the part.
    """

    ends: Array
    teeth_rate: float
    told: Array
    feed: Array
    hold: float
    time: float


class Give(NamedTuple):
    """What the tip does: its velocity `alone` (3,) [m/s], and `more` (3, 6) of it per wrench."""

    alone: Array
    more: Array


class Bite(NamedTuple):
    """What does not change while a part is solved: no material nearby is higher than `top` [m]; see `FreeCut`."""

    teeth: Teeth
    begin: Array  # (3,) where the part begins, and
    place: Array  # (3,) where material is looked up
    time: float  # [s] of the part
    way: Array  # (3,) commanded velocity [m/s]
    top: float
    teeth_rate: float
    told: float  # [m] the commanded chip, and
    most: float  # [m] the thickest
    slope: float  # on which it may come down freely
    feed: Array
    hold: float
    turn: float  # [1/m] of the way, to the left
    felt: Array  # what it was in contact with, see `State`


@kernel(lean=True)
def copy_into(source: Array, target: Array) -> None:
    """Copy all numbers."""
    for i in range(source.shape[0]):
        target[i] = source[i]


@kernel(lean=True)
def level_way(bite: Bite, v: Array) -> tuple[float, float, float]:
    """The level direction (x, y) of chips at velocity v (3,), and how fast the tip goes along it [m/s]."""
    x, y = bite.hold * bite.feed[0] + v[0], bite.hold * bite.feed[1] + v[1]
    size = np.sqrt(x * x + y * y)
    if size <= LEAST_SPEED:
        return float(bite.feed[0]), float(bite.feed[1]), 0.0
    x, y = x / size, y / size
    return float(x), float(y), float(max(x * v[0] + y * v[1], 0.0))


@kernel(lean=True)
def put_beside(bite: Bite, v: Array) -> None:
    """Put `bite.place` where a tip of velocity v (3,) is beside its command, by the radius at most."""
    x, y = bite.time * (v[0] - bite.way[0]), bite.time * (v[1] - bite.way[1])
    size, most = np.sqrt(x * x + y * y), bite.teeth.radius
    share = most / size if size > most else 1.0
    bite.place[0], bite.place[1] = bite.begin[0] + share * x, bite.begin[1] + share * y
    bite.place[2] = bite.begin[2]


@kernel(lean=True)
def wrench_on_way(field: Field, bite: Bite, v: Array, room: Room, result: Array) -> float:
    """Wrench at velocity v (3,) [m/s], into `result` (RESULT,); returns the chip [m] for which it is."""
    put_beside(bite, v)
    note_step(room.step, bite.begin, bite.time * v[0], bite.time * v[1], bite.felt)
    ux, uy, flat = level_way(bite, v)
    speed = np.sqrt(flat * flat + v[2] * v[2])
    if speed <= LEAST_SPEED:
        result[:] = 0.0
        return THINNEST
    level = flat / speed if flat > LEAST_LEVEL * speed else 0.0
    heading = Heading(ux, uy, level, v[2] / speed, bite.turn)
    chip = min(speed / bite.teeth_rate, bite.most)
    cutting_force(field, bite.teeth, bite.place, heading, chip, bite.top, room, result)
    if chip > bite.told and result[0] * v[0] + result[1] * v[1] + result[2] * v[2] > 0.0:
        chip = bite.told
        cutting_force(field, bite.teeth, bite.place, heading, chip, bite.top, room, result)
    return float(chip)


@kernel(lean=True)
def following(give: Give, axis: int, wrench: Array) -> float:
    """Component of the velocity [m/s] under a wrench."""
    total = give.alone[axis]
    for c in range(6):
        total += give.more[axis, c] * wrench[c]
    return float(total)


@kernel(lean=True)
def find_height(
    field: Field, bite: Bite, give: Give, v: Array, near: tuple[float, float], far: float, room: Room, result: Array
) -> float:
    """Solve for v[2] between `near`, a place with its gap, and `far`, beginning at v[2]; returns the chip.

    The gap is what v[2] would become less v[2], and falls: the faster a tool comes down, the more carries it.
    """
    at, gap_at = near
    gap_far, known, chip = 0.0, False, 0.0
    v[2] = min(max(v[2], min(at, far)), max(at, far))
    for _ in range(LOOKS):
        chip = wrench_on_way(field, bite, v, room, result)
        gap = following(give, 2, result) - v[2]
        if abs(gap) <= CLOSE * abs(v[2]) + CLOSE_SPEED or (v[2] == far and gap * gap_at > 0.0):
            break
        if gap * gap_at > 0.0:
            at, gap_at = v[2], gap
        else:
            far, gap_far, known = v[2], gap, True
        share = min(max(gap_at / (gap_at - gap_far), 0.1), 0.9) if known else 1.0
        v[2] = at + share * (far - at) if known else far
    return chip


@kernel(lean=True)
def settle_height(
    field: Field, bite: Bite, give: Give, v: Array, room: Room, result: Array, spare: Array
) -> tuple[float, float]:
    """Solve for v[2] with the level part of v as it is; `result` is the wrench then.

    Returns the chip [m], and of which speed along the axis [m/s] it is.
    """
    before, flat = v[2], np.sqrt(v[0] * v[0] + v[1] * v[1])
    free = bite.slope * flat
    v[2] = 0.0
    chip = wrench_on_way(field, bite, v, room, result)
    alone = following(give, 2, result)
    if alone >= 0.0:
        v[2] = before
        chip = find_height(field, bite, give, v, (0.0, alone), alone, room, result)
        return chip, v[2]
    if alone >= -free:
        v[2] = alone
        return chip, 0.0
    slow = -(free + RESTS * flat + CLOSE_SPEED)
    v[2] = slow
    wrench_on_way(field, bite, v, room, spare)
    carried = following(give, 2, spare)
    if carried < slow:
        v[2] = before
        chip = find_height(field, bite, give, v, (slow, carried - slow), carried, room, result)
        return chip, v[2]
    share = min(max((-free - alone) / (carried - alone), 0.0), 1.0)  # its floor carries it
    for c in range(TORQUE + 1):
        result[c] += share * (spare[c] - result[c])
    v[2] = -free
    return chip, 0.0


@kernel(lean=True)
def solve_way(
    field: Field, bite: Bite, give: Give, v: Array, room: Room, kept: tuple[Array, Array, Array, Array], result: Array
) -> tuple[float, float]:
    """Solve for v (3,), from `v` on; `result` is the wrench then. `kept` is room to work in.

    Returns the chip [m], and of which speed along the axis [m/s] it is.
    """
    spare, best, wrench, B = kept
    B[0, 0], B[0, 1], B[1, 0], B[1, 1] = 1.0, 0.0, 0.0, 1.0  # inverse of the derivative of the gaps
    r0, r1, s0, s1, least = 0.0, 0.0, 0.0, 0.0, np.inf
    best_chip, best_fall = 0.0, 0.0
    for turn in range(ROUNDS):
        chip, fall = settle_height(field, bite, give, v, room, result, spare)
        g0, g1 = v[0] - following(give, 0, result), v[1] - following(give, 1, result)
        size = np.sqrt(g0 * g0 + g1 * g1)
        if size <= CLOSE * np.sqrt(v[0] * v[0] + v[1] * v[1]) + CLOSE_SPEED:
            return chip, fall
        if size < least:
            least, best_chip, best_fall = size, chip, fall
            copy_into(v, best)
            copy_into(result, wrench)
        if turn > 0:
            y0, y1 = g0 - r0, g1 - r1
            b0, b1 = B[0, 0] * y0 + B[0, 1] * y1, B[1, 0] * y0 + B[1, 1] * y1
            w0, w1 = s0 * B[0, 0] + s1 * B[1, 0], s0 * B[0, 1] + s1 * B[1, 1]
            change = w0 * y0 + w1 * y1
            if abs(change) > LEAST_CHANGE * (s0 * s0 + s1 * s1):
                B[0, 0] += (s0 - b0) * w0 / change
                B[0, 1] += (s0 - b0) * w1 / change
                B[1, 0] += (s1 - b1) * w0 / change
                B[1, 1] += (s1 - b1) * w1 / change
        r0, r1 = g0, g1
        s0, s1 = -(B[0, 0] * g0 + B[0, 1] * g1), -(B[1, 0] * g0 + B[1, 1] * g1)
        v[0] += s0
        v[1] += s1
    copy_into(best, v)
    copy_into(wrench, result)
    return best_chip, best_fall


@kernel
def balance(
    field: Field,
    tool: MillingTool,
    cut: FreeCut,
    give: Give,
    room: Room,
    values: Array,
    v: Array,
    chips: Array,
    result: Array,
) -> bool:
    """Velocity v (3,) [m/s] of the tip, looked for from `v` on, and the wrench that goes with it, into `result`.

    `chips` (3,) [m/s] is the velocity of which chips are. Returns whether the tool feels anything: else v is that of
    the tip alone. `values` (STATE,) are what `mill` keeps: a tool that has been put into material feels nothing. All in
    the axes of `field`.
    """
    state = state_of(values)
    state.felt[SPRING] = coarsest(field)
    way = Way(cut.ends[0], cut.ends[1], np.empty(3), np.empty(3))
    cell, flat = coarsest(field), flat_way(way)
    top = top_nearby(field, way.after[0], way.after[1], 2.0 * tool.cutter.radius + cell + flat)
    feels = state.numbers[FREEDOM] == FREE and min(way.before[2], way.after[2]) - cell < top
    if feels and flat <= 0.0 and way.before[2] == way.after[2]:
        feels = state.numbers[CUTTING] > 0.0
    elif feels:
        feels = may_feel(field, tool, way, state)
    result[:] = 0.0
    if not feels:
        copy_into(give.alone, v)
        return False
    told = cut.told
    speed = np.sqrt(told[0] * told[0] + told[1] * told[1] + told[2] * told[2])
    chip = max(speed / cut.teeth_rate, THINNEST)
    most = max(MOST * chip, THICK * tool.teeth.radius)
    slope = HOLLOW if told[2] >= -LEAST_ADVANCE * speed else 0.0
    hold = cut.hold if state.numbers[CUTTING] > 0.0 else 0.0
    bite = Bite(
        tool.teeth,
        way.before,
        np.empty(3),
        cut.time,
        told,
        top,
        cut.teeth_rate,
        chip,
        most,
        slope,
        cut.feed,
        hold,
        state.turn[TURN],
        state.felt,
    )
    kept = (np.empty(RESULT), np.empty(3), np.empty(RESULT), np.empty((2, 2)))
    chip, fall = solve_way(field, bite, give, v, room, kept, result)
    ux, uy, flat = level_way(bite, v)
    speed = np.sqrt(flat * flat + fall * fall)
    share = chip * cut.teeth_rate / speed if speed > 0.0 else 0.0
    chips[0], chips[1], chips[2] = share * ux * flat, share * uy * flat, share * fall
    return True
