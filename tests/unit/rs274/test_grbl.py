"""Grbl 1.1: what it accepts means the same as in RS274, the rest is an error."""

import pytest

from gcodesim.diagnostics import Severity


@pytest.fixture
def grbl(program):
    return lambda text, **settings: program(text, dialect="grbl", **settings)


def test_starts_in_g0_and_needs_no_end(grbl):
    done = grbl("X1\nG1Y2F100\n/G0Z1\n", block_delete=True)

    assert done.ends == [[1, 0, 0], [1, 2, 0], [1, 2, 1]]
    assert not done.findings


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("$H", "GS001"),
        ("% G0", "GS001"),
        ("G0 X1 !", "GS001"),
        ("#1=2", "GS001"),
        ("G0 X[1+1]", "GS004"),
        ("o1 call", "GS008"),
        ("G81 Z-1 R1 F1", "GS012"),
        ("G43 H1", "GS012"),
        ("M6", "GS013"),
        ("G0 A1", "GS001"),
        ("G2 X1 I1 P2 F10", "GS104"),
        ("G10 L2 P7 X1", "GS106"),
        ("G10 L10 P1 Z1", "GS105"),
        ("G43.1 X1", "GS106"),
        ("G1 X1.00000" + "0" * 80 + " F1", "GS002"),
    ],
)
def test_what_it_does_not_know_is_an_error(grbl, line, code):
    done = grbl(f"G21\n{line}\n")

    assert [(f.code, f.span.line) for f in done.errors] == [(code, 2)]


def test_blanks_and_comments_do_not_count_for_the_length(grbl):
    assert not grbl("G0 X1 (" + "long " * 20 + ")\n").findings


def test_signs_beside_a_comment(grbl):
    assert grbl("G0 X-1 (left) Y+2\n").ends == [[-1, 2, 0]]


def test_a_percent_sign_of_its_own_is_what_senders_leave_out(grbl):
    done = grbl("%\nG0 X1\n%\nG0 X2\n")

    assert done.ends == [[1, 0, 0], [2, 0, 0]]
    assert [(f.code, f.level.word, f.span.line, f.count) for f in done.findings] == [("GS001", "warning", 1, 2)]


def test_centre_words_outside_the_plane_are_passed_over(grbl):
    assert grbl("G1 X1 F100\nG2 X3 I1 J0 K0\nG18 G2 X1 I-1 J5 K0\n").ends == [[1, 0, 0], [3, 0, 0], [1, 0, 0]]
    assert [f.code for f in grbl("G1 X1 F100\nG2 X3 K0\n").errors] == ["GS112"]
    assert [f.code for f in grbl("G1 X1 F100\nG2 X3 R2 K0\n").errors]


def test_g92_1_takes_the_shift_away(grbl):
    done = grbl("G0 X5\nG92 X0\nG0 X1\nG92.1\nG0 X1\n")

    assert done.ends == [[5, 0, 0], [6, 0, 0], [1, 0, 0]]


def test_g53_is_absolute_under_g91(grbl):
    assert grbl("G10 L2 P1 X10\nG91\nG0 X5\nG53 G0 X3\n").ends == [[5, 0, 0], [3, 0, 0]]


def test_m1_does_not_stop(grbl):
    done = grbl("G0 X1\nM1\nG0 X2\n", optional_stop=True)

    assert not done.acts("optional_stop", "stop")
    assert [(f.code, f.level.word, f.span.line) for f in done.findings] == [("GS194", "warning", 2)]


@pytest.mark.parametrize("line", ["G0 (a (b) X1", "G0 / X1", "/ G0 X1 (;)"])
def test_what_it_passes_over(grbl, line):
    done = grbl(f"{line}\nG0 Y2\n")

    assert done.ends == [[1, 0, 0], [1, 2, 0]]
    assert not done.findings


def test_a_comment_that_is_left_open_swallows_its_line_and_is_told(grbl):
    """As in `protocol.c` of Grbl 1.1: the flag of a comment is cleared at the end of the line."""
    done = grbl("G0 X1 (left open Y5\n(closed) G0 Y2 ; (no comment\n")

    assert done.ends == [[1, 0, 0], [1, 2, 0]]
    assert [(f.code, f.level.word, f.span.line, f.span.column, f.span.end_column) for f in done.findings] == [
        ("GS003", "warning", 1, 7, 20)
    ]


def test_a_comment_ends_at_its_first_bracket(grbl):
    assert [f.code for f in grbl("G0 X1 (a (b) c)\n").errors] == ["GS004"]


@pytest.mark.parametrize("line", ["G2 I5", "G2 Z1 I5", "G2 R5"])
def test_an_arc_names_an_axis_of_its_plane(grbl, line):
    done = grbl(f"G1 X1 F100\n{line}\n")

    assert [(f.code, f.span.line) for f in done.errors] == [("GS103" if "Z" not in line else "GS110", 2)]


def test_a_modal_arc_does_not_go_on_by_its_centre_alone(grbl):
    assert [(f.code, f.span.line) for f in grbl("G2 X0 I5 F100\nI5\n").errors] == [("GS104", 2)]


def test_an_arc_may_end_five_micrometres_off_its_circle(grbl):
    assert not grbl("G1 X10 F100\nG2 X-10.004 I-10\n").errors
    assert [f.code for f in grbl("G1 X1 F100\nG2 X-1.006 I-1\n").errors] == ["GS111"]
    assert not grbl("G1 X10 F100\nG2 X-10.009 I-10\n").errors  # within 0.1 % of the radius


@pytest.mark.parametrize(
    ("line", "end"),
    [("G3 X1 I0 J0", (1, 0, 0)), ("G2 X1.004 Z-2 I0", (1.004, 0, -2)), ("G3 X1.004 I.001", (1.004, 0, 0))],
)
def test_an_arc_around_its_own_start_is_a_straight_line(grbl, line, end):
    """`mc_arc` of Grbl 1.1h finds no segment in a circle without radius, and ends with the line to the target."""
    done = grbl(f"G1 X1 F100\n{line}\n")

    assert [(f.code, f.severity, f.span.line) for f in done.findings] == [("GS112", Severity.WARNING, 2)]
    assert done.ends == [[1, 0, 0], pytest.approx(end)]


def test_an_arc_that_ends_beside_a_centre_at_its_start_is_refused(grbl):
    assert [f.code for f in grbl("G1 X1 F100\nG2 X1.006 I0\n").errors] == ["GS112"]


@pytest.mark.parametrize(("line", "code"), [("G4 P-2", "GS106"), ("G10 L2 P1", "GS103")])
def test_dwell_and_offsets_without_sense(grbl, line, code):
    assert [f.code for f in grbl(line + "\n").errors] == [code]
