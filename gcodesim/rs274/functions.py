"""Functions that are common to the expressions of all dialects; angles in degrees."""

from __future__ import annotations

import math
from collections.abc import Callable

from gcodesim.arithmetic.scalars import exp, log
from gcodesim.rs274.fault import Fault


def root(a: float) -> float:
    if a < 0.0:
        raise Fault("GS123", f"SQRT of {a:g}: a negative number has no root")
    return math.sqrt(a)


def logarithm(a: float) -> float:
    if a <= 0.0:
        raise Fault("GS123", f"LN of {a:g}: only positive numbers have a logarithm")
    return log(a)


def exponential(a: float) -> float:
    """e to the power of a; raises OverflowError where it is no number."""
    value = exp(a)
    if math.isinf(value):
        raise OverflowError
    return value


def arc(name: str, function: Callable[[float], float]) -> Callable[[float], float]:
    """The inverse of a sine or cosine, whose argument is checked."""

    def inverse(a: float) -> float:
        if not -1.0 <= a <= 1.0:
            raise Fault("GS123", f"{name} of {a:g}: the argument must be between -1 and 1")
        return math.degrees(function(a))

    return inverse


def nearest(a: float) -> float:
    """To the nearest integer, halves away from zero."""
    return math.copysign(math.floor(abs(a) + 0.5), a) if a else 0.0
