"""The moments of a run that a replay needs: between them everything moves along straight lines."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_MOMENTS: Final = 24_000


def key_moments(
    signals: Array, tolerance: Array, forced: NDArray[np.int64], most: int = MOST_MOMENTS
) -> NDArray[np.int64]:
    """Indices of the rows of `signals` (n, k) that a replay needs.

    Between them no column is further off a straight line than `tolerance` (k,).
    `forced` rows are kept. When more than `most` rows would be needed, the
    tolerance is doubled until they suffice. Ramer 1972, Douglas and Peucker 1973,
    with time as the way.
    """
    scaled = np.ascontiguousarray((signals / tolerance).T)  # numpy finds the maximum fastest over a few long rows
    while True:
        kept = _within_one(scaled, forced, max(most, len(forced) + 2))
        if kept is not None:
            return kept
        scaled = scaled * 0.5


def _within_one(scaled: Array, forced: NDArray[np.int64], most: int) -> NDArray[np.int64] | None:
    """The columns of `scaled` (k, n) for a tolerance of 1; None as soon as they are more than `most`."""
    count = scaled.shape[1]
    if count <= 2:
        return np.arange(count)
    kept = np.zeros(count, dtype=bool)
    kept[[0, count - 1]] = True
    kept[forced] = True
    fixed = np.flatnonzero(kept)
    number = len(fixed)
    waiting = [(int(a), int(b)) for a, b in pairwise(fixed) if b - a > 1]
    while waiting:
        a, b = waiting.pop()
        share = np.arange(1, b - a) / (b - a)
        first, last = scaled[:, a, None], scaled[:, b, None]
        off = np.abs(scaled[:, a + 1 : b] - (first + share * (last - first))).max(axis=0)
        worst = int(off.argmax())
        if off[worst] > 1.0:
            number += 1
            if number > most:
                return None
            middle = a + 1 + worst
            kept[middle] = True
            waiting += [(x, y) for x, y in ((a, middle), (middle, b)) if y - x > 1]
    return np.flatnonzero(kept)
