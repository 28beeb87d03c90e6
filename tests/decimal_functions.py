"""Elementary functions of decimal numbers, to the precision of the context: slow series that need no proof."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal, getcontext, localcontext
from functools import cache


@cache
def pi_with(digits: int) -> Decimal:
    """Machin 1706: pi/4 = 4 arctan 1/5 - arctan 1/239."""
    with localcontext() as context:
        context.prec = digits + 10
        return 4 * (4 * _inverse_tangent_of_inverse(5) - _inverse_tangent_of_inverse(239))


def _inverse_tangent_of_inverse(n: int) -> Decimal:
    power, total, k = Decimal(1) / n, Decimal(0), 0
    while abs(power) > Decimal(10) ** -getcontext().prec:
        total += power / (2 * k + 1)
        power, k = -power / (n * n), k + 1
    return total


def sine(x: Decimal) -> Decimal:
    return _with_more(x, _sine_series)


def cosine(x: Decimal) -> Decimal:
    return _with_more(x, lambda t: _sine_series(t + pi_with(getcontext().prec) / 2))


def _with_more(x: Decimal, function: Callable[[Decimal], Decimal]) -> Decimal:
    """For large angles the context needs as many more digits as the angle has before the point."""
    with localcontext() as context:
        context.prec += max(x.adjusted(), 0) + 10
        value = function(x)
    return +value


def _sine_series(x: Decimal) -> Decimal:
    turn = 2 * pi_with(getcontext().prec)
    x -= turn * (x / turn).to_integral_value()
    return _series(x, lambda k: -x * x / ((2 * k + 2) * (2 * k + 3)))


def _series(first: Decimal, ratio: Callable[[int], Decimal]) -> Decimal:
    term, total, k = first, Decimal(0), 0
    while term and (not total or term.adjusted() > total.adjusted() - getcontext().prec - 5):
        total, term, k = total + term, term * ratio(k), k + 1
    return total


def arctangent(x: Decimal) -> Decimal:
    if abs(x) > 1:
        return pi_with(getcontext().prec) / 2 * (1 if x > 0 else -1) - arctangent(1 / x)
    if abs(x) > Decimal("0.1"):
        return 2 * arctangent(x / (1 + (1 + x * x).sqrt()))
    total, power, k = Decimal(0), x, 0
    while power and (not total or power.adjusted() > total.adjusted() - getcontext().prec - 5):
        total, power, k = total + power / (2 * k + 1), -power * x * x, k + 1
    return total


def exponential(x: Decimal) -> Decimal:
    return x.exp()


def logarithm(x: Decimal) -> Decimal:
    return x.ln()
