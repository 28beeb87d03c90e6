"""Ways of tools whose axis has any direction: one piece, arcs as chords, and several one after the other."""

from __future__ import annotations

from math import ceil
from typing import Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.elementary import acos, cos_sin
from gcodesim.arithmetic.matrices import dot, norm
from gcodesim.frames import Array
from gcodesim.material.axis_way import AxisWay

SAGITTA: Final = 0.002
"""Share of a cell between an arc and its chords."""


def straight(start: Array, end: Array, axis_start: Array, axis_end: Array) -> AxisWay:
    """One piece; all (3,)."""
    return AxisWay(*(np.array([part], dtype=float) for part in (start, end, axis_start, axis_end)))


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
