"""Programs for other machines and controls are named as such, once, and no program of a mill is."""

from __future__ import annotations

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.other_machines import foreign_of, lathe_of

PRINTED = ";FLAVOR:Marlin\nM140 S60\nM105\nG28\nM82\nG92 E0\nG1 X10 Y10 F3000\nG1 X60 E2.5 F1200\nM107\n"
KLARTEXT = "0 BEGIN PGM P1 MM\n1 TOOL CALL 5 Z S3000\n2 L X+10 Y+10 R0 FMAX M3\n3 END PGM P1 MM\n"
SCRIPT = "// a frame\n  rapid({z: 5});\ncut({x: 30});\n"
SINUMERIK = 'N10 G17 G90 G94\nN20 T="MILL" D1\nN30 M6\nN40 G1 X10 F100\nN50 M30\n'
FANUC_LATHE = "%\nO0007\nG50 S2000\nT0101\nG96 S180 M3\nG0 X52. Z2.\nG1 Z-30. F.2\nM30\n%\n"
LINUXCNC_LATHE = "G21 G18 G7\nT1 M6\nS800 M3\nG0 X30 Z2\nG1 X24 Z0 F80\nZ-20\nM5\nM2\n"


@pytest.mark.parametrize(
    ("text", "line", "word"),
    [
        (PRINTED, 2, "printer"),
        (KLARTEXT, 1, "Klartext"),
        (SINUMERIK, 2, "Sinumerik"),
        (SCRIPT, 2, "script"),
        ("OPULL\n(pull)\nG0 X20. Z20.\nZ=PR\nRTS\n", 5, "Okuma"),
        ("G15 H1\nT=PT\nM6\n", 1, "Okuma"),
        ("OHOME\nG0 X60.\nG20 HP=4\nRTS\n", 3, "Okuma"),
        ("CALL OO88 PX=10\nM2\n", 1, "Okuma"),
        ("OTC\n IF [PT NE EMPTY] NTC6\nVUACM[1]='NO TOOL'\nRTS\n", 2, "Okuma"),
        ("VC1=VC1+1\nG56 H1\nM2\n", 1, "Okuma"),
        ("var depth = -2\ntool(1);\n", 1, "script"),
        ("function side(x) {\n  cut({x: x})\n}\n", 1, "script"),
    ],
)
@pytest.mark.parametrize("dialect", ["linuxcnc", "fanuc", "grbl"])
def test_one_error_says_which_control_it_is(program, text, line, word, dialect) -> None:
    done = program(text, dialect=dialect)

    assert [(f.code, f.span.line) for f in done.errors] == [("GS016", line)]
    assert word in done.errors[0].message
    assert done.run.failed is done.errors[0]


def test_a_lathe_of_fanuc_is_refused_before_it_moves(program) -> None:
    done = program(FANUC_LATHE, dialect="fanuc")

    assert [(f.code, f.span.line, f.span.column) for f in done.findings] == [("GS016", 3, 1)]
    assert not done.ends


def test_a_lathe_of_linuxcnc_moves_and_is_told(program) -> None:
    done = program(LINUXCNC_LATHE)

    assert [f.code for f in done.findings] == ["GS916"] and done.ends[0] == [15, 0, 0 + 2]


@pytest.mark.parametrize(
    "text",
    [
        "G21 G90\nG0 X1 Y1\nM3 S100\nM106 S1\nG1 X5 F100\nM107\nM2\n",  # a router with a fan
        "(M104 S200 and E5 in a note)\nG1 X1 F100\nM2\n",
        "G1 X#<x=1> F100\nM2\n",
        "(tool(1);)\nT1 M6\n(cut along the rim);\nM2\n",
        "#1=5\nX#1\nM2\n",
        "o1 call\nM2\n",
        "o<call> call\nG15\nG43 H1\nM2\n",
        "O1\nIF[#1EQ0]GOTO5\nIF [#[#2] NE 5] THEN #1=2\nN5 M30\n",
        "o1 if [exists[#<p>] ne 5]\n(CALL O1)\no1 endif\nM2\n",
        "10 G1 X1\n",
    ],
)
def test_programs_of_mills_are_none_of_them(text) -> None:
    assert foreign_of(SourceText("p.nc", text.encode())) is None


@pytest.mark.parametrize(
    ("text", "dialect"),
    [
        (FANUC_LATHE.replace("X52.", "X52. Y0."), "fanuc"),
        (FANUC_LATHE.replace("T0101", "T1 M6"), "fanuc"),
        ("G50\nT1\nG28 Z0\nG83 P100 Z-1 R1 Q1 F1\nM30\n", "fanuc"),
        ("(G50 S2000)\nG0 X1 Z1\nM30\n", "fanuc"),
        (LINUXCNC_LATHE + "Y1\n", "linuxcnc"),
        ("G18 G0 X1 Z1\nG73 X1 Z-1 R1 Q1 F1\nM2\n", "linuxcnc"),
        (FANUC_LATHE, "grbl"),
    ],
)
def test_a_mill_is_no_lathe(text, dialect) -> None:
    assert lathe_of(SourceText("p.nc", text.encode()), DIALECTS[dialect].lathe) is None


def test_codes_of_lathes_and_of_haas_are_named(program) -> None:
    [millimetres] = program("G17 G71\nG0 X1 Y1\nM2\n").errors
    assert millimetres.code == "GS915" and "G21" in millimetres.message
    [pocket] = program("G0 X1 Y1\nG13 I5 D1 F100\nM30\n", dialect="fanuc").errors
    assert pocket.code == "GS915" and "Haas" in pocket.message


def test_a_turret_that_is_called_with_its_offset_is_a_lathes(program) -> None:
    done = program("%\nO0007\nT0101\nG97 S800 M3\nG0 X52. Z2.\nG1 Z-30. F.2\nM30\n%\n", dialect="fanuc")

    assert [(f.code, f.span.line) for f in done.errors] == [("GS016", 3)]


@pytest.mark.parametrize("block", ["G00T0202", "N01G50S0600", "N10G0X380.Z300.T0101M16"])
def test_words_that_stand_close_are_seen(block) -> None:
    assert lathe_of(SourceText("p.nc", f"O0358\n{block}\nG01X118F0.3\nM30\n".encode()), DIALECTS["fanuc"].lathe)


def test_what_a_sender_kept_of_its_talk_names_no_control() -> None:
    assert foreign_of(SourceText("log.nc", b"12:01 > G21\n[MSG: D=3 sent]\nBUFFER D=7\nG1 X10 F100\n")) is None
    assert foreign_of(SourceText("part.mpf", SINUMERIK.encode())) is not None
