"""GS136 and GS137: what never runs."""

from __future__ import annotations

import pytest

SUB = "o<hole> sub\nG0 X1\no<hole> endsub\n"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (SUB + "G0 X2", [("GS136", 1, 1)]),
        (SUB + "o<hole> call", []),
        (SUB + "o1 if [0]\no<hole> call\no1 endif", []),  # the branch not taken today
        (SUB + "#1=5\no1 if [0]\no[#1] call\no1 endif", []),  # which one is known when it runs
        ("o<p> sub\nG0 X1\no<p> endsub\nG0 X3", []),  # p.ngc serves other programs
        ("o1 sub\no2 call\no1 endsub\no2 sub\no2 endsub\no1 call", []),
    ],
)
def test_unused_subroutine(warned, text: str, found: list[tuple[str, int, int]]) -> None:
    assert warned(text) == found


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("G0 X1\nM2\nG0 X2\nG0 X3", [("GS137", 3, 1)]),
        ("G0 X1\nM30\n\n(over)\n;out\n", []),
        ("%\nG0 X1\nM30\n%\nG0 X5", []),  # behind the % there is no program
        ("%\nG0 X1\n%\nG0 X5", []),
        ("G0 X1\no<hole> call\nM2\n" + SUB, []),
        ("G0 X1\nM98 P100\nM2\nO100\nG0 X2\nM99", []),
        ("G0 X1\nM98 P100\nM2\nO100\nG0 X2\nM99\nG0 X7", [("GS137", 7, 1)]),
        ("G0 X1\no1 if [1]\nM2\no1 endif\nG0 X2", []),  # ends here only if
        ("G0 X1\no1 while [1]\nM2\no1 endwhile\nG0 X2", []),
        ("G0 X1\no1 if [1]\nG0 X2\no1 endif\nM2\nG0 X3", [("GS137", 6, 1)]),
        ("G0 X1\no1 do\n#1=[#1+1]\no1 while [#1 LT 3]\nM2\nG0 X3", [("GS137", 6, 1)]),
        ("G0 X1\n/M2\nG0 X2", []),  # a switch decides
        ("G0 X1\nM2\nnotes of the shop: use the long clamp", []),
    ],
)
def test_lines_behind_the_end(warned, text: str, found: list[tuple[str, int, int]]) -> None:
    assert warned(text, end="\n") == found


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("O1\nM98 P2\nM30\nO2\nG0 X1.\nM99", []),
        ("O1\nG65 P2 A1.\nM30\nO2\nG0 X#1\nM99", []),
        ("O1\nM98 P30002\nM30\nO2\nG0 X1.\nM99", []),
        ("O1\n#100=2\nM98 P#100\nM30\nO2\nG0 X1.\nM99", []),
        ("O1\nG0 X1.\nM30\nO2\nG0 X1.\nM99", [("GS136", 4, 1)]),
        ("O1\nG0 X1.\nM30\nO2\nG0 X1.\nM30", []),  # a program of its own
        ("O1\nG0 X1.\nM30\nG0 X2.", [("GS137", 4, 1)]),
        ("O1\nIF [#5001 LT 0] GOTO 99\nM30\nN99 #3000=1 (BELOW ZERO)", []),
        ("O1\nWHILE [#5001 LT 9] DO 1\nM30\nEND 1\nM30", []),
    ],
)
def test_on_fanuc(warned, text: str, found: list[tuple[str, int, int]]) -> None:
    assert warned(text, end="\n", dialect="fanuc") == found


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("#1=1\no1 if [#1 EQ 1]\nG0 X1\nM2", 2),
        ("#1=1\no1 while [#1 LT 2]\nG0 X1\nM2\no2 endwhile", 2),
        ("o1 repeat [2]\nG0 X1\nM2", 1),
        ("o1 do\nG0 X1\nM2", 1),
    ],
)
def test_an_o_word_that_is_never_closed_though_the_program_ends_before(program, text, line):
    done = program(text)

    assert not done.errors
    assert [(f.level.word, f.span.line) for f in done.findings if f.code == "GS130"] == [("warning", line)]


def test_a_fault_elsewhere_does_not_hide_it_and_one_in_an_o_word_does(program):
    text = "G1 X0foo Y0\no1 while [1]\nG0 X1\nM30"

    assert [(f.level.word, f.code, f.span.line) for f in program(text).findings] == [
        ("error", "GS004", 1),
        ("warning", "GS130", 2),
    ]
    assert [f.code for f in program(text.replace("G0 X1", "o1 endwhlie")).findings if f.code == "GS130"] == []


def test_closed_ones(program):
    text = "o1 if [1]\nG0 X1\no1 endif\no2 do\nG0 X0\no2 while [0]\no3 while [0]\no3 endwhile\nM2"

    assert not [f for f in program(text).findings if f.code == "GS130"]
