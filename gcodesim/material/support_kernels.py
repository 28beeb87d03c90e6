"""What lies below beads that were laid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Field
from gcodesim.material.strand_kernels import Nozzle, is_carried

Array = NDArray[np.float64]


@kernel
def support_of(field: Field, ways: Array, width: float, height: float, floor: float, carried: Array) -> None:
    """1 in `carried` (c,) for each piece of a bead below which there is something; it may have been laid already.

    ways (c, 6): start and end of the nozzle tip in S [m]. What is as high as the bead's own layer carries nothing, but
    for a thin bed, which begins at the `floor` [m]: the underside of the stock.
    """
    nozzle = Nozzle(width, height, 1.0e-9, floor)
    for p in range(len(ways)):
        carried[p] = 1.0 if is_carried(field, ways[p, :3], ways[p, 3:], nozzle, width) else 0.0
