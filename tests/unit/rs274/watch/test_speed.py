"""GS176 of a spindle that is started without a speed, or never."""

import pytest

CUT = "G0 Z5\nG1 Z-1 F100\nX10\nG0 Z5\n"


def notes(program, text, **settings):
    done = program(text + "M2", **settings)
    assert not done.errors
    return [(f.level.word, f.span.line) for f in done.findings if f.code == "GS176"]


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_m3_without_s(program, lane):
    assert notes(program, "M3\n" + CUT, lane=lane) == [("warning", 1)]
    assert notes(program, "M3\nG0 Z5\nS8000\nG1 Z-1 F100\nM5\n", lane=lane) == []
    assert notes(program, "M3 S0\n" + CUT, lane=lane) == []  # a laser that is switched by S


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_m3_may_switch_a_tool_that_no_spindle_turns(program, lane):
    cell = {"has_cell": True, "unturned": frozenset((1,))}
    assert notes(program, "T1 M6\nM3\n" + CUT, lane=lane, **cell) == []
    assert notes(program, "M3\n" + CUT, lane=lane, **cell, loaded_tool=1) == []
    assert notes(program, "T1 M6\nM3\n" + CUT + "T2 M6\nM3\n" + CUT, lane=lane, **cell) == [("warning", 8)]


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_a_program_that_never_starts_a_spindle_and_feeds_below_zero(program, lane):
    assert notes(program, CUT, lane=lane) == [("note", 3)]
    assert notes(program, CUT, lane=lane, has_cell=True) == []
    assert notes(program, "G0 Z5\nG1 Z1 F100\nX10\n", lane=lane) == []
    assert notes(program, "M64 P1\n" + CUT, lane=lane) == []
    assert notes(program, "S8000 M3\n" + CUT, lane=lane) == []
