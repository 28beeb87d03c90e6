"""Directions and wrenches of one step, seen from the stock and from the base."""

from __future__ import annotations

from gcodesim.arithmetic import Array
from gcodesim.compiled import kernel


@kernel(lean=True)
def into_axes(X: Array, first: Array, second: Array, out: Array) -> None:
    """Two vectors (3,) of the outer frame in axes of the pose X (4, 4): `out` (2, 3)."""
    for i in range(3):
        out[0, i] = X[0, i] * first[0] + X[1, i] * first[1] + X[2, i] * first[2]
        out[1, i] = X[0, i] * second[0] + X[1, i] * second[1] + X[2, i] * second[2]


@kernel(lean=True)
def wrench_from_axes(X: Array, wrench: Array, out: Array) -> None:
    """A wrench (6,) in axes of the pose X (4, 4), in those of the outer frame: `out` (6,)."""
    for i in range(3):
        out[i] = X[i, 0] * wrench[0] + X[i, 1] * wrench[1] + X[i, 2] * wrench[2]
        out[3 + i] = X[i, 0] * wrench[3] + X[i, 1] * wrench[4] + X[i, 2] * wrench[5]
