"""How long a load is above its limit."""

from __future__ import annotations

from typing import Any

import numpy as np

from gcodesim.jobs.loads import BRIEF, Load

DT = 0.004


def load(turns: bool = True) -> Load:
    return Load(code="GS510", column="power", limit=1.0, per=1.0, unit="W", what="power", turns=turns)


def windows(values: list[float], *borders: int) -> list[Any]:
    return [(part, np.ones(len(part), dtype=np.int64)) for part in np.split(np.array(values), borders)]


def test_the_longest_stretch_goes_on_over_the_border_of_a_window() -> None:
    values = [0.0, 2.0, 2.0, 0.5, 2.0, 2.0, 2.0, 2.0, 0.0, 2.0]
    for borders in ((), (5,), (2, 6), tuple(range(1, 10))):
        own = load()
        above = [own.add(*window, DT) for window in windows(values, *borders)]
        assert any(above)
        assert (own.seconds, own.longest) == (7 * DT, 4 * DT), borders
        assert own.duration == "0.028 s in all, 0.016 s at most at a time"


def test_a_quiet_window_between_two_peaks_ends_the_first() -> None:
    own = load()
    for window in windows([2.0, 2.0, 0.0, 0.0, 2.0], 2, 4):
        own.add(*window, DT)

    assert own.longest == 2 * DT


def test_a_corner_is_brief_and_a_cut_is_not() -> None:
    corner, cut, force = load(), load(), load(turns=False)
    corner.add(np.full(3, 2.0), np.ones(3, dtype=np.int64), DT)
    cut.add(np.full(2, 2.0), np.array([10, int(BRIEF / DT) - 8]), DT)  # steps of many ticks
    force.add(np.full(3, 2.0), np.ones(3, dtype=np.int64), DT)

    assert (corner.brief, cut.brief, force.brief) == (True, False, False)
    assert corner.duration == "0.012 s"
