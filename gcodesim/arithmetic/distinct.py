"""Distinct values of an array, and distinct rows."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", bound=np.generic)


def distinct(values: NDArray[Number]) -> NDArray[Number]:
    """The distinct values (k,) of an array of any shape without NaN, ascending.

    `numpy.unique` gives the same, but imports numpy's masked arrays for it, which costs a short run 15 ms.
    """
    ascending = np.sort(values, axis=None)
    new = np.ones(len(ascending), dtype=np.bool_)
    np.not_equal(ascending[1:], ascending[:-1], out=new[1:])
    return ascending[new]


def row_numbers(rows: NDArray[Number]) -> NDArray[np.int64]:
    """A number (n,) for each row of (n, 3) without NaN, ascending with the rows from 0; equal rows have the same.

    `numpy.unique` with an axis gives the same, and takes several times as long.
    """
    order = np.lexsort((rows[:, 2], rows[:, 1], rows[:, 0]))
    ascending = rows[order]
    new = np.zeros(len(rows), dtype=np.int64)
    new[1:] = (ascending[1:] != ascending[:-1]).any(axis=1)
    numbers = np.empty(len(rows), dtype=np.int64)
    numbers[order] = np.cumsum(new)
    return numbers
