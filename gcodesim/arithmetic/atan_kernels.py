"""Arcus functions [rad], to 0.53 units in the last place: angles of points, by a table and a series for the rest."""

from __future__ import annotations

import math
from typing import Final

from gcodesim.arithmetic.pair_kernels import fast_two_sum, halves, two_product, two_sum
from gcodesim.arithmetic.table_kernels import ARCTANGENTS, HALF_PI, PI, QUARTER_PI
from gcodesim.compiled import kernel

_PI, _PI_LOW = PI
_HALF_PI, _HALF_PI_LOW = HALF_PI
_QUARTER_PI, _ = QUARTER_PI
_NEAR: Final = 0.126
_NOTHING: Final = 2.0**-60
_UP: Final = 2.0**600
_HUGE, _TINY = 2.0**500, 2.0**-500


@kernel
def atan2(y: float, x: float) -> float:
    """Angle of the point (x, y), from -pi to pi; zeros and infinities as in C."""
    return _angle(y, 0.0, x, 0.0)


@kernel
def atan(x: float) -> float:
    """The angle from -pi/2 to pi/2 with the tangent x."""
    return _angle(x, 0.0, 1.0, 0.0)


@kernel
def asin(x: float) -> float:
    """The angle from -pi/2 to pi/2 with the sine x; not a number beyond 1."""
    x = float(x)
    if not abs(x) <= 1.0:
        return math.nan
    if abs(x) < 1e-9:
        return x
    other, low = _other_side(x)
    return _angle(x, 0.0, other, low)


@kernel
def acos(x: float) -> float:
    """The angle from 0 to pi with the cosine x; not a number beyond 1."""
    x = float(x)
    if not abs(x) <= 1.0:
        return math.nan
    other, low = _other_side(x)
    return _angle(other, low, x, 0.0)


@kernel
def _other_side(x: float) -> tuple[float, float]:
    """The root of 1 - x², as a pair."""
    square, square_low = two_product(x, x)
    rest, error = two_sum(1.0, -square)
    rest, rest_low = fast_two_sum(rest, error - square_low)
    if rest <= 0.0:
        return 0.0, 0.0
    root = math.sqrt(rest)
    again, again_low = two_product(root, root)
    return root, (((rest - again) - again_low) + rest_low) / (2.0 * root)


@kernel
def _angle(y: float, y_low: float, x: float, x_low: float) -> float:
    """Angle of the point (x + x_low, y + y_low)."""
    x, y = float(x), float(y)
    if x != x or y != y:
        return math.nan
    a, b = abs(x), abs(y)
    a_low, b_low = (x_low if x > 0.0 else -x_low), (y_low if y > 0.0 else -y_low)
    steep = b > a
    if steep:
        a, b, a_low, b_low = b, a, b_low, a_low
    if b == math.inf:
        angle, low = _QUARTER_PI, 0.0
    elif a == 0.0 or a == math.inf:
        angle, low = 0.0, 0.0
    else:
        angle, low = _of_slope(b, b_low, a, a_low)
    if steep:
        angle, rest = fast_two_sum(_HALF_PI, -angle)
        low = rest + (_HALF_PI_LOW - low)
    if math.copysign(1.0, x) < 0.0:
        angle, rest = fast_two_sum(_PI, -angle)
        low = rest + (_PI_LOW - low)
    return math.copysign(angle + low, y)


@kernel
def _of_slope(b: float, b_low: float, a: float, a_low: float) -> tuple[float, float]:
    """Arcus tangent of b / a, 0 <= b <= a, as a pair."""
    slope = b / a
    if slope < _NOTHING:
        return slope, 0.0
    if a > _HUGE:
        a, b, a_low, b_low = a / _UP, b / _UP, a_low / _UP, b_low / _UP
    elif a < _TINY:
        a, b, a_low, b_low = a * _UP, b * _UP, a_low * _UP, b_low * _UP
    if slope < _NEAR:
        product, rest = two_product(slope, a)
        low = ((((b - product) - rest) + b_low) - slope * a_low) / a
        t = slope * slope
        return slope, low - slope * t * _series(t)
    k = int(slope * 128.0 + 0.5)
    c = k * 0.0078125
    a1, a2 = halves(a)
    across = (((b - c * a1) - c * a2) + b_low) - c * a_low
    slope = across / (a + c * b)
    t = slope * slope
    angle, low = float(ARCTANGENTS[k, 0]), float(ARCTANGENTS[k, 1])
    return fast_two_sum(angle, low + (slope - slope * t * (1.0 / 3.0 - t * (1.0 / 5.0 - t * (1.0 / 7.0)))))


@kernel
def _series(t: float) -> float:
    """(x - arctan x) / x³ for t = x² below 0.016."""
    end = 1.0 / 13.0 - t * (1.0 / 15.0 - t * (1.0 / 17.0 - t * (1.0 / 19.0 - t * (1.0 / 21.0))))
    return 1.0 / 3.0 - t * (1.0 / 5.0 - t * (1.0 / 7.0 - t * (1.0 / 9.0 - t * (1.0 / 11.0 - t * end))))
