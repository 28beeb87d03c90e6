"""Stock whose top is as probed: what the file may look like, what is told about it, and what a cut then takes."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from tests.physics.runs import height_at, run_texts

MM = 1e-3
CELL = """gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: table}}
stock: {min: [0, 0, -10], max: [40, 20, 0], in: table, material: al6082_t6, resolution: 0.5, height_map: points.csv%s}
tools: {1: {type: flat_end_mill, diameter: 10, length: 50}}
"""
SLOPE = "X,Y,Z\n0,0,0\n40,0,-2\n0,20,0\n40,20,-2\n"
FACING = """G21 G90 G61
T1 M6
G43 H1
S8000 M3
G0 X-10 Y5 Z-1
G1 X50 F1000
G0 Z20
Y15
X-10 Z-1
G1 X50
G0 Z20
M5
M2
"""


def faults(folder: Path, points: str, more: str = "") -> list[tuple[str, str]]:
    (folder / "points.csv").write_text(points)
    loaded = read_cell(SourceText("cell.yaml", (CELL % more).encode()), folder / "cell.yaml")
    return [(found.code, found.message) for found in loaded.findings]


def test_facing_takes_what_stands_above(tmp_path: Path) -> None:
    """The top falls by 2 mm over 40: below -1 mm, on its lower half, nothing is taken; the other half is a wedge."""
    (tmp_path / "points.csv").write_text(SLOPE)
    ran = run_texts(FACING, CELL % "", folder=tmp_path)

    assert ran.stock.initial * 1e9 == pytest.approx(40 * 20 * 9.0, rel=1e-3)
    assert ran.stock.removed * 1e9 == pytest.approx(0.5 * 20 * 20 * 1.0, rel=0.01)
    assert height_at(ran, 10.2 * MM, 10.2 * MM) == pytest.approx(-1 * MM, abs=1e-9)
    assert height_at(ran, 30.25 * MM, 10.2 * MM) == pytest.approx(-30.25 / 20 * MM, abs=0.02 * MM)


def test_points_may_come_in_any_order_and_with_more_columns(tmp_path: Path) -> None:
    """As LinuxCNC logs a probe: nine numbers a line, there and back along the rows; in inches."""
    lines = [
        f"{x / 25.4} {y / 25.4} {z / 25.4} 0 0 0 0 0 0"
        for x, y, z in ((40, 20, -2), (0, 20, 0), (0, 0, 0), (40, 0, -2))
    ]
    (tmp_path / "points.csv").write_text("\n".join(lines))
    ran = run_texts(FACING, CELL % ", unit: in", folder=tmp_path)

    assert ran.stock.initial * 1e9 == pytest.approx(40 * 20 * 9.0, rel=1e-3)


@pytest.mark.parametrize(
    ("points", "more", "code", "says"),
    [
        ("", "", "GS714", "0 points"),
        ("0 0 0\n1 0 0\n", "", "GS714", "two by two"),
        (SLOPE + "20,10,0\n", "", "GS714", "no grid of 3 by 3"),
        (SLOPE + "0,0,0\n", "", "GS714", "no grid"),
        (SLOPE + "oops\n", "", "GS714", "line 6"),
        (SLOPE.replace("-2", "-12"), "", "GS710", "underside"),
        (SLOPE, ", cylinder: [10, 10]", "GS719", ""),
    ],
)
def test_what_is_no_map_is_told(tmp_path: Path, points: str, more: str, code: str, says: str) -> None:
    told = faults(tmp_path, points, more)

    assert told
    assert told[0][0] == code
    assert says in told[0][1]
