"""Where the time goes by operation and tool, and how fast feed moves run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import check, prepare, run

CELL = """gcodesim: 1
machine:
  axes:
    X: {travel: [-500, 500 mm], speed: 10 m/min, acceleration: 1 m/s^2}
    Y: {travel: [-500, 500 mm], speed: 10 m/min, acceleration: 1 m/s^2}
    Z: {travel: [-500, 500 mm], speed: 10 m/min, acceleration: 1 m/s^2}
tools: {1: {type: flat_end_mill, diameter: 6}, 2: {type: drill, diameter: 5, name: the drill}}
magazine: {change_time: 3 s}
"""
HEAD = "(A plate)\n(made by hand)\nG21 G90 G17 G61.1\n"


def results(program: str) -> dict[str, Any]:
    loaded = read_cell(SourceText("cell.yaml", CELL.encode()), Path("cell.yaml"))
    return check(prepare(SourceText("a.ngc", (HEAD + program).encode()), loaded)).as_json()


def test_comments_and_tool_changes_begin_operations() -> None:
    found = results(
        "(Pocket)\nT1 M6\nG0 X10 Z5\nG1 Z0 F600\n(MSG, hello)\nX40\n"
        "(finish operation: Pocket)\n(Begin operation: Contour)\n(Path: Contour)\nG0 Z5\nG1 Z0\nX50\n"
        "G0 Z10\nT2 M6\nG0 X20\nG1 Z-5 F200\nG4 P2\nM2\n"
    )["operations"]
    assert [one["name"] for one in found] == ["Pocket", "Contour", "the drill"]
    assert [one["tool"] for one in found] == [1, 1, 2]
    assert [(one["first_line"], one["last_line"]) for one in found] == [(6, 9), (13, 16), (18, 19)]
    assert [one["feed_mm"] for one in found] == [35.0, 15.0, 15.0]


def test_times_add_up_to_the_whole() -> None:
    whole = results("(One)\nT1 M6\nG1 X40 F600\n(Two)\nX80\nG4 P2\nT2 M6\nX90\nM2\n")
    assert sum(one["time_s"] for one in whole["operations"]) == pytest.approx(whole["time"]["total_s"], abs=1e-6)
    assert [one["name"] for one in whole["operations"]] == ["One", "Two", "the drill"]


def test_mean_least_and_share_are_those_of_the_time_law() -> None:
    """40 mm at 100 mm/s with 1 m/s²: 0.1 s up, 0.3 s at the feed, 0.1 s down."""
    one = results("(Cut)\nT1 M6\nG1 X40 F6000\nG0 X0\nM2\n")["operations"][0]
    assert one["mean_feed_mm_min"] == pytest.approx(60.0 * 40.0 / 0.5)
    assert one["least_feed_mm_min"] == pytest.approx(0.0)
    assert one["share_at_feed"] == pytest.approx((0.3 + 2 * 0.001) / 0.5)  # reached from 99 % on
    assert one["rapid_mm"] == pytest.approx(40.0)
    tool = results("T1 M6\nG1 X40 F6000\nG0 X0\nM2\n")["tools"][0]
    assert {key: tool[key] for key in ("mean_feed_mm_min", "share_at_feed")} == pytest.approx(
        {key: one[key] for key in ("mean_feed_mm_min", "share_at_feed")}
    )


def test_passes_of_a_loop_belong_to_their_operation() -> None:
    found = results("T1 M6\no1 repeat [3]\n(Pass)\nG1 X10 F600\nG1 X0\no1 endrepeat\n(Last)\nG1 X5\nM2\n")["operations"]
    assert [one["name"] for one in found] == ["Pass", "Last"]
    assert found[0]["feed_mm"] == pytest.approx(60.0)


def test_a_program_without_feed_has_none() -> None:
    assert results("G0 X10\nM2\n")["operations"] == []


def test_the_share_in_the_air_is_that_of_feed_moves_beside_the_stock() -> None:
    """Of 40 mm at a constant feed the tool, 6 mm wide, cuts in 10 mm of stock for 13; a check does not know."""
    stock = "stock: {box: [10, 40, 5], zero: top-left-center, in: cell, material: brass, resolution: 0.5}\n"
    more = "frames: {cell: {in: world, xyz: [0, 0, 0]}}\nwork_offsets: {G54: {in: cell}}\n"
    program = "(Cut)\nT1 M6\nS1000 M3\nG0 X-15 Z0\nG1 Z-1 F6000\nX25 F60\nG0 Z9\nM2\n"
    loaded = read_cell(SourceText("cell.yaml", (CELL + more + stock).encode()), Path("cell.yaml"))
    job = prepare(SourceText("a.ngc", (HEAD + program).encode()), loaded)
    assert check(job).as_json()["operations"][0]["air_share"] is None

    ran = run(prepare(SourceText("a.ngc", (HEAD + program).encode()), loaded), None)[0].as_json()
    assert ran["operations"][0]["air_share"] == pytest.approx(27.0 / 40.0, abs=0.02)
    assert ran["tools"][0]["air_share"] == ran["operations"][0]["air_share"]


@pytest.mark.parametrize(("density", "kilograms", "pure"), [("", 8.96, "copper"), (", density: 8.4 g/cm^3", 8.4, "")])
def test_what_is_left_has_a_mass(density: str, kilograms: float, pure: str) -> None:
    """40 x 20 x 10 mm of brass weigh as much copper, unless the cell knows better; wood has a centre but no mass."""
    stock = f"stock: {{box: [40, 20, 10], zero: top-center, in: cell, material: brass{density}, resolution: 0.5}}\n"
    more = "frames: {cell: {in: world, xyz: [0, 0, 0]}}\nwork_offsets: {G54: {in: cell}}\n"
    found = []
    for material in ("brass", "beech"):
        text = CELL + more + stock.replace("brass", material)
        loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))
        ran = run(prepare(SourceText("a.ngc", (HEAD + "G0 Z50\nM2\n").encode()), loaded), None)[0]
        found.append(ran.as_json()["stocks"]["stock"]["body"])
    metal, wood = found

    assert metal["mass_kg"] == pytest.approx(8e-3 * kilograms)
    assert (metal["density_of"], wood["density_of"]) == (pure, "")
    assert metal["center_mm"] == wood["center_mm"] == pytest.approx([0.0, 0.0, -5.0], abs=1e-9)
    assert metal["inertia_kg_mm2"][2] == pytest.approx([0.0, 0.0, 8e-3 * kilograms * 2000.0 / 12.0], abs=1e-6)
    assert (wood["mass_kg"] is None) == (not density)
