"""Where teeth stand, and which of them are impossible."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.tools import TOOLS
from gcodesim.tools.teeth import late_at, starts_of
from gcodesim.units import DEG


def mill(**more):
    return TOOLS["flat_end_mill"](diameter=10e-3, length=50e-3, flute_length=20e-3, **{"flutes": 3, **more})


def degrees(*angles):
    return tuple(angle * DEG for angle in angles)


def test_even_teeth_are_not_uneven() -> None:
    assert not mill().uneven and not mill(runout=0.0).uneven and not mill(flutes=1, runout=5e-6).uneven
    assert not mill(pitches=degrees(120, 120, 120), helices=degrees(35, 35, 35)).uneven
    assert mill(runout=5e-6).uneven and mill(pitches=degrees(110, 120, 130)).uneven and mill(up_cut=5e-3).uneven


def test_pitches_add_up_and_are_stretched_to_a_turn() -> None:
    tool = mill(pitches=degrees(100, 120, 139.9))

    assert not tool.problems()
    assert starts_of(tool) == pytest.approx(np.array([0.0, 100.0, 220.0]) * 2 * math.pi / 359.9)
    assert starts_of(mill()) == pytest.approx(np.array([0.0, 120.0, 240.0]) * DEG)


def test_a_helix_makes_late_and_goes_back_above_an_up_cut() -> None:
    """2 z tan(helix) / D; at twice the height of the up-cut part a tooth stands as at the tip."""
    found = late_at(mill(helices=degrees(30, 40, 45), up_cut=6e-3), np.array([0.0, 5e-3, 6e-3, 12e-3]))

    assert found[:, 0] == pytest.approx(0.0) and found[:, 3] == pytest.approx(0.0, abs=1e-15)
    assert found[:, 1] == pytest.approx([math.tan(30 * DEG), math.tan(40 * DEG), 1.0])
    assert found[2, 2] == pytest.approx(1.2)


@pytest.mark.parametrize(
    ("keys", "key", "said"),
    [
        ({"pitches": degrees(100, 120)}, "pitches", "2 angles, and there are 3 teeth"),
        ({"helices": degrees(30, 31, 32, 33)}, "helices", "4 angles, and there are 3 teeth"),
        ({"pitches": degrees(100, 120, 100)}, "pitches", "320 deg together"),
        ({"helices": degrees(30, 89.5, 30)}, "helices", "89.5 deg"),
        ({"helices": degrees(0, 45, 0)}, "helices", "meet below 20 mm"),
        ({"up_cut": 25e-3}, "up_cut", "25 mm is more than the edges are long, 20 mm"),
        ({"flutes": 0}, "flutes", "at least one"),
        ({"helix": 90 * DEG}, "helix", "no helix"),
    ],
)
def test_teeth_that_cannot_be_are_told(keys, key, said) -> None:
    found = mill(**keys).problems()

    assert [name for name, _ in found] == [key] and said in found[0][1]
