"""A stock that is too coarse for a tool says so; one that is fine enough for its tools does not."""

from __future__ import annotations

import pytest

from tests.physics.runs import run_texts

PROGRAM = "G21 G90\nT1 M6\nS9000 M3\nG0 X0 Y5 Z5\nG1 Z-1 F200\nG1 X60 F600\nG0 Z5\nM5\nM2\n"
CELL = """
gcodesim: 1
machine: gantry_xyz
stock: {{box: [60, 30, 10], zero: top-front-left, resolution: {resolution}}}
tools: {{1: {{type: flat_end_mill, diameter: 3}}, 2: {{type: flat_end_mill, diameter: 1}}}}
"""


@pytest.mark.parametrize(("resolution", "codes"), [("1.5", []), ("1.6", ["GS412"]), ("100", ["GS412"])])
def test_two_columns_across_every_cutter_that_feeds(resolution: str, codes: list[str]) -> None:
    ran = run_texts(PROGRAM, CELL.format(resolution=resolution))
    assert [finding.code for finding in ran.bad] == codes
