"""Elementary functions for Python, of numbers and of arrays, with the same bits on every processor.

A number gives a float, an array an array of its shape. Many values at once are computed by a kernel, few by plain
Python; both give the same bits. Angles are in radians. What has no value is not a number, what is too large is
infinite: nothing raises.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, overload

import numpy as np

from gcodesim.arithmetic import Array, array_kernels, atan_kernels, power_kernels, sin_kernels
from gcodesim.compiled import as_python

cos_sin_of: Final[Callable[[float], tuple[float, float]]] = as_python(sin_kernels.cos_sin)
tan: Final[Callable[[float], float]] = as_python(sin_kernels.tan)
atan: Final[Callable[[float], float]] = as_python(atan_kernels.atan)
exp: Final[Callable[[float], float]] = as_python(power_kernels.exp)
log: Final[Callable[[float], float]] = as_python(power_kernels.log)
log10: Final[Callable[[float], float]] = as_python(power_kernels.log10)
power: Final[Callable[[float, float], float]] = as_python(power_kernels.power)


class Elementary:
    """A function of one value."""

    def __init__(self, one: Callable[[float], float], many: Callable[[Array, Array], None]) -> None:
        self._one = as_python(one)
        self._many = many

    @overload
    def __call__(self, x: float) -> float: ...
    @overload
    def __call__(self, x: Array) -> Array: ...
    def __call__(self, x: float | Array) -> float | Array:
        if not isinstance(x, np.ndarray):
            return self._one(x)
        return _each(self._many, x)


sin: Final = Elementary(sin_kernels.sin, array_kernels.sines)
cos: Final = Elementary(sin_kernels.cos, array_kernels.cosines)
asin: Final = Elementary(atan_kernels.asin, array_kernels.arcsines)
acos: Final = Elementary(atan_kernels.acos, array_kernels.arccosines)


@overload
def cos_sin(x: float) -> tuple[float, float]: ...
@overload
def cos_sin(x: Array) -> tuple[Array, Array]: ...
def cos_sin(x: float | Array) -> tuple[Any, Any]:
    """Cosine and sine."""
    if not isinstance(x, np.ndarray):
        return cos_sin_of(x)
    values = np.ascontiguousarray(x, dtype=np.float64)
    cosine, sine = np.empty(values.shape), np.empty(values.shape)
    array_kernels.cosines_and_sines(values.reshape(-1), cosine.reshape(-1), sine.reshape(-1))
    return cosine, sine


@overload
def atan2(y: float, x: float) -> float: ...
@overload
def atan2(y: Array, x: Array) -> Array: ...
def atan2(y: Any, x: Any) -> float | Array:
    """Angle of the point (x, y), from -pi to pi."""
    if not isinstance(y, np.ndarray):
        return _angle(y, x)
    return _each(array_kernels.angles, y, x)


_angle: Final[Callable[[float, float], float]] = as_python(atan_kernels.atan2)


def hypot(a: Array, b: Array) -> Array:
    """Length of the sides a and b of a right angle."""
    return np.asarray(np.sqrt(a * a + b * b))


def _each(kernel: Callable[..., None], *values: Array) -> Array:
    same = [np.ascontiguousarray(value, dtype=np.float64) for value in values]
    out = np.empty(same[0].shape)
    kernel(*(value.reshape(-1) for value in same), out.reshape(-1))
    return out
