"""Removal by bodies of revolution whose axis has any direction, against closed forms and fine integration."""

from __future__ import annotations

import numpy as np
import pytest

from tests.removal_cases import read_cases, run_case
from tests.slow import some_slow

CASES = {case["id"]: case for case in read_cases()}
GROUPS = sorted({case["group"] for case in CASES.values() if "group" in case})
# the same cut, turned: the first is looked at with the others, all are compared by volume
LOOKED_AT = [name for name, case in CASES.items() if "group" not in case or name.endswith("-30")]


@pytest.mark.parametrize("name", some_slow(LOOKED_AT, "V-v_line", "V-core", "V-turned-engraving-30"))
def test_what_a_tool_sweeps_is_removed(name):
    """Volume, points in and out of material, where rays meet it, and its pieces; cells of the size of the case."""
    case = CASES[name]
    got = run_case(case)
    cell, want = case["resolution"], case["removed"]

    assert got["removed"] == pytest.approx(want["value"], abs=case["tolerance_rel"] * want["value"] + want["error"])
    assert abs(got["removed"] - want["value"]) <= got["bound"] + want["error"]
    for probe, inside in zip(case["probes"], got["inside"], strict=True):
        if probe["clear"] >= max(0.05, cell / 2):
            assert inside == probe["material"], probe
    for ray, entry in zip(case["rays"], got["rays"], strict=True):
        assert entry == pytest.approx(ray["entry"], abs=max(0.01, cell / 2 / ray["cosine"])), ray
    if "pieces" in case:
        assert got["pieces"] == pytest.approx(case["pieces"], rel=0.01)
    stock = got["stock"]
    edges = np.sort(stock.surface(0.0).faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, faces = np.unique(edges, axis=0, return_counts=True)
    assert (faces % 2 == 0).all()  # closed
    assert stock.surface(0.0).volume == pytest.approx(stock.volume, rel=3e-3)  # all edges are bevelled


@pytest.mark.parametrize("group", GROUPS)
def test_stock_and_tool_turned_together_give_the_same(group):
    volumes = [run_case(case, looks=False)["removed"] for case in CASES.values() if case.get("group") == group]
    assert len(volumes) == 4
    assert max(volumes) <= 1.0001 * min(volumes)


@pytest.mark.parametrize("name", ["V-lead_slot", "V-cross_drill", "V-saw", "V-ring_on_bar"])
def test_the_error_falls_nearly_with_the_square_of_the_cell(name):
    """Closed forms; half the cell leaves less than half of the error, by where cells lie about a quarter."""
    case = CASES[name]
    coarse, fine = (run_case(case, case["resolution"] * share, looks=False) for share in (1.0, 0.5))
    exact = case["removed"]["value"]
    assert abs(fine["removed"] - exact) <= max(abs(coarse["removed"] - exact) / 2.2, 2e-4 * exact)
    assert fine["bound"] < 0.4 * coarse["bound"]
    assert abs(fine["removed"] - exact) <= fine["bound"]
