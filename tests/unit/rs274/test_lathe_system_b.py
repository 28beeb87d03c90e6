"""Lathes with code system B make the moves that the same program in system A makes."""

from __future__ import annotations

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.fanuc.lathe_system_b import is_in_system_b

IN_A = """O0007
G21 G99 G40
T0101
G50 S2500
G96 S180 M3
G0 X42. Z2.
G71 U2. R0.5
G71 P10 Q20 U0.4 W0.1 F0.25
N10 G0 X20.
G1 Z-20. F0.1
U10. W-5.
Z-40.
N20 X42.
G70 P10 Q20
G97 S800
G0 X24. Z4.
G32 Z-18. F1.5
G0 X30.
Z4.
G92 X19. Z-18. F1.5
X18.6
G90 X18. Z-5. F0.2
G94 X10. Z-2. F0.1
G0 U-10. W-2.
G98 G1 X30. F100.
G4 X1.5
G28 U0 W0
M30
"""
IN_B = """O0007
G21 G95 G90 G40
T0101
G92 S2500
G96 S180 M3
G0 X42. Z2.
G71 U2. R0.5
G71 P10 Q20 U0.4 W0.1 F0.25
N10 G0 X20.
G1 Z-20. F0.1
G91 X10. Z-5.
G90 Z-40.
N20 X42.
G70 P10 Q20
G97 S800
G0 X24. Z4.
G33 Z-18. F1.5
G0 X30.
Z4.
G78 X19. Z-18. F1.5
X18.6
G77 X18. Z-5. F0.2
G79 X10. Z-2. F0.1
G91 G0 X-10. Z-2.
G90 G94 G1 X30. F100.
G91 G4 X1.5
G28 X0 Z0
M30
"""


def test_moves_are_those_of_system_a(program) -> None:
    one, other = program(IN_A, dialect="fanuc_lathe"), program(IN_B, dialect="fanuc_lathe_b")

    assert one.findings == [] and other.findings == []
    assert len(one.events) > 60
    assert one.events == other.events


@pytest.mark.parametrize(
    ("text", "is_b"),
    [
        (IN_A, False),
        (IN_B, True),
        ("T0101\nG97 S500 M3\nG0 X20. Z2.\nG33 Z-10. F1.5\n", True),
        ("T0101\nG50 S2000 (NOT G92 S2000)\nG0 X20. Z2.\n", False),
        ("T0101\nG71 U2. R1.\nG71 P1 Q2 U.4 W.1 F.2\nG0 X20. Z2.\n", False),
    ],
)
def test_which_system_a_program_is_in(text: str, is_b: bool) -> None:
    assert is_in_system_b(SourceText("p.nc", text.encode())) is is_b
