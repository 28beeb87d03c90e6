"""Lines in the style, as a user would write them by hand."""

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.formatting.line import line_text
from gcodesim.formatting.style import Style
from gcodesim.rs274 import Settings, file_of
from gcodesim.rs274.dialects import DIALECTS


def shown(text: str, dialect: str = "linuxcnc", **style) -> str:
    file = file_of(SourceText("p.nc", f"{text}\n".encode()), Settings(dialect=dialect))
    return line_text(file.tokens(0), Style(**style), DIALECTS[dialect], {})


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("g01x1.50y-.5f0200", "G1 X1.5 Y-0.5 F200"),
        ("  G1\tX +5.  Y-0.000 Z 0 1", "G1 X5 Y0 Z1"),
        ("n0010 m06 t01", "N0010 M6 T1"),
        ("g59.30 (Keep  MY case)x1;Tail ", "G59.3 (Keep  MY case) X1 ;Tail"),
        ("#<My  Name>=[#1+2.0]#2=-#3", "#<My  Name> = [#1 + 2] #2 = -#3"),
        ("x-[2**3.00-[-1]]ysin[30.0]", "X-[2 ** 3 - [-1]] Y SIN[30]"),
        ("f[atan[1]/[2]/exists[#<a>]]", "F[ATAN[1]/[2] / EXISTS[#<a>]]"),
        ("O0100 IF[#1GT[2MOD3]AND1]", "o0100 if [#1 GT [2 MOD 3] AND 1]"),
        ("O<Bore>CALL[1.0][-#2](deep)", "o<Bore> call [1] [-#2] (deep)"),
        ("/g0x##1", "/G0 X##1"),
        ("%", "%"),
        ("  ", ""),
    ],
)
def test_line_of_linuxcnc(text, expected):
    assert shown(text) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("o0012(PART)", "O0012 (PART)"),
        ("t0101m06", "T0101 M6"),
        ("g1x10.000y.50z5p0010", "G1 X10. Y0.5 Z5 P0010"),
        ("if[#1gt5.]goto20", "IF [#1 GT 5.] GOTO 20"),
        ("if[#1eq2]then#3=4.50-#4*2", "IF [#1 EQ 2] THEN #3 = 4.5 - #4 * 2"),
        ("while[#1lt3]do1", "WHILE [#1 LT 3] DO1"),
        ("/2n20g1x1.,c2.50", "/2 N20 G1 X1. ,C2.5"),
        ("#1=pow[2,3]", "#1 = POW[2, 3]"),
        ("#1=atan[1]/[2]/3", "#1 = ATAN[1]/[2] / 3"),
        ("dprnt[Depth*#1[44]  mm]", "dprnt[Depth*#1[44]  mm]"),
        ("g1x1/y2", "G1 X1 /Y2"),
    ],
)
def test_line_of_a_fanuc(text, expected):
    assert shown(text, "fanuc") == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("g28 x y;home", "G28 X Y ;home"),
        ("M117  Hello  World ; note", "M117 Hello  World ; note"),
        ("start_print BED=060", "start_print BED=060"),
        ("g1(inner)e-.50f1800.0", "G1 (inner) E-0.5 F1800"),
        ("N3 g1 x5*112", "N3 g1 x5*112"),
    ],
)
def test_line_of_a_printer(text, expected):
    assert shown(text, "marlin") == expected


def test_numbers_are_the_same_to_the_last_digit():
    assert shown("x00123456789.12345678901234567890") == "X123456789.1234567890123456789"


def test_what_a_shop_may_want_otherwise():
    assert shown("G1X1 (note) M6", spaces=False, case="lower", code_digits=2) == "g01x1(note)m06"
    assert shown("o1 if [#1 GT 2]", spaces=False) == "o1if[#1GT2]"
    assert shown("G1 X5", "marlin", spaces=False, case="lower") == "G1 X5"  # 0X5 is a number to some controls


def test_positions_with_decimals():
    text = "n5 g1 x1.5 y-2 z[1 + 2] i.12345 f100 s500 m3"

    assert shown(text, decimals=3) == "N5 G1 X1.500 Y-2.000 Z[1 + 2] I0.12345 F100 S500 M3"
    assert shown(text, decimals=0) == "N5 G1 X1.5 Y-2. Z[1 + 2] I0.12345 F100 S500 M3"
    # where X10 may be a hundredth of X10., no point comes
    assert shown("g1 x10 y-10. z.5", "fanuc", decimals=2) == "G1 X10 Y-10.00 Z0.50"
