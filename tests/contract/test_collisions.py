"""Moves of bodies and arms among still bodies, with the truth about them from an independent engine.

`tests/data/collisions/README.md` says where it comes from and what may differ.
"""

from __future__ import annotations

import json

import pytest

from tests.collision_cases import Case, answer, read_cases

CASES = read_cases()
FIRST, FIRST_MM = 1e-3, 0.05  # of the motion, or of the way of the fastest point
DISTANCE_MM, DISTANCE_SHARE = 0.05, 1e-3
DEPTH_MM = 0.05


@pytest.mark.parametrize("case", CASES["cases"], ids=lambda case: f"{case['id']} {case['title']}")
def test_a_move_meets_what_it_meets(case: Case) -> None:
    truth, found = case["truth"], answer(case, CASES["robots"])
    assert found["collides"] == truth["collides"]
    if truth["collides"]:
        allowed = max(FIRST, FIRST_MM / truth["travel_mm"]) if truth["travel_mm"] else FIRST
        assert found["first"] == pytest.approx(truth["first"], abs=allowed)
        if "depth" in truth and "depth" in found:
            assert found["depth"] == pytest.approx(truth["depth"], abs=DEPTH_MM + truth["depth_error"])
    for key in ("distance", "self_distance"):
        if key in found and truth.get(key) is not None:
            low, high = truth[f"{key}_bracket"]
            room = DISTANCE_MM + DISTANCE_SHARE * high
            assert low - room <= found[key] <= high + room


def test_what_is_found_can_be_written() -> None:
    """Answers are plain numbers: the script beside the data writes them as JSON."""
    case = next(case for case in CASES["cases"] if case["truth"]["collides"])
    assert json.loads(json.dumps(answer(case, CASES["robots"])))["collides"] is True
