"""Tables of a law of cutting: powers, and their means over the angles of a revolution.

The means are exact integrals, so that mean forces do not depend on how many angles there are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.power_kernels import power
from gcodesim.arithmetic.sin_kernels import cos, sin
from gcodesim.compiled import kernel

Array = NDArray[np.float64]

TABLE = 1025  # points of x**p on 0..1

# Rows of the means: three for each component of a law, sin(phi)**exponent alone, times sin(phi), and times cos(phi);
# then sin(phi) and cos(phi).
GROWN, GROWN_SINE, GROWN_COSINE = 0, 1, 2
SINE, COSINE = 9, 10
MEANS = 11

# Nodes and weights of Gauss-Legendre quadrature with five points (Abramowitz and Stegun 1964, table 25.4).
NODES = np.array([-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640])
WEIGHTS = np.array([0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665, 0.2369268850561891])
PARTS = 4  # of an angle, with nodes of their own

TANGENTIAL, NORMAL, AXIAL = 0, 1, 2  # components of a law

# Rows of `Room.unit`: forces, and where teeth differ the share of them that cuts.
UNIT_U, UNIT_L, UNIT_Z, UNIT_TURN, UNIT_SHARE = 0, 1, 2, 3, 4


class ForceLaw(NamedTuple):
    """Force per width of an edge, factor h**exponent + rub, each (3,).

    powers (3, TABLE) and means (MEANS, ANGLES): see `fill_tables`.
    """

    factor: Array
    exponent: Array
    rub: Array
    powers: Array
    means: Array


class Scale(NamedTuple):
    """factor c**exponent of each component, with c the feed per tooth: force per width [N/m] of a chip that thick."""

    tangential: float
    normal: float
    axial: float


@kernel(lean=True, inlined=True)
def scale_of(law: ForceLaw, component: int, chip: float) -> float:
    """One component of `Scale`."""
    return float(law.factor[component] * power(chip, law.exponent[component])) if chip > 0.0 else 0.0


@kernel
def fill_tables(exponent: Array, powers: Array, means: Array) -> None:
    """Fill powers (3, TABLE) with x**p on 0..1, because a power costs more than all the rest, and means (MEANS, n).

    The means are over each of n even angles of a revolution; behind the tool nothing grows.
    """
    for component in range(3):
        for i in range(powers.shape[1]):
            powers[component, i] = power(i / (powers.shape[1] - 1.0), exponent[component])
    means[:] = 0.0
    angles = means.shape[1]
    last = angles // 2 - 1
    for k in range(angles):
        for part in range(PARTS):
            for node in range(NODES.shape[0]):
                place, weight = (part + 0.5 * (1.0 + NODES[node])) / PARTS, 0.5 * WEIGHTS[node] / PARTS
                if k == 0 or k == last:  # the sine begins or ends like a power: place**4 makes that smooth
                    weight *= 4.0 * place * place * place
                    place *= place * place * place
                    place = place if k == 0 else 1.0 - place
                phi = (k + place) * (2.0 * np.pi / angles)
                sine, cosine = sin(phi), cos(phi)
                for component in range(3 if k <= last else 0):
                    grown = weight * power(sine, exponent[component])
                    means[3 * component + GROWN, k] += grown
                    means[3 * component + GROWN_SINE, k] += grown * sine
                    means[3 * component + GROWN_COSINE, k] += grown * cosine
                means[SINE, k] += weight * sine
                means[COSINE, k] += weight * cosine


@kernel(lean=True)
def power_at(table: Array, component: int, left: int, part: float) -> float:
    """Value between point `left` of `table` and the next, `part` of the way."""
    value: float = (1.0 - part) * table[component, left] + part * table[component, left + 1]
    return value
