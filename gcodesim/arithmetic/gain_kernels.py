"""Singular values of many small matrices."""

from __future__ import annotations

import math

from gcodesim.arithmetic import Array
from gcodesim.compiled import kernel


@kernel(lean=True)
def inner(a: Array, b: Array) -> float:
    """Inner product of vectors (k,), summed like `matrices.dots`."""
    total: float = a[0] * b[0]
    for k in range(1, a.shape[0]):
        total += a[k] * b[k]
    return total


@kernel(lean=True)
def least_column_gains(columns: Array, out: Array) -> None:
    """Smallest singular values `out` (n,) of matrices given by their `columns` (n, j, i), which are overwritten.

    The same turns, in the same order, as in `matrices.least_gains`.
    """
    n, count, rows = columns.shape
    for m in range(n):
        A = columns[m]
        for _ in range(30):
            moved = False
            for i in range(count):
                for j in range(i + 1, count):
                    u, v = A[i], A[j]
                    a, b, g = inner(u, u), inner(v, v), inner(u, v)
                    if not abs(g) > 1e-16 * math.sqrt(a * b):
                        continue
                    moved = True
                    half = (b - a) / (2.0 * g)
                    t = math.copysign(1.0, half) / (abs(half) + math.sqrt(half * half + 1.0))
                    c = 1.0 / math.sqrt(t * t + 1.0)
                    s = t * c
                    for k in range(rows):
                        u[k], v[k] = c * u[k] - s * v[k], s * u[k] + c * v[k]
            if not moved:
                break
        least = math.inf
        for i in range(count):
            least = min(least, math.sqrt(inner(A[i], A[i])))
        out[m] = least
