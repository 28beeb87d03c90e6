"""The joints of a cell over time: nodes until the way between them is straight, asked in blocks."""

from __future__ import annotations

import numpy as np

from gcodesim.checks.timed_way import SLACK, TimedWay
from gcodesim.frames import Array

REACH = np.array([1.0, 0.5])


def _swinging(times: Array) -> Array:
    return np.stack([np.sin(times), np.cos(2.0 * times)], axis=1)


def test_no_body_leaves_the_way_by_more_than_the_slack() -> None:
    found = TimedWay.of(_swinging, np.array([0.0, 3.0, 7.0]), REACH)

    share = np.linspace(0.0, 1.0, 11)[:, None, None]
    times = found.time[:-1] + share[..., 0] * np.diff(found.time)
    straight = found.way.q[:-1] + share * np.diff(found.way.q, axis=0)
    off = np.abs(_swinging(times.ravel()).reshape(straight.shape) - straight)
    assert (off <= found.way.bend + 1e-12).all()
    assert (off @ REACH).max() <= SLACK


def test_a_long_way_is_asked_in_blocks() -> None:
    """The samples of all stretches at once made a program of an hour take half a gigabyte."""
    asked: list[int] = []

    def joints(times: Array) -> Array:
        asked.append(len(times))
        return np.stack([1e-3 * times, 2e-3 * times], axis=1)

    nodes = np.arange(0.0, 5000.0, 0.1)

    found = TimedWay.of(joints, nodes, REACH)

    assert len(found.time) >= len(nodes)
    assert max(asked[1:]) <= 15_000 and sum(asked[1:]) == 3 * (len(found.time) - 1)
