"""Distinct values of an array."""

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
