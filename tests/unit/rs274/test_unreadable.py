"""Slips of the keyboard and of posts: the finding tells what was probably meant."""

from __future__ import annotations

import pytest


@pytest.mark.parametrize(
    ("block", "code", "column", "hint"),
    [
        ("G0 X10,5", "GS001", 7, "write 10.5"),
        ("G0 X,5", "GS004", 4, "write .5"),
        ("G0 X1_0", "GS001", 6, "write 10"),
        ("G0 X1O", "GS001", 6, "digit 0: 10"),
        ("G0 XO5", "GS004", 4, "digit 0: 05"),
        ("GO X5", "GS004", 1, "digit 0"),
        ("G0 X1l Y5", "GS004", 6, "digit 1: 11"),
        ("G0 Xl0", "GS004", 4, "digit 1: X10"),
        ("G0 X1e3", "GS104", 6, "write 1000"),
        ("G0 X1.5E-2", "GS104", 8, "write 0.015"),
        ("G0 X１", "GS004", 4, "looks like `1`"),
        ("G0 X10mm", "GS004", 7, "carry no unit"),
        ("G0 X=5", "GS004", 4, "without `=`"),
        ("G0 X5 // over", "GS001", 7, "in parentheses"),
        ("# over", "GS001", 3, "in parentheses"),
        ("G0 X5 {over}", "GS001", 7, "in parentheses"),
        ("G0 X", "GS004", 4, "write a number after X"),
        ("G2 X5 I", "GS004", 7, "write a number after I"),  # no slip for 1: a blank stands between
        ("G0 X[1+]", "GS004", 7, ""),
        ("#1 5", "GS007", 4, "#1=2"),
        ("G0 X1.2.3", "GS005", 5, ""),
    ],
)
def test_slips(program, block: str, code: str, column: int, hint: str) -> None:
    (error,) = program(block + "\nM2").errors

    assert (error.code, error.span.line, error.span.column) == (code, 1, column)
    assert hint in error.hint


@pytest.mark.parametrize(
    ("dialect", "block", "code", "column", "hint"),
    [
        ("linuxcnc", "G1 X\u22125", "GS004", 4, "U+2212 only looks like `-`"),
        ("linuxcnc", "G1\u00a0X5", "GS001", 3, "U+00A0 only looks like a blank"),
        ("linuxcnc", "G1 \u04255", "GS001", 4, "U+0425 only looks like `X`"),
        ("linuxcnc", "G1 X5 \u201cnote\u201d", "GS001", 7, "in parentheses"),
        ("linuxcnc", "GI X1", "GS004", 1, "letter I? Write the digit 1: G1"),
        ("linuxcnc", "G1 X5 mm", "GS004", 7, "carry no unit"),
        ("linuxcnc", "G1 X1+2]", "GS001", 6, "in brackets"),
        ("linuxcnc", "#1=1/2", "GS001", 5, "in brackets"),
        ("linuxcnc", "G1 X5 )", "GS001", 7, "no `(` before"),
        ("linuxcnc", "5 X1", "GS001", 1, "behind a letter, as in X5"),
        ("linuxcnc", "#1=sqr[4]", "GS006", 4, "did you mean SQRT?"),
        ("linuxcnc", "#1=[1 modd 2]", "GS006", 10, ""),
        ("linuxcnc", "#1=[2*(1+2)]", "GS006", 7, "group by [ ]"),
        ("linuxcnc", "o1 iff [1]", "GS008", 4, "did you mean if?"),
        ("linuxcnc", "o1 if #1", "GS008", 7, "in brackets, as in o1 if [#1]"),
        ("linuxcnc", "o1 if [1", "GS006", 7, "add `]`"),
        ("linuxcnc", "o call", "GS008", 1, "behind it, as in o100"),
        ("linuxcnc", "GOTO 5", "GS008", 1, "fanuc knows GOTO"),
        ("linuxcnc", "G54.1 P3", "GS012", 1, "fanuc knows it (--dialect fanuc)"),
        ("linuxcnc", "G17.1", "GS012", 1, "did you mean G17?"),
        ("rs274", "G96 S100", "GS012", 1, "fanuc and linuxcnc know it"),
        ("rs274", "M98 P5", "GS013", 1, "fanuc and linuxcnc know it"),
        ("rs274", "G1 X1e3", "GS001", 6, "write 1000"),
        ("rs274", "#<a>=5", "GS007", 1, "linuxcnc has them"),
        ("rs274", "o1 sub", "GS008", 1, "linuxcnc has them"),
        ("fanuc", "G1 X1O", "GS004", 6, "digit 0: 10"),
        ("fanuc", "G1 X1O5", "GS001", 6, "digit 0: 05"),
        ("fanuc", "G1 X#<a>", "GS007", 5, "linuxcnc has them"),
        ("grbl", "#1=5", "GS001", 1, "neither parameters nor expressions"),
        ("grbl", "G1 X[1+2]", "GS004", 4, "neither parameters nor expressions"),
        ("grbl", "G1 X1 Y--5", "GS004", 8, "write the number behind it"),
        ("grbl", "o1 sub", "GS008", 1, "linuxcnc has them"),
    ],
)
def test_slips_in_each_dialect(program, dialect: str, block: str, code: str, column: int, hint: str) -> None:
    (error,) = program(f"G21 G90 G94 F100\n{block}\nM2", dialect=dialect).errors

    assert (error.code, error.span.line, error.span.column) == (code, 2, column), error
    assert hint in error.hint


@pytest.mark.parametrize("dialect", ["fanuc", "linuxcnc", "rs274"])
@pytest.mark.parametrize(
    ("block", "column", "message"),
    [
        ("G0 X5 5 Y1 (5 5 --5)", 4, "`X5 5` is read as X55"),
        ("G0 X1 Y--5", 7, "`Y--5` has two signs and is read as Y5"),
    ],
)
def test_odd_numbers_are_warned_of(program, dialect: str, block: str, column: int, message: str) -> None:
    done = program(f"G21 G90 G94 F100\n{block}\nM2", dialect=dialect)

    (odd,) = [finding for finding in done.findings if finding.code == "GS197"]
    assert (odd.span.line, odd.span.column, odd.message) == (2, column, message)
    assert done.run.failed is None


@pytest.mark.parametrize(
    ("dialect", "block", "column", "before"),
    [
        ("linuxcnc", "G0 X[1+2 Y3", 5, " before Y3"),
        ("linuxcnc", "G0 X1 Y[[2+3]*4 F100", 8, " before F100"),
        ("linuxcnc", "#1=[SIN[3]", 4, ""),
        ("linuxcnc", "G0 X[[[1+2", 7, ""),
        ("linuxcnc", "o1 call [1] [2 [3]", 13, " before ["),
        ("linuxcnc", "G0 X[1+2 #3=5", 5, " before #3="),
        ("linuxcnc", "G0 X[2*[3+1 ; [ note", 8, " before the comment"),
        ("fanuc", "IF [#1 EQ 2 GOTO 5", 4, " before GOTO"),
        ("fanuc", "IF[#1EQ2 THEN #1=4", 3, " before THEN"),
        ("fanuc", "WHILE[#1 LT 3 DO1", 6, " before DO"),
    ],
)
def test_a_bracket_that_is_never_closed_is_pointed_at(program, dialect, block, column, before) -> None:
    (error,) = program(f"G21 G90\n{block}\nM2", dialect=dialect).errors

    assert (error.code, error.message) == ("GS006", "a bracket is never closed")
    assert (error.span.line, error.span.column, error.hint) == (2, column, "add `]`" + before)


def test_expected_is_what_may_stand_there(program) -> None:
    """Behind a whole word there may be no bracket, and no sign of equation."""
    (error,) = program("G0 X5 ?\nM2").errors

    assert "a word" in error.hint and "the end of the line" in error.hint
    assert "`]`" not in error.hint and "`=`" not in error.hint
