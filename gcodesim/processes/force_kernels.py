"""Force on an upright cutter that stands in material, averaged over a revolution and at its worst angle.

Frame K and the rows of the edge as in `engagement_kernels`. On an element of edge of width b with chip thickness
h = c (v . n): dF = -dFt t - dFr n - dFa e, with t along the cutting velocity, n the outward normal of the edge, e along
the edge away from the tip; each of Ft, Fr, Fa = b (K h**p + E) (see `laws`). b has no 1/cos(helix) (Altintas 2012,
sec. 2.8).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.power_kernels import power
from gcodesim.compiled import kernel
from gcodesim.material.kernels import Field, coarsest
from gcodesim.processes.edge_kernels import (
    ANGLES,
    ARC,
    COS_KAPPA,
    EDGE_WIDTH,
    FROM,
    HEIGHT,
    HIGH,
    LEAST_ADVANCE,
    LOW,
    RADIUS,
    SIN_KAPPA,
    STEEPEST,
    TO,
    UPRIGHT,
    Circle,
    Heading,
    lay_rows,
)
from gcodesim.processes.engagement_kernels import Room, contact_of_cylinder, contact_of_rows

Array = NDArray[np.float64]

TABLE = 1025  # points of x**p on 0..1
LEAST_SHARE = 0.05  # of a row in material, from which on an angle counts as one of contact

# The result of `cutting_force`: wrench about the tip in S (6), torque, greatest chip thickness, axial depth, radial
# width, entry and exit angle, and the sum of engaged elements (0: no contact).
FORCE, MOMENT, TORQUE, CHIP, DEPTH, WIDTH, ENTRY, EXIT, CONTACT = 0, 3, 6, 7, 8, 9, 10, 11, 12
RESULT = 13

# Sums over rows at each angle, in `Room.sums`: forces along u, l, z; the first two times height, and the third times
# radius; torque; shares, the greatest share, and the greatest radial width.
F_U, F_L, F_Z, TILT_U, TILT_L, LIFT, TURN, SHARES, MOST, WIDEST = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
SUMS = 10

TANGENTIAL, NORMAL, AXIAL = 0, 1, 2  # components of a law


class ForceLaw(NamedTuple):
    """Force per width of an edge, factor h**exponent + rub, each (3,); powers (3, TABLE): see `power_table`."""

    factor: Array
    exponent: Array
    rub: Array
    powers: Array


class Teeth(NamedTuple):
    """The edges of a cutter, all alike and evenly spread."""

    radius: float  # [m]
    number: float
    lag: float  # tangent of the helix
    height: float  # [m] up to which they cut
    pieces: Array  # (k, 8) outline, see `Cutter.edge`
    law: ForceLaw
    circle: Circle


@kernel(lean=True)
def power_table(exponent: Array, table: Array) -> None:
    """Fill `table` (3, TABLE) with x**p on 0..1 for each exponent, because a power costs more than all the rest."""
    for component in range(3):
        for i in range(table.shape[1]):
            table[component, i] = power(i / (table.shape[1] - 1.0), exponent[component])


@kernel(lean=True)
def power_at(table: Array, component: int, left: int, part: float) -> float:
    """Value between point `left` of `table` and the next, `part` of the way."""
    value: float = (1.0 - part) * table[component, left] + part * table[component, left + 1]
    return value


class Scale(NamedTuple):
    """factor c**exponent of each component, with c the feed per tooth: force per width [N/m] of a chip that thick."""

    tangential: float
    normal: float
    axial: float


@kernel(lean=True, inlined=True)
def scale_of(law: ForceLaw, component: int, chip: float) -> float:
    """One component of `Scale`."""
    return float(law.factor[component] * power(chip, law.exponent[component])) if chip > 0.0 else 0.0


@kernel(lean=True)
def unit_forces(
    teeth: Teeth, heading: Heading, scale: Scale, sin_kappa: float, cos_kappa: float, begin: int, end: int, unit: Array
) -> None:
    """Fill unit[:, begin:end] with force per width [N/m] at each angle: tangential, inward (radial), along the axis.

    Angles at which the edge does not advance get 0.
    """
    sines = teeth.circle.sines[begin:end]
    unit_t, unit_r, unit_a = unit[0, begin:end], unit[1, begin:end], unit[2, begin:end]
    _, exponent, rub, powers = teeth.law
    level, fall = heading.level, heading.climb * cos_kappa
    if exponent[TANGENTIAL] == 1.0 and exponent[NORMAL] == 1.0 and exponent[AXIAL] == 1.0:
        for k in range(sines.shape[0]):
            advance = level * sines[k] * sin_kappa - fall
            grown = min(advance, 1.0)
            normal, axial = scale.normal * grown + rub[NORMAL], scale.axial * grown + rub[AXIAL]
            cuts = advance > LEAST_ADVANCE
            unit_t[k] = scale.tangential * grown + rub[TANGENTIAL] if cuts else 0.0
            unit_r[k] = normal * sin_kappa + axial * cos_kappa if cuts else 0.0
            unit_a[k] = normal * cos_kappa - axial * sin_kappa if cuts else 0.0
        return
    common = exponent[TANGENTIAL] == exponent[NORMAL] and exponent[TANGENTIAL] == exponent[AXIAL]
    for k in range(sines.shape[0]):
        advance = min(level * sines[k] * sin_kappa - fall, 1.0)
        if advance <= LEAST_ADVANCE:
            unit_t[k], unit_r[k], unit_a[k] = 0.0, 0.0, 0.0
            continue
        place = advance * (TABLE - 1)
        left = min(int(place), TABLE - 2)
        part = place - left
        grown_t = power_at(powers, TANGENTIAL, left, part)
        grown_r, grown_a = grown_t, grown_t
        if not common:
            grown_r, grown_a = power_at(powers, NORMAL, left, part), power_at(powers, AXIAL, left, part)
        normal, axial = scale.normal * grown_r + rub[NORMAL], scale.axial * grown_a + rub[AXIAL]
        unit_t[k] = scale.tangential * grown_t + rub[TANGENTIAL]
        unit_r[k] = normal * sin_kappa + axial * cos_kappa
        unit_a[k] = normal * cos_kappa - axial * sin_kappa


class ToothForce(NamedTuple):
    """Force of one row on one tooth (ANGLES,) along u, l, z [N], and its torque [N·m]."""

    u: Array
    l: Array  # noqa: E741 - its name in frame K
    z: Array
    turn: Array


@kernel(lean=True)
def add_row(row: Array, circle: Circle, unit: Array, weights: Array, force: ToothForce, sums: Array) -> None:
    """Force of one row on one tooth, and its part in `sums`.

    Only angles FROM..TO of the row are written; the others carry no force.

    Sums over rows are kept separately for each angle, so this loop has no dependence between its iterations.
    """
    r, z, width, begin, end = row[RADIUS], row[HEIGHT], row[EDGE_WIDTH], int(row[FROM]), int(row[TO])
    # slices, because an index of which the compiler cannot see that it is not negative keeps it to one angle at a time
    sines, cosines, share = circle.sines[begin:end], circle.cosines[begin:end], weights[begin:end]
    unit_t, unit_r, unit_a = unit[0, begin:end], unit[1, begin:end], unit[2, begin:end]
    f_u, f_l, f_z, turn = force.u[begin:end], force.l[begin:end], force.z[begin:end], force.turn[begin:end]
    all_u, all_l, all_z = sums[F_U, begin:end], sums[F_L, begin:end], sums[F_Z, begin:end]
    tilt_u, tilt_l, lift = sums[TILT_U, begin:end], sums[TILT_L, begin:end], sums[LIFT, begin:end]
    torque, contact = sums[TURN, begin:end], sums[SHARES, begin:end]
    most, widest = sums[MOST, begin:end], sums[WIDEST, begin:end]
    for k in range(share.shape[0]):
        b = share[k] * width
        tangential, inward = b * unit_t[k], b * unit_r[k]
        a_u = -tangential * cosines[k] - inward * sines[k]
        a_l = tangential * sines[k] - inward * cosines[k]
        a_z = b * unit_a[k]
        a_t = r * tangential
        f_u[k], f_l[k], f_z[k], turn[k] = a_u, a_l, a_z, a_t
        all_u[k] += a_u
        all_l[k] += a_l
        all_z[k] += a_z
        tilt_u[k] += z * a_u
        tilt_l[k] += z * a_l
        lift[k] += r * a_z
        torque[k] += a_t
        contact[k] += share[k]
        most[k] = max(most[k], share[k])
        widest[k] = max(widest[k], share[k] * r)


@kernel(lean=True)
def cutting_force(
    field: Field, teeth: Teeth, tip: Array, heading: Heading, chip: float, top: float, room: Room, result: Array
) -> int:
    """Mean force over a revolution with the tip at `tip` [m]; returns the number of rows filled in `room`.

    chip [m]: feed per tooth; top [m]: no material is higher near the tool; result (RESULT,).
    """
    result[:] = 0.0
    level, climb = heading.level, heading.climb
    height = min(teeth.height, top - tip[2])
    if height <= min(STEEPEST * coarsest(field) * climb, 0.0):
        return 0
    height = max(height, 1.0e-9)  # downwards the lowest rows sample material that is still below the tip
    last = ANGLES if climb < 0.0 else ANGLES // 2  # nothing behind the tool cuts unless it goes down
    law, pieces, rows = teeth.law, teeth.pieces, room.rows
    scale = Scale(scale_of(law, TANGENTIAL, chip), scale_of(law, NORMAL, chip), scale_of(law, AXIAL, chip))
    room.sums[:] = 0.0
    used = 0
    steepest = 0.0
    for piece in range(pieces.shape[0]):
        number = lay_rows(pieces, piece, height, coarsest(field), rows[used:])
        if number == 0:
            continue
        first, end = used, used + number - 1
        most_advance = max(
            level * rows[first, SIN_KAPPA] - climb * rows[first, COS_KAPPA],
            level * rows[end, SIN_KAPPA] - climb * rows[end, COS_KAPPA],
        )
        if most_advance <= LEAST_ADVANCE:
            continue  # there is no angle at which this piece advances: a flat bottom in a level cut
        straight = pieces[piece, ARC] == 0.0
        if straight and abs(rows[first, COS_KAPPA]) < UPRIGHT:
            touched = contact_of_cylinder(field, teeth.circle, tip, heading, room, first, number)
        else:
            touched = contact_of_rows(field, teeth.circle, tip, heading, room, first, number, last)
        if not touched:
            continue
        used += number
        add_rows(teeth, heading, scale, room, first, number, straight)
        steepest = max(steepest, rows[used - 1, SIN_KAPPA])
    if used == 0:
        return 0
    sum_up(teeth, heading, chip, steepest, last, room, used, result)
    return used if result[CONTACT] > 0.0 else 0


@kernel(lean=True, inlined=True)
def add_rows(teeth: Teeth, heading: Heading, scale: Scale, room: Room, first: int, number: int, straight: bool) -> None:
    """Forces of the rows first..first + number, which are those of one piece."""
    rows = room.rows
    if straight:  # rows of one slope share the force per width
        begin, end = ANGLES, 0
        for i in range(first, first + number):
            begin, end = min(begin, int(rows[i, FROM])), max(end, int(rows[i, TO]))
        unit_forces(teeth, heading, scale, rows[first, SIN_KAPPA], rows[first, COS_KAPPA], begin, end, room.unit)
    for i in range(first, first + number):
        begin, end = int(rows[i, FROM]), int(rows[i, TO])
        if begin >= end:
            continue
        if not straight:
            unit_forces(teeth, heading, scale, rows[i, SIN_KAPPA], rows[i, COS_KAPPA], begin, end, room.unit)
        on_tooth = ToothForce(room.force[0, i], room.force[1, i], room.force[2, i], room.force[3, i])
        add_row(rows[i], teeth.circle, room.unit, room.weights[i], on_tooth, room.sums)


@kernel(lean=True, inlined=True)
def sum_up(
    teeth: Teeth, heading: Heading, chip: float, steepest: float, last: int, room: Room, used: int, result: Array
) -> None:
    """From the sums at each angle to the `result`; its CONTACT is 0 where there is none."""
    ux, uy, level, climb = heading
    sines, cosines = teeth.circle
    sums, rows = room.sums, room.rows
    f_u, f_l, f_z, m_u, m_l, torque = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    delta = 2.0 * np.pi / ANGLES
    entry, leave, fullest = 2.0 * np.pi, 0.0, 0
    for k in range(last):
        f_u += sums[F_U, k]
        f_l += sums[F_L, k]
        f_z += sums[F_Z, k]
        m_u += cosines[k] * sums[LIFT, k] - sums[TILT_L, k]
        m_l += sums[TILT_U, k] - sines[k] * sums[LIFT, k]
        torque += sums[TURN, k]
        result[CONTACT] += sums[SHARES, k]
        if sums[SHARES, k] > sums[SHARES, fullest]:
            fullest = k
        if sines[k] > 0.0:
            result[WIDTH] += sums[WIDEST, k] * sines[k] * delta
        w = sums[MOST, k]
        if w > LEAST_SHARE:
            entry, leave = min(entry, (k + 1.0 - w) * delta), max(leave, (k + w) * delta)
            result[CHIP] = max(result[CHIP], chip * (level * sines[k] * steepest))
    if climb < 0.0:  # the bottom takes the chip of the fall
        result[CHIP] = max(result[CHIP], -chip * climb * rows[0, COS_KAPPA])
    if result[CONTACT] <= 0.0:
        return
    for i in range(used):
        result[DEPTH] += room.weights[i, fullest] * (rows[i, HIGH] - rows[i, LOW])
    share = teeth.number / ANGLES
    result[FORCE] = share * (ux * f_u - uy * f_l)
    result[FORCE + 1] = share * (uy * f_u + ux * f_l)
    result[FORCE + 2] = share * f_z
    result[MOMENT] = share * (ux * m_u - uy * m_l)
    result[MOMENT + 1] = share * (uy * m_u + ux * m_l)
    result[MOMENT + 2] = share * torque
    result[TORQUE] = share * torque
    if leave > entry:
        result[ENTRY], result[EXIT] = entry, leave


@kernel(lean=True)
def peaks_of(teeth: Teeth, room: Room, used: int) -> tuple[float, float]:
    """Greatest force [N] and torque [N·m] within a revolution: all teeth and heights at once, each late by its lag.

    Rows lag by z tan(helix) / radius; forces between the angles are interpolated.
    """
    rows, force, turning = room.rows, room.force, room.turning
    delta = 2.0 * np.pi / ANGLES
    number = int(teeth.number)
    turning[:] = 0.0
    for i in range(used):
        begin, end = int(rows[i, FROM]), int(rows[i, TO])
        if begin >= end:
            continue
        place = (rows[i, HEIGHT] * teeth.lag / teeth.radius / delta) % ANGLES
        whole = int(place)
        part = place - whole
        rest = 1.0 - part
        for axis in range(4):
            source, target = force[axis, i][begin:end], turning[axis][whole + begin : whole + end + 1]
            last = source.shape[0]
            target[0] += rest * source[0]
            for k in range(1, last):
                target[k] = target[k] + rest * source[k] + part * source[k - 1]
            target[last] += part * source[last - 1]
    for axis in range(4):  # both halves in one, then the first angles again, for values that turn past the end
        one, all_teeth = turning[axis, : 2 * ANGLES + 1], turning[axis, 2 * ANGLES + 1 : 3 * ANGLES + 1]
        for k in range(ANGLES):
            one[k] += one[ANGLES + k]
            one[ANGLES + k] = one[k]
        one[2 * ANGLES] = one[0]
        for tooth in range(number):
            place = tooth * ANGLES / number
            whole = int(place)
            part = place - whole
            here, following = one[whole : whole + ANGLES], one[whole + 1 : whole + 1 + ANGLES]
            for k in range(ANGLES):
                all_teeth[k] += (1.0 - part) * here[k] + part * following[k]
    first = 2 * ANGLES + 1
    f_u, f_l, f_z, turn = turning[0][first:], turning[1][first:], turning[2][first:], turning[3][first:]
    for k in range(ANGLES):  # apart from the search, whose steps depend on each other
        f_u[k] = f_u[k] * f_u[k] + f_l[k] * f_l[k] + f_z[k] * f_z[k]
    greatest, torque = 0.0, 0.0
    for k in range(ANGLES):
        greatest = f_u[k] if f_u[k] > greatest else greatest
        torque = turn[k] if turn[k] > torque else torque
    return float(np.sqrt(greatest)), float(torque)
