"""Products of two matrices (3, 3), inside of compiled loops; `product_kernels` has those of many at a time."""

from __future__ import annotations

from gcodesim.arithmetic import Array
from gcodesim.compiled import kernel


@kernel(lean=True)
def multiply(first: Array, other: Array, out: Array) -> None:
    """Fill the first three columns of `out` with `first` times `other`, neither of which is `out`."""
    for r in range(3):
        for c in range(3):
            out[r, c] = first[r, 0] * other[0, c] + first[r, 1] * other[1, c] + first[r, 2] * other[2, c]


@kernel(lean=True)
def multiply_transposed(first: Array, other: Array, out: Array) -> None:
    """The same with the transpose of `other`."""
    for r in range(3):
        for c in range(3):
            out[r, c] = first[r, 0] * other[c, 0] + first[r, 1] * other[c, 1] + first[r, 2] * other[c, 2]
