"""Milling over a window of steps in one compiled call: force, deflection, removal, misuse.

A step: find, in the stock as earlier steps have left it, where the displaced cutter is in material; solve wrench and
deflection together; remove what the displaced cutter sweeps; check whether shank or holder touch.

Deflection. delta = C F(p + delta), with chips as the tip then travels (`travel_kernels`), is solved from the
last step's delta by relaxation, with the factor taken from the last two residuals (Aitken 1937; for vectors Irons and
Tuck 1969). With constant engagement the first residual is already small: then one more relaxed step follows without
sampling again, so delta goes to C F without overshoot, however soft the machine. `F/C` one step late would ring as soon
as the cut is stiffer than the machine. A machine so soft that it has no balance nearby (a narrow shoulder that slips
to the side) moves on towards the best solution found, no faster than the feed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.kernels import (
    Field,
    Scratch,
    Shape,
    coarsest,
    patch_at,
    remove_form,
    remove_piece,
    scratch,
    shape_in,
    tighten_tops,
    top_nearby,
    touch_form,
    touch_piece,
)
from gcodesim.processes.arrival_kernels import FELT, SPRING, note_step, remember
from gcodesim.processes.edge_kernels import Heading
from gcodesim.processes.engagement_kernels import Room
from gcodesim.processes.force_kernels import (
    CHIP,
    DEPTH,
    ENTRY,
    EXIT,
    RESULT,
    TORQUE,
    WIDTH,
    Teeth,
    cutting_force,
)
from gcodesim.processes.law_kernels import TANGENTIAL
from gcodesim.processes.peak_kernels import peaks_of
from gcodesim.processes.travel_kernels import (
    SAME_WAY,
    Travel,
    Wrenches,
    edge_wrench,
    follow_travel,
    move_of,
    solve_travel,
)

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

# columns of `out` (n, OUTPUTS)
(
    WRENCH, PEAK, OUT_TORQUE, POWER, REMOVED, ENGAGED, DEFLECTION, OUT_DEPTH, OUT_WIDTH, OUT_ENTRY, OUT_EXIT, OUT_CHIP,
    SHANK, HOLDER, STOPPED, REVERSED, INSIDE, PEAK_TORQUE, FEED_FORCE, SIDE_FORCE,
) = (0, 6, 7, 8, 9, 10, 11, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26)  # fmt: skip
OUTPUTS = 27
# places in `State.numbers`
RELAXATION, ADVANCE, FREEDOM, CUTTING, HAS_TIP, STEP, PIECE, CREDIT = 0, 1, 2, 3, 4, 5, 6, 7
PLACED, BLOCKED, FREE = 0.0, 1.0, 2.0  # values of FREEDOM

LEAST_SPEED = 1.0e-7  # [m/s]; slower is a dwell
LEAST_LEVEL = 1.0e-6  # share of the speed that is horizontal, below which a tool goes straight up or down
LEAST_TOUCH = 1.0e-6  # [m] of depth below which a tool only touches the surface
LARGEST_TILT = 1.0e-3  # [-] horizontal part of the axis from which on a tool is not upright
CLEARANCE = 1.0e-6  # [m] by which a shank is assumed to be thinner, so that it does not rub in its own cut

# Force is looked up one cell ahead of the tool, so a tool that only passes by would feel material. Force therefore
# counts only within CREDIT_CELLS of the last removal: a section of PLAIN_SECTION cells, a column cut by COLUMN_CUT
# of a cell, or, under a closer look, anything at all.
CREDIT_CELLS = 1.5
PLAIN_SECTION = 0.5
COLUMN_CUT = 0.02
SPRINGS = 2.0  # a tip that is bent springs away from the front that it has cut by so many bends at most
SMALL_BEND = 0.25  # a tool that is bent by more cells than this leans on the material, even where it slides along it
LEAST_VOLUME = 1.0e-15  # [m³]; less is rounding

# A cut is like another one up to this share of its mean force and torque, its chip, depth and width, and up to so much
# of the angles at which teeth enter and leave [rad]: then its peaks are in proportion to the means.
ALIKE_SHARE = 0.005
ALIKE_ANGLE = 0.01
# So they are within so many cells of way, unless mean force or torque have grown or fallen by more than these shares:
# what else has changed there is mostly what columns of this width say of the same wall.
SAME_CELLS = 2.0
GROWN, FALLEN = 0.02, 0.1
# Places in `State.turn`: how much the way turns to the left [1/m]; how many of the two places are known through which
# it went, and these, x and y [m]. A way that turns by less than SHARP from step to step may be an arc; places are
# TURN_CELLS apart, so that chords of an arc and rounded coordinates do not count.
TURN, KNOWN, EARLIER, LATER = 0, 1, 2, 4
SHARP = 0.97  # cosine
LEAST_TURN = 0.5  # [1/m] that counts
TURN_CELLS, LOST_CELLS = 2.0, 8.0
GOES_ON = 0.3  # of its turn, up to which a way is an arc no longer
# places in `State.peaks`; the last one is the way since then [cells]
MEAN_FORCE, MEAN_TORQUE, FED, AT_DEPTH, AT_WIDTH, AT_ENTRY, AT_EXIT, PEAK_OF_FORCE, PEAK_OF_TORQUE, GONE = range(10)

EVALUATIONS = 10  # most samplings of the stock for one step, and
TO_TOUCH = 40  # for the one in which the tool comes to it, whose contact is all to be found
CLOSE_RELATIVE = 0.01  # residual, as a share of the deflection, up to which the stock is not sampled again
CLOSE_ABSOLUTE = 0.2e-6  # [m] the same, absolute
CLOSE_ADVANCE = 0.02  # residual along the feed, as a share of the feed, since the chip depends on it
RELAX_LEAST, RELAX_MOST = 0.01, 1.0


class MillingTool(NamedTuple):
    """A cutter: its edges, and its parts that fill room.

    shank, holder (k, 7): their sections as shapes, none of a part that is missing; `widest` is the greatest radius of
    all [m]. Where `cutter` is only the cylinder around a form, `slabs` (m, 6) are the form; else there are none.
    """

    teeth: Teeth
    cutter: Shape
    shank: Array
    holder: Array
    slabs: Array
    widest: float


class Motion(NamedTuple):
    """The motion of n steps in S, not bent; of step k the tip's pieces are first_piece[k]..first_piece[k + 1] of c.

    A rigid machine has no compliance: none of its rows.
    """

    starts: Array  # (c, 3) [m]
    ends: Array  # (c, 3) [m]
    first_piece: Indices  # (n + 1,)
    axis: Array  # (n, 3) from tip to holder
    velocity: Array  # (n, 3) [m/s]
    turn: Array  # (n,) to the left [1/m], see `Heading`; NaN where it has to be followed
    spindle: Array  # (n,) [rad/s], positive M3
    rapid: Flags  # (n,)
    compliance: Array  # (n or 0, 3, 6) translation of the tip


class State(NamedTuple):
    """The memory from step to step and from window to window; `STATE` numbers, see `state_of`."""

    numbers: Array  # see above: how `solve_step` went, whether the tool may cut, where an interrupted call goes on
    delta: Array  # (3,) bend of the tip [m], and
    before: Array  # (3,) that before the step
    tip: Array  # (3,) where the tip was commanded last [m]
    feed: Array  # (2,) horizontal direction of the command
    travel: Array  # (2,) horizontal direction in which the tip goes
    patch: Array  # (2,) where `tops` were looked at last
    chips: Array  # (6,) wrench of chips, and
    edges: Array  # (7,) of the edges, in the last cut
    turn: Array  # (6,) how much its way turns, see `follow_turn`
    peaks: Array  # (10,) for which contact peaks were looked for last, and what they were: see `greatest_loads`
    felt: Array  # (FELT,) what was in contact, see `arrival_kernels`


STATE = 55 + FELT


def axis_of(values: Array) -> Array:
    """A view of the axis (3,) of the frame in which `feed`, `travel`, `chips` and `edges` are; 0: S itself."""
    return values[36:39]


class Step(NamedTuple):
    """What is commanded in one step."""

    turn: float  # [1/m] of the way, to the left

    tip: Array  # (3,) at its beginning, not bent [m]
    level: float  # horizontal and
    climb: float  # vertical share of its direction
    chip: float  # feed per tooth [m]
    way: float  # [m]
    top: float  # no material near the tool is higher [m]


class Trial(NamedTuple):
    """Room for the search of `solve_step`: bends (3,) [m], and directions (2,)."""

    start: Array  # the tip before the step, and
    place: Array  # where it is tried
    delta: Array
    residual: Array
    earlier: Array  # residual before
    best: Array
    best_travel: Array
    begin: Array
    left: Array
    moves: Array  # (6, 3)


class Bench(NamedTuple):
    """What `feel` works in: room, the search of `solve_step`, and the numbers of the step that it felt."""

    room: Room
    trial: Trial
    result: Array


class Way(NamedTuple):
    """Where the tip is at the beginning and at the end of a step, and of a piece, with the bend: (3,) [m]."""

    before: Array
    after: Array
    start: Array
    end: Array


@kernel
def state_of(values: Array) -> State:
    """Views of the numbers (STATE,) that are kept."""
    return State(
        values[0:8], values[8:11], values[11:14], values[14:17], values[17:19], values[19:21], values[21:23],
        values[23:29], values[29:36], values[49:55], values[39:49],
        values[55:STATE],
    )  # fmt: skip


@kernel
def new_trial() -> Trial:
    """Room for `solve_step`."""
    return Trial(
        np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(2), np.empty(2),
        np.empty(3), np.empty((6, 3)),
    )  # fmt: skip


@kernel(lean=True)
def flat_way(way: Way) -> float:
    """Horizontal way [m] of the commanded tip in a step."""
    return float(np.sqrt(np.square(way.after[0] - way.before[0]) + np.square(way.after[1] - way.before[1])))


@kernel(lean=True)
def travel_between(way: Way, state: State) -> float:
    """Way [m] of the displaced tip in a step."""
    square = 0.0
    for axis in range(3):
        d = way.after[axis] - way.before[axis] + state.delta[axis] - state.before[axis]
        square += d * d
    return float(np.sqrt(square))


@kernel(lean=True)
def bend(state: State) -> float:
    """Deflection [m] of the tip."""
    d = state.delta
    return float(np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]))


@kernel(lean=True)
def unbend(state: State) -> None:
    """No force, no deflection."""
    for axis in range(3):
        state.delta[axis] = 0.0


@kernel(lean=True)
def along(vector: Array, ux: float, uy: float, level: float, climb: float) -> float:
    """Component of `vector` (3,) along the feed."""
    return float(level * (ux * vector[0] + uy * vector[1]) + climb * vector[2])


@kernel(lean=True, inlined=True)
def look(
    field: Field, teeth: Teeth, step: Step, travel: Travel, wrenches: Wrenches, place: Array, asked: float, room: Room,
    result: Array,
) -> tuple[int, float, float]:  # fmt: skip
    """Wrench at a place of the tip, and how it travels then: rows that are filled, advance, growth of the force."""
    heading = Heading(travel.travel[0], travel.travel[1], step.level, step.climb, step.turn)
    used = cutting_force(field, teeth, place, heading, asked * step.chip, step.top, room, result)
    if used == 0:
        travel.travel[0], travel.travel[1] = travel.feed[0], travel.feed[1]  # nothing holds it on another path
        return used, asked, 1.0
    if step.way <= 0.0:
        return used, asked, 1.0
    edge_wrench(teeth, heading, room, used, wrenches.edges)
    advance, ratio = follow_travel(travel, wrenches, asked, result)
    return used, advance, ratio


@kernel(lean=True)
def next_relaxation(relaxation: float, residual: Array, earlier: Array) -> float:
    """The factor from the last two residuals (Aitken)."""
    towards, change = 0.0, 0.0
    for axis in range(3):
        difference = residual[axis] - earlier[axis]
        towards += earlier[axis] * difference
        change += difference * difference
    if change > 0.0:
        return min(max(-relaxation * towards / change, RELAX_LEAST), RELAX_MOST)
    return relaxation


@kernel(lean=True, inlined=True)
def solve_step(
    field: Field, teeth: Teeth, compliance: Array, step: Step, room: Room, trial: Trial, state: State, result: Array
) -> tuple[int, float, float]:
    """Wrench and deflection of one step together; `state` holds the deflection before and after.

    The chip is as thick as the tip advances, in the direction in which it travels (`travel_kernels`).
    Returns the number of rows that are filled for `peaks_of`, the feed per tooth [m] that they stand for, and by what
    forces then have to be multiplied.
    """
    numbers, feed, level, climb, way = state.numbers, state.feed, step.level, step.climb, step.way
    start, place, delta, residual, earlier, best, best_travel, begin, left, moves = trial
    begin[0], begin[1] = state.travel[0], state.travel[1]
    for axis in range(3):
        earlier[axis] = 0.0
        delta[axis] = state.delta[axis]
        start[axis] = step.tip[axis] + delta[axis]
        left[axis] = way * (climb if axis == 2 else level * feed[axis]) - delta[axis]
    relaxation = numbers[RELAXATION] if numbers[RELAXATION] > 0.0 else 0.5
    advance = numbers[ADVANCE] if numbers[ADVANCE] > 0.0 else 1.0
    exponent = teeth.law.exponent[TANGENTIAL]
    travel = Travel(compliance, left, begin, feed, state.travel, level, climb, way, exponent, moves)
    wrenches = Wrenches(state.edges, state.chips)
    turned = begin[0] != feed[0] or begin[1] != feed[1]
    if way > 0.0 and turned and numbers[CUTTING] > 0.0:  # where it would go under the forces of the last step
        advance = solve_travel(travel, wrenches, advance)
    asked, best_asked, ratio = advance, advance, 1.0
    least = np.inf
    used = 0
    last = EVALUATIONS if numbers[CUTTING] > 0.0 else TO_TOUCH
    for turn in range(last + 1):
        if turn == last:  # no fixed point found: move on from the best place seen, no faster than the feed
            advance = best_asked
            travel.travel[0], travel.travel[1] = best_travel[0], best_travel[1]
        for axis in range(3):
            if turn == last:
                delta[axis] = best[axis]
            place[axis] = step.tip[axis] + delta[axis]
        note_step(room.step, start, left[0] + delta[0], left[1] + delta[1], state.felt)
        asked, ux, uy = advance, travel.travel[0], travel.travel[1]
        used, advance, ratio = look(field, teeth, step, travel, wrenches, place, asked, room, result)
        follows = way > 0.0 and used > 0 and advance != 1.0
        move_of(compliance, result, residual)
        size, bent = 0.0, 0.0
        for axis in range(3):
            bent += residual[axis] * residual[axis]
            residual[axis] -= delta[axis]
            size += residual[axis] * residual[axis]
        if turn == last:
            onward = min(1.0, way / np.sqrt(size)) if size > 0.0 else 0.0
            for axis in range(3):
                delta[axis] += onward * residual[axis]
            break
        if turn > 0:
            relaxation = next_relaxation(relaxation, residual, earlier)
        if size < least:
            least = size
            best_asked = asked
            best_travel[0], best_travel[1] = ux, uy
            for axis in range(3):
                best[axis] = delta[axis]
        limit = CLOSE_RELATIVE * np.sqrt(bent) + CLOSE_ABSOLUTE
        short = abs(along(residual, ux, uy, level, climb))
        for axis in range(3):
            earlier[axis] = residual[axis]
            delta[axis] += relaxation * residual[axis]
        same = ux * travel.travel[0] + uy * travel.travel[1] >= SAME_WAY
        if size <= limit * limit and same and (not follows or short <= CLOSE_ADVANCE * way):
            break
    result[CHIP] *= advance / asked
    numbers[RELAXATION], numbers[ADVANCE] = relaxation, advance
    for axis in range(3):
        state.delta[axis] = delta[axis]
    return used, asked * step.chip, ratio


@kernel(lean=True, inlined=True)
def find_way(motion: Motion, k: int, state: State, way: Way) -> bool:
    """Where the commanded tip begins and ends in step k; whether that is known: a dwell needs a step before it."""
    pieces_from, pieces_to = motion.first_piece[k], motion.first_piece[k + 1]
    if pieces_to <= pieces_from and state.numbers[HAS_TIP] == 0.0:
        return False
    for axis in range(3):
        if pieces_to > pieces_from:
            way.before[axis] = motion.starts[pieces_from, axis]
            way.after[axis] = motion.ends[pieces_to - 1, axis]
        else:
            way.before[axis] = state.tip[axis]
            way.after[axis] = state.tip[axis]
        state.tip[axis] = way.after[axis]
    state.numbers[HAS_TIP] = 1.0
    return True


@kernel(lean=True, inlined=True)
def remove_cutter(field: Field, start: Array, end: Array, tool: MillingTool, spare: Scratch) -> tuple[float, bool]:
    """Remove what the cutting part sweeps from `start` to `end`; see `remove_piece`."""
    if tool.slabs.shape[0] > 0:
        return remove_form(field, start, end, tool.slabs)
    return remove_piece(field, start, end, tool.cutter, spare)


@kernel
def remove_standing(field: Field, tip: Array, tool: MillingTool) -> bool:
    """Remove what is where the cutting part stands with its tip there; False when a column had no room."""
    return remove_cutter(field, tip, tip, tool, scratch(field))[1]


@kernel(lean=True, inlined=True)
def touch_cutter(field: Field, start: Array, end: Array, tool: MillingTool) -> tuple[float, float]:
    """What the cutting part would run through from `start` to `end`: volume [m³] and depth [m]; none is removed."""
    if tool.slabs.shape[0] > 0:
        return touch_form(field, start, end, tool.slabs)
    return touch_piece(field, start, end, tool.cutter)


@kernel(lean=True, inlined=True)
def depth_of(field: Field, start: Array, end: Array, sections: Array, top: float) -> float:
    """How deep [m] a part of the tool is in material from `start` to `end`; 0 where it is missing or only touches.

    sections (k, 7): shapes; `top` [m]: above it there is no material.
    """
    depth, lowest = 0.0, min(start[2], end[2])
    for k in range(sections.shape[0]):
        shape = shape_in(sections, k)
        if lowest + shape.bottom < top:
            depth = max(depth, touch_piece(field, start, end, shape)[1])
    return depth if depth > LEAST_TOUCH else 0.0


@kernel(lean=True, inlined=True)
def point_feed(motion: Motion, k: int, state: State) -> tuple[float, float, float]:
    """Renew `state.feed` for step k; speed [m/s], and the horizontal and vertical share of its direction."""
    vx, vy, vz = motion.velocity[k, 0], motion.velocity[k, 1], motion.velocity[k, 2]
    speed = float(np.sqrt(vx * vx + vy * vy + vz * vz))
    flat = np.sqrt(vx * vx + vy * vy)
    level, climb = 1.0, 0.0
    if speed > LEAST_SPEED:
        level, climb = flat / speed, vz / speed
        if flat > LEAST_LEVEL * speed:
            state.feed[0], state.feed[1] = vx / flat, vy / flat
        else:
            level = 0.0
    if state.feed[0] == 0.0 and state.feed[1] == 0.0:
        state.feed[0] = 1.0
    return speed, level, climb


@kernel(lean=True, inlined=True)
def lost_from(turn: Array, tip: Array, cell: float) -> bool:
    """Whether a tool has gone on since the last place without being followed."""
    x, y = tip[0] - turn[LATER], tip[1] - turn[LATER + 1]
    return bool(turn[KNOWN] > 0.0 and x * x + y * y > np.square(LOST_CELLS * cell))


@kernel(lean=True)
def follow_turn(tip: Array, old_x: float, old_y: float, cell: float, state: State) -> None:
    """Renew `state.turn` with the commanded tip (3,) at the beginning of a step, whose feed was (old_x, old_y) before.

    The turn of the circle through the last three places, or none where they do not go on as one.
    """
    turn, ux, uy = state.turn, state.feed[0], state.feed[1]
    if old_x * ux + old_y * uy < SHARP or lost_from(turn, tip, cell):
        turn[TURN], turn[KNOWN] = 0.0, 0.0
    if turn[KNOWN] == 0.0:
        turn[LATER], turn[LATER + 1], turn[KNOWN] = tip[0], tip[1], 1.0
        return
    x, y = tip[0] - turn[LATER], tip[1] - turn[LATER + 1]
    way = np.sqrt(x * x + y * y)
    if way < TURN_CELLS * cell:
        if way > 0.5 * TURN_CELLS * cell:  # an arc has turned by half of what its chord says
            now = 2.0 * (x * uy - y * ux) / (way * way)
            if now * turn[TURN] < GOES_ON * turn[TURN] * turn[TURN]:
                turn[TURN] = 0.0
        return
    if turn[KNOWN] > 1.0:
        from_x, from_y = turn[LATER] - turn[EARLIER], turn[LATER + 1] - turn[EARLIER + 1]
        whole_x, whole_y = from_x + x, from_y + y
        sides = np.sqrt((from_x * from_x + from_y * from_y) * (whole_x * whole_x + whole_y * whole_y)) * way
        found = 2.0 * (from_x * y - from_y * x) / sides
        turn[TURN] = found if abs(found) > LEAST_TURN else 0.0
    turn[EARLIER], turn[EARLIER + 1], turn[KNOWN] = turn[LATER], turn[LATER + 1], 2.0
    turn[LATER], turn[LATER + 1] = tip[0], tip[1]


@kernel(lean=True, inlined=True)
def may_feel(field: Field, tool: MillingTool, way: Way, state: State) -> bool:
    """Whether a tool at feed may feel material: it cuts, leans on it, or runs through some in this step."""
    cell = coarsest(field)
    if state.numbers[CREDIT] > 0.0 or bend(state) >= SMALL_BEND * cell:
        return True
    for axis in range(3):
        way.start[axis] = way.before[axis] + state.delta[axis]
        way.end[axis] = way.after[axis] + state.delta[axis]
    shared, _ = touch_cutter(field, way.start, way.end, tool)
    if shared > LEAST_VOLUME:
        state.numbers[CREDIT] = CREDIT_CELLS * cell
        return True
    return False


@kernel(lean=True)
def is_close(one: float, other: float, share: float) -> bool:
    """Whether two figures of a cut are the same up to a share of them."""
    return abs(one - other) <= share * abs(other)


@kernel(lean=True)
def greatest_loads(
    teeth: Teeth,
    heading: Heading,
    chip: float,
    cell: float,
    room: Room,
    used: int,
    result: Array,
    way: float,
    peaks: Array,
) -> tuple[float, float]:
    """Greatest force [N] and torque [N·m] within a revolution, after so long a `way` [m] in contact.

    They are looked for only where the cut is no longer like the one for which they were found last, which `peaks`
    remembers; a steady cut goes on for hundreds of steps.
    """
    mean, turn = float(np.sqrt(result[0] * result[0] + result[1] * result[1] + result[2] * result[2])), result[TORQUE]
    peaks[GONE] += way / cell
    if min(mean, turn, peaks[MEAN_FORCE], peaks[MEAN_TORQUE]) > 0.0 and is_known(result, mean, chip, peaks):
        # contact that grows raises a mean more than its peaks
        by_force, by_torque = min(mean / peaks[MEAN_FORCE], 1.0), min(turn / peaks[MEAN_TORQUE], 1.0)
        return peaks[PEAK_OF_FORCE] * by_force, peaks[PEAK_OF_TORQUE] * by_torque
    force, torque = peaks_of(teeth, heading.level, heading.climb, chip, cell, room, used)
    peaks[MEAN_FORCE], peaks[MEAN_TORQUE], peaks[FED] = mean, turn, chip
    peaks[AT_DEPTH], peaks[AT_WIDTH] = result[DEPTH], result[WIDTH]
    peaks[AT_ENTRY], peaks[AT_EXIT] = result[ENTRY], result[EXIT]
    peaks[PEAK_OF_FORCE], peaks[PEAK_OF_TORQUE], peaks[GONE] = force, torque, 0.0
    return force, torque


@kernel(lean=True, inlined=True)
def is_known(result: Array, mean: float, chip: float, peaks: Array) -> bool:
    """Whether a cut is like the one for which peaks were looked for last."""
    by_force, by_torque = mean / peaks[MEAN_FORCE] - 1.0, result[TORQUE] / peaks[MEAN_TORQUE] - 1.0
    if max(by_force, by_torque) > GROWN or min(by_force, by_torque) < -FALLEN:
        return False
    if peaks[GONE] <= SAME_CELLS:
        return True
    alike = is_close(mean, peaks[MEAN_FORCE], ALIKE_SHARE)
    alike = alike and is_close(result[TORQUE], peaks[MEAN_TORQUE], ALIKE_SHARE)
    alike = alike and is_close(chip, peaks[FED], ALIKE_SHARE) and is_close(result[DEPTH], peaks[AT_DEPTH], ALIKE_SHARE)
    alike = alike and is_close(result[WIDTH], peaks[AT_WIDTH], ALIKE_SHARE)
    alike = alike and abs(result[ENTRY] - peaks[AT_ENTRY]) <= ALIKE_ANGLE
    return alike and abs(result[EXIT] - peaks[AT_EXIT]) <= ALIKE_ANGLE


@kernel(lean=True, inlined=True)
def feel(
    field: Field, tool: MillingTool, motion: Motion, k: int, way: Way, top: float, bench: Bench, state: State,
    out: Array,
) -> None:  # fmt: skip
    """Force and deflection of step k, into `state` and `out` (OUTPUTS,)."""
    room, trial, result = bench
    numbers, heading = state.numbers, state.travel
    for axis in range(3):
        state.before[axis] = state.delta[axis]
    before, after, spindle, rapid = way.before, way.after, motion.spindle[k], motion.rapid[k]
    old_x, old_y = state.feed[0], state.feed[1]
    speed, level, climb = point_feed(motion, k, state)
    if np.isnan(motion.turn[k]):
        follow_turn(before, old_x, old_y, coarsest(field), state)
    else:
        state.turn[TURN], state.turn[KNOWN] = motion.turn[k], 0.0
    used, ratio, chip, length = 0, 1.0, 0.0, 0.0
    turning_in = spindle > 0.0 and not rapid and min(before[2], after[2]) < top
    if speed <= LEAST_SPEED:
        turning_in = turning_in and numbers[CUTTING] > 0.0
    elif turning_in:
        turning_in = may_feel(field, tool, way, state)
    rigid = motion.compliance.shape[0] == 0
    if rigid or level == 0.0 or numbers[CUTTING] == 0.0 or (heading[0] == 0.0 and heading[1] == 0.0):
        heading[0], heading[1] = state.feed[0], state.feed[1]
    if turning_in:
        if speed > LEAST_SPEED:
            chip = speed * 2.0 * np.pi / (spindle * tool.teeth.number)
            flat = flat_way(way)
            length = float(np.sqrt(flat * flat + np.square(after[2] - before[2])))
        if rigid:
            unbend(state)
            fed = Heading(state.feed[0], state.feed[1], level, climb, state.turn[TURN])
            for axis in range(3):
                trial.place[axis] = before[axis]
            note_step(room.step, before, after[0] - before[0], after[1] - before[1], state.felt)
            used = cutting_force(field, tool.teeth, before, fed, chip, top, room, result)
        else:
            state.felt[SPRING] = SPRINGS * bend(state)
            step = Step(state.turn[TURN], before, level, climb, chip, length, top)
            used, chip, ratio = solve_step(field, tool.teeth, motion.compliance[k], step, room, trial, state, result)
    elif not rapid:
        unbend(state)
    if level == 0.0:  # straight up or down: what follows begins afresh
        heading[0], heading[1] = 0.0, 0.0
    # a rapid keeps the deflection until the tool is out: springing back inside its own cut would gouge the wall,
    # which a tool that is still turning would resist
    numbers[CUTTING] = 1.0 if used > 0 else 0.0
    remember(room, Heading(heading[0], heading[1], level, climb, 0.0), trial.place, used, state.felt)
    if used == 0:
        state.peaks[GONE] = np.inf
    else:
        for component in range(6):
            out[WRENCH + component] = result[component]
        ux, uy = state.feed[0], state.feed[1]
        out[FEED_FORCE] = ux * result[0] + uy * result[1]
        out[SIDE_FORCE] = ux * result[1] - uy * result[0]
        way_cut = Heading(ux, uy, level, climb, 0.0)
        cell = coarsest(field)
        force, torque = greatest_loads(tool.teeth, way_cut, chip, cell, room, used, result, length, state.peaks)
        mean = float(np.sqrt(result[0] * result[0] + result[1] * result[1] + result[2] * result[2]))
        # peaks are kept while a cut is alike; no mean is above its peak
        out[PEAK], out[PEAK_TORQUE] = max(ratio * force, mean), max(ratio * torque, result[TORQUE])
        out[OUT_TORQUE] = result[TORQUE]
        out[POWER] = result[TORQUE] * spindle
        out[ENGAGED] = 1.0
        out[OUT_DEPTH], out[OUT_WIDTH] = result[DEPTH], result[WIDTH]
        out[OUT_ENTRY], out[OUT_EXIT] = result[ENTRY], result[EXIT]
        out[OUT_CHIP] = result[CHIP]
    for axis in range(3):
        out[DEFLECTION + axis] = state.delta[axis]


@kernel(lean=True, inlined=True)
def cut(
    field: Field, tool: MillingTool, motion: Motion, k: int, first: int, way: Way, top: float, spare: Scratch,
    state: State, out: Array,
) -> bool:  # fmt: skip
    """Remove along the displaced pieces of step k, from `first` on; False when a column had no room."""
    pieces_from, pieces_to = motion.first_piece[k], motion.first_piece[k + 1]
    pieces = pieces_to - pieces_from
    start, end = way.start, way.end
    for piece in range(first, pieces_to):
        a, b = (piece - pieces_from) / pieces, (piece - pieces_from + 1.0) / pieces
        for axis in range(3):
            old, new = state.before[axis], state.delta[axis]
            start[axis] = motion.starts[piece, axis] + old + a * (new - old)
            end[axis] = motion.ends[piece, axis] + old + b * (new - old)
        volume, ok = remove_cutter(field, start, end, tool, spare)
        out[REMOVED] += volume
        if not ok:
            state.numbers[STEP], state.numbers[PIECE] = k + 1.0, float(piece)
            return False
        out[SHANK] = max(out[SHANK], depth_of(field, start, end, tool.shank, top))
        out[HOLDER] = max(out[HOLDER], depth_of(field, start, end, tool.holder, top))
    return True


@kernel(lean=True, inlined=True)
def settle(field: Field, motion: Motion, k: int, way: Way, state: State, out: Array) -> None:
    """The consequences of the volume that step k has removed, for the next steps and for misuse."""
    cell = coarsest(field)
    length = travel_between(way, state)
    if out[REMOVED] > min(PLAIN_SECTION * length, COLUMN_CUT * cell) * cell * cell and length > 0.0:
        state.numbers[CREDIT] = CREDIT_CELLS * cell
    else:
        state.numbers[CREDIT] -= length
    if out[REMOVED] > LEAST_VOLUME:
        out[ENGAGED] = 1.0
        if not motion.rapid[k]:
            if motion.spindle[k] == 0.0:
                out[STOPPED] = 1.0
            elif motion.spindle[k] < 0.0:
                out[REVERSED] = 1.0


@kernel(lean=True, inlined=True)
def is_free(field: Field, tool: MillingTool, tip: Array) -> bool:
    """Whether no part is in material: a long tool may go through the stock with its edges below it."""
    deepest = max(touch_cutter(field, tip, tip, tool)[1], 0.0)
    deepest = max(deepest, depth_of(field, tip, tip, tool.shank, np.inf))
    deepest = max(deepest, depth_of(field, tip, tip, tool.holder, np.inf))
    return deepest <= LEAST_TOUCH


@kernel
def mill(field: Field, tool: MillingTool, motion: Motion, room: Room, values: Array, out: Array) -> int:
    """Run n steps; returns n, or the step in which a column had no room (give columns more and call again).

    values (STATE,): see `State`; out (n, OUTPUTS) is filled. All in S.
    """
    bench = Bench(room, new_trial(), np.zeros(RESULT))
    way = Way(np.empty(3), np.empty(3), np.empty(3), np.empty(3))
    return mill_steps(field, tool, motion, bench, way, scratch(field), state_of(values), out)


@kernel(lean=True)
def mill_steps(
    field: Field, tool: MillingTool, motion: Motion, bench: Bench, way: Way, spare: Scratch, state: State, out: Array
) -> int:
    """The loop of `mill`, which has made all arrays, so that none is counted in each step."""
    n = len(motion.spindle)
    before, after, delta, numbers = way.before, way.after, state.delta, state.numbers
    cell = coarsest(field)
    resumed = numbers[STEP] > 0.0
    for k in range(int(numbers[STEP]) - 1 if resumed else 0, n):
        if not find_way(motion, k, state, way):
            continue
        # nothing near: idle
        reach = tool.widest + cell + flat_way(way)
        top = top_nearby(field, after[0] + delta[0], after[1] + delta[1], reach)
        if min(before[2], after[2]) + min(delta[2], 0.0) - cell >= top:
            unbend(state)
            numbers[CUTTING] = 0.0
            numbers[FREEDOM] = FREE
            continue
        if not resumed and numbers[FREEDOM] != FREE:
            numbers[FREEDOM] = FREE if is_free(field, tool, before) else BLOCKED
        if numbers[FREEDOM] == BLOCKED:
            out[k, INSIDE] = 1.0
            continue
        pi, pj = patch_at(field, after[0], after[1])
        if state.patch[0] != pi + 1.0 or state.patch[1] != pj + 1.0:  # cutting has lowered what is here
            state.patch[0], state.patch[1] = pi + 1.0, pj + 1.0
            tighten_tops(field, after[0], after[1], reach)
        top = top_nearby(field, after[0] + delta[0], after[1] + delta[1], reach)
        first = motion.first_piece[k]
        if resumed:
            first, resumed = int(numbers[PIECE]), False
            numbers[STEP] = 0.0
        else:
            feel(field, tool, motion, k, way, top, bench, state, out[k])
        if not cut(field, tool, motion, k, first, way, top, spare, state, out[k]):
            return k
        settle(field, motion, k, way, state, out[k])
    return n
