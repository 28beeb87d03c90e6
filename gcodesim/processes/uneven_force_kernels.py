"""Force on an edge whose teeth are not all alike: what `level_forces` and `steep_forces` are for those that are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.processes.edge_kernels import (
    ANGLES,
    COS_KAPPA,
    FROM,
    HEIGHT,
    HIGH,
    LEAST_ADVANCE,
    LOW,
    SIN_KAPPA,
    TO,
    Circle,
    Heading,
    turned,
)
from gcodesim.processes.law_kernels import (
    AXIAL,
    NORMAL,
    TABLE,
    TANGENTIAL,
    UNIT_L,
    UNIT_SHARE,
    UNIT_TURN,
    UNIT_U,
    UNIT_Z,
    ForceLaw,
    Scale,
    power_at,
)
from gcodesim.processes.uneven_kernels import Uneven, advance_of_tooth, greatest_advance, sense_at, spread_tooth

Array = NDArray[np.float64]

NODE = 0.5773502691896258  # of Gauss-Legendre with two points


@kernel(lean=True, inlined=True)
def grown_of(law: ForceLaw, uneven: Uneven, component: int, advance: float) -> float:
    """advance**exponent of one component, for a chip of up to as many c as there are teeth."""
    if law.exponent[component] == 1.0:
        return advance
    place = min(advance / uneven.late.shape[0], 1.0) * (TABLE - 1)
    left = min(int(place), TABLE - 2)
    return float(uneven.grown[component] * power_at(law.powers, component, left, place - left))


@kernel(lean=True)
def uneven_forces(
    uneven: Uneven, law: ForceLaw, circle: Circle, heading: Heading, scale: Scale, chip: float, row: Array,
    begin: int, end: int, unit: Array,
) -> None:  # fmt: skip
    """Fill unit[:, begin:end] with force per width [N/m] along u, l, z and the cut, mean of all teeth; their share.

    `row` is that of the edge; chip [m] the feed of a mean pitch. Each angle by Gauss-Legendre quadrature.
    """
    sin_kappa, cos_kappa, teeth = row[SIN_KAPPA], row[COS_KAPPA], uneven.late.shape[0]
    sense, aside, rub = sense_at(uneven, row[HEIGHT]), sin_kappa / chip, law.rub
    for tooth in range(teeth):
        spread_tooth(uneven, tooth, row[HEIGHT])
    for k in range(begin, end):
        unit[UNIT_U, k], unit[UNIT_L, k], unit[UNIT_Z, k], unit[UNIT_TURN, k] = 0.0, 0.0, 0.0, 0.0
        unit[UNIT_SHARE, k] = 0.0
        for node in (-NODE, NODE):
            sine, cosine = turned(circle.sines[k], circle.cosines[k], node * np.pi / ANGLES)
            even = heading.level * sine * sin_kappa - heading.climb * cos_kappa
            if even <= LEAST_ADVANCE:
                continue
            tangential, normal, axial = 0.0, 0.0, 0.0
            for tooth in range(teeth):
                advance = advance_of_tooth(uneven, tooth, even, aside)
                if advance > LEAST_ADVANCE:
                    unit[UNIT_SHARE, k] += 0.5 / teeth
                    tangential += scale.tangential * grown_of(law, uneven, TANGENTIAL, advance) + rub[TANGENTIAL]
                    normal += scale.normal * grown_of(law, uneven, NORMAL, advance) + rub[NORMAL]
                    axial += scale.axial * grown_of(law, uneven, AXIAL, advance) + rub[AXIAL]
            share = 0.5 / teeth
            tangential, normal, axial = share * tangential, share * normal, share * sense * axial
            inward = normal * sin_kappa + axial * cos_kappa
            unit[UNIT_U, k] -= tangential * cosine + inward * sine
            unit[UNIT_L, k] += tangential * sine - inward * cosine
            unit[UNIT_Z, k] += normal * cos_kappa - axial * sin_kappa
            unit[UNIT_TURN, k] += tangential


@kernel(lean=True)
def rubbing_share(row: Array, unit: Array, weights: Array) -> float:
    """The share of teeth that cut, mean over the contact of a row."""
    whole, cutting = 0.0, 0.0
    for k in range(int(row[FROM]), int(row[TO])):
        whole += weights[k]
        cutting += weights[k] * unit[UNIT_SHARE, k]
    return cutting / whole if whole > 0.0 else 0.0


@kernel(lean=True)
def greatest_uneven_chip(uneven: Uneven, heading: Heading, chip: float, rows: Array, used: int, sine: float) -> float:
    """Greatest chip [m] of any tooth at the first `used` rows, at that angle of contact whose sine is the greatest."""
    most = 0.0
    for i in range(used):
        sin_kappa = rows[i, SIN_KAPPA]
        even = heading.level * sine * sin_kappa - heading.climb * rows[i, COS_KAPPA]
        if even > LEAST_ADVANCE:
            aside = sin_kappa / chip
            most = max(most, greatest_advance(uneven, rows[i, LOW], even, aside))
            most = max(most, greatest_advance(uneven, rows[i, HIGH], even, aside))
    return chip * most
