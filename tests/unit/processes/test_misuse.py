"""Misuse of tools from columns of rows: which events there are, where, and with which numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.processes.misuse import cutter_findings
from gcodesim.processes.rows import Rows
from gcodesim.tools import TOOLS

MM3 = 1e-9
SHAPE = {"rapid": bool, "changed": bool, "retreat": bool, "tool": np.int64, "setting": np.int64, "time": float}
WRITTEN = (
    "removed", "rapid_cut", "rapid_bound", "rapid_depth", "stopped_cut", "reversed_cut", "shank_depth", "holder_depth",
    "inside",
)  # fmt: skip


def line_of(row: int) -> Span:
    return Span("part.nc", row + 1, 1)


def use(n: int, words: dict[int, str] | None = None, **columns: Any) -> Rows:
    """n rows in which nothing is wrong, but for the columns given as {row: value} or arrays; `words` by row."""
    filled = {}
    for name in (*SHAPE, *WRITTEN):
        column = np.zeros(n, dtype=SHAPE.get(name, float))
        given = columns.pop(name, {})
        if name == "tool":
            column[:] = 1
        if isinstance(given, dict):
            for row, value in given.items():
                column[row] = value
        else:
            column[:] = given
        filled[name] = column
    said = [(words or {}).get(row, "G1") for row in range(n)]
    return Rows(
        **{name: filled[name] for name in SHAPE},
        columns={name: filled[name] for name in WRITTEN},
        span=columns.pop("span", line_of),
        with_word=lambda some: np.array([word in some for word in said]),
        tools={2: TOOLS["flat_end_mill"](number=2, name="mill", diameter=1e-3, length=1e-3)},
        **columns,
    )


def found(rows: Rows) -> list[Diagnostic]:
    return cutter_findings(rows)


def test_nothing_wrong_nothing_found() -> None:
    assert found(use(5)) == []


def test_a_rapid_that_only_grazes_is_forgiven() -> None:
    rows = use(3, rapid=True, rapid_cut={1: 2 * MM3, 2: 5 * MM3}, rapid_bound=3 * MM3)

    (finding,) = found(rows)

    assert (finding.code, finding.span.line) == ("GS401", 3)
    assert finding.value == pytest.approx(5.0)
    assert finding.limit == pytest.approx(3.0)


def test_two_plunges_are_two_events() -> None:
    rows = use(6, rapid=[1, 1, 0, 1, 1, 1], rapid_cut={0: 9 * MM3, 1: 4 * MM3, 4: 2 * MM3}, time=np.arange(6.0))

    findings = found(rows)

    assert [(f.code, f.span.line, f.count, f.time) for f in findings] == [("GS401", 1, 2, 0.0), ("GS401", 5, 1, 4.0)]
    assert findings[0].value == pytest.approx(13.0)


def test_a_tool_in_stock_at_the_start_and_one_after_a_change() -> None:
    rows = use(8, changed={0: True, 4: True}, tool=[1, 1, 1, 1, 2, 2, 2, 2], inside={0: 0.5, 1: 0.25, 4: 1.0})

    findings = found(rows)

    assert [(f.code, f.span.line) for f in findings] == [("GS402", 1), ("GS403", 5)]
    assert findings[0].value == pytest.approx(0.75)
    assert "mill" in findings[1].message


def test_a_holder_that_rubs_on_over_many_rows_is_one_event_with_its_greatest_depth() -> None:
    """Rows between two passes do not end it; a rapid that leaves does, and so does another tool."""
    rows = use(
        9,
        rapid=[0, 0, 0, 0, 1, 0, 0, 0, 0],
        holder_depth={0: 0.001, 2: 0.003, 5: 0.002, 7: 0.004},
        setting=[0, 0, 0, 0, 0, 0, 0, 1, 1],
    )

    findings = [f for f in found(rows) if f.code == "GS405"]

    assert [(f.span.line, f.count) for f in findings] == [(1, 2), (6, 1), (8, 1)]
    assert [f.value for f in findings] == pytest.approx([3.0, 2.0, 4.0])
    assert "3.000 mm" in findings[0].message


def test_shank_and_spindle_have_their_codes() -> None:
    rows = use(4, shank_depth={0: 0.001}, stopped_cut={2: 7 * MM3}, reversed_cut={3: 8 * MM3})

    assert sorted((f.code, f.span.line) for f in found(rows)) == [
        ("GS404", 1),
        ("GS501", 3),
        ("GS502", 4),
    ]


def test_a_hundred_holes_with_the_spindle_off_have_one_cause() -> None:
    rapid = [i % 2 for i in range(200)]
    rows = use(200, rapid=rapid, stopped_cut=dict.fromkeys(range(0, 200, 2), MM3))

    assert [(f.code, f.span.line, f.count) for f in found(rows)] == [("GS501", 1, 100)]


def test_a_tap_on_its_way_out_cuts_nothing_that_the_grid_could_show() -> None:
    grain = np.full(4, 0.05 * MM3)

    assert not found(use(4, reversed_cut={1: 0.02 * MM3, 2: 0.02 * MM3}, rapid_bound=grain))
    assert [f.code for f in found(use(4, reversed_cut={1: 0.04 * MM3, 2: 0.04 * MM3}, rapid_bound=grain))] == ["GS502"]


def test_the_same_line_in_a_loop_is_told_once() -> None:
    cut = {0: 9 * MM3, 2: 4 * MM3, 4: 5 * MM3}
    rows = use(6, rapid=[1, 0, 1, 0, 1, 0], rapid_cut=cut, span=lambda row: Span("part.nc", 7))

    findings = found(rows)

    assert [(f.code, f.count) for f in findings] == [("GS401", 3)] and findings[0].value == pytest.approx(9.0)


def test_feeding_with_the_spindle_off_is_one_event_until_the_spindle_changes() -> None:
    rows = use(6, stopped_cut=[MM3, 0.0, MM3, MM3, 0.0, MM3], setting=[0, 0, 0, 1, 1, 1])

    findings = found(rows)

    assert [(f.code, f.span.line, f.count) for f in findings] == [("GS501", 1, 2), ("GS501", 4, 2)]
    assert findings[0].value == pytest.approx(2.0)


def test_on_its_way_out_of_a_hole_a_tool_does_no_harm() -> None:
    up = use(3, retreat=True, rapid=[1, 0, 0], rapid_cut={0: MM3}, stopped_cut={1: MM3}, reversed_cut={2: MM3})

    assert found(up) == []


def test_probes_and_left_hand_taps_are_allowed_what_they_do() -> None:
    assert found(use(2, words={0: "G38.2", 1: "G74"}, stopped_cut={0: MM3}, reversed_cut={1: MM3})) == []
    assert [f.code for f in found(use(2, words={0: "G74", 1: "G31"}, stopped_cut={0: MM3}, reversed_cut={1: MM3}))] == [
        "GS501",
        "GS502",
    ]


def test_a_cell_of_the_grid_and_a_rub_of_the_own_wall_are_no_cut() -> None:
    rub = 2e-6 * np.pi * 1e-3 * 1e-3

    assert not found(use(2, rapid=True, rapid_cut={0: 0.9 * MM3}, grain=MM3))
    assert [f.code for f in found(use(2, rapid=True, rapid_cut={0: 1.1 * MM3}, grain=MM3))] == ["GS401"]
    deep = {"tool": 2, "rapid": True, "rapid_depth": 5e-3}
    assert not found(use(2, **deep, rapid_cut={0: 0.9 * rub}))
    assert [f.code for f in found(use(2, **deep, rapid_cut={0: 1.1 * rub}))] == ["GS401"]
    # of its wall no more than is in the stock
    shallow = {**deep, "rapid_depth": 0.1e-3}
    assert not found(use(2, **shallow, rapid_cut={0: 0.09 * rub}))
    assert [f.code for f in found(use(2, **shallow, rapid_cut={0: 0.11 * rub}))] == ["GS401"]


def test_a_cut_while_a_blind_axis_turns() -> None:
    turns = {"A": np.array([0, 1, 1, 1, 0], dtype=bool)}
    (finding,) = found(use(5, removed={0: MM3, 1: 2 * MM3, 2: 3 * MM3}, turns=turns))

    assert (finding.code, finding.span.line, finding.count) == ("GS407", 2, 2)
    assert finding.value == pytest.approx(5.0)
    assert "axis A" in finding.message
