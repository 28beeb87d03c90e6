"""Powers and logarithms, to 0.53 units in the last place, by tables and short series (Tang 1989, 1990)."""

from __future__ import annotations

import math
from typing import Final

from gcodesim.arithmetic.pair_kernels import ROUNDING, fast_two_sum, halves, two_product, two_sum
from gcodesim.arithmetic.table_kernels import INVERSE_LN10, LN2_64TH_PARTS, LN2_PARTS, LOGARITHMS, POWERS_OF_TWO
from gcodesim.compiled import kernel

_LN2_1, _LN2_2, _LN2_3 = LN2_PARTS
_STEP_1, _STEP_2 = LN2_64TH_PARTS
_STEPS: Final = 92.33248261689366  # 64 / ln 2
_INVERSE_LN10, _INVERSE_LN10_LOW = INVERSE_LN10
_ROOT_HALF: Final = math.sqrt(0.5)
_MOST, _LEAST = 710.0, -746.0  # beyond, the power is infinite or zero


@kernel
def exp(x: float) -> float:
    """e to the power of x; infinite where it is too large."""
    x = float(x)
    return _exp(x, 0.0)


@kernel
def log(x: float) -> float:
    """Natural logarithm; minus infinity at zero, not a number below."""
    high, low = _log(x)
    return high + low


@kernel
def log10(x: float) -> float:
    """Logarithm to the base of ten; exact at powers of ten."""
    high, low = _log(x)
    if not abs(high) < math.inf:
        return high
    product, rest = two_product(high, _INVERSE_LN10)
    return product + (rest + (low * _INVERSE_LN10 + high * _INVERSE_LN10_LOW))


@kernel
def power(x: float, y: float) -> float:
    """x to the power of y, with the special cases of C's `pow`."""
    x, y = float(x), float(y)
    if y == 0.0 or x == 1.0:
        return 1.0
    if x != x or y != y:
        return math.nan
    sign = 1.0
    if math.copysign(1.0, x) < 0.0:
        whole = abs(y) >= 4503599627370496.0 or y == math.floor(y)
        odd = whole and abs(y) < 9007199254740992.0 and 0.5 * y != math.floor(0.5 * y)
        if not whole and -math.inf < x < 0.0:
            return math.nan
        sign = -1.0 if odd else 1.0
    size = abs(x)
    if size == 1.0:
        return sign
    if size == 0.0 or size == math.inf or abs(y) == math.inf:
        return sign * (math.inf if (size > 1.0) == (y > 0.0) else 0.0)
    high, low = _log(size)
    if abs(y) > 1e300 or abs(high * y) > 800.0:
        return sign * (math.inf if (high > 0.0) == (y > 0.0) else 0.0)
    product, rest = two_product(high, y)
    return sign * _exp(product, rest + low * y)


@kernel
def _exp(x: float, low: float) -> float:
    """e to the power of x + low."""
    if not x < _MOST:
        return x if x != x else math.inf
    if x < _LEAST:
        return 0.0
    steps = (x * _STEPS + ROUNDING) - ROUNDING
    n = int(steps)
    first = x - steps * _STEP_1
    r, error = two_sum(first, -steps * _STEP_2)
    r, low = two_sum(r, error + low)
    t = r * r
    more = r + (0.5 * t + (r * t * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0)))) + low))
    base, base_low = float(POWERS_OF_TWO[n & 63, 0]), float(POWERS_OF_TWO[n & 63, 1])
    value = base + (base_low + base * more)
    double = n >> 6
    if -1021 < double < 1023:
        return math.ldexp(value, double)
    return value * math.ldexp(1.0, double - double // 2) * math.ldexp(1.0, double // 2)


@kernel
def _log(x: float) -> tuple[float, float]:
    """Natural logarithm as a pair, to 68 bits."""
    x = float(x)
    if not 0.0 < x < math.inf:
        return (-math.inf if x == 0.0 else x if x > 0.0 else math.nan), 0.0
    m, exponent = math.frexp(x)
    doubles = float(exponent)
    if m < _ROOT_HALF:
        m, doubles = 2.0 * m, doubles - 1.0
    j = int((m - 1.0) * 128.0 + 64.5) - 26
    c = float(LOGARITHMS[j, 0])
    m1, m2 = halves(m)
    r, r_low = two_sum(c * m1 - 1.0, c * m2)
    square, square_low = two_product(r, r)
    series = -1.0 / 6.0 + r * (1.0 / 7.0 + r * (-1.0 / 8.0 + r * (1.0 / 9.0 + r * (-1.0 / 10.0 + r * (1.0 / 11.0)))))
    cubic = r * square * (1.0 / 3.0 + r * (-1.0 / 4.0 + r * (1.0 / 5.0 + r * series)))
    high, low = two_sum(doubles * _LN2_1, float(LOGARITHMS[j, 1]))
    high, more = two_sum(high, r)
    low += more
    high, more = two_sum(high, -0.5 * square)
    low += more + (doubles * _LN2_2)
    low += cubic + (float(LOGARITHMS[j, 2]) + doubles * _LN2_3 + (r_low - 0.5 * square_low - r * r_low))
    return fast_two_sum(high, low)
