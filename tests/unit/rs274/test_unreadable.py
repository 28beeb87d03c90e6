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
        ("G0 Xl0", "GS004", 4, "digit 1: 10"),
        ("G0 X1e3", "GS104", 6, "write 1000"),
        ("G0 X1.5E-2", "GS104", 8, "write 0.015"),
        ("G0 X１", "GS004", 4, "plain digits"),
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


def test_expected_is_what_may_stand_there(program) -> None:
    """Behind a whole word there may be no bracket, and no sign of equation."""
    (error,) = program("G0 X5 ?\nM2").errors

    assert "a word" in error.hint and "the end of the line" in error.hint
    assert "`]`" not in error.hint and "`=`" not in error.hint
