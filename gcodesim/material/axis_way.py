"""The way of a tool whose axis has any direction: straight pieces, and arcs as chords of them."""

from __future__ import annotations

from math import ceil
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos, cos_sin
from gcodesim.arithmetic.matrices import dot, norm

Array = NDArray[np.float64]

SAGITTA: Final = 0.002
"""Share of a cell between an arc and its chords."""


class AxisWay(NamedTuple):
    """Pieces of a tip's way in S, each (c, 3): tips [m], and unit vectors from the tip to the holder at both ends.

    Between them the axis is that of the weighted mean of both vectors.
    """

    starts: Array
    ends: Array
    axes_start: Array
    axes_end: Array


def straight(start: Array, end: Array, axis_start: Array, axis_end: Array) -> AxisWay:
    """One piece; all (3,)."""
    return AxisWay(*(np.array([part], dtype=float) for part in (start, end, axis_start, axis_end)))


def upright(starts: Array, ends: Array) -> AxisWay:
    """Pieces (c, 3) of a tool along Z."""
    axes = np.zeros_like(starts)
    axes[:, 2] = 1.0
    return AxisWay(starts, ends, axes, axes)


class Helix(NamedTuple):
    """An arc about `centre` (3,) [m] and the unit vector `normal` by `angle` [rad], which rises by `rise` [m]."""

    centre: Array
    normal: Array
    angle: float
    rise: float


def turned_about(normal: Array, angles: Array, vector: Array) -> Array:
    """`vector` (3,) turned about the unit vector `normal` by each of `angles` (n,) [rad]; (n, 3) (Rodrigues)."""
    c, s = (part[:, None] for part in cos_sin(angles))
    turned: Array = c * vector + s * np.cross(normal, vector) + (1.0 - c) * dot(normal, vector) * normal
    return turned


def along_helix(start: Array, helix: Helix, axis: Array, axis_turns: bool, cell: float) -> AxisWay:
    """Chords of an arc from `start` (3,) [m], for stock with cells of the size `cell` [m].

    The axis keeps its direction, or turns with the arc.
    """
    arm = start - helix.centre
    across = arm - dot(arm, helix.normal) * helix.normal
    radius = norm(across)
    least = 2.0 * acos(max(-1.0, 1.0 - SAGITTA * cell / radius)) if radius > 0.0 else np.inf
    chords = max(1, ceil(abs(helix.angle) / min(least, 0.2)))
    share = np.arange(chords + 1) / chords
    points = helix.centre + turned_about(helix.normal, share * helix.angle, arm)
    points = points + share[:, None] * helix.rise * helix.normal
    axes = np.tile(axis, (chords + 1, 1)) if not axis_turns else turned_about(helix.normal, share * helix.angle, axis)
    return AxisWay(points[:-1], points[1:], axes[:-1], axes[1:])


def joined(ways: list[AxisWay]) -> AxisWay:
    """All pieces one after the other."""
    return AxisWay(*(np.concatenate(parts) for parts in zip(*ways, strict=True)))
