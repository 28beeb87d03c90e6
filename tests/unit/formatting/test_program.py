"""Whole programs: bytes, indentation, and what is left alone."""

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.formatting import CannotFormatError, Style, formatted
from gcodesim.formatting import program as module
from gcodesim.rs274 import Settings
from gcodesim.rs274.assumed import assumed_tools

STANDARD = Style()


def written(raw: bytes, style: Style = STANDARD, **settings) -> bytes:
    return formatted(SourceText("p.nc", raw), Settings(**settings), style).program.raw


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (b"g0x1\r\nm2", b"G0 X1\r\nM2\r\n"),
        (b"\xef\xbb\xbfg0 (\xc3\xa4)\nm2\n", b"\xef\xbb\xbfG0 (\xc3\xa4)\nM2\n"),
        (b"g0 (\xe4)\rm2\r", b"G0 (\xe4)\rM2\r"),
        (b"g0x1\n\n  \t\nm2\r\n", b"G0 X1\n\n\nM2\n"),
    ],
)
def test_bytes_around_the_words_stay(raw, expected):
    assert written(raw) == expected


def test_bodies_of_o_words_are_indented():
    raw = b"o1 sub\no2 while [#1 lt 2]\no3 if [1]\ng0\no3 else\n#1=[#1+1]\no3 endif\no2 endwhile\no1 endsub\nm2\n"
    lines = written(raw).decode().splitlines()

    assert [len(line) - len(line.lstrip()) for line in lines] == [0, 2, 4, 6, 4, 6, 4, 2, 0, 0]
    assert written(raw, Style(indent=0)).decode().splitlines() == [line.lstrip() for line in lines]


def test_comments_in_a_column_stay_in_one():
    raw = b"g21g90    (units)\ng0 x1.00 (a)\ng1y2f100 (b)\nz3\nm3s1000 (c)\n\nm5      (d)\nm2 (e)\n"

    assert written(raw).decode().splitlines() == [
        "G21 G90 (units)",
        "G0 X1      (a)",
        "G1 Y2 F100 (b)",
        "Z3",
        "M3 S1000 (c)",
        "",
        "M5 (d)",
        "M2 (e)",
    ]


def test_a_line_that_would_be_too_long_goes_without_blanks():
    raw = b"#1=[" + b"+".join([b"1"] * 120) + b"]\nm2\n"

    assert max(map(len, written(raw).splitlines())) <= 255


def test_lines_that_nobody_reads_stay():
    found = formatted(SourceText("p.nc", b"%\nm2\n%\n  hello & goodbye\n"), Settings(), Style())

    assert found.program.raw == b"%\nM2\n%\n  hello & goodbye\n"
    assert found.unread == (4,)


def test_a_program_with_errors_is_left_alone():
    with pytest.raises(CannotFormatError) as raised:
        written(b"g1x\nm2\n")

    assert [finding.code for finding in raised.value.findings] == ["GS004"]


def test_nothing_is_written_that_says_something_else(monkeypatch):
    """A formatter with a fault: each wrong text must be noticed, also where no block leads to it."""
    for old, new in (("G0 X1", "G0 X2"), ("G0 Y1", "G0 Y1."), ("(note)", "(NOTE)"), ("G0 Y3", "G0 Y4")):
        raw = b"%\no1\nm98p2\ng0x1\ng0y1\n(note)\nm30\ng0y3\no2\nm99\n%\n"
        with monkeypatch.context() as patched:
            real = module.line_text
            patched.setattr(module, "line_text", lambda *a: real(*a).replace(old, new))  # noqa: B023
            with pytest.raises(AssertionError, match="would change it: line"):
                written(raw, dialect="fanuc")


FANUC = """%
O0001
N1 G90
N7 #1=1
N3 IF [#1 GT 2] GOTO 9
M98 P2
GOTO 3
N9 G1 X1. F100.
#1=3
N4 M30
O0002
N1 #1=#1+1
N2 IF [#1 GT 5] GOTO 1
M99 P3
%
"""


def test_jumps_follow_new_line_numbers():
    text = written(FANUC.encode(), Style(step=5), dialect="fanuc").decode()

    assert "N15 IF [#1 GT 2] GOTO 20" in text
    assert "GOTO 15\nN20 G1 X1. F100." in text
    assert "N5 #1 = #1 + 1\nN10 IF [#1 GT 5] GOTO 5\nM99 P15\n" in text
    assert written(text.encode(), Style(step=5), dialect="fanuc").decode() == text


def test_the_contour_of_a_lathe_follows():
    raw = (
        b"O1\nT0101\nG98 G0 X50. Z2.\nG71 U1. R1.\nG71 P7 Q8 U0.5 W0.1 F0.2\nN7 G0 X20.\nG1 Z-10. F0.1\nN8 X45. Z-20.\n"
    )
    raw += b"M30\n"
    tools = assumed_tools(SourceText("p.nc", raw))
    text = written(raw, Style(step=10), dialect="fanuc_lathe", tool_table=tools).decode()

    assert "G71 P10 Q20 U0.5" in text
    assert "N10 G0 X20.\n" in text


@pytest.mark.parametrize(
    ("line", "message"),
    [("GOTO #1", "is computed"), ("M99 P#1", "is computed"), ("IF [0 EQ 1] GOTO 77", "N77, to which this leads")],
)
def test_a_jump_that_cannot_follow_leaves_the_numbers(line, message):
    raw = f"O1\nIF [1 EQ 1] GOTO 5\nN4 {line}\nN5 M30\n".encode()

    with pytest.raises(CannotFormatError, match=message):
        written(raw, Style(step=10), dialect="fanuc")


def test_numbers_that_would_become_too_large():
    raw = b"".join(b"N%d G0\n" % n for n in range(1, 200)) + b"M2\n"

    with pytest.raises(CannotFormatError, match="199 blocks in steps of 1000 end above N99999"):
        written(raw, Style(step=1000))
