"""Products of many small matrices."""

from __future__ import annotations

from gcodesim.arithmetic import Array
from gcodesim.compiled import kernel


@kernel(lean=True)
def products(first: Array, other: Array, out: Array) -> None:
    """Fill `out` (n, i, j) with the products of matrices (n, i, k) and (n, k, j); a single `other` serves all.

    Each element is summed from the first k to the last, like that of `matrices.multiplied`.
    """
    n, rows, columns = out.shape
    alone = other.shape[0] == 1
    for r in range(n):
        right = other[0] if alone else other[r]
        for i in range(rows):
            line = out[r, i]
            for j in range(columns):
                line[j] = first[r, i, 0] * right[0, j]
            for k in range(1, right.shape[0]):
                factor = first[r, i, k]
                for j in range(columns):
                    line[j] += factor * right[k, j]


@kernel(lean=True)
def applications(matrices: Array, vectors: Array, out: Array) -> None:
    """Fill `out` (n, i) with matrices (n, i, k) times vectors (n, k); a single matrix, or a single vector, serves all.

    Summed like that of `matrices.applied`.
    """
    n, rows = out.shape
    one_matrix, one_vector = matrices.shape[0] == 1, vectors.shape[0] == 1
    for r in range(n):
        matrix, vector = matrices[0 if one_matrix else r], vectors[0 if one_vector else r]
        for i in range(rows):
            total = matrix[i, 0] * vector[0]
            for k in range(1, vector.shape[0]):
                total += matrix[i, k] * vector[k]
            out[r, i] = total
