"""Chatter is a tip that goes back against its command for a while, not one that is thrown once."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gcodesim.executor.tip_swings import TipSwings

DT, SPEED = 4e-3, 20e-3


class Record(dict[str, np.ndarray]):
    """Steps of a level cut along X; those in `cuts` are engaged."""

    def __init__(self, begin: int, end: int, cuts: np.ndarray, tool: int = 1) -> None:
        told = np.zeros((end - begin, 4, 4))
        told[:, 0, 3] = SPEED * DT * (1 + np.arange(begin, end))
        super().__init__(engaged=cuts)
        self.feeds = np.ones(end - begin, dtype=bool)
        self.window: Any = SimpleNamespace(
            tip=told,
            tool=np.full(end - begin, tool),
            row=np.arange(begin, end) // 100,
            samples=SimpleNamespace(time=DT * (1 + np.arange(begin, end))),
        )


def swings_of(off: np.ndarray, cuts: np.ndarray | None = None, window: int = 37) -> TipSwings:
    """What comes of a tip that is `off` (n,) [m] its command along the way."""
    swings, n = TipSwings(DT), len(off)
    cuts = np.ones(n, dtype=bool) if cuts is None else cuts
    for begin in range(0, n, window):
        end = min(begin + window, n)
        record: Any = Record(begin, end, cuts[begin:end])
        tips = record.window.tip[:, :3, 3].copy()
        tips[:, 0] += off[begin:end]
        swings.add(record, tips)
    return swings


def test_a_swing_that_is_faster_than_the_feed_is_chatter() -> None:
    t = DT * np.arange(1000)
    omega = 2.0 * np.pi * 20.0
    wild = np.where((t > 1.0) & (t < 3.0), 2.0 * SPEED / omega * np.sin(omega * t), 0.0)

    swings = swings_of(wild)

    (run,) = swings.chatter()
    assert swings.time[run.start] == pytest.approx(1.0, abs=0.2)
    assert swings.time[run.stop - 1] == pytest.approx(2.8, abs=0.2)
    assert max(swings.widest[run]) == pytest.approx(2.0 * SPEED / omega, rel=0.05)
    # where the speed 2 cos is below -1: a third of the time
    assert sum(swings.back[run]) / sum(swings.steps[run]) == pytest.approx(1.0 / 3.0, abs=0.05)


def test_slow_swings_and_single_blows_are_none() -> None:
    t = DT * np.arange(1000)
    slow = 0.9 * SPEED / (2.0 * np.pi * 20.0) * np.sin(2.0 * np.pi * 20.0 * t)
    blow = np.where(t > 2.0, 1e-3 * np.exp(-(t - 2.0) / 0.03) * np.sin(2.0 * np.pi * 20.0 * t), 0.0)

    assert not swings_of(slow).chatter()
    assert not swings_of(blow).chatter()


def test_only_what_cuts_counts() -> None:
    t = DT * np.arange(1000)
    wild = 2.0 * SPEED / (2.0 * np.pi * 20.0) * np.sin(2.0 * np.pi * 20.0 * t)

    assert not swings_of(wild, np.zeros(1000, dtype=bool)).chatter()
    assert swings_of(wild, t > 2.0).time[0] > 2.0


def test_windows_are_nothing_to_it() -> None:
    draw = np.random.default_rng(3)
    off = np.cumsum(draw.normal(0.0, 5e-5, 700))
    one, other = swings_of(off, window=700), swings_of(off, window=11)

    assert (one.back, one.steps, one.row) == (other.back, other.steps, other.row)
    assert one.widest == pytest.approx(other.widest)
