"""Products, lengths and inverses of small matrices, as sums in one order.

`@`, `dot` and `numpy.linalg` are left to BLAS and LAPACK, which add up in an order, and with fused operations, that
depend on the processor. Everything takes stacks: (..., i, k).
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gcodesim.arithmetic import Array
from gcodesim.arithmetic.gain_kernels import least_column_gains
from gcodesim.arithmetic.product_kernels import applications, products

MANY: Final = 256
"""Matrices from which on a kernel does it; both ways give the same bits."""
FEW: Final = 16
"""The same where numpy takes a hundred steps for each matrix."""


def multiplied(first: Array, *others: Array) -> Array:
    """Product of matrices (..., i, k) and (..., k, j), from left to right."""
    for other in others:
        if first.ndim == 3 and len(first) > MANY and other.shape[:-2] in ((), (len(first),)):
            first = _products(first, other)
            continue
        total = first[..., :, 0, None] * other[..., 0, None, :]
        for k in range(1, first.shape[-1]):
            total += first[..., :, k, None] * other[..., k, None, :]
        first = total
    return first


def _products(first: Array, other: Array) -> Array:
    out = np.empty((len(first), first.shape[1], other.shape[-1]))
    products(_ready(first), _ready(other).reshape(-1, *other.shape[-2:]), out)
    return out


def _ready(values: Array) -> Array:
    """The same numbers in the form for kernels."""
    return np.require(values, np.float64, ["C", "W"])


def applied(A: Array, v: Array) -> Array:
    """Matrices (..., i, k) times vectors (..., k)."""
    if A.ndim == 3 and v.ndim in (1, 2):
        vectors = np.atleast_2d(v)
        count = max(len(A), len(vectors))
        if count > MANY and {len(A), len(vectors)} <= {1, count}:
            out = np.empty((count, A.shape[1]))
            applications(_ready(A), _ready(vectors), out)
            return out
    total: Array = A[..., :, 0] * v[..., 0, None]
    for k in range(1, A.shape[-1]):
        total += A[..., :, k] * v[..., k, None]
    return total


def dots(a: Array, b: Array) -> Array:
    """Inner products (...) of vectors (..., k)."""
    total: Array = a[..., 0] * b[..., 0]
    for k in range(1, a.shape[-1]):
        total = total + a[..., k] * b[..., k]
    return total


def dot(a: Array, b: Array) -> float:
    """Inner product of two vectors (k,)."""
    return float(dots(a, b))


def norms(v: Array) -> Array:
    """Lengths (...) of vectors (..., k)."""
    return np.asarray(np.sqrt(dots(v, v)))


def norm(v: Array) -> float:
    """Length of a vector (k,)."""
    return math.sqrt(dots(v, v))


def greatest(rows: Array) -> Array:
    """The greatest (n,) of each of `rows` (n, k), k at least 1: by columns, which is much quicker for a small k."""
    found: Array = rows[:, 0].copy()
    for k in range(1, rows.shape[1]):
        np.maximum(found, rows[:, k], out=found)
    return found


def inverse_pose(X: Array) -> Array:
    """Inverses (..., 4, 4) of poses: of a rotation and a shift."""
    inverse = np.zeros(X.shape)
    R = np.swapaxes(X[..., :3, :3], -1, -2)
    inverse[..., :3, :3] = R
    inverse[..., :3, 3] = -applied(R, X[..., :3, 3])
    inverse[..., 3, 3] = 1.0
    return inverse


def determinant(A: Array) -> float:
    """Of a matrix (3, 3)."""
    return dot(A[0], np.cross(A[1], A[2]))


def solution(A: Array, b: Array) -> Array:
    """x (n,) of A x = b by elimination with the largest pivot of each column; A is (n, n) and regular."""
    rows = np.column_stack([A, b])
    count = len(rows)
    for k in range(count):
        best = k + int(np.argmax(np.abs(rows[k:, k])))
        rows[[k, best]] = rows[[best, k]]
        for i in range(k + 1, count):
            rows[i] = rows[i] - rows[i, k] / rows[k, k] * rows[k]
    x = np.zeros(count)
    for k in reversed(range(count)):
        rest = rows[k, -1]
        for i in range(k + 1, count):
            rest = rest - rows[k, i] * x[i]
        x[k] = rest / rows[k, k]
    return x


def space_solutions(A: Array, b: Array) -> Array:
    """x (n, 3) of A x = b for many regular matrices A (n, 3, 3) (Cramer 1750)."""
    u, v, w = A[..., 0], A[..., 1], A[..., 2]
    across = np.cross(v, w)
    parts = [dots(b, across), dots(u, np.cross(b, w)), dots(u, np.cross(v, b))]
    return np.asarray(np.stack(parts, axis=-1) / dots(u, across)[..., None])


def principal_axes(A: Array) -> tuple[Array, Array]:
    """Values (n,), ascending, and vectors (n, n), as columns, of a symmetric matrix (Jacobi 1846)."""
    A, V = np.array(A, dtype=float), np.eye(len(A))
    for _ in range(50):
        off = [(i, j) for i in range(len(A)) for j in range(i + 1, len(A)) if A[i, j] != 0.0]
        if not off:
            break
        for i, j in off:
            if abs(A[i, j]) <= 1e-17 * math.sqrt(abs(A[i, i] * A[j, j])):
                A[i, j] = A[j, i] = 0.0
                continue
            half = (A[j, j] - A[i, i]) / (2.0 * A[i, j])
            t = math.copysign(1.0, half) / (abs(half) + math.sqrt(half * half + 1.0))
            c = 1.0 / math.sqrt(t * t + 1.0)
            s = t * c
            for M in (A, A.T, V):  # columns, then rows
                M[:, i], M[:, j] = c * M[:, i] - s * M[:, j], s * M[:, i] + c * M[:, j]
            A[i, j] = A[j, i] = 0.0
    order = np.argsort(np.diag(A), kind="stable")
    return np.diag(A)[order], V[:, order]


def least_gains(A: Array) -> Array:
    """Smallest singular values (n,) of matrices (n, i, j), by rotations that make their columns square to each other
    (Hestenes 1958)."""
    A = np.array(A if A.shape[-2] >= A.shape[-1] else np.swapaxes(A, -1, -2), dtype=float)
    if A.ndim == 3 and len(A) > FEW:
        out = np.empty(len(A))
        least_column_gains(_ready(np.swapaxes(A, -1, -2)), out)
        return out
    count = A.shape[-1]
    for _ in range(30):
        moved = False
        for i in range(count):
            for j in range(i + 1, count):
                u, v = A[..., i], A[..., j]
                a, b, g = dots(u, u), dots(v, v), dots(u, v)
                turn = np.abs(g) > 1e-16 * np.sqrt(a * b)
                if not turn.any():
                    continue
                moved = True
                half = np.where(turn, b - a, 0.0) / np.where(turn, 2.0 * g, 1.0)
                t = np.where(turn, np.copysign(1.0, half) / (np.abs(half) + np.sqrt(half * half + 1.0)), 0.0)
                c = (1.0 / np.sqrt(t * t + 1.0))[..., None]
                s = t[..., None] * c
                A[..., i], A[..., j] = c * u - s * v, s * u + c * v
        if not moved:
            break
    return np.asarray(np.sqrt(np.stack([dots(A[..., k], A[..., k]) for k in range(count)], axis=-1)).min(axis=-1))


def least_inverse(A: Array) -> Array:
    """Pseudoinverse (k, i) of a matrix (i, k): the shortest of the solutions that come nearest (Moore 1920)."""
    squares, axes = principal_axes(multiplied(A.T, A))
    kept = squares > 1e-12 * squares.max(initial=0.0)
    gains = np.where(kept, 1.0 / np.where(kept, squares, 1.0), 0.0)
    return multiplied(axes * gains, axes.T, A.T)
