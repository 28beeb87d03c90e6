"""Sums and products with their rounding errors: a pair is a value and a small correction to it."""

from __future__ import annotations

from typing import Final

from gcodesim.compiled import kernel

_SPLIT: Final = 134217729.0  # 2**27 + 1
# added and taken away, it leaves the nearest whole number (ties to even) of anything below 2**51
ROUNDING: Final = 6755399441055744.0


@kernel
def two_sum(a: float, b: float) -> tuple[float, float]:
    """a + b exactly (Knuth 1969, theorem 4.2.2 B)."""
    total = a + b
    of_b = total - a
    return total, (a - (total - of_b)) + (b - of_b)


@kernel
def fast_two_sum(a: float, b: float) -> tuple[float, float]:
    """a + b exactly, where a is the larger one (Dekker 1971)."""
    total = a + b
    return total, b - (total - a)


@kernel
def halves(a: float) -> tuple[float, float]:
    """Two numbers of 26 bits with the sum a (Veltkamp 1968); a is below 2**996."""
    large = _SPLIT * a
    high = large - (large - a)
    return high, a - high


@kernel
def two_product(a: float, b: float) -> tuple[float, float]:
    """a times b exactly (Dekker 1971)."""
    a1, a2 = halves(a)
    b1, b2 = halves(b)
    product = a * b
    return product, a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2)
