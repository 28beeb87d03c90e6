"""How long a load is above its limit."""

from __future__ import annotations

from typing import Any

import numpy as np

from gcodesim.jobs.loads import BRIEF, Load

DT = 0.004


def load(turns: bool = True) -> Load:
    return Load(code="GS510", column="power", limit=1.0, per=1.0, unit="W", what="power", turns=turns)


def windows(values: list[float], *borders: int) -> list[Any]:
    return [{"power": part} for part in np.split(np.array(values), borders)]


def test_the_longest_stretch_goes_on_over_the_border_of_a_window() -> None:
    values = [0.0, 2.0, 2.0, 0.5, 2.0, 2.0, 2.0, 2.0, 0.0, 2.0]
    for borders in ((), (5,), (2, 6), tuple(range(1, 10))):
        own = load()
        above = [own.add(window, DT) for window in windows(values, *borders)]
        assert any(above)
        assert (own.seconds, own.longest) == (7 * DT, 4 * DT), borders
        assert own.duration == "0.028 s in all, 0.016 s at most at a time"


def test_a_quiet_window_between_two_peaks_ends_the_first() -> None:
    own = load()
    for window in windows([2.0, 2.0, 0.0, 0.0, 2.0], 2, 4):
        own.add(window, DT)

    assert own.longest == 2 * DT


def test_a_corner_is_brief_and_a_cut_is_not() -> None:
    corner, cut, force = load(), load(), load(turns=False)
    corner.add({"power": np.full(3, 2.0)}, DT)  # type: ignore[arg-type]
    cut.add({"power": np.full(int(BRIEF / DT) + 2, 2.0)}, DT)  # type: ignore[arg-type]
    force.add({"power": np.full(3, 2.0)}, DT)  # type: ignore[arg-type]

    assert (corner.brief, cut.brief, force.brief) == (True, False, False)
    assert corner.duration == "0.012 s"
