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
