"""Joints that turn far on a short way, against every pair of nodes tried."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.planning.nodes import Nodes
from gcodesim.planning.spot_kernels import far_turns

SPOT, JUMP = 0.02, 1.0


@pytest.mark.parametrize("seed", range(5))
def test_pairs_are_as_far_apart_as_the_spot_is_wide_with_good_nodes_between(seed: int) -> None:
    rng = np.random.default_rng(seed)
    piece = np.sort(rng.integers(0, 12, 80))
    s = np.concatenate([np.cumsum(rng.exponential(0.004, np.count_nonzero(piece == p))) for p in range(12)])
    head = np.isin(np.arange(80), (0, 30, 31, 60))
    good = rng.random(80) < 0.95
    q = np.cumsum(rng.normal(scale=0.3, size=(80, 3)), axis=0)
    turning = np.array([True, False, True])
    found = np.empty((80, 2), dtype=np.int64)

    count = far_turns(piece, s, head, good, q, turning, SPOT, JUMP, found)

    expected, nodes = [], Nodes(piece, s, head)
    for a, b in nodes.chains:
        way = nodes.way(a, b)
        for k in range(a, b):
            begin = a + int(np.argmax(way >= way[k - a] - SPOT))
            far = np.abs(q[k] - q[begin])[turning].max() > JUMP
            if far and good[begin : k + 1].all():
                expected.append((begin, k))
    assert [tuple(pair) for pair in found[:count].tolist()] == expected
    assert expected
