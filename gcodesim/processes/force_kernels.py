"""Force on an upright cutter that stands in material, averaged over a revolution and at its worst angle.

Frame K and the rows of the edge as in `engagement_kernels`. On an element of edge of width b with chip thickness
h = c (v . n): dF = -dFt t - dFr n - dFa e, with t along the cutting velocity, n the outward normal of the edge, e along
the edge away from the tip; each of Ft, Fr, Fa = b (K h**p + E) (see `laws`). b has no 1/cos(helix) (Altintas 2012,
sec. 2.8).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.processes.engagement_kernels import (
    ANGLES,
    FROM,
    LEAST_ADVANCE,
    STEEPEST,
    TO,
    UPRIGHT,
    contact_of_cylinder,
    contact_of_rows,
    lay_rows,
)

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

TABLE = 1025  # points of x**p on 0..1

# columns of the result of `cutting_force`
FORCE, TORQUE, CHIP, DEPTH, WIDTH, ENTRY, EXIT, CONTACT = 0, 6, 7, 8, 9, 10, 11, 12
RESULT = 13

# rows of its scratch `sums` (SUMS + SPARE, ANGLES); below the sums stand unit forces (until then shares), places,
# components, slices, and one for the caller
SUMS = 10
SPARE = 9


@kernel(lean=True)
def power_table(laws: Array, table: Array) -> None:
    """Fill `table` (3, TABLE) with x**p on 0..1 for the exponents laws[:, 1]: a power costs more than all the rest."""
    for component in range(3):
        for i in range(table.shape[1]):
            table[component, i] = (i / (table.shape[1] - 1.0)) ** laws[component, 1]


@kernel(lean=True)
def power_at(table: Array, component: int, left: int, part: float) -> float:
    """Value between point `left` of `table` and the next, `part` of the way."""
    value: float = (1.0 - part) * table[component, left] + part * table[component, left + 1]
    return value


@kernel(lean=True)
def unit_forces(
    laws: Array, table: Array, scale: Array, circle: Array, level: float, climb: float, sin_kappa: float,
    cos_kappa: float, begin: int, end: int, unit: Array,
) -> None:  # fmt: skip
    """Fill unit[:, begin:end] with force per width [N/m] at each angle: tangential, inward (radial), along the axis.

    scale (3,): K c**p of each component; angles at which the edge does not advance get 0.
    """
    sines, unit_t, unit_r, unit_a = circle[0, begin:end], unit[0, begin:end], unit[1, begin:end], unit[2, begin:end]
    fall = climb * cos_kappa
    if laws[0, 1] == 1.0 and laws[1, 1] == 1.0 and laws[2, 1] == 1.0:
        for k in range(sines.shape[0]):
            advance = level * sines[k] * sin_kappa - fall
            grown = min(advance, 1.0)
            normal, axial = scale[1] * grown + laws[1, 2], scale[2] * grown + laws[2, 2]
            cuts = advance > LEAST_ADVANCE
            unit_t[k] = scale[0] * grown + laws[0, 2] if cuts else 0.0
            unit_r[k] = normal * sin_kappa + axial * cos_kappa if cuts else 0.0
            unit_a[k] = normal * cos_kappa - axial * sin_kappa if cuts else 0.0
        return
    common = laws[0, 1] == laws[1, 1] and laws[0, 1] == laws[2, 1]
    for k in range(sines.shape[0]):
        advance = min(level * sines[k] * sin_kappa - fall, 1.0)
        if advance <= LEAST_ADVANCE:
            unit_t[k], unit_r[k], unit_a[k] = 0.0, 0.0, 0.0
            continue
        place = advance * (TABLE - 1)
        left = min(int(place), TABLE - 2)
        part = place - left
        grown_t = power_at(table, 0, left, part)
        grown_r, grown_a = grown_t, grown_t
        if not common:
            grown_r, grown_a = power_at(table, 1, left, part), power_at(table, 2, left, part)
        normal, axial = scale[1] * grown_r + laws[1, 2], scale[2] * grown_a + laws[2, 2]
        unit_t[k] = scale[0] * grown_t + laws[0, 2]
        unit_r[k] = normal * sin_kappa + axial * cos_kappa
        unit_a[k] = normal * cos_kappa - axial * sin_kappa


@kernel(lean=True)
def add_row(
    circle: Array, unit: Array, weights: Array, r: float, z: float, width: float, begin: int, end: int,
    force_u: Array, force_l: Array, force_z: Array, sums: Array,
) -> None:  # fmt: skip
    """Force of one row (ANGLES,) on one tooth along u, l, z [N], and its part in `sums` (SUMS, ANGLES).

    Only angles begin..end, the others carry none and are not written.

    Sums over rows stay apart by angle: so this loop has no dependence between its turns.
    """
    # slices, because an index of which the compiler cannot see that it is not negative keeps it to one angle at a time
    sines, cosines, share = circle[0, begin:end], circle[1, begin:end], weights[begin:end]
    unit_t, unit_r, unit_a = unit[0, begin:end], unit[1, begin:end], unit[2, begin:end]
    f_u, f_l, f_z = force_u[begin:end], force_l[begin:end], force_z[begin:end]
    all_u, all_l, all_z = sums[0, begin:end], sums[1, begin:end], sums[2, begin:end]
    tilt_u, tilt_l, lift = sums[3, begin:end], sums[4, begin:end], sums[5, begin:end]
    torque, contact, most, widest = sums[6, begin:end], sums[7, begin:end], sums[8, begin:end], sums[9, begin:end]
    for k in range(share.shape[0]):
        b = share[k] * width
        tangential, inward = b * unit_t[k], b * unit_r[k]
        a_u = -tangential * cosines[k] - inward * sines[k]
        a_l = tangential * sines[k] - inward * cosines[k]
        a_z = b * unit_a[k]
        f_u[k], f_l[k], f_z[k] = a_u, a_l, a_z
        all_u[k] += a_u
        all_l[k] += a_l
        all_z[k] += a_z
        tilt_u[k] += z * a_u
        tilt_l[k] += z * a_l
        lift[k] += r * a_z
        torque[k] += r * tangential
        contact[k] += share[k]
        most[k] = max(most[k], share[k])
        widest[k] = max(widest[k], share[k] * r)


@kernel(lean=True)
def cutting_force(
    lo: Array, hi: Array, count: Ints, grid: Array, tool: Array, edge: Array, laws: Array, table: Array,
    circle: Array, tip: Array, ux: float, uy: float, level: float, climb: float, chip: float, top: float,
    rows: Array, weights: Array, force: Array, sums: Array, result: Array,
) -> int:  # fmt: skip
    """Mean force over a revolution with the tip at `tip` [m]; returns the number of rows filled in `rows`, `force`.

    tool (4,): radius, flutes, tan(helix), height of the edge; circle (2, ANGLES): sine, cosine of phi;
    ux, uy: horizontal direction of the feed; level, climb: its horizontal and vertical share (unit vector);
    chip [m]: feed per tooth; top [m]: no material is higher near the tool.
    rows (ROWS, COLUMNS), sums (SUMS + SPARE, ANGLES): scratch;
    force (3, ROWS, ANGLES) [N]: on one tooth per row and angle, along u, l, z, within the range of each row.
    result (RESULT,): wrench about the tip in S (6), torque, greatest chip thickness, axial depth, radial width,
    entry and exit angle, and the sum of engaged elements (0: no contact).
    """
    result[:] = 0.0
    height = min(tool[3], top - tip[2])
    if height <= min(STEEPEST * max(grid[2], grid[3]) * climb, 0.0):
        return 0
    height = max(height, 1.0e-9)  # downwards the lowest rows ask for what is still below the tip
    last = ANGLES if climb < 0.0 else ANGLES // 2  # nothing behind the tool cuts unless it goes down
    scale, line = sums[SUMS + 6], sums[SUMS + 7]
    for component in range(3):
        scale[component] = laws[component, 0] * chip ** laws[component, 1] if chip > 0.0 else 0.0
    unit = sums[SUMS : SUMS + 3]
    sums[:SUMS] = 0.0
    used = 0
    steepest = 0.0
    for piece in range(edge.shape[0]):
        number = lay_rows(edge, height, max(grid[2], grid[3]), rows[used:], piece)
        if number == 0:
            continue
        first, end = used, used + number - 1
        touched = False
        if max(level * rows[first, 2] - climb * rows[first, 3], level * rows[end, 2] - climb * rows[end, 3]) <= (
            LEAST_ADVANCE
        ):
            continue  # no angle at which this piece advances: a flat bottom in a level cut
        if edge[piece, 0] == 0.0 and rows[first, 3] < UPRIGHT:
            touched = contact_of_cylinder(
                lo, hi, count, grid, circle, tip, ux, uy, level, climb, rows, first, number, weights, line,
                sums[SUMS + 2 : SUMS + 6],
            )  # fmt: skip
        else:
            touched = contact_of_rows(
                lo, hi, count, grid, circle, tip, ux, uy, level, climb, rows, first, number, last, weights,
                sums[SUMS + 3 : SUMS + 6],
            )  # fmt: skip
        if not touched:
            continue
        used += number
        straight = edge[piece, 0] == 0.0
        if straight:  # rows of one slope share the force per width
            begin, end = last, 0
            for i in range(first, used):
                begin, end = min(begin, int(rows[i, FROM])), max(end, int(rows[i, TO]))
            unit_forces(laws, table, scale, circle, level, climb, rows[first, 2], rows[first, 3], begin, end, unit)
        for i in range(first, used):
            begin, end = int(rows[i, FROM]), int(rows[i, TO])
            if begin >= end:
                continue
            if not straight:
                unit_forces(laws, table, scale, circle, level, climb, rows[i, 2], rows[i, 3], begin, end, unit)
            add_row(
                circle, unit, weights[i], rows[i, 0], rows[i, 1], rows[i, 4], begin, end, force[0, i], force[1, i],
                force[2, i], sums,
            )  # fmt: skip
        steepest = max(steepest, rows[used - 1, 2])
    if used == 0:
        return 0
    f_u, f_l, f_z, m_u, m_l, torque = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    delta = 2.0 * np.pi / ANGLES
    entry, leave, fullest = 2.0 * np.pi, 0.0, 0
    for k in range(last):
        f_u += sums[0, k]
        f_l += sums[1, k]
        f_z += sums[2, k]
        m_u += circle[1, k] * sums[5, k] - sums[4, k]
        m_l += sums[3, k] - circle[0, k] * sums[5, k]
        torque += sums[6, k]
        result[CONTACT] += sums[7, k]
        if sums[7, k] > sums[7, fullest]:
            fullest = k
        if circle[0, k] > 0.0:
            result[WIDTH] += sums[9, k] * circle[0, k] * delta
        w = sums[8, k]
        if w > 0.05:
            entry, leave = min(entry, (k + 1.0 - w) * delta), max(leave, (k + w) * delta)
            result[CHIP] = max(result[CHIP], chip * (level * circle[0, k] * steepest))
    if climb < 0.0:  # the bottom takes the chip of the fall
        result[CHIP] = max(result[CHIP], -chip * climb * rows[0, 3])
    if result[CONTACT] <= 0.0:
        return 0
    for i in range(used):
        result[DEPTH] += weights[i, fullest] * (rows[i, 6] - rows[i, 5])
    share = tool[1] / ANGLES
    result[0] = share * (ux * f_u - uy * f_l)
    result[1] = share * (uy * f_u + ux * f_l)
    result[2] = share * f_z
    result[3] = share * (ux * m_u - uy * m_l)
    result[4] = share * (uy * m_u + ux * m_l)
    result[5] = share * torque
    result[TORQUE] = share * torque
    if leave > entry:
        result[ENTRY], result[EXIT] = entry, leave
    return used


@kernel(lean=True)
def peak_force(tool: Array, rows: Array, force: Array, used: int, turning: Array) -> float:
    """Greatest force [N] within a revolution: all teeth and heights at once, each height late by its helix lag.

    Rows lag by z tan(helix) / radius; forces between the angles are interpolated.
    turning (3, 3 ANGLES + 1): scratch; one tooth's force over its angle at the tip, twice, then that of all teeth.
    """
    delta = 2.0 * np.pi / ANGLES
    teeth = int(tool[1])
    turning[:] = 0.0
    for i in range(used):
        begin, end = int(rows[i, FROM]), int(rows[i, TO])
        if begin >= end:
            continue
        place = (rows[i, 1] * tool[2] / tool[0] / delta) % ANGLES
        whole = int(place)
        part = place - whole
        for axis in range(3):
            source = force[axis, i]
            target = turning[axis, whole:]
            target[begin] += (1.0 - part) * source[begin]
            inner, here, earlier = target[begin + 1 : end], source[begin + 1 : end], source[begin : end - 1]
            for k in range(inner.shape[0]):
                inner[k] = inner[k] + (1.0 - part) * here[k] + part * earlier[k]
            target[end] += part * source[end - 1]
    for axis in range(3):  # both halves in one, and the first angles again behind them for what turns past the end
        one, all_teeth = turning[axis, : 2 * ANGLES + 1], turning[axis, 2 * ANGLES + 1 : 3 * ANGLES + 1]
        for k in range(ANGLES):
            one[k] += one[ANGLES + k]
            one[ANGLES + k] = one[k]
        one[2 * ANGLES] = one[0]
        for tooth in range(teeth):
            place = tooth * ANGLES / teeth
            whole = int(place)
            part = place - whole
            here, following = one[whole : whole + ANGLES], one[whole + 1 : whole + 1 + ANGLES]
            for k in range(ANGLES):
                all_teeth[k] += (1.0 - part) * here[k] + part * following[k]
    greatest = 0.0
    for k in range(ANGLES):
        square = 0.0
        for axis in range(3):
            square += turning[axis, 2 * ANGLES + 1 + k] ** 2
        greatest = max(greatest, square)
    return float(np.sqrt(greatest))
