"""Windows that are cut together: the order of steps that counts is kept, and nothing else of it."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from gcodesim.executor.weave_kernels import spells_of
from gcodesim.processes.zone import EVERYWHERE, Zone

Array = NDArray[np.float64]


def spells(low: Array, high: Array) -> list[tuple[int, int]]:
    channels, _, steps, _ = low.shape
    out = np.empty((channels * steps, 2), dtype=np.int64)
    count = spells_of(low, high, np.zeros(channels, dtype=np.int64), out)
    return [(int(channel), int(end)) for channel, end in out[:count]]


def order_of(found: list[tuple[int, int]], channels: int) -> list[tuple[int, int]]:
    """All (step, channel) in the order in which they are cut."""
    at, done = [0] * channels, []
    for channel, end in found:
        done += [(step, channel) for step in range(at[channel], end)]
        at[channel] = end
    return done


def boxes(seed: int, channels: int, steps: int, far: float) -> tuple[Array, Array]:
    """Tools that wander about in two stocks; now and then one acts on nothing."""
    draw = np.random.default_rng(seed)
    at = np.cumsum(draw.normal(size=(channels, 2, steps, 3)), axis=2) + far * draw.normal(size=(channels, 1, 1, 3))
    low, high = at - 2.0, at + 2.0
    away = draw.random((channels, 2, steps)) < 0.3
    low[away], high[away] = np.inf, -np.inf
    return low, high


@pytest.mark.parametrize("seed", range(12))
def test_steps_that_share_room_keep_their_order(seed: int) -> None:
    low, high = boxes(seed, channels=2 + seed % 2, steps=40, far=3.0)

    done = order_of(spells(low, high), len(low))

    place = {each: number for number, each in enumerate(done)}
    assert sorted(place) == sorted(product(range(40), range(len(low))))
    shared = 0
    for (i, c), (j, d) in product(place, place):
        if c == d:
            assert (i < j) == (place[i, c] < place[j, d]) or i == j
        elif (i, c) < (j, d) and ((low[c, :, i] < high[d, :, j]) & (high[c, :, i] > low[d, :, j])).all(axis=-1).any():
            shared += 1
            assert place[i, c] < place[j, d]
    assert shared > 10


def test_tools_that_are_apart_go_all_the_way_at_once() -> None:
    low, high = boxes(3, channels=3, steps=50, far=1e4)

    assert spells(low, high) == [(0, 50), (1, 50), (2, 50)]


def test_who_comes_later_to_the_same_place_waits_for_nothing() -> None:
    """The second tool goes where the first has been ten steps earlier, and the first where the second has yet to go."""
    x = np.arange(30.0)
    low = np.stack([x, x - 10.0])[:, None, :, None] * np.ones(3)

    assert spells(low, low + 1.0) == [(0, 30), (1, 30)]
    assert spells(low[::-1].copy(), low[::-1] + 1.0)[0] == (0, 10)  # its next step comes after the other's first


def test_tools_on_one_spot_take_turns() -> None:
    low = np.zeros((2, 1, 4, 3))

    assert spells(low, low + 1.0) == [(0, 1), (1, 1), (0, 2), (1, 2), (0, 3), (1, 3), (0, 4), (1, 4)]


@pytest.mark.parametrize("seed", range(4))
def test_boxes_of_steps_make_the_box_of_the_window(seed: int) -> None:
    draw = np.random.default_rng(seed)
    points, first = draw.normal(size=(13, 3)), np.sort(draw.choice(np.arange(1, 12), 4, replace=False))
    first = np.append(0, first)
    axis = draw.normal(size=(6, 3)) + np.array([0.0, 0.0, 3.0])
    axis /= np.sqrt((axis * axis).sum(axis=1))[:, None]
    zone = Zone(radius=0.5, below=0.2, above=3.0)

    low, high = zone.bounds_by_step((points[:-1], points[1:]), first, (axis[:-1], axis[1:]), 0.1)

    least, most = zone.bounds(points[:-1], points[1:], axis, 0.1)
    assert (low.min(axis=0) >= least - 1e-12).all() and (high.max(axis=0) <= most + 1e-12).all()
    for step, (begin, end) in enumerate(zip(first, [*first[1:], 12], strict=True)):
        for at, way in product(points[begin : end + 1], axis[step : step + 2]):
            side = np.cross(way, draw.normal(size=3))
            side *= 0.5 / np.sqrt(side @ side)
            for point in (at - 0.2 * way + side, at + 3.0 * way - side):
                assert (point > low[step]).all() and (point < high[step]).all()


def test_a_step_without_a_piece_has_no_bounds() -> None:
    point, axis = np.zeros((2, 3)), np.tile([0.0, 0.0, 1.0], (3, 1))
    for zone, first in ((Zone(radius=1.0), np.array([0, 1, 1])), (EVERYWHERE, np.array([0, 1, 2]))):
        low, high = zone.bounds_by_step((point, point), first, (axis, axis))
        bounded = np.isfinite(low).all(axis=1) & np.isfinite(high).all(axis=1)
        assert bounded.tolist() == [False] * 3 if zone is EVERYWHERE else [True, False, True]
