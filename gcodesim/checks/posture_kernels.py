"""Whether bodies of a machine are in each other in one posture after the other."""

from __future__ import annotations

import numpy as np

from gcodesim.checks.gap_kernels import Ints
from gcodesim.checks.search_kernels import PairSearch, comes_near, look_at
from gcodesim.compiled import kernel


@kernel
def touching(level: float, search: PairSearch) -> Ints:
    """Which of the pairs is the first below `level` [m] at each row of the way's q; -1: none."""
    out = np.full(search.way.q.shape[0], -1, dtype=np.int64)
    for k in range(search.way.q.shape[0]):
        for p in range(search.roots.shape[0]):
            look_at(p, k, search)
            if comes_near(p, level, search):
                out[k] = p
                break
    return out
