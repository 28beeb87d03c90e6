"""Plane, units and way of counting, from the text of a program."""

from gcodesim.report.modes import modes_of


def at(changes, line):
    """The words that hold at a line."""
    return [words for first, words in changes if first <= line][-1]


def test_words_hold_from_their_line_on():
    changes = modes_of({"a.nc": ["G21 G90 (G20)", "G1 X1", "g91 G18 ; G19", "G90.1 G1 X2", "G017 G90"]})["a.nc"]

    assert at(changes, 1) == ["G21", "G90"] and at(changes, 2) == ["G21", "G90"]
    assert at(changes, 4) == ["G18", "G21", "G91"]
    assert at(changes, 5) == ["G17", "G21", "G90"]


def test_where_a_program_jumps_only_what_never_changes_is_said():
    lines = ["G21 G90", "o1 while [#1 LT 3]", "G91 G1 X1", "o1 endwhile", "G90"]
    assert at(modes_of({"a.nc": lines})["a.nc"], 4) == ["G21"]

    files = {"a.nc": ["G20 G17", "M98 P1"], "b.nc": ["G1 X1", "G18"]}
    assert at(modes_of(files)["b.nc"], 1) == at(modes_of(files)["a.nc"], 2) == ["G20"]
    assert modes_of({"a.nc": ["G1 X1"]}) == {"a.nc": [(1, [])]}
