"""Sum of the forces on many elements of edge at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.power_kernels import power
from gcodesim.compiled import kernel

Array = NDArray[np.float64]

# Columns of elements: radius and width [m], sine and cosine of kappa and of phi, chip thickness [m], and 1 or -1, by
# which the force along the edge is multiplied.
RADIUS, WIDTH, SIN_KAPPA, COS_KAPPA, SIN_PHI, COS_PHI, CHIP, SENSE = 0, 1, 2, 3, 4, 5, 6, 7
COLUMNS = 8
SUMS = 4  # force in K [N] and torque [N·m]


@kernel
def add_elements(elements: Array, law: Array, sums: Array) -> None:
    """Add the force in K and the torque of `elements` (n, COLUMNS) to `sums` (SUMS,).

    law (3, 3): rows tangential, normal, axial; columns K, p, E of force per width = K h**p + E. An element whose chip
    thickness is negative is not in contact; one without thickness feels the edge force.
    """
    for i in range(elements.shape[0]):
        chip, b = elements[i, CHIP], elements[i, WIDTH]
        if chip < 0.0:
            continue
        ft = b * ((law[0, 0] * power(chip, law[0, 1]) if chip > 0.0 else 0.0) + law[0, 2])
        fr = b * ((law[1, 0] * power(chip, law[1, 1]) if chip > 0.0 else 0.0) + law[1, 2])
        fa = b * ((law[2, 0] * power(chip, law[2, 1]) if chip > 0.0 else 0.0) + law[2, 2])
        fa *= elements[i, SENSE]
        sin_kappa, cos_kappa = elements[i, SIN_KAPPA], elements[i, COS_KAPPA]
        inward = fr * sin_kappa + fa * cos_kappa
        sums[0] += -ft * elements[i, COS_PHI] - inward * elements[i, SIN_PHI]
        sums[1] += ft * elements[i, SIN_PHI] - inward * elements[i, COS_PHI]
        sums[2] += fr * cos_kappa - fa * sin_kappa
        sums[3] += ft * elements[i, RADIUS]
