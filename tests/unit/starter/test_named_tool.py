"""Tools of a first cell that cut no chips."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.starter.first_cell import cell_for

BODY = b"T1 M6\nG0 X0 Y0\nG1 X50 F600\nM30\n"


def tool_for(comment: str):
    """The tool of the cell that is made, whole: its kind of tool and the cell's text."""
    text = cell_for(SourceText("x.nc", f"({comment})\n".encode() + BODY))
    loaded = read_cell(SourceText("cell.yaml", text), Path("cell.yaml"))
    assert loaded.cell is not None and [f.code for f in loaded.findings] == [], text.decode()
    return loaded.cell.tools[1], text.decode()


@pytest.mark.parametrize(
    ("comment", "kind"),
    [
        ("T1 extruder", "extruder"),
        ("T1 MIG torch 1.2 mm wire", "welding_torch"),
        ("T1 plasma torch", "plasma"),
        ("T1 laser 10 W", "laser"),
        ("T1 waterjet nozzle", "jet"),
        ("T1 spray gun", "spray_gun"),
        ("T1 sandblasting lance", "sand_blaster"),
        ("T1 suction gripper", "suction_gripper"),
        ("T1 gripper 2 fingers", "finger_gripper"),
        ("T1 inspection camera", "camera"),
        ("T1 drag knife", "drag_knife"),
        ("T1 probe 3 mm", "probe"),
    ],
)
def test_a_tool_that_is_no_mill_becomes_none(comment: str, kind: str) -> None:
    tool, _ = tool_for(comment)
    assert tool.kind == kind


@pytest.mark.parametrize("comment", ["T1 end mill 6 mm for the camera housing", "T1 spray cooled drill 6 mm"])
def test_a_mill_stays_one(comment: str) -> None:
    tool, _ = tool_for(comment)
    assert tool.kind in ("flat_end_mill", "drill") and tool.diameter == pytest.approx(6e-3)


def test_an_extruder_has_the_bead_and_the_switches_that_its_comment_tells() -> None:
    tool, text = tool_for("T1 extruder, bead 8 x 4 mm, M10 and M11 switch its pump")
    assert (tool.bead_width, tool.bead_height) == pytest.approx((8e-3, 4e-3))
    assert "m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}" in text
