"""How far the control of a cell sees."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.motion.look_ahead import LookAhead
from gcodesim.shop import open_shop
from gcodesim.simulation import prepare

MILL = """gcodesim: 1
machine: {model: gantry_xyz}
"""
ARM = """gcodesim: 1
robots: {arm: {model: ur10e}}
"""


def seen(text: str) -> LookAhead | None:
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))
    assert loaded.cell is not None, [finding.message for finding in loaded.findings]
    return open_shop(loaded.cell).look_ahead


@pytest.mark.parametrize(
    ("cell", "wanted"),
    [
        (MILL, LookAhead(blocks=50, corners_count=True)),
        (MILL + "look_ahead: 200\n", LookAhead(blocks=200, corners_count=True)),
        (MILL + "look_ahead: unlimited\n", None),
        (MILL + "dialect: grbl\n", LookAhead(blocks=14)),
        (MILL + "dialect: fanuc\n", None),
        (MILL + "dialect: fanuc\nlook_ahead: 40\n", LookAhead(blocks=40)),
        (ARM, None),
        (ARM + "look_ahead: 20\n", LookAhead(blocks=20, corners_count=True)),
    ],
)
def test_the_cell_says_how_far_else_the_control_as_it_is_delivered(cell: str, wanted: LookAhead | None) -> None:
    assert seen(cell) == wanted


@pytest.mark.parametrize(("value", "code"), [("1", "GS710"), ("far", "GS707"), ("2.5", "GS707")])
def test_what_is_no_number_of_blocks_is_a_finding(value: str, code: str) -> None:
    loaded = read_cell(SourceText("cell.yaml", f"{MILL}look_ahead: {value}\n".encode()), Path("cell.yaml"))
    assert [finding.code for finding in loaded.findings] == [code]


def test_a_program_of_short_blocks_takes_longer_where_few_are_known() -> None:
    """Blocks of 0.2 mm: over 5 and a half of them 3 m/s² end sqrt(2 a d) = 0.081 m/s; 0.2 m/s are commanded."""
    blocks = "".join(f"G1 X{0.2 * k:.1f} F12000\n" for k in range(1, 501))
    times = []
    for more in ("look_ahead: 5\n", "", "look_ahead: unlimited\n"):
        loaded = read_cell(SourceText("cell.yaml", (MILL + more).encode()), Path("cell.yaml"))
        job = prepare(SourceText("a.ngc", f"G21 G90 G61\n{blocks}M2\n".encode()), loaded)
        assert job.plan is not None
        times.append(job.plan.trajectory.duration)
    assert times[0] == pytest.approx(0.1 / 0.081, rel=0.06)
    assert times[2] == pytest.approx(0.1 / 0.196 + 0.196 / 3.0, rel=0.02)
    # LinuxCNC comes to the last block at 0.024 m/s, as if it were half as long, and not at 0.035
    assert times[1] - times[2] == pytest.approx(0.0032, abs=0.0005)
