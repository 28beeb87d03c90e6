"""`signals:` and `m_codes:` of a cell: what is read, and who receives it."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.language import settings_of_cell
from gcodesim.cell.loader import read_cell
from gcodesim.cell.show import cell_as_text
from gcodesim.diagnostics import SourceText

EXTRUDER = "tools: {1: {type: extruder, bead_width: 2, bead_height: 1}}\n"
MILL = "tools: {1: {type: flat_end_mill, diameter: 6}}\n"


def loaded(text: str):  # type: ignore[no-untyped-def]
    return read_cell(SourceText("cell.yaml", f"gcodesim: 1\nmachine: gantry_xyz\n{text}".encode()), Path("cell.yaml"))


def codes(text: str) -> list[tuple[str, int]]:
    return [(finding.code, finding.span.line) for finding in loaded(text).findings]


def test_words_are_read_and_shown() -> None:
    cell = loaded(MILL.replace("1:", "2:") + "signals: {spindle: {word: m67 e01, per: 60 rpm}}\n").cell
    assert cell is not None
    source = cell.channels["main"].signals["spindle"]
    assert source.word.text == "M67 E1" and source.factor == pytest.approx(6.283185307)
    again = read_cell(SourceText("cell.yaml", cell_as_text(cell).encode()), Path("cell.yaml"))
    assert again.cell is not None and again.cell.channels["main"].signals == cell.channels["main"].signals


def test_what_is_wired_is_no_longer_skipped() -> None:
    cell = loaded(EXTRUDER + "signals: {active: {word: M62 P1}}\ninputs: {P0: {output: E2}}\n").cell
    assert cell is not None
    assert settings_of_cell(cell)[0].wired == {"P1", "E2"}
    cell = loaded(EXTRUDER + "signals: {active: {word: M10/M11}}\n").cell
    assert cell is not None
    actions = settings_of_cell(cell)[0].m_codes
    assert {code: (action.target, action.verb) for code, action in actions.items()} == {
        "M10": ("active", "on"),
        "M11": ("active", "off"),
    }


@pytest.mark.parametrize(
    ("text", "code", "message", "hint"),
    [
        ("signals: {spindel: {word: S}}", "GS712", "no tool of this cell reads a signal `spindel`", "`spindle`"),
        ("signals: {spindle: {word: S, per: 1 W}}", "GS709", "the signal `spindle` is in rad/s", "rpm"),
        ("signals: {spindle: {word: S, per: 1}}", "GS708", "`per` is 1 without a unit", "write for example `1 rad/s`"),
        ("signals: {spindle: {word: S, per: 0 rpm}}", "GS710", "it must not be 0", ""),
        ("signals: {spindle: {word: S, per: fast}}", "GS707", "a quantity in a unit of the signal", ""),
        ("signals: {spindle: {word: M2}}", "GS711", "which gives no signal", ""),
        ("signals: {spindle: {per: 1 rpm}}", "GS705", "lacks `word`", ""),
        ("m_codes: {M10: {tool: activate}}", "GS735", "M10 does `tool: activate`, and nothing", "add the tool"),
        ("m_codes: {M62 P1: {gripper: close}}", "GS735", "M62 P1 does `gripper: close`", "no tool of this cell"),
        ("m_codes: {M10: {griper: close}}", "GS711", "an M-code cannot act on `griper`", "did you mean `gripper`?"),
        ("m_codes: {M10: {gripper: shut}}", "GS711", "", ""),
    ],
)
def test_what_nobody_takes_is_told(text: str, code: str, message: str, hint: str) -> None:
    (finding,) = loaded(f"{MILL}{text}\n").findings
    assert (finding.code, finding.span.line) == (code, 4)
    assert message in finding.message and hint in finding.hint


def test_actions_reach_the_tool_that_declares_them() -> None:
    activate = "m_codes: {M10: {tool: activate}, M11: {gripper: close}}\n"
    (finding,) = loaded(EXTRUDER + activate).findings
    assert (finding.code, finding.span.line) == ("GS735", 4)
    assert "tools of this cell receive `tool: activate`, `tool: deactivate`" in finding.hint


def test_channels_say_it_at_their_own_place() -> None:
    text = "channels:\n  main:\n    m_codes:\n      M10: {tool: activate}\n"
    assert codes(MILL + text) == [("GS735", 7)]


def test_nothing_is_said_when_tools_could_not_be_read() -> None:
    broken = "tools: {1: {type: extruder, bead_width: 2}}\n"
    assert codes(broken + "m_codes: {M10: {tool: activate}}\n") == [("GS705", 3)]
