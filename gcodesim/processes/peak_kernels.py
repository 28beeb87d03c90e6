"""Greatest force and torque of a cutter within a revolution.

While a cutter turns, its force jumps where an edge without a helix enters or leaves the material, has a bend where one
with a helix begins or ends to do so, and is smooth in between. So the turn is divided at these borders; between two of
them the force is greatest at one end, or where parabolas find it.

A *stretch* is a part of the edge that is in contact from one angle to another: a row of one tooth, or all rows of a
cylinder. Its lowest and its highest point enter and leave at turning angles of their own, because the helix makes the
upper one late and because the wall may be elsewhere at its height; what is between them does so evenly. All teeth are
alike, so that one pitch is enough; where they are not (`uneven_kernels`), a whole turn is the pitch, and each tooth
lays stretches of its own. Frame K and phi as in `edge_kernels`; a turning angle is phi of a tooth at the tip.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.processes.edge_kernels import (
    ANGLES,
    COS_KAPPA,
    EDGE_WIDTH,
    FROM,
    HIGH,
    LEAST_ADVANCE,
    LOW,
    PUSHED,
    RADIUS,
    SIN_KAPPA,
    TO,
    UPRIGHT,
    Circle,
    turned,
)
from gcodesim.processes.engagement_kernels import Room
from gcodesim.processes.force_kernels import Teeth
from gcodesim.processes.law_kernels import AXIAL, NORMAL, TABLE, TANGENTIAL, ForceLaw, Scale, power_at, scale_of
from gcodesim.processes.uneven_force_kernels import grown_of
from gcodesim.processes.uneven_kernels import (
    Uneven,
    advance_of_tooth,
    are_uneven,
    late_at,
    sense_at,
    spread_tooth,
    stretch_at,
)

Array = NDArray[np.float64]

# Columns of `Turning.stretches`: turning angles [rad] at which the lowest and the highest point enter and leave, and by
# how much these points are late; the first and the last of these angles; radius [m], sine and cosine of kappa; width of
# edge [m]; the share of it in material, or -1 where that changes with the angle: then the row whose weights have it and
# the angles from which to take it; 1 where it goes on in the stretch of the row below, or above; push [N/m]; where
# teeth differ also the tooth, and the height of the lowest and the highest point [m].
(
    ENTER_LOW, ENTER_HIGH, LEAVE_LOW, LEAVE_HIGH, LATE_LOW, LATE_HIGH, EARLIEST, LATEST, AT_RADIUS, SINE_AT, COSINE_AT,
    WIDE, SHARE, ROW_OF, SHARE_FIRST, SHARE_LAST, JOINS_LOW, JOINS_HIGH, PUSHES, TOOTH, AT_LOW, AT_HIGH,
) = range(22)  # fmt: skip
STRETCHES = 22
MOST_OF_ROW = ANGLES // 2  # stretches of one row

ONE = 2.0 * np.pi / ANGLES  # angle [rad]
PER_ANGLE = ANGLES / (2.0 * np.pi)
TURNS = 4096.0  # more than a helix makes
HALF = 0.5  # share at the middle of a soft wall
SOFTEST = 3  # angles over which a wall may be soft
ALIKE = 0.02  # share by which two angles, or two rows of a cylinder, are still alike
WHOLE = 0.5  # share of an angle from which on contact that is no longer than two is short rather than thin
APART = 1.0e-7  # [rad] between borders that are two; how far beside a jump its sides are
LARGE, NEARBY = 0.15, 1.0 / 24.0  # share of the edge below which borders are not looked at within this share of a pitch
LONGEST = 1.0  # [rad] in which the force has no second extreme
HOPE = 0.75  # of the greatest load, that one end of these has to have if more is to be found inside
SNAP = 0.01  # [rad] between the borders of two rows that are the same
FAR_ASIDE = 2.0 * ONE  # [rad] by which contact of a cylinder and of what is below or above it is not the same
BRIEF = 0.2  # [rad] of phi for which the chip in the middle stands
NODE = 0.5773502691896258  # of Gauss-Legendre with two points
ROUNDS = 2  # of parabolas,
WORTH = 1.003  # of what is known, that they have to promise
SHORTEST = 0.1  # [rad] in which only the ends are looked at,
WIDE_GAP = 0.25  # and from which on they are looked at more closely where there are more
FEW = 6  # stretches than these
BORDERS = 128  # for which there is room,
GAPS = BORDERS + 2 * ANGLES  # and for what is between them

# Columns of `Room.gaps`, between two places that are looked at: the places [rad], and force and torque there and in the
# middle.
BEGIN, END, LOADS, TORQUES = 0, 1, 2, 5
GAP = 8


class Chips(NamedTuple):
    """What an edge feels wherever it is."""

    law: ForceLaw
    scale: Scale
    level: float
    climb: float
    circle: Circle
    pitch: float  # [rad]
    blur: float  # [m] over which a wall is soft
    chip: float  # [m] feed per tooth
    uneven: Uneven


class TipLoad(NamedTuple):
    """Square of the force on the tool [N²], and torque [N·m]."""

    force: float
    torque: float


@kernel(lean=True)
def is_blurred(chips: Chips, row: Array, line: Array) -> bool:
    """Whether a row of a flat bottom is so near to the axis that a wall is soft over more angles than `lay_row` bears.

    A flat bottom advances all the way round or nowhere.
    """
    if chips.blur <= SOFTEST * ONE * row[RADIUS]:
        return False
    least, most = 2.0, 0.0
    for k in range(ANGLES):
        least, most = min(least, line[k]), max(most, line[k])
    return least < HALF < most


@kernel(lean=True)
def lay_blurred(chips: Chips, row: Array, line: Array, stretches: Array, number: int) -> int:
    """`lay_row` for such a row: a wall is where the share is a half, however soft it is."""
    for k in range(ANGLES):
        if line[k] <= HALF or line[k - 1] > HALF:
            continue
        enter = k - 0.5 + (HALF - line[k - 1]) / (line[k] - line[k - 1])
        last = k
        while line[(last + 1) % ANGLES] > HALF:
            last += 1
        here, behind = line[last % ANGLES], line[(last + 1) % ANGLES]
        leave = last + 0.5 + (here - HALF) / (here - behind)
        stretch = stretches[number]
        stretch[ENTER_LOW], stretch[ENTER_HIGH] = enter * ONE, enter * ONE
        stretch[LEAVE_LOW], stretch[LEAVE_HIGH] = leave * ONE, leave * ONE
        stretch[AT_RADIUS], stretch[SINE_AT], stretch[COSINE_AT] = row[RADIUS], row[SIN_KAPPA], row[COS_KAPPA]
        stretch[WIDE], stretch[PUSHES], stretch[SHARE] = row[EDGE_WIDTH], row[PUSHED], 1.0
        stretch[SHARE_FIRST], stretch[SHARE_LAST] = 0.0, 0.0
        stretch[JOINS_LOW], stretch[JOINS_HIGH] = 0.0, 0.0
        number += 1
    return number


@kernel(lean=True, inlined=True)
def lay_row(chips: Chips, row: Array, line: Array, stretches: Array, number: int) -> int:
    """Add the stretches of a row with shares `line` (ANGLES,) to the first `number`; how many there are then.

    An angle at the end of one is in contact in as large a part as it has of the share beside it, unless the edge begins
    or ceases to advance there. Both points enter and leave at the phi of the row's middle.
    """
    sines, sine, fall = chips.circle.sines, chips.level * row[SIN_KAPPA], chips.climb * row[COS_KAPPA]
    k, end, trace = int(row[FROM]), int(row[TO]), 0.0
    for m in range(k, end):
        trace = max(trace, ALIKE * line[m])
    while k < end:
        if line[k] <= trace:
            k += 1
            continue
        first = k
        while k < end and line[k] > trace:
            k += 1
        last = k - 1
        before = sine * sines[first - 1 if first > 0 else ANGLES - 1] - fall
        behind = sine * sines[last + 1 if last < ANGLES - 1 else 0] - fall
        at_first, at_last = sine * sines[first] - fall, sine * sines[last] - fall
        from_rest, to_rest = before <= LEAST_ADVANCE < at_first, behind <= LEAST_ADVANCE < at_last
        inner_first, inner_last, missing_first, missing_last = first, last, 0.0, 0.0
        if last - first >= 2:  # a wall is as soft as a column is wide
            while inner_first < min(first + SOFTEST, last) and line[inner_first + 1] > line[inner_first] + ALIKE:
                inner_first += 1
            while inner_last > max(last - SOFTEST, inner_first) and line[inner_last - 1] > line[inner_last] + ALIKE:
                inner_last -= 1
            for m in range(first, inner_first):
                missing_first += line[m] / line[inner_first]
            for m in range(inner_last + 1, last + 1):
                missing_last += line[m] / line[inner_last]
        least, most, total = 2.0, 0.0, 0.0
        for m in range(inner_first, inner_last + 1):
            least, most, total = min(least, line[m]), max(most, line[m]), total + line[m]
        share = total / (inner_last - inner_first + 1)
        enter, leave = inner_first - missing_first, inner_last + 1.0 + missing_last
        if last - first < 2:  # short, or thin
            share = 1.0 if most >= WHOLE else most
            enter, leave = first + 1.0 - min(line[first] / share, 1.0), last + min(line[last] / share, 1.0)
        if last == first:
            part = leave - last
            enter = first + (0.0 if from_rest else (1.0 - part if to_rest else 0.5 - 0.5 * part))
            leave = enter + part
        if from_rest and enter - first < ALIKE:
            enter = first - 0.5 + before / (before - at_first)
        if to_rest and last + 1.0 - leave < ALIKE:
            leave = last + 0.5 + at_last / (at_last - behind)
        stretch = stretches[number]
        stretch[ENTER_LOW], stretch[ENTER_HIGH] = enter * ONE, enter * ONE
        stretch[LEAVE_LOW], stretch[LEAVE_HIGH] = leave * ONE, leave * ONE
        stretch[AT_RADIUS], stretch[SINE_AT], stretch[COSINE_AT] = row[RADIUS], row[SIN_KAPPA], row[COS_KAPPA]
        stretch[WIDE], stretch[PUSHES] = row[EDGE_WIDTH], row[PUSHED]
        stretch[SHARE] = -1.0 if most - least > ALIKE and last - first >= 2 else share
        stretch[SHARE_FIRST], stretch[SHARE_LAST] = inner_first, inner_last
        stretch[JOINS_LOW], stretch[JOINS_HIGH] = 0.0, 0.0
        number += 1
    return number


@kernel(lean=True, inlined=True)
def same_row(row: Array, below: Array, line: Array, line_below: Array) -> bool:
    """Whether a row of a cylinder is in contact as the one below it is."""
    if abs(row[COS_KAPPA]) >= UPRIGHT or abs(below[COS_KAPPA]) >= UPRIGHT:
        return False
    most = 0.0
    for k in range(int(row[FROM]), int(row[TO])):
        most = max(most, abs(line[k] - line_below[k]))
    return most <= ALIKE


@kernel(lean=True, inlined=True)
def join(lower: Array, upper: Array) -> None:
    """Let contact go on evenly from one stretch to that of the row above, if it is the same contact.

    The wall of a cylinder is upright; of other rows, the border is between their middles. Rows that enter together
    do so exactly, so that force jumps there.
    """
    if lower[LEAVE_HIGH] <= upper[ENTER_LOW] or upper[LEAVE_LOW] <= lower[ENTER_HIGH]:
        return
    part = lower[WIDE] / (lower[WIDE] + upper[WIDE])
    if abs(upper[COSINE_AT]) < UPRIGHT or abs(lower[COSINE_AT]) < UPRIGHT:
        part = 1.0 if abs(upper[COSINE_AT]) < UPRIGHT else 0.0
        aside = max(abs(upper[ENTER_LOW] - lower[ENTER_HIGH]), abs(upper[LEAVE_LOW] - lower[LEAVE_HIGH]))
        if aside > FAR_ASIDE or abs(upper[COSINE_AT]) + abs(lower[COSINE_AT]) < UPRIGHT:
            return
    for low, high in ((ENTER_LOW, ENTER_HIGH), (LEAVE_LOW, LEAVE_HIGH)):
        if abs(upper[low] - lower[high]) <= SNAP:
            upper[low], upper[high] = lower[high], lower[high]
    enter = lower[ENTER_HIGH] + part * (upper[ENTER_LOW] - lower[ENTER_HIGH])
    leave = lower[LEAVE_HIGH] + part * (upper[LEAVE_LOW] - lower[LEAVE_HIGH])
    lower[ENTER_HIGH], lower[LEAVE_HIGH], lower[JOINS_HIGH] = enter, leave, 1.0
    upper[ENTER_LOW], upper[LEAVE_LOW], upper[JOINS_LOW] = enter, leave, 1.0


@kernel(lean=True, inlined=True)
def close_stretch(stretch: Array) -> None:
    """From the phi at which the lowest and the highest point enter and leave, to turning angles.

    An end that joins no other row goes on as the row does to its other end.
    """
    if stretch[JOINS_LOW] != stretch[JOINS_HIGH] and abs(stretch[COSINE_AT]) >= UPRIGHT:
        low, high = (ENTER_LOW, ENTER_HIGH) if stretch[JOINS_HIGH] > 0.0 else (ENTER_HIGH, ENTER_LOW)
        shift = LEAVE_LOW - ENTER_LOW
        enter, leave = 2.0 * stretch[low] - stretch[high], 2.0 * stretch[low + shift] - stretch[high + shift]
        stretch[low], stretch[low + shift] = min(enter, leave), max(enter, leave)
        if enter > leave:
            stretch[low], stretch[low + shift] = 0.5 * (enter + leave), 0.5 * (enter + leave)
    for end in (ENTER_LOW, LEAVE_LOW):
        stretch[end] += stretch[LATE_LOW]
    for end in (ENTER_HIGH, LEAVE_HIGH):
        stretch[end] += stretch[LATE_HIGH]
    stretch[EARLIEST] = min(stretch[ENTER_LOW], stretch[ENTER_HIGH])
    stretch[LATEST] = max(stretch[LEAVE_LOW], stretch[LEAVE_HIGH])


@kernel(lean=True, inlined=True)
def late_of(teeth: Teeth, tooth: int, z: float) -> float:
    """By how much a tooth is late at z [m]: [rad]."""
    if are_uneven(teeth.uneven):
        return late_at(teeth.uneven, tooth, z)
    return float(teeth.lag / teeth.radius * z)


@kernel(lean=True, inlined=True)
def goes_back(teeth: Teeth, row: Array, below: Array) -> bool:
    """Whether a helix goes another way in a row than in the one below."""
    if not are_uneven(teeth.uneven):
        return False
    middle, middle_below = 0.5 * (row[LOW] + row[HIGH]), 0.5 * (below[LOW] + below[HIGH])
    return stretch_at(teeth.uneven, middle) != stretch_at(teeth.uneven, middle_below)


@kernel(lean=True)
def lay_stretches(teeth: Teeth, tooth: int, chips: Chips, room: Room, used: int, stretches: Array) -> int:
    """The stretches of one tooth from the first `used` rows of `room`, lowest first; returns how many there are."""
    rows, weights = room.rows, room.weights
    number, first, end = 0, 0, 0  # those of the last row are first..end
    for i in range(used):
        row = rows[i]
        same = end > first and same_row(row, rows[i - 1], weights[i], weights[i - 1])
        if same and not goes_back(teeth, row, rows[i - 1]):
            for k in range(first, end):
                stretches[k, WIDE] += row[EDGE_WIDTH]
                stretches[k, LATE_HIGH], stretches[k, AT_HIGH] = late_of(teeth, tooth, row[HIGH]), row[HIGH]
            continue
        if row[SIN_KAPPA] <= UPRIGHT and is_blurred(chips, row, weights[i]):
            number = lay_blurred(chips, row, weights[i], stretches, end)
        else:
            number = lay_row(chips, row, weights[i], stretches, end)
        for k in range(end, number):
            stretches[k, LATE_LOW], stretches[k, LATE_HIGH] = (
                late_of(teeth, tooth, row[LOW]), late_of(teeth, tooth, row[HIGH])
            )  # fmt: skip
            stretches[k, ROW_OF], stretches[k, TOOTH] = i, tooth
            stretches[k, AT_LOW], stretches[k, AT_HIGH] = row[LOW], row[HIGH]
        if number - end == end - first:
            for k in range(end, number):
                join(stretches[k - end + first], stretches[k])
        first, end = end, number
    for k in range(end):
        close_stretch(stretches[k])
    return end


@kernel(lean=True)
def lay_teeth(teeth: Teeth, chips: Chips, room: Room, used: int) -> int:
    """The stretches of all teeth that differ, or of one; returns how many there are."""
    if not are_uneven(teeth.uneven):
        return lay_stretches(teeth, 0, chips, room, used, room.stretches)
    number = 0
    for tooth in range(teeth.uneven.late.shape[0]):
        number += lay_stretches(teeth, tooth, chips, room, used, room.stretches[number:])
    return number


@kernel(lean=True)
def add_uneven_load(
    chips: Chips, stretch: Array, place: float, width: float, sine: float, cosine: float, load: Array
) -> None:
    """Add to `load` (4,) what a part of a stretch of one tooth bears, `place` of it above its foot, at an angle."""
    uneven, law, scale, tooth = chips.uneven, chips.law, chips.scale, int(stretch[TOOTH])
    z, sine_kappa, cosine_kappa = stretch[AT_LOW], stretch[SINE_AT], stretch[COSINE_AT]
    z += place * (stretch[AT_HIGH] - z)
    even = chips.level * sine * sine_kappa - chips.climb * cosine_kappa
    if even <= LEAST_ADVANCE:
        return
    spread_tooth(uneven, tooth, z)
    advance = advance_of_tooth(uneven, tooth, even, sine_kappa / chips.chip)
    if advance <= LEAST_ADVANCE:
        return
    tangential = width * (scale.tangential * grown_of(law, uneven, TANGENTIAL, advance) + law.rub[TANGENTIAL])
    normal = width * (scale.normal * grown_of(law, uneven, NORMAL, advance) + law.rub[NORMAL])
    axial = width * (scale.axial * grown_of(law, uneven, AXIAL, advance) + law.rub[AXIAL])
    axial *= sense_at(uneven, 0.5 * (stretch[AT_LOW] + stretch[AT_HIGH]))
    inward = normal * sine_kappa + axial * cosine_kappa
    load[0] -= tangential * cosine + inward * sine
    load[1] += tangential * sine - inward * cosine
    load[2] += normal * cosine_kappa - axial * sine_kappa + width * stretch[PUSHES]
    load[3] += tangential * stretch[AT_RADIUS]


@kernel(lean=True, inlined=True)
def load_between(chips: Chips, stretch: Array, line: Array, angle: float, low: float, high: float, load: Array) -> None:
    """Add to `load` (4,) the force along u, l, z and the torque of a part of a stretch, low..high of it from its foot.

    angle [rad]: of its tooth at the tip.
    """
    late, part = stretch[LATE_HIGH] - stretch[LATE_LOW], high - low
    nodes = 1 if abs(late * part) < BRIEF else 2
    sine_kappa, cosine_kappa, law, scale = stretch[SINE_AT], stretch[COSINE_AT], chips.law, chips.scale
    exponent, rub, uneven = law.exponent, law.rub, are_uneven(chips.uneven)
    for node in range(nodes):
        place = 0.5 * (low + high) + ((node - 0.5) * NODE * part if nodes == 2 else 0.0)
        width = part * stretch[WIDE] / nodes
        phi = angle - stretch[LATE_LOW] - place * late
        k = int(phi * PER_ANGLE + ANGLES) - ANGLES  # rounding may leave a phi just below 0
        middle = k + 0.5
        k &= ANGLES - 1
        sine, cosine = turned(chips.circle.sines[k], chips.circle.cosines[k], phi - middle * ONE)
        if stretch[SHARE] >= 0.0:
            width *= stretch[SHARE]
        else:
            width *= line[min(max(k, int(stretch[SHARE_FIRST])), int(stretch[SHARE_LAST]))]
        if uneven:
            add_uneven_load(chips, stretch, place, width, sine, cosine, load)
            continue
        advance = min(chips.level * sine * sine_kappa - chips.climb * cosine_kappa, 1.0)
        if advance <= LEAST_ADVANCE:
            continue
        grown_t = grown_n = grown_a = advance
        if exponent[TANGENTIAL] != 1.0 or exponent[NORMAL] != 1.0 or exponent[AXIAL] != 1.0:
            at = advance * (TABLE - 1)
            left = min(int(at), TABLE - 2)
            grown_t = power_at(law.powers, TANGENTIAL, left, at - left)
            grown_n = power_at(law.powers, NORMAL, left, at - left)
            grown_a = power_at(law.powers, AXIAL, left, at - left)
        tangential = width * (scale.tangential * grown_t + rub[TANGENTIAL])
        normal = width * (scale.normal * grown_n + rub[NORMAL])
        axial = width * (scale.axial * grown_a + rub[AXIAL])
        inward = normal * sine_kappa + axial * cosine_kappa
        load[0] -= tangential * cosine + inward * sine
        load[1] += tangential * sine - inward * cosine
        load[2] += normal * cosine_kappa - axial * sine_kappa + width * stretch[PUSHES]
        load[3] += tangential * stretch[AT_RADIUS]


@kernel(lean=True, inlined=True)
def behind_line(at_low: float, at_high: float, angle: float) -> tuple[float, float]:
    """The part of a stretch, from its foot, whose points are at turning angles up to `angle`; these change evenly."""
    if at_low <= angle and at_high <= angle:
        return 0.0, 1.0
    if at_low > angle and at_high > angle:
        return 0.0, 0.0
    part = (angle - at_low) / (at_high - at_low)
    return (0.0, part) if at_low <= angle else (part, 1.0)


@kernel(lean=True)
def load_at(chips: Chips, weights: Array, stretches: Array, number: int, angle: float, load: Array) -> TipLoad:
    """The load with a tooth at turning angle `angle` [rad], from 0 to a pitch and a little more; load (4,) is room."""
    load[:] = 0.0
    pitch, per_pitch = chips.pitch, 1.0 / chips.pitch
    for i in range(number):
        stretch = stretches[i]
        at = (
            angle + (int((stretch[EARLIEST] - angle) * per_pitch + TURNS) - TURNS) * pitch
        )  # the first that has entered
        at += pitch if at < stretch[EARLIEST] else 0.0
        while at <= stretch[LATEST]:
            entered_low, entered_high = behind_line(stretch[ENTER_LOW], stretch[ENTER_HIGH], at)
            left_low, left_high = behind_line(stretch[LEAVE_LOW], stretch[LEAVE_HIGH], at)
            low, high = entered_low, entered_high
            if left_high > left_low:  # what has left is at one end
                if left_low == 0.0:
                    low = max(low, left_high)
                else:
                    high = min(high, left_low)
            if high > low:
                load_between(chips, stretch, weights[int(stretch[ROW_OF])], at, low, high, load)
            at += pitch
    return TipLoad(load[0] * load[0] + load[1] * load[1] + load[2] * load[2], load[3])


@kernel(lean=True, inlined=True)
def keep_border(borders: Array, number: int, angle: float, pitch: float, jumps: bool, near: float) -> int:
    """Put a turning angle among the first `number` borders unless one is near; how many there are then.

    borders (2, BORDERS): angles [rad] in order, from 0 to a pitch, and 1 where force jumps.
    """
    place = angle - (int(angle / pitch + TURNS) - TURNS) * pitch
    k = number
    while k > 0 and borders[0, k - 1] > place:
        k -= 1
    if k > 0 and place - borders[0, k - 1] <= near:
        borders[1, k - 1] = max(borders[1, k - 1], 1.0 if jumps else 0.0)
        return number
    if k < number and borders[0, k] - place <= near:
        borders[1, k] = max(borders[1, k], 1.0 if jumps else 0.0)
        return number
    if number == borders.shape[1]:
        return number
    for m in range(number, k, -1):
        borders[0, m], borders[1, m] = borders[0, m - 1], borders[1, m - 1]
    borders[0, k], borders[1, k] = place, 1.0 if jumps else 0.0
    return number + 1


@kernel(lean=True, inlined=True)
def goes_on_in(stretches: Array, number: int, i: int) -> int:
    """The stretch of the row above in which stretch i goes on, or `number`."""
    j, row = i + 1, stretches[i, ROW_OF] + 1.0
    while j < number and stretches[j, ROW_OF] <= row:
        if stretches[j, ROW_OF] == row and abs(stretches[j, ENTER_LOW] - stretches[i, ENTER_HIGH]) <= APART:
            return j
        j += 1
    return number


@kernel(lean=True, inlined=True)
def find_turns(stretches: Array, number: int, pitch: float, borders: Array, found: int) -> int:
    """Add to the first `found` borders those where what goes on from row to row enters last, or leaves first.

    There no more of it comes, or all of it begins to go; returns how many borders there are then.
    """
    for i in range(number):
        if stretches[i, JOINS_HIGH] == 0.0:
            continue
        j = goes_on_in(stretches, number, i)
        if j == number:
            continue
        lower, upper = stretches[i], stretches[j]
        if lower[ENTER_HIGH] - lower[ENTER_LOW] > APART and upper[ENTER_HIGH] - upper[ENTER_LOW] < -APART:
            found = keep_border(borders, found, lower[ENTER_HIGH], pitch, False, SNAP)
        if lower[LEAVE_HIGH] - lower[LEAVE_LOW] < -APART and upper[LEAVE_HIGH] - upper[LEAVE_LOW] > APART:
            found = keep_border(borders, found, lower[LEAVE_HIGH], pitch, False, SNAP)
    return found


@kernel(lean=True)
def find_borders(stretches: Array, number: int, teeth: int, pitch: float, borders: Array) -> int:
    """Where force jumps or bends while a pitch goes by, at the ends of the stretches; returns how many there are.

    Of small ones only some that are not near another. The stretches are those of so many `teeth`.
    """
    whole, found = 0.0, find_turns(stretches, number, pitch, borders, 0)
    for i in range(number):
        whole += stretches[i, WIDE]
    whole /= teeth
    for small in (False, True):
        for i in range(number):
            stretch = stretches[i]
            if (stretch[WIDE] < LARGE * whole) != small:
                continue
            for low, high in ((ENTER_LOW, ENTER_HIGH), (LEAVE_LOW, LEAVE_HIGH)):
                jumps = abs(stretch[low] - stretch[high]) <= APART
                near = NEARBY * pitch / teeth if small and not jumps else APART
                if jumps or stretch[JOINS_LOW] == 0.0:
                    found = keep_border(borders, found, stretch[low], pitch, jumps, near)
                if not jumps and stretch[JOINS_HIGH] == 0.0:
                    found = keep_border(borders, found, stretch[high], pitch, jumps, near)
    return found


@kernel(lean=True)
def climb_parabolas(chips: Chips, room: Room, number: int, gap: Array, of: int, best: float) -> TipLoad:
    """The greatest loads of those that parabolas lead to between two places; `of` is LOADS or TORQUES."""
    begin, end = gap[BEGIN], gap[END]
    middle = 0.5 * (begin + end)
    at_begin, at_middle, at_end = gap[of], gap[of + 1], gap[of + 2]
    force, torque = 0.0, 0.0
    for _ in range(ROUNDS):
        before, behind = middle - begin, end - middle
        slope_before, slope_behind = (at_middle - at_begin) / before, (at_end - at_middle) / behind
        bent = (slope_behind - slope_before) / (before + behind)
        if bent >= 0.0:
            break
        slope = (slope_before * behind + slope_behind * before) / (before + behind)
        place = middle - 0.5 * slope / bent
        promise = at_middle - 0.25 * slope * slope / bent
        if not begin < place < end or promise < best * WORTH:
            break
        found = load_at(chips, room.weights, room.stretches, number, place, room.load)
        force, torque = max(force, found.force), max(torque, found.torque)
        here = found.force if of == LOADS else found.torque
        best = max(best, here)
        if place < middle:
            if here >= at_middle:
                end, at_end, middle, at_middle = middle, at_middle, place, here
            else:
                begin, at_begin = place, here
        elif here >= at_middle:
            begin, at_begin, middle, at_middle = middle, at_middle, place, here
        else:
            end, at_end = place, here
        if not begin < middle < end:
            break
    return TipLoad(force, torque)


@kernel(lean=True)
def lay_gaps(chips: Chips, room: Room, number: int, found: int) -> int:
    """Fill `room.gaps` with what is between the first `found` borders, and loads at its ends; returns how many."""
    borders, gaps, weights, stretches, load = room.borders, room.gaps, room.weights, room.stretches, room.load
    used = 0
    last = load_at(chips, weights, stretches, number, borders[0, 0] + APART, load)
    for i in range(found):
        begin, end, jumps = borders[0, i], borders[0, 0] + chips.pitch, borders[1, 0]
        if i + 1 < found:
            end, jumps = borders[0, i + 1], borders[1, i + 1]
        parts = int((end - begin) / LONGEST) + 1
        for part in range(parts):
            gap = gaps[used]
            gap[BEGIN], gap[END] = begin + part * (end - begin) / parts, begin + (part + 1.0) * (end - begin) / parts
            gap[LOADS], gap[TORQUES] = last.force, last.torque
            last = load_at(chips, weights, stretches, number, gap[END] - (APART if part + 1 == parts else 0.0), load)
            gap[LOADS + 2], gap[TORQUES + 2] = last.force, last.torque
            used += 1
        if jumps > 0.0 and i + 1 < found:
            last = load_at(chips, weights, stretches, number, end + APART, load)
    return used


@kernel(lean=True, inlined=True)
def narrow_gap(chips: Chips, room: Room, number: int, gap: Array) -> TipLoad:
    """Look between the middle of a gap and its greater end; narrow it to that half if force is greater there.

    Where many rows leave one after the other, force has a crest that a parabola over the whole gap does not see.
    Returns what was found.
    """
    begin, end, later = gap[BEGIN], gap[END], gap[LOADS + 2] > gap[LOADS]
    middle = 0.5 * (begin + end)
    place = 0.5 * (middle + end) if later else 0.5 * (begin + middle)
    found = load_at(chips, room.weights, room.stretches, number, place, room.load)
    if found.force > gap[LOADS + 1]:
        gap[BEGIN], gap[END] = (middle, end) if later else (begin, middle)
        beside = 0 if later else 2
        for of in (LOADS, TORQUES):
            gap[of + beside] = gap[of + 1]
        gap[LOADS + 1], gap[TORQUES + 1] = found.force, found.torque
    return found


@kernel(lean=True, inlined=True)
def greatest_in(chips: Chips, room: Room, number: int, gap: Array, known: TipLoad) -> TipLoad:
    """The greatest loads of those that are `known` and those that are found between two places."""
    force, torque = known
    hope = max(gap[LOADS], gap[LOADS + 2]) > HOPE * HOPE * force or max(gap[TORQUES], gap[TORQUES + 2]) > HOPE * torque
    if not hope or gap[END] - gap[BEGIN] < SHORTEST:
        return known
    middle = load_at(chips, room.weights, room.stretches, number, 0.5 * (gap[BEGIN] + gap[END]), room.load)
    gap[LOADS + 1], gap[TORQUES + 1] = middle.force, middle.torque
    force, torque = max(force, middle.force), max(torque, middle.torque)
    if number > FEW and gap[END] - gap[BEGIN] > WIDE_GAP:
        half = narrow_gap(chips, room, number, gap)
        force, torque = max(force, half.force), max(torque, half.torque)
    more = climb_parabolas(chips, room, number, gap, LOADS, force)
    force, torque = max(force, more.force), max(torque, more.torque)
    more = climb_parabolas(chips, room, number, gap, TORQUES, torque)
    return TipLoad(max(force, more.force), max(torque, more.torque))


@kernel(lean=True)
def peaks_of(
    teeth: Teeth, level: float, climb: float, chip: float, blur: float, room: Room, used: int
) -> tuple[float, float]:
    """Greatest force [N] and torque [N·m] within a revolution, of all teeth and heights at once.

    The first `used` rows of `room` are those of `cutting_force` for the feed per tooth `chip` [m].
    """
    if are_uneven(teeth.uneven) and chip <= 0.0:
        return 0.0, 0.0
    law = teeth.law
    scale = Scale(scale_of(law, TANGENTIAL, chip), scale_of(law, NORMAL, chip), scale_of(law, AXIAL, chip))
    pitch = 2.0 * np.pi / (1.0 if are_uneven(teeth.uneven) else teeth.number)
    chips = Chips(law, scale, level, climb, teeth.circle, pitch, blur, chip, teeth.uneven)
    number = lay_teeth(teeth, chips, room, used)
    teeth_laid = max(teeth.uneven.late.shape[0], 1)
    found = find_borders(room.stretches, number, teeth_laid, chips.pitch, room.borders)
    if found == 0:
        return 0.0, 0.0
    gaps = lay_gaps(chips, room, number, found)
    force, torque = 0.0, 0.0
    for i in range(gaps):
        gap = room.gaps[i]
        force = max(force, max(gap[LOADS], gap[LOADS + 2]))
        torque = max(torque, max(gap[TORQUES], gap[TORQUES + 2]))
    known = TipLoad(force, torque)
    for i in range(gaps):
        known = greatest_in(chips, room, number, room.gaps[i], known)
    return float(np.sqrt(known.force)), float(known.torque)
