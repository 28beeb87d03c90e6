"""The stays of a part in a run, kept as numbers."""

from __future__ import annotations

import tracemalloc
from math import inf

import numpy as np

from gcodesim.frames import Pose
from gcodesim.scene import Past, Stay


def stay(k: int) -> Stay:
    X = Pose.from_xyz_rpy((0.1 * k, 0.0, -0.3), (0.1, 0.2, 0.3 * k))
    parent, holder = ("arm/flange", "arm T1") if k % 2 else ("table", "")
    return Stay(body="part/box", parent=parent, X=X, begin=float(k), holder=holder)


def test_stays_come_back_as_they_were_and_end_when_the_part_leaves() -> None:
    past = Past("part/box")
    for k in range(3):
        past.leave(k - 0.25)
        past.add(stay(k))

    assert len(past) == 3
    for k, kept in enumerate(past):
        own = stay(k)
        assert (kept.body, kept.parent, kept.holder, kept.begin) == ("part/box", own.parent, own.holder, own.begin)
        assert (kept.end, kept.room, kept.opening) == (inf if k == 2 else k + 0.75, inf, 1.0)
        assert np.array_equal(kept.X.matrix, own.X.matrix)


def test_a_thousand_stays_are_small() -> None:
    past, stays = Past("part/box"), [stay(k) for k in range(1000)]
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        for each in stays:
            past.add(each)
        grown = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()

    assert grown < 200_000
