"""Stock out of reach: said where it is certain, never where a tool could still come."""

from __future__ import annotations

from textwrap import dedent

import pytest

from gcodesim.cell import place
from gcodesim.cell.reach import reach_findings
from tests.unit.cell.text import sound

TOOL = "tools: {1: {type: flat_end_mill, diameter: 10, length: 50}}\nstock: {box: [100, 60, 20], in: G54}\n"
GANTRY = "machine: gantry_xyz\n" + TOOL  # X 0 to 1200, Y 0 to 800, Z -400 to 0
ARM = "robots: {arm: {model: kuka_kr10_r1100_2}}\n" + TOOL


def found(text: str) -> list[tuple[str, float | None, float | None]]:
    cell = sound(dedent(text))
    (channel,) = cell.channels
    return [(f.code, f.value, f.limit) for f in reach_findings(cell, channel, place(cell))]


@pytest.mark.parametrize(
    ("xyz", "value", "limit"),
    [
        ("[1206, 0, -100]", 1206, 1205),  # the widest tool reaches 5 mm beyond the travel
        ("[-106, 0, -100]", -6, -5),
        ("[0, -66, -100]", -6, -5),
        ("[0, 0, -471]", -451, -450),  # top of the stock under the longest tool at the lower end of Z
        ("[0, 0, 1]", 1, 0),
    ],
)
def test_stock_beyond_the_travel_of_a_machine(xyz: str, value: float, limit: float) -> None:
    assert found(GANTRY + f"work_offsets: {{G54: {{xyz: {xyz}}}}}") == [
        ("GS734", pytest.approx(value), pytest.approx(limit))
    ]


@pytest.mark.parametrize("xyz", ["[1204, 0, -100]", "[-104, 0, -100]", "[0, -64, -469]", "[0, 0, -19]"])
def test_stock_that_can_just_be_touched(xyz: str) -> None:
    assert found(GANTRY + f"work_offsets: {{G54: {{xyz: {xyz}}}}}") == []


def test_stock_turned_into_reach() -> None:
    """Turned by 90 deg the plate reaches back over its zero, into the travel."""
    offsets = "work_offsets: {G54: {xyz: [1230, 0, -100], rpy: [0, 0, 90]}}"
    assert found(GANTRY + offsets) == []
    assert found(GANTRY + offsets.replace("90", "0"))[0][0] == "GS734"


def test_a_table_that_turns_may_bring_it_near() -> None:
    axes = ", ".join(f"{a}: {{travel: [0, 300], speed: 10 m/min}}" for a in "XYZ")
    table = "C: {travel: unlimited, speed: 90 deg/s, side: table, at: [150, 150, 0]}"
    text = TOOL + "work_offsets: {G54: {xyz: [400, 0, 100]}}\nmachine: {axes: {" + axes
    assert [code for code, _, _ in found(text + "}}")] == ["GS734"]
    assert found(text + f", {table}}}}}") == []


def test_stock_farther_than_an_arm_is_long() -> None:
    """The KR 10 reaches 1.1 m; its links in a row, the flange and a tool of 50 mm are a little more."""
    assert found(ARM + "work_offsets: {G54: {xyz: [1000, 0, 200]}}") == []
    ((code, value, limit),) = found(ARM + "work_offsets: {G54: {xyz: [2000, 0, 200]}}")
    assert code == "GS734" and value is not None and limit is not None
    assert 1900 < value < 2100 and 1100 < limit < 1500


def test_without_tools_there_is_nothing_to_say() -> None:
    assert found("machine: gantry_xyz\nstock: {box: [1, 1, 1], in: G54, xyz: [9000, 0, 0]}") == []
