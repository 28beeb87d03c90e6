"""Elementary functions of many values [rad where they are angles]; `out` is as long as the values."""

from __future__ import annotations

from gcodesim.arithmetic import Array
from gcodesim.arithmetic.atan_kernels import acos, asin, atan2
from gcodesim.arithmetic.sin_kernels import cos, cos_sin, sin
from gcodesim.compiled import kernel


@kernel(short=True)
def sines(x: Array, out: Array) -> None:
    for i in range(len(x)):
        out[i] = sin(x[i])


@kernel(short=True)
def cosines(x: Array, out: Array) -> None:
    for i in range(len(x)):
        out[i] = cos(x[i])


@kernel(short=True)
def cosines_and_sines(x: Array, cosine: Array, sine: Array) -> None:
    for i in range(len(x)):
        cosine[i], sine[i] = cos_sin(x[i])


@kernel(short=True)
def arcsines(x: Array, out: Array) -> None:
    for i in range(len(x)):
        out[i] = asin(x[i])


@kernel(short=True)
def arccosines(x: Array, out: Array) -> None:
    for i in range(len(x)):
        out[i] = acos(x[i])


@kernel(short=True)
def angles(y: Array, x: Array, out: Array) -> None:
    for i in range(len(x)):
        out[i] = atan2(y[i], x[i])
