"""How a tool that yields really travels in a step: that is where its chips are cut, and how thick they are.

While a cut grows the tip is pushed back against the feed, so that it advances less than commanded and its chips are
thinner; while the cut fades the bend is reduced through thicker ones. Where the feed turns, the tip does not turn at
once: its bend swings round with the force, as fast as the tip cuts. The way of the tip is the commanded one plus
the growth of its bend delta, and force F depends on that way v:

    delta = C F(v),   v = commanded + (delta - delta before)

which is an implicit Euler step of a differential equation for the bend. Without it a soft machine would be bent faster
than it is fed, and dig itself in without ever moving on.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.arithmetic.power_kernels import power
from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.processes.edge_kernels import (
    ANGLES,
    COS_KAPPA,
    EDGE_WIDTH,
    FROM,
    HEIGHT,
    LEVER_COSINES,
    LEVER_SINES,
    MORE_COSINES,
    MORE_SINES,
    RADIUS,
    RUBS,
    SIN_KAPPA,
    TO,
    Array,
    Heading,
)
from gcodesim.processes.engagement_kernels import Room
from gcodesim.processes.force_kernels import TORQUE, Teeth
from gcodesim.processes.law_kernels import AXIAL, COSINE, NORMAL, SINE, TANGENTIAL
from gcodesim.processes.uneven_kernels import are_uneven

LEAST, MOST = 1.0e-3, 4.0  # range of advance over feed for which chips are computed
SAME_WAY = 1.0 - 0.5 * 0.05 * 0.05  # cosine of the angle by which a contact may turn before it is sampled again
ARRIVED = 1.0e-7  # [rad] from the feed, less than rounding of directions leaves
ROUNDS, LARGEST_TURN = 40, 0.5  # of Newton's method; [rad] in one of them


class Travel(NamedTuple):
    """A step of a tip that yields.

    left [m]: way commanded in this step less the bend at its beginning, so that left + bend is the way of the tip;
    horizontal directions: `begin`, where the tip went before, `feed`, the command, and `travel`, in between, which is
    to be found.
    """

    compliance: Array  # (3, 6) translation of the tip
    left: Array  # (3,)
    begin: Array  # (2,)
    feed: Array  # (2,)
    travel: Array  # (2,)
    level: float  # horizontal and
    climb: float  # vertical share of the commanded direction
    way: float  # [m] commanded, > 0
    exponent: float  # of the force of chips over their thickness
    moves: Array  # (6, 3) room to work in


class Wrenches(NamedTuple):
    """The two parts of a wrench (>= 6,): of the edges, which no chip changes (then its torque), and of chips."""

    edges: Array
    chips: Array


@kernel(lean=True)
def edge_wrench(teeth: Teeth, heading: Heading, room: Room, used: int, wrench: Array) -> None:
    """The part of `cutting_force` that no chip changes, from the contact it has found: wrench (7,), torque last.

    The edge forces E of a law are the same at all angles, so that each row needs three sums over its contact.
    """
    wrench[:] = 0.0
    rub_t, rub_n, rub_a = teeth.law.rub[TANGENTIAL], teeth.law.rub[NORMAL], teeth.law.rub[AXIAL]
    if rub_t == 0.0 and rub_n == 0.0 and rub_a == 0.0:
        return
    ux, uy, rows, weights = heading.ux, heading.uy, room.rows, room.weights
    mean_sines, mean_cosines = teeth.law.means[SINE], teeth.law.means[COSINE]
    f_u, f_l, f_z, m_u, m_l, torque = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(used):
        all_of, sines, cosines = 0.0, 0.0, 0.0
        for k in range(int(rows[i, FROM]), int(rows[i, TO])):
            all_of += weights[i, k]
            sines += weights[i, k] * mean_sines[k]
            cosines += weights[i, k] * mean_cosines[k]
        r, z, width = rows[i, RADIUS], rows[i, HEIGHT], rows[i, EDGE_WIDTH]
        if are_uneven(teeth.uneven):
            width *= rows[i, RUBS]
        tangential = width * rub_t
        inward = width * (rub_n * rows[i, SIN_KAPPA] + rub_a * rows[i, COS_KAPPA])
        along = width * (rub_n * rows[i, COS_KAPPA] - rub_a * rows[i, SIN_KAPPA])
        more_s, more_c, lever_s, lever_c = (
            rows[i, MORE_SINES], rows[i, MORE_COSINES], rows[i, LEVER_SINES], rows[i, LEVER_COSINES]
        )  # fmt: skip
        f_u += -tangential * (cosines + more_c) - inward * (sines + more_s)
        f_l += tangential * (sines + more_s) - inward * (cosines + more_c)
        f_z += along * all_of
        m_u += r * along * cosines - tangential * (z * sines + lever_s) + inward * (z * cosines + lever_c)
        m_l += -tangential * (z * cosines + lever_c) - inward * (z * sines + lever_s) - r * along * sines
        torque += r * tangential * all_of
    share = teeth.number / ANGLES
    wrench[0], wrench[1], wrench[2] = share * (ux * f_u - uy * f_l), share * (uy * f_u + ux * f_l), share * f_z
    wrench[3], wrench[4] = share * (ux * m_u - uy * m_l), share * (uy * m_u + ux * m_l)
    wrench[5] = share * torque
    wrench[TORQUE] = share * torque


@kernel(lean=True)
def move_of(compliance: Array, wrench: Array, move: Array) -> None:
    """Displacement `move` (3,) [m] of the tip under `wrench` (6,); compliance (3, 6): its translation rows."""
    for axis in range(3):
        total = 0.0
        for component in range(6):
            total += compliance[axis, component] * wrench[component]
        move[axis] = total


@kernel(lean=True)
def turn_wrench(wrench: Array, c: float, s: float) -> None:
    """Turn force and moment of `wrench` (>= 6,) about Z, by the angle whose cosine and sine are c and s."""
    for first in (0, 3):
        x, y = wrench[first], wrench[first + 1]
        wrench[first], wrench[first + 1] = c * x - s * y, s * x + c * y


@kernel(lean=True)
def spread_moves(compliance: Array, wrench: Array, moves: Array) -> None:
    """Displacements (3, 3) [m] of a wrench that turns about Z: c moves[0] + s moves[1] + moves[2] once it has."""
    for axis in range(3):
        row = compliance[axis]
        moves[0, axis] = row[0] * wrench[0] + row[1] * wrench[1] + row[3] * wrench[3] + row[4] * wrench[4]
        moves[1, axis] = row[1] * wrench[0] - row[0] * wrench[1] + row[4] * wrench[3] - row[3] * wrench[4]
        moves[2, axis] = row[2] * wrench[2] + row[5] * wrench[5]


@kernel(lean=True)
def angle_between(one: Array, other: Array) -> float:
    """Angle [rad] by which direction `one` (2,) has to be turned to be `other`, from -pi to pi."""
    return atan2(one[0] * other[1] - one[1] * other[0], one[0] * other[0] + one[1] * other[1])


@kernel(lean=True)
def solve_travel(step: Travel, wrenches: Wrenches, asked: float) -> float:
    """Advance over feed [-] of the tip in a step; turns `step.travel` in place.

    The wrenches were asked for that travel at the advance `asked` > 0. They turn with the travel, and chips grow with
    the advance to the power `exponent`.

    Solves left + C W(travel, advance) = advance way travel, along the travel and across it, by Newton's method; the
    travel stays between `begin` and `feed`. If chips pull the tool on, towards ever thicker ones, they are taken at the
    commanded feed, and a force that turns it further and further in the commanded direction. What holds it then, and
    keeps it from weaving about a straight line, is inertia.
    """
    compliance, left, begin, feed, travel, level, climb, way, exponent, moves = step
    spread_moves(compliance, wrenches.chips, moves[:3])
    spread_moves(compliance, wrenches.edges, moves[3:])
    ux, uy = travel[0], travel[1]
    pushed = level * (ux * (moves[0, 0] + moves[2, 0]) + uy * (moves[0, 1] + moves[2, 1]))
    pushed += climb * (moves[0, 2] + moves[2, 2])
    turned = ux * (moves[1, 1] + moves[4, 1]) - uy * (moves[1, 0] + moves[4, 0])
    back, onward = angle_between(travel, begin), angle_between(travel, feed)
    grows, turns = pushed < 0.0, level > 0.0 and turned < 0.0 and back != onward
    a, angle = min(max(asked, LEAST), MOST) if grows else 1.0, 0.0 if turns else onward
    least, most = min(back, onward), max(back, onward)
    c, s = cos_sin(angle)
    for _ in range(ROUNDS):
        growth = power(a / asked, exponent)
        vx, vy = c * ux - s * uy, s * ux + c * uy
        along, across, along_turned, across_turned, along_grown, across_grown = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for axis in range(3):
            level_v = vx if axis == 0 else (vy if axis == 1 else 0.0)
            u = level * level_v + (climb if axis == 2 else 0.0)
            n = -vy if axis == 0 else (vx if axis == 1 else 0.0)
            chip = growth * (c * moves[0, axis] + s * moves[1, axis] + moves[2, axis])
            goes = left[axis] + chip + c * moves[3, axis] + s * moves[4, axis] + moves[5, axis]
            turning = growth * (c * moves[1, axis] - s * moves[0, axis]) + c * moves[4, axis] - s * moves[3, axis]
            along += u * goes
            across += n * goes
            along_turned += level * n * goes + u * turning
            across_turned += n * turning - level_v * goes
            along_grown += u * chip
            across_grown += n * chip
        along -= a * way
        along_grown = exponent / a * along_grown - way
        across_grown *= exponent / a
        turn = 0.0
        if turns:
            determinant = along_grown * across_turned - along_turned * across_grown
            if not grows:
                turn = -across / across_turned if across_turned < 0.0 else math.copysign(LARGEST_TURN, across)
            elif determinant > 0.0:
                turn = (across_grown * along - along_grown * across) / determinant
            else:  # far from the solution
                turn = -across / across_turned if across_turned < 0.0 else math.copysign(LARGEST_TURN, across)
            turn = min(max(turn, -LARGEST_TURN), LARGEST_TURN)
            turn = min(max(angle + turn, least), most) - angle
        following = a
        if grows:
            more = -(along + along_turned * turn) / along_grown if along_grown < 0.0 else 0.0
            following = min(max(a + more, 0.5 * a, LEAST), 2.0 * a, MOST)
        angle += turn
        done = abs(following - a) < 1.0e-6 * a and abs(turn) < 1.0e-6
        a = following
        c, s = cos_sin(angle)
        if done:
            break
    travel[0], travel[1] = c * ux - s * uy, s * ux + c * uy
    size = math.sqrt(travel[0] * travel[0] + travel[1] * travel[1])
    travel[0], travel[1] = travel[0] / size, travel[1] / size
    if abs(angle - onward) < ARRIVED:
        travel[0], travel[1] = feed[0], feed[1]
    return float(a)


@kernel(lean=True, inlined=True)
def follow_travel(step: Travel, wrenches: Wrenches, asked: float, result: Array) -> tuple[float, float]:
    """Change the wrench `result` (>= 7,), asked for the travel at the advance `asked`, to that of the travel it leaves.

    `wrenches.edges` is its part that no chip changes. Returns the advance, and by what the force has grown; the travel
    turns, and `wrenches` are then the two parts of the wrench.
    """
    edges, chips = wrenches
    travel, exponent = step.travel, step.exponent
    ux, uy = travel[0], travel[1]
    for component in range(6):
        chips[component] = result[component] - edges[component]
    advance = solve_travel(step, wrenches, asked)
    growth = power(advance / asked, exponent)
    cosine, sine = ux * travel[0] + uy * travel[1], ux * travel[1] - uy * travel[0]
    turn_wrench(edges, cosine, sine)
    turn_wrench(chips, cosine, sine)
    before, after = 0.0, 0.0
    for component in range(6):
        chips[component] *= growth
        total = edges[component] + chips[component]
        if component < 3:
            before += result[component] * result[component]
            after += total * total
        result[component] = total
    result[TORQUE] = edges[TORQUE] + growth * (result[TORQUE] - edges[TORQUE])
    return advance, math.sqrt(after / before) if before > 0.0 else 1.0
