"""Sine, cosine and tangent [rad], to 0.53 units in the last place, at any angle.

The angle is reduced to -pi/4 … pi/4, as a pair, by Cody and Waite's method (1980) up to 2**19, above by as many bits of
2/pi as matter (Payne and Hanek 1983). Near zero follows Taylor's series, elsewhere the formula for the sum of two
angles, one of them in a table (Gal and Bachelis 1991).
"""

from __future__ import annotations

import math
from typing import Final

from gcodesim.arithmetic.pair_kernels import ROUNDING, fast_two_sum, two_product, two_sum
from gcodesim.arithmetic.table_kernels import HALF_PI, HALF_PI_PARTS, INVERSE_OF_HALF_PI, SINES
from gcodesim.compiled import kernel

_TWO_OVER_PI: Final = 2.0 / math.pi
_PART1, _PART2, _PART3 = HALF_PI_PARTS
_HALF_PI, _HALF_PI_LOW = HALF_PI
_LARGE: Final = 524288.0
_NEAR: Final = 0.126  # below, Taylor's series in a few terms is as good as the table
_PIECE: Final = 24
_MASK: Final = (1 << _PIECE) - 1


@kernel
def sin(x: float) -> float:
    """Sine of x [rad]."""
    if x == 0.0:  # keeps the sign of zero
        return x
    quadrant, r, low = _reduced(x)
    if quadrant & 1:
        value, rest = _cosine(r, low)
    else:
        value, rest = _sine(r, low)
    value = value + rest
    return -value if quadrant & 2 else value


@kernel
def cos(x: float) -> float:
    """Cosine of x [rad]."""
    quadrant, r, low = _reduced(x)
    if quadrant & 1:
        value, rest = _sine(r, low)
    else:
        value, rest = _cosine(r, low)
    value = value + rest
    return -value if (quadrant + 1) & 2 else value


@kernel
def cos_sin(x: float) -> tuple[float, float]:
    """Cosine and sine of x [rad]: the values of `cos` and `sin`."""
    quadrant, r, low = _reduced(x)
    s, s_rest = _sine(r, low)
    c, c_rest = _cosine(r, low)
    s, c = (x if x == 0.0 else s + s_rest), c + c_rest
    if quadrant & 1:
        s, c = c, s
    return (-c if (quadrant + 1) & 2 else c), (-s if quadrant & 2 else s)


@kernel
def tan(x: float) -> float:
    """Tangent of x [rad]."""
    if x == 0.0:
        return x
    quadrant, r, low = _reduced(x)
    s, s_rest = _sine(r, low)
    c, c_rest = _cosine(r, low)
    s, s_rest = fast_two_sum(s, s_rest)
    c, c_rest = fast_two_sum(c, c_rest)
    if quadrant & 1:
        s, s_rest, c, c_rest = -c, -c_rest, s, s_rest
    value = s / c
    product, rest = two_product(value, c)
    return value + (((s - product) - rest) + s_rest - value * c_rest) / c


@kernel
def _sine(r: float, low: float) -> tuple[float, float]:
    """Sine of r + low, |r| <= pi/4, as a value and a small correction to it."""
    size = abs(r)
    if not size >= _NEAR:  # also what is not a number
        t = r * r
        series = -1.0 / 6.0 + t * (1.0 / 120.0 + t * (-1.0 / 5040.0 + t * (1.0 / 362880.0 - t * (1.0 / 39916800.0))))
        return r, r * t * series + low
    k = int(size * 128.0 + 0.5)
    s, s_low, c = float(SINES[k, 0]), float(SINES[k, 1]), float(SINES[k, 2])
    d = size - k * 0.0078125
    low = low if r > 0.0 else -low
    t = d * d
    sine = d + (d * t * (-1.0 / 6.0 + t * (1.0 / 120.0 - t * (1.0 / 5040.0))) + low)
    less = t * (0.5 + t * (-1.0 / 24.0 + t * (1.0 / 720.0)))
    rest = c * sine + (s_low - s * less)
    return (s, rest) if r > 0.0 else (-s, -rest)


@kernel
def _cosine(r: float, low: float) -> tuple[float, float]:
    """Cosine of r + low, |r| <= pi/4, as a value and a small correction to it."""
    size = abs(r)
    low = low if r > 0.0 else -low
    if not size >= _NEAR:  # also what is not a number
        t = r * r
        series = 1.0 / 24.0 + t * (-1.0 / 720.0 + t * (1.0 / 40320.0 - t * (1.0 / 3628800.0)))
        return 1.0, t * t * series - 0.5 * t - size * low
    k = int(size * 128.0 + 0.5)
    s, c, c_low = float(SINES[k, 0]), float(SINES[k, 2]), float(SINES[k, 3])
    d = size - k * 0.0078125
    t = d * d
    sine = d + (d * t * (-1.0 / 6.0 + t * (1.0 / 120.0 - t * (1.0 / 5040.0))) + low)
    less = t * (0.5 + t * (-1.0 / 24.0 + t * (1.0 / 720.0)))
    return c, (c_low - c * less) - s * sine


@kernel
def _reduced(x: float) -> tuple[int, float, float]:
    """How many quarter turns x is, and the rest as a pair: x = k pi/2 + r + low."""
    x = float(x)
    if abs(x) < 0.785:
        return 0, x, 0.0
    if not abs(x) <= _LARGE:
        return _reduced_large(x)
    quarters = (x * _TWO_OVER_PI + ROUNDING) - ROUNDING
    first = x - quarters * _PART1
    # both differences may round: the first is exact only where it cancels
    second, error = two_sum(first, -quarters * _PART2)
    r, low = two_sum(second, -quarters * _PART3)
    return int(quarters), r, low + error


@kernel
def _reduced_large(x: float) -> tuple[int, float, float]:
    """The same for an angle beyond 2**19: a product of whole numbers, of which whole turns are left out."""
    if not abs(x) < math.inf:
        return 0, math.nan, math.nan
    fraction, exponent = math.frexp(abs(x))
    mantissa, exponent = int(fraction * 9007199254740992.0), exponent - 53
    first = max((exponent - 2) // _PIECE, 0)  # pieces of 2/pi before this one make whole turns
    shift = exponent - first * _PIECE
    point = 10 - shift // _PIECE  # the pieces of the product before the binary point, from the last
    shift = shift % _PIECE
    m0, m1, m2 = mantissa & _MASK, (mantissa >> _PIECE) & _MASK, mantissa >> (2 * _PIECE)
    carry, spill, quarters = 0, 0, 0
    r, low = 0.0, 0.0
    weight = math.ldexp(1.0, -_PIECE * point)
    for i in range(point + 1):
        total = carry
        if i < 10:
            total += m0 * int(INVERSE_OF_HALF_PI[first + 9 - i])
        if 1 <= i < 11:
            total += m1 * int(INVERSE_OF_HALF_PI[first + 10 - i])
        if 2 <= i < 12:
            total += m2 * int(INVERSE_OF_HALF_PI[first + 11 - i])
        carry = total >> _PIECE
        spill += (total & _MASK) << shift
        piece = spill & _MASK
        spill = spill >> _PIECE
        if i == point:
            quarters += piece
        else:
            if i == point - 1 and piece >= 1 << (_PIECE - 1):
                piece, quarters = piece - (1 << _PIECE), 1
            r, error = two_sum(piece * weight, r)
            low += error
            weight *= 16777216.0
    r, low = fast_two_sum(r, low)
    product, rest = two_product(r, _HALF_PI)
    r, low = fast_two_sum(product, rest + (r * _HALF_PI_LOW + low * _HALF_PI))
    return (quarters, r, low) if x > 0.0 else (-quarters, -r, -low)
