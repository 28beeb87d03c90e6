"""Grbl 1.1: what it accepts means the same as in RS274, the rest is an error."""

import pytest


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
