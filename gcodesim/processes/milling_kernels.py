"""Milling over a window of steps in one compiled call: force, deflection, removal, misuse.

A step: ask the stock, as the steps before left it, where the displaced cutter is in material; solve wrench and
deflection together; remove what the displaced cutter sweeps; look whether shank or holder touch.

Deflection. delta = C F(p + delta), with chips as the tip then travels (`travel_kernels`), is solved from the
last step's delta by relaxation, with the factor taken from the last two residuals (Aitken 1937; for vectors Irons and
Tuck 1969). With constant engagement the first residual is already small: then one more relaxed step follows without
asking again, so delta goes to C F without overshoot, however soft the machine. `F/C` one step late would ring as soon
as the cut is stiffer than the machine. A machine so soft that it has no balance nearby (a narrow shoulder that slips
to the side) travels on towards the best that was found, no faster than the feed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.kernels import PATCH_SHIFT, patch_top, remove_piece, scratch, touch_piece
from gcodesim.processes.force_kernels import (
    CHIP,
    DEPTH,
    ENTRY,
    EXIT,
    RESULT,
    SPARE,
    SUMS,
    TORQUE,
    WIDTH,
    cutting_force,
    peak_force,
)
from gcodesim.processes.travel_kernels import SAME_WAY, edge_wrench, follow_travel, move_of, solve_travel

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Indices = NDArray[np.int64]
Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]

# columns of `motion` (n, 9)
AXIS, VELOCITY, SPINDLE, RAPID, ACTIVE = 0, 3, 6, 7, 8
# columns of `out` (n, OUTPUTS)
(
    WRENCH, PEAK, OUT_TORQUE, POWER, REMOVED, ENGAGED, DEFLECTION, OUT_DEPTH, OUT_WIDTH, OUT_ENTRY, OUT_EXIT, OUT_CHIP,
    SHANK, HOLDER, STOPPED, REVERSED, INSIDE, TILTED,
) = (0, 6, 7, 8, 9, 10, 11, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24)  # fmt: skip
OUTPUTS = 25
# places in `state` (STATE,)
(
    DELTA, RELAXATION, FEED_X, FEED_Y, FREEDOM, CUTTING, TIP, HAS_TIP, STEP, PIECE, BEFORE, PATCH_X, PATCH_Y, CREDIT,
    ADVANCE, TRAVEL, CHIPS, EDGES,
) = (0, 3, 4, 5, 6, 7, 8, 11, 12, 13, 14, 17, 18, 19, 20, 21, 23, 29)  # fmt: skip
STATE = 36
PLACED, BLOCKED, FREE = 0.0, 1.0, 2.0  # values of FREEDOM

LEAST_SPEED = 1.0e-7  # [m/s]; slower is a dwell
LEAST_TOUCH = 1.0e-6  # [m] of depth below which a tool only touches the surface
LARGEST_TILT = 1.0e-3  # [-] horizontal part of the axis from which on a tool is not upright
CLEARANCE = 1.0e-6  # [m] by which a shank is taken to be thinner, so that it does not rub in its own cut

# A tool that passes by material must not feel it because force looks a cell ahead. It feels something as long as it
# has moved less than CREDIT_CELLS since it last removed: a section of PLAIN_SECTION cells, a column cut by COLUMN_CUT
# of a cell, or anything at all when looked at closely.
CREDIT_CELLS = 1.5
PLAIN_SECTION = 0.5
COLUMN_CUT = 0.02
SMALL_BEND = 0.25  # a tool that is bent by more cells leans on the material, even where it slides along it
LEAST_VOLUME = 1.0e-15  # [m³]; less is rounding

EVALUATIONS = 10  # looks at the stock for one step, at most
CLOSE_RELATIVE = 0.01  # residual, as a share of the deflection, up to which the stock is not asked again
CLOSE_ABSOLUTE = 0.2e-6  # [m] the same, absolute
CLOSE_ADVANCE = 0.02  # residual along the feed, as a share of the feed, since the chip depends on it
RELAX_LEAST, RELAX_MOST = 0.01, 1.0


@kernel(lean=True)
def top_nearby(tops: Array, grid: Array, x: float, y: float, radius: float) -> float:
    """Height [m] that no material within `radius` of (x, y) surpasses; -inf where there is no stock."""
    size = 1 << PATCH_SHIFT
    first_i = int(np.floor((x - radius - grid[0]) / (grid[2] * size)))
    last_i = int(np.floor((x + radius - grid[0]) / (grid[2] * size)))
    first_j = int(np.floor((y - radius - grid[1]) / (grid[3] * size)))
    last_j = int(np.floor((y + radius - grid[1]) / (grid[3] * size)))
    top = -np.inf
    for i in range(max(first_i, 0), min(last_i + 1, tops.shape[0])):
        for j in range(max(first_j, 0), min(last_j + 1, tops.shape[1])):
            top = max(top, tops[i, j])
    return top


@kernel(lean=True)
def tighten_tops(
    hi: Array, count: Ints, tops: Array, grid: Array, state: Array, x: float, y: float, radius: float
) -> None:
    """Renew the patches under the tool whenever it has come to another patch: cutting has lowered them."""
    size = 1 << PATCH_SHIFT
    pi = int(np.floor((x - grid[0]) / (grid[2] * size)))
    pj = int(np.floor((y - grid[1]) / (grid[3] * size)))
    if state[PATCH_X] == pi + 1.0 and state[PATCH_Y] == pj + 1.0:
        return
    state[PATCH_X], state[PATCH_Y] = pi + 1.0, pj + 1.0
    reach_i = int(np.ceil(radius / (grid[2] * size)))
    reach_j = int(np.ceil(radius / (grid[3] * size)))
    for i in range(max(pi - reach_i, 0), min(pi + reach_i + 1, tops.shape[0])):
        for j in range(max(pj - reach_j, 0), min(pj + reach_j + 1, tops.shape[1])):
            tops[i, j] = patch_top(hi, count, i, j)


@kernel(lean=True)
def travel_between(before: Array, after: Array, state: Array) -> float:
    """Way [m] of the displaced tip in a step from `before` to `after` (3,)."""
    square = 0.0
    for axis in range(3):
        d = after[axis] - before[axis] + state[DELTA + axis] - state[BEFORE + axis]
        square += d * d
    return float(np.sqrt(square))


@kernel(lean=True)
def bend(state: Array) -> float:
    """Deflection [m] of the tip."""
    return float(np.sqrt(state[DELTA] ** 2 + state[DELTA + 1] ** 2 + state[DELTA + 2] ** 2))


@kernel(lean=True)
def along(vector: Array, ux: float, uy: float, level: float, climb: float) -> float:
    """Component of `vector` (3,) along the feed."""
    return float(level * (ux * vector[0] + uy * vector[1]) + climb * vector[2])


@kernel(lean=True)
def solve_step(
    lo: Array, hi: Array, count: Ints, grid: Array, tool: Array, edge: Array, laws: Array, table: Array,
    circle: Array, compliance: Array, rigid: bool, tip: Array, feed: Array, level: float, climb: float,
    chip: float, way: float, top: float, rows: Array, weights: Array, force: Array, sums: Array, moves: Array,
    state: Array, result: Array,
) -> tuple[int, float]:  # fmt: skip
    """Wrench and deflection of one step together; `state` holds the deflection before and after.

    way [m]: commanded in this step, in the direction feed (2,); the chip is as thick as the tip advances, in the
    direction in which it travels (`travel_kernels`). moves (6, 3): scratch.
    Returns the number of rows that are filled for `peak_force`, and by what their forces have to be multiplied.
    """
    spare = sums[SUMS + SPARE - 1]
    place = spare[0:3]
    travel = state[TRAVEL : TRAVEL + 2]
    if rigid:
        for axis in range(3):
            state[DELTA + axis] = 0.0
        used = cutting_force(
            lo, hi, count, grid, tool, edge, laws, table, circle, tip, feed[0], feed[1], level, climb, chip, top,
            rows, weights, force, sums, result,
        )  # fmt: skip
        return used, 1.0
    delta, residual, earlier, best = spare[3:6], spare[6:9], spare[9:12], spare[12:15]
    left, best_travel, begin = spare[15:18], spare[18:20], spare[20:22]
    earlier[:] = 0.0
    begin[0], begin[1] = travel[0], travel[1]
    for axis in range(3):
        delta[axis] = state[DELTA + axis]
        left[axis] = way * (climb if axis == 2 else level * feed[axis]) - delta[axis]
    relaxation = state[RELAXATION] if state[RELAXATION] > 0.0 else 0.5
    advance = state[ADVANCE] if state[ADVANCE] > 0.0 else 1.0
    chips, edges = state[CHIPS : CHIPS + 6], state[EDGES : EDGES + TORQUE + 1]
    turned = travel[0] != feed[0] or travel[1] != feed[1]
    if way > 0.0 and turned and state[CUTTING] > 0.0:  # where the forces of the last step would let it go
        advance = solve_travel(
            compliance, edges, chips, left, level, climb, way, laws[0, 1], begin, feed, travel, advance, moves
        )
    asked, best_asked, ratio = advance, advance, 1.0
    least = np.inf
    used = 0
    for turn in range(EVALUATIONS + 1):
        if turn == EVALUATIONS:  # no fixed point found: on from the best place seen, no faster than the feed
            advance = best_asked
            travel[0], travel[1] = best_travel[0], best_travel[1]
        for axis in range(3):
            if turn == EVALUATIONS:
                delta[axis] = best[axis]
            place[axis] = tip[axis] + delta[axis]
        asked, ux, uy = advance, travel[0], travel[1]
        used = cutting_force(
            lo, hi, count, grid, tool, edge, laws, table, circle, place, ux, uy, level, climb, asked * chip, top,
            rows, weights, force, sums, result,
        )  # fmt: skip
        ratio, follows = 1.0, False
        if way > 0.0 and used > 0:
            edge_wrench(tool, laws, circle, ux, uy, rows, weights, used, edges)
            advance, ratio = follow_travel(
                compliance, edges, chips, left, level, climb, way, laws[0, 1], begin, feed, travel, asked, moves, result
            )
            follows = advance != 1.0
        elif used == 0:
            travel[0], travel[1] = feed[0], feed[1]  # nothing holds it on another way
        move_of(compliance, result, residual)
        size, bent = 0.0, 0.0
        for axis in range(3):
            bent += residual[axis] * residual[axis]
            residual[axis] -= delta[axis]
            size += residual[axis] * residual[axis]
        if turn == EVALUATIONS:
            onward = min(1.0, way / np.sqrt(size)) if size > 0.0 else 0.0
            for axis in range(3):
                delta[axis] += onward * residual[axis]
            break
        if turn > 0:
            towards, change = 0.0, 0.0
            for axis in range(3):
                difference = residual[axis] - earlier[axis]
                towards += earlier[axis] * difference
                change += difference * difference
            if change > 0.0:
                relaxation = min(max(-relaxation * towards / change, RELAX_LEAST), RELAX_MOST)
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
        same = ux * travel[0] + uy * travel[1] >= SAME_WAY
        if size <= limit * limit and same and (not follows or short <= CLOSE_ADVANCE * way):
            break
    result[CHIP] *= advance / asked
    state[RELAXATION], state[ADVANCE] = relaxation, advance
    for axis in range(3):
        state[DELTA + axis] = delta[axis]
    return used, ratio


@kernel
def mill(
    lo: Array, hi: Array, count: Ints, grid: Array, dirty: Bytes, walls: Singles, tops: Array, starts: Array,
    ends: Array, first_piece: Indices, motion: Array, compliance: Array, tool: Array, edge: Array, laws: Array,
    table: Array, circle: Array, shapes: Array, rows: Array, weights: Array, force: Array, sums: Array, turning: Array,
    state: Array, out: Array,
) -> int:  # fmt: skip
    """Run n steps; returns n, or the step in which a column had no room (grow `lo`, `hi` and call again).

    starts, ends (c, 3): pieces of the undeflected tip; first_piece (n + 1,): pieces of step k are
    first_piece[k]..first_piece[k+1]; motion (n, 9); compliance (n or 0, 3, 6); shapes (3, 8): cutter, shank, holder,
    of which a missing one has radius 0; the rest as in `cutting_force`. All in S.
    """
    n = motion.shape[0]
    result = np.zeros(RESULT)
    before, after, p, q = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    spare, moves = scratch(count), np.empty((6, 3))
    rigid_machine = compliance.shape[0] == 0
    no_compliance = np.zeros((3, 6))
    widest = max(shapes[0, 1], max(shapes[1, 1], shapes[2, 1]))
    cell = max(grid[2], grid[3])
    k = 0
    resumed = False
    if state[STEP] > 0.0:
        k = int(state[STEP]) - 1
        resumed = True
    while k < n:
        pieces_from, pieces_to = first_piece[k], first_piece[k + 1]
        if pieces_to > pieces_from:
            before[:] = starts[pieces_from]
            after[:] = ends[pieces_to - 1]
        elif state[HAS_TIP] > 0.0:
            before[:] = state[TIP : TIP + 3]
            after[:] = before
        else:
            k += 1
            continue
        state[TIP : TIP + 3] = after
        state[HAS_TIP] = 1.0

        # nothing near: idle
        travel = np.sqrt((after[0] - before[0]) ** 2 + (after[1] - before[1]) ** 2)
        reach = widest + cell + travel
        top = top_nearby(tops, grid, after[0] + state[DELTA], after[1] + state[DELTA + 1], reach)
        lowest = min(before[2], after[2])
        if lowest + min(state[DELTA + 2], 0.0) - cell >= top:
            state[DELTA : DELTA + 3] = 0.0
            state[CUTTING] = 0.0
            state[FREEDOM] = FREE
            k += 1
            continue
        tilt = motion[k, AXIS] ** 2 + motion[k, AXIS + 1] ** 2
        if tilt > LARGEST_TILT * LARGEST_TILT or motion[k, AXIS + 2] <= 0.0:
            out[k, TILTED] = 1.0
            state[DELTA : DELTA + 3] = 0.0
            state[CUTTING] = 0.0
            k += 1
            continue
        if not resumed and state[FREEDOM] != FREE:
            deepest = 0.0
            for body in range(3):  # a long tool may stand through the stock with its edges below it
                if shapes[body, 1] > 0.0:
                    _, depth = touch_piece(lo, hi, count, grid, tops, before, before, shapes[body])
                    deepest = max(deepest, depth)
            state[FREEDOM] = BLOCKED if deepest > LEAST_TOUCH else FREE
        if state[FREEDOM] == BLOCKED:
            out[k, INSIDE] = 1.0
            k += 1
            continue
        tighten_tops(hi, count, tops, grid, state, after[0], after[1], reach)
        top = top_nearby(tops, grid, after[0] + state[DELTA], after[1] + state[DELTA + 1], reach)

        spindle = motion[k, SPINDLE]
        rapid = motion[k, RAPID] > 0.0
        if not resumed:
            state[BEFORE : BEFORE + 3] = state[DELTA : DELTA + 3]
            vx, vy, vz = motion[k, VELOCITY], motion[k, VELOCITY + 1], motion[k, VELOCITY + 2]
            speed = np.sqrt(vx * vx + vy * vy + vz * vz)
            flat = np.sqrt(vx * vx + vy * vy)
            level, climb, chip = 1.0, 0.0, 0.0
            if speed > LEAST_SPEED:
                level, climb = flat / speed, vz / speed
                if flat > 1.0e-6 * speed:
                    state[FEED_X], state[FEED_Y] = vx / flat, vy / flat
                else:
                    level = 0.0
            if state[FEED_X] == 0.0 and state[FEED_Y] == 0.0:
                state[FEED_X] = 1.0
            used, ratio = 0, 1.0
            result[:] = 0.0
            turning_in = spindle > 0.0 and not rapid and lowest < top
            if speed <= LEAST_SPEED:
                turning_in = turning_in and state[CUTTING] > 0.0
            elif turning_in and state[CREDIT] <= 0.0 and bend(state) < SMALL_BEND * cell:
                for axis in range(3):
                    q[axis] = after[axis] + state[DELTA + axis]
                    p[axis] = before[axis] + state[DELTA + axis]
                shared, _ = touch_piece(lo, hi, count, grid, tops, p, q, shapes[0])
                turning_in = shared > LEAST_VOLUME
                if turning_in:
                    state[CREDIT] = CREDIT_CELLS * cell
            feed, heading = state[FEED_X : FEED_X + 2], state[TRAVEL : TRAVEL + 2]
            if rigid_machine or level == 0.0 or state[CUTTING] == 0.0 or (heading[0] == 0.0 and heading[1] == 0.0):
                heading[0], heading[1] = feed[0], feed[1]
            if turning_in:
                chip = speed * 2.0 * np.pi / (spindle * tool[1]) if speed > LEAST_SPEED else 0.0
                way = np.sqrt(travel * travel + (after[2] - before[2]) ** 2) if speed > LEAST_SPEED else 0.0
                used, ratio = solve_step(
                    lo, hi, count, grid, tool, edge, laws, table, circle,
                    no_compliance if rigid_machine else compliance[k], rigid_machine, before,
                    feed, level, climb, chip, way, top, rows, weights, force, sums, moves, state, result,
                )  # fmt: skip
            elif not rapid:
                state[DELTA : DELTA + 3] = 0.0
            if level == 0.0:  # straight up or down: what comes then begins afresh
                heading[0], heading[1] = 0.0, 0.0
            # a rapid keeps the bend until the tool is out: springing back inside its own cut would gouge the wall,
            # which a tool that still turns would resist
            state[CUTTING] = 1.0 if used > 0 else 0.0
            if used > 0:
                out[k, WRENCH : WRENCH + 6] = result[:6]
                out[k, PEAK] = ratio * peak_force(tool, rows, force, used, turning)
                out[k, OUT_TORQUE] = result[TORQUE]
                out[k, POWER] = result[TORQUE] * spindle
                out[k, ENGAGED] = 1.0
                out[k, OUT_DEPTH], out[k, OUT_WIDTH] = result[DEPTH], result[WIDTH]
                out[k, OUT_ENTRY], out[k, OUT_EXIT] = result[ENTRY], result[EXIT]
                out[k, OUT_CHIP] = result[CHIP]
            out[k, DEFLECTION : DEFLECTION + 3] = state[DELTA : DELTA + 3]

        # removal along the displaced pieces
        piece = pieces_from
        if resumed:
            piece = int(state[PIECE])
            resumed = False
            state[STEP] = 0.0
        pieces = pieces_to - pieces_from
        while piece < pieces_to:
            a, b = (piece - pieces_from) / pieces, (piece - pieces_from + 1.0) / pieces
            for axis in range(3):
                old, new = state[BEFORE + axis], state[DELTA + axis]
                p[axis] = starts[piece, axis] + old + a * (new - old)
                q[axis] = ends[piece, axis] + old + b * (new - old)
            volume, ok = remove_piece(lo, hi, count, grid, dirty, walls, p, q, shapes[0], spare)
            out[k, REMOVED] += volume
            if not ok:
                state[STEP], state[PIECE] = k + 1.0, float(piece)
                return k
            for body in range(1, 3):
                if shapes[body, 1] > 0.0 and min(p[2], q[2]) + shapes[body, 5] < top:
                    _, depth = touch_piece(lo, hi, count, grid, tops, p, q, shapes[body])
                    column = SHANK if body == 1 else HOLDER
                    out[k, column] = max(out[k, column], depth)
            piece += 1
        way = travel_between(before, after, state)
        if out[k, REMOVED] > min(PLAIN_SECTION * way, COLUMN_CUT * cell) * cell * cell and way > 0.0:
            state[CREDIT] = CREDIT_CELLS * cell
        else:
            state[CREDIT] -= way
        if out[k, REMOVED] > LEAST_VOLUME:
            out[k, ENGAGED] = 1.0
            if not rapid:
                if spindle == 0.0:
                    out[k, STOPPED] = 1.0
                elif spindle < 0.0:
                    out[k, REVERSED] = 1.0
        k += 1
    return int(n)
