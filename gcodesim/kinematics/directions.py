"""Turns about given axes that bring one direction into another: Paden and Kahan 1986, subproblems 1 and 2.

The two axes of the second one need not be at right angles, as in nutating heads and tables.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import acos, atan2, cos, sin
from gcodesim.arithmetic.matrices import applied, dot, norm
from gcodesim.frames import Array, rotation_about

_FLAT: Final = 1e-9  # of unit vectors: smaller parts have no direction
_POLE: Final = 7e-7  # of unit vectors, whose words have six decimals: how far from an axis they are rounded onto it
_MISSED: Final = 1e-7  # of unit vectors: how far apart two heights along an axis may be


def two_turns(
    first: Array, second: Array, start: Array, end: Array, free: tuple[float, float]
) -> list[tuple[float, float]]:
    """Angles (a, b) [rad] with exp(first a) exp(second b) start = end, all unit vectors (3,); at most two pairs.

    An angle that is open, because the direction lies on its axis, is that of `free`.
    """
    found = []
    for inner in _angles_of_height(first, second, start, dot(end, first), free[1]):
        outer = angle_about(first, applied(rotation_about(second, inner), start), end, free[0])
        if outer is not None:
            found.append((outer, inner))
    return found


def angle_about(axis: Array, start: Array, end: Array, free: float) -> float | None:
    """The angle about `axis` that turns `start` to `end`; `free` where both lie on it, None where it cannot."""
    if abs(dot(axis, start) - dot(axis, end)) > _MISSED:
        return None
    a, b = start - dot(axis, start) * axis, end - dot(axis, end) * axis
    if min(norm(a), norm(b)) < _POLE:
        return free
    return atan2(dot(axis, np.cross(a, b)), dot(a, b))


def _angles_of_height(first: Array, second: Array, u: Array, height: float, free: float) -> list[float]:
    """Angles about `second` after which `u` has the component `height` along `first`; two, one at the end of reach."""
    across = u - dot(u, second) * second
    a, b = dot(first, across), dot(first, np.cross(second, u))
    size = math.hypot(a, b)
    rest = height - dot(u, second) * dot(first, second)
    if size < _FLAT:
        return [free] if abs(rest) < _MISSED else []
    share = rest / size
    if abs(share) > 1.0 + 1e-9:
        return []
    spread = acos(min(max(share, -1.0), 1.0))
    middle = atan2(b, a)
    angles = [middle + spread] if spread < 1e-8 else [middle + spread, middle - spread]
    return [atan2(sin(angle), cos(angle)) for angle in angles]
