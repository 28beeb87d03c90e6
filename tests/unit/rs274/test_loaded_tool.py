"""The tool that stands in the spindle before the first block."""

from __future__ import annotations

import pytest

LENGTHS = {1: 0.05, 2: 0.0625}
MOVES = "G21 G90\nG1 X1 Z-1 F100\n"


@pytest.mark.parametrize("dialect", ["grbl", "linuxcnc", "fanuc"])
def test_it_is_there_with_its_length_before_the_first_block(program, dialect) -> None:
    done = program(MOVES + "M2\n", dialect=dialect, loaded_tool=2, auto_length=LENGTHS)

    kinds = [event["kind"] for event in done.events]
    assert kinds.index("tool_number") < kinds.index("line")
    assert [event["tool"] for event in done.acts("tool_number")] == [2]
    assert [event["offset"][2] for event in done.acts("tool_offset")] == [62.5]
    assert done.ends == [[1, 0, -1]] and not done.errors
    assert [f.code for f in done.findings] == ["GS195"] and "T2" in done.findings[0].message


@pytest.mark.parametrize("dialect", ["grbl", "linuxcnc", "fanuc"])
def test_g49_takes_no_length_away_that_was_touched_off(program, dialect) -> None:
    done = program("G49\n" + MOVES + "M2\n", dialect=dialect, loaded_tool=1, auto_length=LENGTHS)

    assert done.acts("tool_offset")[-1]["offset"][2] == 50.0
    assert not done.errors


def test_a_program_that_says_g43_has_no_length_before_it(program) -> None:
    done = program(MOVES + "G43 H1\nX2\nM2\n", loaded_tool=1, auto_length=LENGTHS)

    assert [(e["kind"], e.get("offset", [0, 0, 0])[2]) for e in done.acts("line", "tool_offset")] == [
        ("line", 0),
        ("tool_offset", 50.0),
        ("line", 0),
    ]


def test_strict_assumes_nothing(program) -> None:
    done = program(MOVES + "M2\n", loaded_tool=1, auto_length=LENGTHS, tool_length="strict")

    assert not done.acts("tool_offset") and not done.findings


def test_without_one_the_spindle_is_empty(program) -> None:
    assert not program(MOVES + "M2\n", auto_length=LENGTHS).acts("tool_number", "tool_offset")


@pytest.mark.parametrize("dialect", ["fanuc", "linuxcnc"])
def test_h0_of_a_fanuc_takes_no_length_away_that_was_touched_off(program, dialect) -> None:
    """There G43 H0 is no length; LinuxCNC takes that of the tool in the spindle, which is said once more."""
    done = program("G43 H0 (not H2)\n" + MOVES + "M2\n", dialect=dialect, loaded_tool=2, auto_length=LENGTHS)

    assert done.acts("tool_offset")[-1]["offset"][2] == 62.5
    assert ("GS195" in [f.code for f in done.findings]) == (dialect == "fanuc")
    assert not done.errors


def test_h0_counts_nothing_beside_a_length(program) -> None:
    done = program("G43 H0\nG1 Z1 F100\nG43 H1\n" + MOVES + "M2\n", dialect="fanuc", loaded_tool=2, auto_length=LENGTHS)

    assert [event["offset"][2] for event in done.acts("tool_offset")][-2:] == [0.0, 50.0]
