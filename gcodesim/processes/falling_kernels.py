"""Where the flat bottom of a tool ends contact at a wall, on a straight way along it on which the tool falls.

A level tool cuts in front only, and its limits at walls are seams of its rows (`limit_kernels`). A falling one cuts all
around. Columns show a wall up to half a cell beside its place, and rows are kept inside their own width, which is less
than what the tool sweeps at the height of a flat bottom: of a strip two cells wide a tenth of the force was missing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.material.kernels import ELSEWHERE
from gcodesim.processes.edge_kernels import ANGLES, Circle, Clearance
from gcodesim.processes.limit_kernels import PER_ANGLE, ContactLimit, EdgeBand

Array = NDArray[np.float64]

NARROW = 0.4  # of a radius from the axis on, strips beside a wall are narrow
ALONG = 0.5  # cells by which a wall may go aside on the length of a radius and still run along the way


@kernel(lean=True, inlined=True)
def is_beside_row(wall: ContactLimit, clearance: Clearance, band: EdgeBand, widest: float, at_left: bool) -> bool:
    """Whether a wall that runs along the way stands at the height of a row, within it or up to a cell beside it.

    `widest` [m]: the radius of the piece of the edge. Walls near its axis are left to the search for seams, which knows
    better what a single tooth feels where they cross angles flatly.
    """
    if 0.5 * (band.bottom + band.top) < wall.foot:
        return False
    if abs(wall.slope) * band.radius > ALONG * clearance.aside:
        return False
    aside = wall.aside if at_left else -wall.aside
    return bool(NARROW * widest < aside < band.radius + clearance.aside)


@kernel(lean=True)
def end_at_wall(
    circle: Circle, clearance: Clearance, limit: float, beyond: float, radius: float, at_left: bool, line: Array
) -> bool:
    """Let the share (ANGLES,) of a row of a falling tool change at a wall's limit [angles], in front and behind.

    `beyond`: the share outside of it. Inside, what is asked a cell from the wall counts up to the wall; false where
    that is not known, and nothing is done.
    """
    half, side = ANGLES // 2, 1.0 if at_left else -1.0
    border = side * radius * cos_sin(limit / PER_ANGLE)[0] - clearance.aside
    inner, found = 0, False
    for j in range(half):
        inner = j if at_left else half - 1 - j
        if side * radius * circle.cosines[inner] <= border:
            found = True
            break
    if not found or line[inner] == ELSEWHERE or line[ANGLES - 1 - inner] == ELSEWHERE:
        return False
    for behind in (False, True):
        share = line[ANGLES - 1 - inner if behind else inner]
        for j in range(half):
            k = j if at_left else half - 1 - j
            if k == inner:
                break
            before = min(max(limit - k, 0.0), 1.0)
            part = before if at_left else 1.0 - before
            line[ANGLES - 1 - k if behind else k] = part * beyond + (1.0 - part) * share
    return True


@kernel(lean=True)
def leave_wall(limit: float, steps: Array) -> int:
    """Take the marks (ANGLES,) of `mark_steps` at a limit [angles] away, which is known; how many there were."""
    number = 0
    m = int(limit)
    for k in range(max(m - 1, 0), min(m + 3, ANGLES // 2 + 1)):
        for at in (k, ANGLES - k):
            if at < ANGLES and steps[at] > 0.0:
                steps[at] = 0.0
                number += 1
    return number
