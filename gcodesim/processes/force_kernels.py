"""Force on an upright cutter that stands in material, averaged over a revolution.

Frame K and the rows of the edge as in `engagement_kernels`. On an element of edge of width b with chip thickness
h = c (v . n): dF = -dFt t - dFr n - dFa e, with t along the cutting velocity, n the outward normal of the edge, e along
the edge away from the tip; each of Ft, Fr, Fa = b (K h**p + E) (see `laws`). b has no 1/cos(helix) (Altintas 2012,
sec. 2.8).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.kernels import Field, coarsest
from gcodesim.processes.cylinder_kernels import contact_of_cylinder
from gcodesim.processes.edge_kernels import (
    ANGLES,
    ARC,
    COS_KAPPA,
    EDGE_WIDTH,
    FROM,
    HEIGHT,
    HIGH,
    LEAST_ADVANCE,
    LEVER_COSINES,
    LEVER_SINES,
    LOW,
    MORE_COSINES,
    MORE_SINES,
    PUSHED,
    RADIUS,
    RUBS,
    SIN_KAPPA,
    STEEPEST,
    TO,
    UPRIGHT,
    Circle,
    Heading,
    lay_rows,
    turned,
)
from gcodesim.processes.engagement_kernels import NOWHERE, Room, contact_of_rows
from gcodesim.processes.law_kernels import (
    AXIAL,
    COSINE,
    GROWN,
    GROWN_COSINE,
    GROWN_SINE,
    NORMAL,
    SINE,
    TABLE,
    TANGENTIAL,
    UNIT_L,
    UNIT_TURN,
    UNIT_U,
    UNIT_Z,
    ForceLaw,
    Scale,
    power_at,
    scale_of,
)
from gcodesim.processes.rim_kernels import widest_below
from gcodesim.processes.seam_kernels import DROP, LEVER, LIMIT, ROW
from gcodesim.processes.uneven_force_kernels import greatest_uneven_chip, rubbing_share, uneven_forces
from gcodesim.processes.uneven_kernels import Uneven, are_uneven

Array = NDArray[np.float64]

LEAST_SHARE = 0.05  # of a row in material, from which on an angle counts as one of contact

# The result of `cutting_force`: wrench about the tip in S (6), torque, greatest chip thickness, axial depth, radial
# width, entry and exit angle, and the sum of engaged elements (0: no contact).
FORCE, MOMENT, TORQUE, CHIP, DEPTH, WIDTH, ENTRY, EXIT, CONTACT = 0, 3, 6, 7, 8, 9, 10, 11, 12
RESULT = 13

# Sums over rows at each angle, in `Room.sums`: forces along u, l, z; the first two times height, and the third times
# radius; torque; shares, the greatest share, and the greatest radial width.
F_U, F_L, F_Z, TILT_U, TILT_L, LIFT, TURN, SHARES, MOST, WIDEST = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
SUMS = 10


class Teeth(NamedTuple):
    """The edges of a cutter, all alike and evenly spread but for what `uneven` says."""

    radius: float  # [m]
    number: float
    lag: float  # tangent of the helix
    height: float  # [m] up to which they cut
    pieces: Array  # (k, 10) outline, see `Cutter.edge`; and the push of each piece [N/m]
    law: ForceLaw
    circle: Circle
    uneven: Uneven


@kernel(lean=True, inlined=True)
def slope_power(law: ForceLaw, component: int, slope: float) -> float:
    """slope**exponent of one component, for a slope in 0..1."""
    if slope == 1.0 or law.exponent[component] == 1.0:
        return slope
    place = slope * (TABLE - 1)
    left = min(int(place), TABLE - 2)
    return power_at(law.powers, component, left, place - left)


@kernel(lean=True)
def level_forces(
    law: ForceLaw, level: float, scale: Scale, sin_kappa: float, cos_kappa: float, begin: int, end: int, unit: Array
) -> None:
    """Fill unit[:, begin:end] with force per width [N/m] along u, l, z and the cut where nothing rises or falls.

    These are exact means over each angle: chips are level sin(kappa) sin(phi) thick there.
    """
    means, rub, exponent, slope = law.means[:, begin:end], law.rub, law.exponent, level * sin_kappa
    t = scale.tangential * slope_power(law, TANGENTIAL, slope)
    n = scale.normal * slope_power(law, NORMAL, slope)
    a = scale.axial * slope_power(law, AXIAL, slope)
    n_in, a_in, n_up, a_up = n * sin_kappa, a * cos_kappa, n * cos_kappa, a * sin_kappa
    rub_t, rub_in = rub[TANGENTIAL], rub[NORMAL] * sin_kappa + rub[AXIAL] * cos_kappa
    rub_up = rub[NORMAL] * cos_kappa - rub[AXIAL] * sin_kappa
    unit_u, unit_l = unit[UNIT_U, begin:end], unit[UNIT_L, begin:end]
    unit_z, unit_turn = unit[UNIT_Z, begin:end], unit[UNIT_TURN, begin:end]
    sines, cosines = means[SINE], means[COSINE]
    t_1, t_s, t_c = means[GROWN], means[GROWN_SINE], means[GROWN_COSINE]
    if exponent[TANGENTIAL] == exponent[NORMAL] and exponent[TANGENTIAL] == exponent[AXIAL]:
        inward, up = n_in + a_in, n_up - a_up
        for k in range(sines.shape[0]):
            unit_u[k] = -(t * t_c[k] + rub_t * cosines[k]) - (inward * t_s[k] + rub_in * sines[k])
            unit_l[k] = t * t_s[k] + rub_t * sines[k] - (inward * t_c[k] + rub_in * cosines[k])
            unit_z[k] = up * t_1[k] + rub_up
            unit_turn[k] = t * t_1[k] + rub_t
        return
    n_1, n_s, n_c = means[3 * NORMAL + GROWN], means[3 * NORMAL + GROWN_SINE], means[3 * NORMAL + GROWN_COSINE]
    a_1, a_s, a_c = means[3 * AXIAL + GROWN], means[3 * AXIAL + GROWN_SINE], means[3 * AXIAL + GROWN_COSINE]
    for k in range(sines.shape[0]):
        unit_u[k] = -(t * t_c[k] + rub_t * cosines[k]) - (n_in * n_s[k] + a_in * a_s[k] + rub_in * sines[k])
        unit_l[k] = t * t_s[k] + rub_t * sines[k] - (n_in * n_c[k] + a_in * a_c[k] + rub_in * cosines[k])
        unit_z[k] = n_up * n_1[k] - a_up * a_1[k] + rub_up
        unit_turn[k] = t * t_1[k] + rub_t


@kernel(lean=True)
def steep_forces(
    teeth: Teeth, heading: Heading, scale: Scale, sin_kappa: float, cos_kappa: float, begin: int, end: int, unit: Array
) -> None:
    """The same of a tool that rises or falls: chips are as thick as in the middle of each angle.

    Angles at which the edge does not advance get 0.
    """
    middles = teeth.circle.sines[begin:end]
    sines, cosines = teeth.law.means[SINE, begin:end], teeth.law.means[COSINE, begin:end]
    unit_u, unit_l = unit[UNIT_U, begin:end], unit[UNIT_L, begin:end]
    unit_z, unit_turn = unit[UNIT_Z, begin:end], unit[UNIT_TURN, begin:end]
    _, exponent, rub, powers, _ = teeth.law
    level, fall = heading.level, heading.climb * cos_kappa
    if exponent[TANGENTIAL] == 1.0 and exponent[NORMAL] == 1.0 and exponent[AXIAL] == 1.0:
        for k in range(sines.shape[0]):
            advance = level * middles[k] * sin_kappa - fall
            grown = min(advance, 1.0)
            normal, axial = scale.normal * grown + rub[NORMAL], scale.axial * grown + rub[AXIAL]
            cuts = 1.0 if advance > LEAST_ADVANCE else 0.0
            tangential = cuts * (scale.tangential * grown + rub[TANGENTIAL])
            inward = cuts * (normal * sin_kappa + axial * cos_kappa)
            unit_u[k] = -tangential * cosines[k] - inward * sines[k]
            unit_l[k] = tangential * sines[k] - inward * cosines[k]
            unit_z[k] = cuts * (normal * cos_kappa - axial * sin_kappa)
            unit_turn[k] = tangential
        return
    common = exponent[TANGENTIAL] == exponent[NORMAL] and exponent[TANGENTIAL] == exponent[AXIAL]
    for k in range(middles.shape[0]):
        advance = min(level * middles[k] * sin_kappa - fall, 1.0)
        if advance <= LEAST_ADVANCE:
            unit_u[k], unit_l[k], unit_z[k], unit_turn[k] = 0.0, 0.0, 0.0, 0.0
            continue
        place = advance * (TABLE - 1)
        left = min(int(place), TABLE - 2)
        part = place - left
        grown_t = power_at(powers, TANGENTIAL, left, part)
        grown_r, grown_a = grown_t, grown_t
        if not common:
            grown_r, grown_a = power_at(powers, NORMAL, left, part), power_at(powers, AXIAL, left, part)
        normal, axial = scale.normal * grown_r + rub[NORMAL], scale.axial * grown_a + rub[AXIAL]
        tangential, inward = scale.tangential * grown_t + rub[TANGENTIAL], normal * sin_kappa + axial * cos_kappa
        unit_u[k] = -tangential * cosines[k] - inward * sines[k]
        unit_l[k] = tangential * sines[k] - inward * cosines[k]
        unit_z[k] = normal * cos_kappa - axial * sin_kappa
        unit_turn[k] = tangential


@kernel(lean=True)
def add_row(row: Array, unit: Array, weights: Array, sums: Array) -> None:
    """Add the force of one row on one tooth to `sums`.

    Only angles FROM..TO of the row carry any. Sums over rows are kept separately for each angle, so this loop has no
    dependence between its iterations.
    """
    r, z, width, begin, end = row[RADIUS], row[HEIGHT], row[EDGE_WIDTH], int(row[FROM]), int(row[TO])
    # slices, because an index of which the compiler cannot see that it is not negative keeps it to one angle at a time
    share = weights[begin:end]
    unit_u, unit_l = unit[UNIT_U, begin:end], unit[UNIT_L, begin:end]
    unit_z, unit_turn = unit[UNIT_Z, begin:end], unit[UNIT_TURN, begin:end]
    all_u, all_l, all_z = sums[F_U, begin:end], sums[F_L, begin:end], sums[F_Z, begin:end]
    tilt_u, tilt_l, lift = sums[TILT_U, begin:end], sums[TILT_L, begin:end], sums[LIFT, begin:end]
    torque, contact = sums[TURN, begin:end], sums[SHARES, begin:end]
    most, widest = sums[MOST, begin:end], sums[WIDEST, begin:end]
    for k in range(share.shape[0]):
        b = share[k] * width
        a_u, a_l, a_z = b * unit_u[k], b * unit_l[k], b * unit_z[k]
        a_t = r * (b * unit_turn[k])
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
    steepest, widest = 0.0, widest_below(pieces, height)
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
            seams = contact_of_cylinder(field, teeth.circle, tip, heading, room, first, number)
            if seams == NOWHERE:
                continue
            if are_uneven(teeth.uneven) and chip > 0.0:
                add_uneven(teeth, heading, scale, chip, room, first, number, seams, True)
            else:
                add_cylinder(teeth.law, level, scale, room, first, number, seams)
        else:
            seams = contact_of_rows(field, pieces, teeth.circle, tip, heading, room, first, number, last, widest)
            if seams == NOWHERE:
                continue
            if are_uneven(teeth.uneven) and chip > 0.0:
                add_uneven(teeth, heading, scale, chip, room, first, number, seams, False)
            else:
                add_rows(teeth, heading, scale, room, first, number, straight, seams)
        used += number
        steepest = max(steepest, rows[used - 1, SIN_KAPPA])
    if used == 0:
        return 0
    sum_up(teeth, heading, chip, steepest, last, room, used, result)
    return used if result[CONTACT] > 0.0 else 0


@kernel(lean=True, inlined=True)
def missing_before(values: Array, m: int, part: float) -> float:
    """Integral [angles] over the first `part` of angle m, less that share of its whole.

    values (n,) are means over angles; the integrand is the parabola that has these over m and its neighbours.
    """
    last, here = values.shape[0] - 1, values[m]
    before = values[m - 1] if m > 0 else 2.0 * here - values[m + 1]
    behind = values[m + 1] if m < last else 2.0 * here - values[m - 1]
    half = part - 0.5
    curve = (half * half * half + 0.125 - 0.25 * part) / 6.0
    return float(curve * (behind - 2.0 * here + before) - 0.25 * part * (1.0 - part) * (behind - before))


@kernel(lean=True)
def mend_limit(law: ForceLaw, row: Array, unit: Array, limit: float, drop: float, lever: float, sums: Array) -> None:
    """Let contact end at `limit` [angles] itself in `sums`, which have a share of what a whole angle has.

    Before the limit stands `drop` more of the edge than behind it, `lever` times its height [m]; unit (4, n). What
    `edge_wrench` needs to say the same is kept in the row.
    """
    last = unit.shape[1]
    m = min(int(limit), last - 1)
    part, r, width = limit - m, row[RADIUS], row[EDGE_WIDTH]
    u = width * missing_before(unit[UNIT_U], m, part)
    l = width * missing_before(unit[UNIT_L], m, part)  # noqa: E741 - its name in frame K
    z = width * drop * missing_before(unit[UNIT_Z], m, part)
    sums[F_U, m] += drop * u
    sums[F_L, m] += drop * l
    sums[F_Z, m] += z
    sums[TILT_U, m] += lever * u
    sums[TILT_L, m] += lever * l
    sums[LIFT, m] += r * z
    sums[TURN, m] += r * width * drop * missing_before(unit[UNIT_TURN], m, part)
    sine = missing_before(law.means[SINE, :last], m, part)
    cosine = missing_before(law.means[COSINE, :last], m, part)
    row[MORE_SINES] += drop * sine
    row[MORE_COSINES] += drop * cosine
    row[LEVER_SINES] += lever * sine
    row[LEVER_COSINES] += lever * cosine


@kernel(lean=True, inlined=True)
def with_limit(begin: int, end: int, limit: float) -> tuple[int, int]:
    """The angles begin..end together with the one in which contact ends at `limit` [angles]."""
    m = int(limit)
    return min(begin, m), max(end, m + 1)


@kernel(lean=True, inlined=True)
def mend_width(law: ForceLaw, radius: float, limit: float, sums: Array) -> None:
    """The same for the radial width of a cylinder, of whose `radius` [m] this is the share that ends at the limit."""
    m = min(int(limit), ANGLES // 2 - 1)
    missing = radius * missing_before(law.means[SINE], m, limit - m)
    sums[WIDEST, m] += missing / law.means[SINE, m]  # which `sum_up` multiplies it with


@kernel(lean=True, inlined=True)
def add_cylinder(law: ForceLaw, level: float, scale: Scale, room: Room, first: int, number: int, seams: int) -> None:
    """Forces of the rows first..first + number, which are those of a cylinder and share seams."""
    rows, numbers, half = room.rows, room.seams.numbers, ANGLES // 2
    begin, end = int(rows[first, FROM]), int(rows[first, TO])
    for seam in range(seams):
        begin, end = with_limit(begin, end, numbers[LIMIT, seam])
    begin, end = max(begin - 1, 0), min(end + 1, half)
    level_forces(law, level, scale, rows[first, SIN_KAPPA], 0.0, begin, end, room.unit)
    for i in range(first, first + number):
        add_row(rows[i], room.unit, room.weights[i], room.sums)
    for seam in range(seams):
        limit, drop, lever = numbers[LIMIT, seam], numbers[DROP, seam], numbers[LEVER, seam]
        mend_limit(law, rows[first], room.unit[:, :half], limit, drop, lever, room.sums)
        mend_width(law, rows[first, RADIUS] * drop / number, limit, room.sums)


@kernel(lean=True, inlined=True)
def row_forces(teeth: Teeth, heading: Heading, scale: Scale, row: Array, begin: int, end: int, unit: Array) -> int:
    """Force per width [N/m] of a row at the angles begin..end and beside them; returns how many angles may count."""
    sin_kappa, cos_kappa = row[SIN_KAPPA], row[COS_KAPPA]
    if abs(heading.climb * cos_kappa) <= LEAST_ADVANCE:
        last = ANGLES // 2
        level_forces(teeth.law, heading.level, scale, sin_kappa, cos_kappa, max(begin - 1, 0), min(end + 1, last), unit)
        return last
    last = ANGLES if heading.climb < 0.0 else ANGLES // 2
    steep_forces(teeth, heading, scale, sin_kappa, cos_kappa, max(begin - 1, 0), min(end + 1, last), unit)
    return last


@kernel(lean=True)
def press(push: float, unit: Array) -> None:
    """Add a push [N/m] along the axis at all angles at which the edge advances."""
    for k in range(unit.shape[1]):
        if unit[UNIT_TURN, k] > 0.0:
            unit[UNIT_Z, k] += push


@kernel(lean=True, inlined=True)
def add_rows(
    teeth: Teeth, heading: Heading, scale: Scale, room: Room, first: int, number: int, straight: bool, seams: int
) -> None:
    """Forces of the rows first..first + number, which are those of one piece."""
    rows, places, numbers = room.rows, room.seams.places, room.seams.numbers
    last = ANGLES
    if straight:  # rows of one slope share the force per width
        begin, end = ANGLES, 0
        for i in range(first, first + number):
            begin, end = min(begin, int(rows[i, FROM])), max(end, int(rows[i, TO]))
        for k in range(seams):
            begin, end = with_limit(begin, end, numbers[LIMIT, k])
        last = row_forces(teeth, heading, scale, rows[first], begin, end, room.unit)
        if rows[first, PUSHED] > 0.0:
            press(rows[first, PUSHED], room.unit[:, max(begin - 1, 0) : min(end + 1, last)])
    seam = 0
    for i in range(first, first + number):
        begin, end = int(rows[i, FROM]), int(rows[i, TO])
        if begin >= end:
            continue
        if not straight:
            for k in range(seam, seams):
                if places[ROW, k] != i:
                    break
                begin, end = with_limit(begin, end, numbers[LIMIT, k])
            last = row_forces(teeth, heading, scale, rows[i], begin, end, room.unit)
        add_row(rows[i], room.unit, room.weights[i], room.sums)
        while seam < seams and places[ROW, seam] == i:
            limit, drop, lever = numbers[LIMIT, seam], numbers[DROP, seam], numbers[LEVER, seam]
            mend_limit(teeth.law, rows[i], room.unit[:, :last], limit, drop, lever, room.sums)
            seam += 1


@kernel(lean=True)
def add_uneven(
    teeth: Teeth, heading: Heading, scale: Scale, chip: float, room: Room, first: int, number: int, seams: int,
    cylinder: bool,
) -> None:  # fmt: skip
    """The same where teeth differ: force per width is another one at each height.

    Rows of a cylinder share seams, which are mended by the force in the middle of its height.
    """
    rows, places, numbers, unit = room.rows, room.seams.places, room.seams.numbers, room.unit
    last, seam = ANGLES if heading.climb < 0.0 else ANGLES // 2, 0
    for j in range(number):
        i = first + (j + number // 2 + 1) % number  # the middle one last
        begin, end = int(rows[i, FROM]), int(rows[i, TO])
        seam = 0
        while not cylinder and seam < seams and places[ROW, seam] != i:
            seam += 1
        own = seam
        while own < seams and (cylinder or places[ROW, own] == i):
            begin, end = with_limit(begin, end, numbers[LIMIT, own])
            own += 1
        begin, end = max(begin - 1, 0), min(end + 1, last)
        uneven_forces(teeth.uneven, teeth.law, teeth.circle, heading, scale, chip, rows[i], begin, end, unit)
        if rows[i, PUSHED] > 0.0:
            press(rows[i, PUSHED], unit[:, begin:end])
        rows[i, RUBS] = rubbing_share(rows[i], unit, room.weights[i])
        add_row(rows[i], unit, room.weights[i], room.sums)
        for k in range(seam, own if not cylinder or j == number - 1 else seam):
            limit, drop, lever = numbers[LIMIT, k], numbers[DROP, k], numbers[LEVER, k]
            mend_limit(teeth.law, rows[first if cylinder else i], unit[:, :last], limit, drop, lever, room.sums)
            if cylinder:
                mend_width(teeth.law, rows[first, RADIUS] * drop / number, limit, room.sums)


@kernel(lean=True)
def greatest_sine(circle: Circle, most: Array, k: int) -> float:
    """Greatest sin(phi) over that part of angle k, most[k] of it, that is in contact."""
    half = np.pi / ANGLES
    sine, cosine = circle.sines[k], circle.cosines[k]
    least, last = turned(sine, cosine, -half)[0], turned(sine, cosine, half)[0]
    if most[k] >= 1.0:
        return max(least, last)
    earlier, later = most[max(k - 1, 0)], most[min(k + 1, most.shape[0] - 1)]
    limit = (2.0 * most[k] - 1.0) * half
    return max(last, turned(sine, cosine, -limit)[0]) if later > earlier else max(least, turned(sine, cosine, limit)[0])


@kernel(lean=True)
def foremost_sine(circle: Circle, most: Array) -> float:
    """The same over all angles of contact, 0 where nothing in front of the tool is in contact.

    It is looked for from the angle straight ahead to both sides, until no angle farther on can have a greater one.
    """
    greatest, middle, reach = 0.0, ANGLES // 4, np.pi / ANGLES + 1.0e-9
    for j in range(middle):
        if circle.sines[middle + j] + reach <= greatest:
            break
        for k in (middle - 1 - j, middle + j):
            if most[k] > LEAST_SHARE:
                greatest = max(greatest, greatest_sine(circle, most, k))
    return greatest


@kernel(lean=True, inlined=True)
def sum_up(
    teeth: Teeth, heading: Heading, chip: float, steepest: float, last: int, room: Room, used: int, result: Array
) -> None:
    """From the sums at each angle to the `result`; its CONTACT is 0 where there is none."""
    ux, uy, level, climb, _ = heading
    sines, cosines = teeth.law.means[SINE], teeth.law.means[COSINE]
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
    result[CHIP] = chip * (level * foremost_sine(teeth.circle, sums[MOST]) * steepest)
    if are_uneven(teeth.uneven) and chip > 0.0:
        foremost = foremost_sine(teeth.circle, sums[MOST])
        result[CHIP] = greatest_uneven_chip(teeth.uneven, heading, chip, rows, used, foremost)
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
