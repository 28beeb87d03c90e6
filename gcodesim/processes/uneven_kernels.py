"""Chips and forces of teeth that are not all alike: pitches, helices, compression edges, run-out.

A tooth takes what is left between its own way and those of the teeth that were there before it (Kline and DeVor 1983,
eq. 1 to 4): with c the feed of a mean pitch, `advance` the share of it by which an edge of that slope advances at phi,

    h = min over m = 1..n of  c advance (gap_m n / 2 pi) + (g - g_m) sin kappa

gap_m is the angle to the tooth m places ahead, at that height, and g, g_m are how far out both stand. Below zero the
tooth passes through air. Where all teeth are alike this is c advance, and nothing of this file is used.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.sin_kernels import cos
from gcodesim.compiled import kernel

Array = NDArray[np.float64]

TURN = 2.0 * np.pi


class Uneven(NamedTuple):
    """Teeth (t,) that differ; none where all are alike.

    Between two of the `heights` (k,) [m] a tooth is late by what changes evenly; `late` (t, k) [rad] is less where it
    stands ahead at the tip. `senses` (k - 1,): 1 where the force along the edge acts as at the tip, -1 where the
    helix goes the other way. The axis of the edges stands `offset` [m] beside that of the spindle, at `angle` [rad].
    `grown` (3,): t to the exponents of the law. `gaps` and `steps` (t, t) are room.
    """

    heights: Array
    late: Array
    senses: Array
    offset: float
    angle: float
    grown: Array
    gaps: Array
    steps: Array


@kernel(lean=True, inlined=True)
def are_uneven(uneven: Uneven) -> bool:
    """Whether there are teeth that differ."""
    return bool(uneven.late.shape[0] > 0)


@kernel(lean=True, inlined=True)
def stretch_at(uneven: Uneven, z: float) -> int:
    """Between which heights z [m] is: i for i..i + 1; what is below or above counts to the first or last."""
    i, last = 0, uneven.heights.shape[0] - 2
    while i < last and z >= uneven.heights[i + 1]:
        i += 1
    return i


@kernel(lean=True)
def late_at(uneven: Uneven, tooth: int, z: float) -> float:
    """By how much a tooth is late at z [m]: [rad]."""
    i = stretch_at(uneven, z)
    low, high = uneven.heights[i], uneven.heights[i + 1]
    return float(uneven.late[tooth, i] + (z - low) / (high - low) * (uneven.late[tooth, i + 1] - uneven.late[tooth, i]))


@kernel(lean=True, inlined=True)
def sense_at(uneven: Uneven, z: float) -> float:
    """1 or -1: see `Uneven.senses`."""
    return float(uneven.senses[stretch_at(uneven, z)])


@kernel(lean=True)
def spread_tooth(uneven: Uneven, tooth: int, z: float) -> None:
    """Fill row `tooth` of gaps [mean pitches] and steps [m]: those to the teeth 1..t places ahead of it at z [m]."""
    teeth = uneven.late.shape[0]
    late = late_at(uneven, tooth, z)
    out = uneven.offset * cos(uneven.angle + late) if uneven.offset > 0.0 else 0.0
    for m in range(1, teeth):
        late_ahead = late_at(uneven, (tooth + m) % teeth, z)
        gap = late - late_ahead
        gap -= TURN * np.floor(gap / TURN)
        uneven.gaps[tooth, m - 1] = gap * teeth / TURN
        uneven.steps[tooth, m - 1] = (
            out - uneven.offset * cos(uneven.angle + late_ahead) if uneven.offset > 0.0 else 0.0
        )
    uneven.gaps[tooth, teeth - 1], uneven.steps[tooth, teeth - 1] = float(teeth), 0.0


@kernel(lean=True, inlined=True)
def advance_of_tooth(uneven: Uneven, tooth: int, advance: float, aside: float) -> float:
    """The chip of a tooth over c, from what all would have: `advance`; `aside` [1/m] is sin(kappa) / c.

    `spread_tooth` has been called.
    """
    gaps, steps = uneven.gaps[tooth], uneven.steps[tooth]
    least = gaps[0] * advance + steps[0] * aside
    for m in range(1, gaps.shape[0]):
        least = min(least, gaps[m] * advance + steps[m] * aside)
    return float(least)


@kernel(lean=True)
def greatest_advance(uneven: Uneven, z: float, advance: float, aside: float) -> float:
    """The chip of that tooth which takes most at z [m], over c."""
    most = 0.0
    for tooth in range(uneven.late.shape[0]):
        spread_tooth(uneven, tooth, z)
        most = max(most, advance_of_tooth(uneven, tooth, advance, aside))
    return most
