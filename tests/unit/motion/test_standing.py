"""How long the machine stands for its spindle, tools and devices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.motion.standing import Standstill
from gcodesim.simulation import check, prepare

CELL = """gcodesim: 1
machine: gantry_xyz
tools: {1: {type: flat_end_mill, diameter: 3}, 2: {type: drill, diameter: 3}}
MORE
"""
DOOR = "devices: {door: {box: [20, 60, 40], xyz: [-900, 0, 0], WORD, travel: [0, 60, 0], travel_time: 1.5 s}}"


def times(program: str, more: str) -> dict[str, Any]:
    loaded = read_cell(SourceText("cell.yaml", CELL.replace("MORE", more).encode()), Path("cell.yaml"))
    assert loaded.cell is not None, [finding.message for finding in loaded.findings]
    job = prepare(SourceText("a.ngc", ("G21 G90\n" + program + "M2\n").encode()), loaded)
    return dict(check(job).as_json()["time"])


@pytest.mark.parametrize(
    ("before", "after", "seconds"),
    [(0, 100, 1), (100, 0, 0.5), (50, 100, 0.5), (100, 50, 0.25), (-100, 100, 1.5), (0, -100, 1), (80, 80, 0)],
)
def test_a_spindle_takes_its_time(before: float, after: float, seconds: float) -> None:
    assert Standstill(run_up=0.01, run_down=0.005).spindle_time(before, after) == pytest.approx(seconds)


def test_each_change_of_speed_counts_in_a_program() -> None:
    spindle = "spindle: {run_up: 2 s, run_down: 1 s, speed: 10000 rpm}"
    program = "S5000 M3\nG0 X10\nS10000\nG0 X20\nM4\nG0 X30\nM5\n"
    told, untold = times(program, spindle), times(program, "")
    assert told["spindle_s"] == pytest.approx(1.0 + 1.0 + (1.0 + 2.0) + 1.0)
    assert "spindle_s" not in untold
    assert told["total_s"] == pytest.approx(untold["total_s"] + told["spindle_s"])
    assert times("S5000 M3\nM2\n", spindle)["spindle_s"] == pytest.approx(1.5)  # M2 stops it


def test_times_count_to_the_greatest_speed_of_the_cell() -> None:
    more = "spindle: {run_up: 2 s}\nlimits: {spindle_speed: 8000 rpm}"
    assert times("S4000 M3\nM5\n", more)["spindle_s"] == pytest.approx(1.0)
    loaded = read_cell(SourceText("cell.yaml", CELL.replace("MORE", "spindle: {run_up: 2 s}").encode()), Path("c.yaml"))
    assert [finding.code for finding in loaded.findings] == ["GS705"]


@pytest.mark.parametrize(
    ("word", "program"),
    [("word: M64 P3", "M64 P3\nG0 X5\nM65 P3\n"), ("word: M10/M11", "M10\nG0 X5\nM11\n")],
)
def test_devices_are_awaited_where_the_cell_says_so(word: str, program: str) -> None:
    assert times(program, DOOR.replace("WORD", word + ", awaited: true"))["devices_s"] == pytest.approx(3.0)
    assert "devices_s" not in times(program, DOOR.replace("WORD", word))


def test_tool_changes_stand_apart() -> None:
    more = "magazine: {change_time: 4 s}\nspindle: {run_up: 2 s, run_down: 1 s, speed: 10000 rpm}"
    found = times("T1 M6\nS10000 M3\nG0 X1\nM5\nT2 M6\nG4 P1.5\n", more)
    assert (found["tool_change_s"], found["spindle_s"], found["dwell_s"]) == (8.0, 3.0, 1.5)
