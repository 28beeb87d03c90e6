"""Removed and deposited volumes of whole runs against exact geometry."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.physics.runs import Ran, run_texts

DATA = Path(__file__).parents[1] / "data" / "physics"
CASES = {case["id"]: case for case in json.loads((DATA / "programs.json").read_text())["cases"]}
ROOT = Path(__file__).parents[2]


def run_case(case: dict, cells: float, rate: int = 250) -> Ran:
    """A case of `programs.json` on a gantry, with `cells` cells across the tool."""
    inputs = case["inputs"]
    stock, diameter = inputs["stock"], inputs["tool"]["diameter_mm"]
    cell = f"""
gcodesim: 1
machine: gantry_xyz
work_offsets: {{G54: {{in: world, xyz: [400, 300, -200]}}}}
stock: {{min: {stock["min_mm"]}, max: {stock["max_mm"]}, in: G54, material: al6082_t6, resolution: {diameter / cells}}}
tools:
  1: {{type: {inputs["tool"]["type"]}_end_mill, diameter: {diameter}, length: 60}}
simulation: {{rate: {rate} Hz}}
"""
    return run_texts(inputs["gcode"], cell)


@pytest.mark.parametrize("name", sorted(CASES))
def test_removed_volume_of_a_program(name: str) -> None:
    """V-PRG: within the tolerance of the case and within the printed bound, better on a finer grid."""
    case = CASES[name]
    want = case["expected"]["removed_mm3"]
    errors = []
    for cells in (20, 40):
        ran = run_case(case, cells)
        stock = ran.stock
        removed = stock.removed * 1e9
        errors.append(abs(removed - want["value"]))
        assert errors[-1] <= want["rel"] * want["value"]
        assert errors[-1] <= stock.error_bound * 1e9
        assert stock.removed == pytest.approx(stock.initial - stock.remaining, rel=1e-9)
        assert not ran.bad
    assert errors[1] < errors[0] or errors[1] < 1e-6 * want["value"]


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_rate_of_steps_moves_no_volume(name: str) -> None:
    slow, fast = (run_case(CASES[name], 20, rate).stock.removed for rate in (250, 1000))
    assert slow == pytest.approx(fast, rel=1e-3)
