"""Elementary functions: within 0.53 units in the last place, and with the same bits compiled and interpreted."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from decimal import Decimal, localcontext
from random import Random

import numpy as np
import pytest

from gcodesim.arithmetic import array_kernels, elementary
from gcodesim.arithmetic.power_kernels import exp, log, log10, power
from gcodesim.arithmetic.sin_kernels import tan
from gcodesim.compiled import Kernel, kernel
from tests import decimal_functions as true

Function = Callable[..., float]
ACCURATE = 0.53  # units in the last place


def spread(seed: int, low: float, high: float, count: int = 150) -> list[float]:
    random = Random(seed)
    return [random.uniform(low, high) for _ in range(count)]


def scales(seed: int, least: int, most: int, count: int = 60) -> list[float]:
    random = Random(seed)
    return [math.ldexp(random.uniform(-2.0, 2.0), random.randint(least, most)) for _ in range(count)]


# close to multiples of pi/2, closest of all doubles (Muller 2016, table 11.1), and as large as they come
ANGLES = [
    *spread(1, -8.0, 8.0), *scales(2, -60, 18), *spread(3, -524288.0, 524288.0, 60), *scales(4, 19, 1023),
    *(k * math.pi / 2.0 for k in range(1, 40)), 6381956970095103.0 * 2.0**797, 1.7976931348623157e308, 1e22, 524288.0,
]  # fmt: skip
RATIOS = [*spread(5, -1.0, 1.0), *(1.0 - 2.0**-k for k in range(1, 53)), *(-(2.0**-k) for k in range(60))]
POINTS = [
    *zip(spread(6, -1.0, 1.0), spread(7, -1.0, 1.0), strict=True),
    *zip(scales(8, -600, 600), scales(9, -600, 600), strict=True),
]
POWERS = [
    *zip(spread(10, 0.0, 5.0), spread(11, -4.0, 4.0), strict=True),
    *zip(spread(12, 0.99, 1.01), spread(13, -3e4, 3e4), strict=True),
    *zip(spread(14, 0.0, 2000.0), spread(15, -90.0, 90.0), strict=True),
]


def tangent(x: Decimal) -> Decimal:
    return true.sine(x) / true.cosine(x)


def angle(y: Decimal, x: Decimal) -> Decimal:
    if x == 0:
        return true.pi_with(60) / 2 * (1 if y > 0 else -1)
    flat = true.arctangent(y / x)
    return flat if x > 0 else flat + true.pi_with(60) * (1 if y >= 0 else -1)


CASES: dict[str, tuple[Function, Callable[..., Decimal], list[tuple[float, ...]]]] = {
    "sin": (elementary.sin, true.sine, [(x,) for x in ANGLES]),
    "cos": (elementary.cos, true.cosine, [(x,) for x in ANGLES]),
    "tan": (elementary.tan, tangent, [(x,) for x in ANGLES]),
    "atan": (elementary.atan, true.arctangent, [(x,) for x in ANGLES]),
    "atan2": (elementary.atan2, angle, list(POINTS)),
    "asin": (elementary.asin, lambda x: angle(x, ((1 - x) * (1 + x)).sqrt()), [(x,) for x in RATIOS]),
    "acos": (elementary.acos, lambda x: angle(((1 - x) * (1 + x)).sqrt(), x), [(x,) for x in RATIOS]),
    "exp": (elementary.exp, Decimal.exp, [(x,) for x in (*spread(16, -3.0, 3.0), *spread(17, -700.0, 709.0))]),
    "log": (elementary.log, Decimal.ln, [(abs(x),) for x in (*scales(18, -1000, 1000), *spread(19, 0.9, 1.1))]),
    "log10": (elementary.log10, Decimal.log10, [(abs(x),) for x in (*scales(20, -900, 900), *spread(21, 0.9, 1.1))]),
    "power": (elementary.power, lambda x, y: (x.ln() * y).exp(), list(POWERS)),
}


@pytest.mark.parametrize("name", CASES)
def test_values_are_the_nearest_or_almost(name: str) -> None:
    function, reference, arguments = CASES[name]
    with localcontext() as context:
        context.prec = 60
        for values in arguments:
            exact, found = reference(*map(Decimal, values)), function(*values)
            error = abs(Decimal(found) - exact) / Decimal(math.ulp(float(exact)))
            assert error < ACCURATE, (values, found)


@pytest.mark.parametrize("name", CASES)
def test_special_values_are_those_of_c(name: str) -> None:
    ours, theirs = CASES[name][0], getattr(math, {"power": "pow"}.get(name, name))
    special = [0.0, -0.0, 1.0, -1.0, math.inf, -math.inf, math.nan, 0.5, -2.0, 3.0, 5e-324]
    pairs = len(CASES[name][2][0]) == 2
    for values in [(a, b) for a in special for b in special] if pairs else [(a,) for a in special]:
        found = ours(*values)
        try:
            wanted = theirs(*values)
        except ValueError:  # Python's way to say that there is no value, or an infinite one
            assert not math.isfinite(found), values
        except OverflowError:
            assert math.isinf(found), values
        else:
            assert math.isclose(found, wanted, rel_tol=1e-15) or (math.isnan(found) and math.isnan(wanted)), values
            assert math.copysign(1.0, found) == math.copysign(1.0, wanted) or math.isnan(found), values


def test_powers_of_ten_have_whole_logarithms_and_small_powers_are_exact() -> None:
    assert [elementary.log10(10.0**k) for k in range(23)] == list(range(23))
    assert [elementary.power(float(a), float(b)) for a in range(1, 30) for b in range(8)] == [
        float(a**b) for a in range(1, 30) for b in range(8)
    ]


def test_cos_sin_gives_what_cos_and_sin_give() -> None:
    for x in ANGLES:
        assert elementary.cos_sin(x) == (elementary.cos(x), elementary.sin(x))


@kernel
def others(x: np.ndarray, y: np.ndarray, out: np.ndarray) -> None:
    """What no array of the package needs."""
    for i in range(len(x)):
        out[0, i], out[1, i], out[2, i] = tan(x[i]), exp(x[i]), log(x[i])
        out[3, i], out[4, i] = log10(x[i]), power(x[i], y[i])


def test_compiled_and_interpreted_scalars_give_the_same_bits() -> None:
    x, y = (np.array([*column, *ANGLES]) for column in map(list, zip(*POWERS, strict=True)))
    compiled, plain = np.empty((5, len(x))), np.empty((5, len(x)))
    others(x, y, compiled)
    others.interpreted(x, y, plain)
    assert compiled.tobytes() == plain.tobytes()


def many() -> Iterator[tuple[Kernel, tuple[np.ndarray, ...], int]]:
    x, ratios = np.array(ANGLES * 3), np.array(RATIOS * 3)
    y, z = (np.array(column * 3) for column in map(list, zip(*POINTS, strict=True)))
    yield array_kernels.sines, (x,), 1
    yield array_kernels.cosines, (x,), 1
    yield array_kernels.cosines_and_sines, (x,), 2
    yield array_kernels.arcsines, (ratios,), 1
    yield array_kernels.arccosines, (ratios,), 1
    yield array_kernels.angles, (y, z), 1


@pytest.mark.parametrize("many_of, values, results", list(many()), ids=lambda value: getattr(value, "__name__", ""))
def test_compiled_and_interpreted_functions_give_the_same_bits(
    many_of: Kernel, values: tuple[np.ndarray, ...], results: int
) -> None:
    compiled, plain = (tuple(np.full(len(values[0]), 7.0) for _ in range(results)) for _ in range(2))
    many_of(*values, *compiled)
    many_of.interpreted(*values, *plain)
    for one, other in zip(compiled, plain, strict=True):
        assert one.tobytes() == other.tobytes()


def test_arrays_of_any_length_and_shape_hold_what_single_values_give() -> None:
    for shape in ((3, 4), (40, 3, 5), (0,)):
        x = np.array(ANGLES[:12] * 50)[: math.prod(shape)].reshape(shape)
        cosine, sine = elementary.cos_sin(x.T)
        assert sine.shape == x.T.shape
        assert elementary.sin(x).ravel().tolist() == [elementary.sin(float(v)) for v in x.ravel()]
        assert (cosine == elementary.cos(x).T).all() and (sine == elementary.sin(x).T).all()
        assert elementary.atan2(x, x + 1.0).ravel().tolist() == [elementary.atan2(v, v + 1.0) for v in x.ravel()]
