"""Programs taken up at each of their lines: the rest moves as in the whole program, or a finding says why not."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from gcodesim import canon
from gcodesim.diagnostics import SourceText
from gcodesim.motion import build_tool_path
from gcodesim.restart import Restart, restart_of
from gcodesim.restart.program import reading_up_to
from gcodesim.rs274 import Settings, ToolTable, interpret

TABLE, _ = ToolTable.read(SourceText("tool.tbl", b"T1 P1 Z50 D6\nT2 P2 Z80 D10\n"))
LINUXCNC = """%
(everything that a preamble has to say)
O100 sub
  G1 X[#1+5] F300
  G91 G1 Y2
  G90
O100 endsub
G21 G90 G17 G64 P0.02
T1 M6
G43 H1
T2
#100=3.5
#<_depth>=-1
S8000 M3 M8
G54
G0 X0 Y0
G0 Z5
G1 Z#<_depth> F200
O100 call [10]
G10 L2 P2 X100 Y50 Z-20 R30
G55
G0 X-90 Y-40 Z30
G52 X1
G2 X-80 Y-40 I5.5 F500
X-70 I5
G1 X-60 Y[-40+#100]
G0 Z40
G99 G81 X-60 Y-30 Z19 R25 F100
X-50
G80
G41 D1 G1 X-40
X-30 Y-20
G40 X-20
O200 while [#100 LT 5]
#100=[#100+1]
G1 X#100
O200 endwhile
G20
G54
G91
G1 X0.1 A10
G93 G1 Y0.1 F30
G94
M64 P2
G90 G0 Z3
T2 M6
G43.1 Z2
G1 X1 F10
M2
%
"""
FANUC = """%
O1234 (MAIN)
G21 G90 G17 G40 G80
T1 M6
G54
S5000 M3
#101=12.5
G0 X0. Y0.
G43 H1 Z20. M8
G1 Z-1. F250.
X#101 Y10.
G52 X5.
X20. Y20.
M98 P2000
G3 X30. Y20. R5.
G98 G83 X10. Y10. Z-8. R2. Q3. F120.
X20.
G80
G0 Z50. M9
G68 X0. Y0. R20.
G1 X5.
G69
WHILE [#101 LT 15.] DO1
#101=#101+1.
G1 X#101
END1
G0 Z60.
M30
O2000
G1 X40.
M99
%
"""
LATHE = """G21 G18 G7 G90 G40
G54
T1 M6 G43 H1
G96 D2500 S180 M3
G95 F0.25
G0 X42 Z2
Z0
G1 X-0.2 F0.15
G0 X42 Z2
X38
G1 Z-59.8
G0 X60 Z50
G97 S900
G10 L2 P2 X4 Z-10
G55
G8
G0 X16 Z12
G1 X12 F0.1
G2 X15 Z9 I3
G94 F200
G1 Z0
G0 X30
G20
G7
G1 X1
G0 Z4
M30
"""
FANUC_LATHE = """%
O1
G21 G40 G18
G50 S2000
T0101
G96 S150 M3
G0 X42. Z2.
G99 G1 Z-30. F0.2
U4. W1.
G0 X50. Z5.
G90 X40. Z-30. F0.25
X38.
X36.
G0 X60. Z20.
G97 S800
G98 G1 X58. F120.
G0 X100. Z100.
T0202
G50 S900
G0 X20. Z2.
G71 U2. R1.
G71 P10 Q20 U0.4 W0.1 F0.2
N10 G0 X10.
G1 Z-5.
N20 X20.
G70 P10 Q20
G0 X100. Z100.
G96 S100
G1 X90. F0.1
M30
%
"""
GRBL = """G21 G90
M3 S1000
G0 X10 Y10
G0 Z5
G1 Z-1 F200
G2 X20 Y10 I5
X30 I5
G20
G1 X1
G91 X0.5
G0 Z1
M5
M2
"""


PRINT = """;FLAVOR:Marlin
M201 X1000 Y1000
M204 S800
M140 S60
M190 S60
M104 S205
M109 S210
G28
M82
G92 E0
G1 Z2 F300
;LAYER:0
;TYPE:WALL
M106 S128
G0 X10 Y10 Z0.2 F6000
G1 X50 E2 F1200
G3 X40 Y40 R40 E3.5
G1 E2.7 F1800
G0 X20 Y20 F6000
G1 E3.5 F1800
G1 X30 E4 F1200
;LAYER:1
M204 P900
M221 S95
G0 Z0.4
G92 E0 X0
M83
M207 S0.8 F2400 Z0.2
G1 X50 E1.2
G10
G0 X60
G11
M107
M200 D1.75
G91
G1 X70 E1
G90
M83
T1
M104 S190
G20
G1 X1 E0.1
;max_layer_z = 0.4
;machine_max_acceleration_x = 3000
;machine_max_acceleration_extruding = 1250
"""
CALLED = {"linuxcnc": (4, 5), "fanuc": (30,)}
"""Lines of subroutines, which are executed between others."""


def taken_up(text: str, line: int, dialect: str) -> tuple[Restart, Sequence[canon.Event]]:
    settings = Settings(dialect=dialect, tool_table=TABLE, start=(0.0, 0.0, 0.1, 0.0, 0.0, 0.0))
    program = SourceText("part.nc", text.encode())
    before = reading_up_to(program, line, settings)
    events = list(before)
    others = [event for event in events if not isinstance(event, canon.Move)]
    return restart_of(program, line, before, build_tool_path(events, settings.start), others), events


def moves(text: str, dialect: str) -> list[tuple[int, tuple[object, ...]]]:
    """All moves with their lines, and with the tool, length, spindle and coolant in force."""
    settings = Settings(dialect=dialect, tool_table=TABLE, start=(0.0, 0.0, 0.1, 0.0, 0.0, 0.0))
    run = interpret(SourceText("part.nc", text.encode()), settings)
    found, state = [], {"tool": 0, "offset": (0.0,) * 6, "spindle": ("off", 0.0, None), "coolant": (False, False)}
    for event in run:
        match event:
            case canon.Move():
                own = [getattr(event, name, 0.0) for name in ("feed", "sweep", "pitch", "extrude")]
                numbers = [*event.end, *getattr(event, "center", ()), *(value or 0.0 for value in own)]
                kind = (type(event).__name__, getattr(event, "feed_unit", ""))
                found.append((event.span.line, (*kind, *state.values(), numbers)))
            case canon.Extrude():
                found.append((event.span.line, ("extrude", [event.length, event.feed])))
            case canon.PlannerLimits():
                state["limits"] = tuple(event.limits)
            case canon.SectionStart():
                state["section"] = event.section
            case canon.ToolChange():
                state["tool"] = event.tool
            case canon.ToolOffset():
                state["offset"] = tuple(round(value, 8) for value in event.offset)
            case canon.Spindle():
                state["spindle"] = (event.direction, event.speed, event.max_speed)
            case canon.Coolant():
                state["coolant"] = (event.flood, event.mist)
    assert run.failed is None, run.failed
    return found


@pytest.mark.parametrize(
    ("dialect", "text", "refused"),
    [
        ("linuxcnc", LINUXCNC, {4, 5, 6, 7, 25, 29, 32, 33, 35, 36, 37}),
        ("fanuc", FANUC, {17, 21, 22, 24, 25, 26, 29, 30}),
        ("grbl", GRBL, {7}),
        ("marlin", PRINT, set()),
        ("linuxcnc", LATHE, set()),
        ("fanuc_lathe", FANUC_LATHE, {12, 13, 22, 23, 24, 25, 26}),
    ],
)
def test_each_line_goes_on_as_in_the_whole_program_or_is_refused(dialect, text, refused):
    whole = moves(text, dialect)
    lines = text.splitlines()
    wrong = {}
    for line in range(3 if dialect.startswith("fanuc") else 2, len(lines) - 1):
        made, _ = taken_up(text, line, dialect)
        if made.program is None:
            (finding,) = made.findings
            assert finding.code == "GS148"
            wrong[line] = finding.message
            continue
        first = next(
            (i for i, (at, _) in enumerate(whole) if at >= line and at not in CALLED.get(dialect, ())), len(whole)
        )
        after = [move for _, move in whole[first:]]
        tail = [move for _, move in moves(made.program.text, dialect)]
        tail = tail[len(tail) - len(after) :]
        assert [move[:-1] for move in tail] == [move[:-1] for move in after], (line, made.program.text)
        for now, then in zip(tail, after, strict=True):
            assert now[-1] == pytest.approx(then[-1], abs=1e-6), (line, made.program.text)
    assert set(wrong) == refused, wrong


def test_lines_keep_their_numbers():
    made, _ = taken_up(LINUXCNC, 45, "linuxcnc")

    assert made.program is not None and made.program.name == "restart.nc"
    assert made.program.lines[44:] == LINUXCNC.splitlines()[44:]
    assert made.program.lines[:7] == ["%", "", *LINUXCNC.splitlines()[2:7]]
    assert len(made.program.lines) == len(LINUXCNC.splitlines())


def test_the_way_is_up_across_and_down():
    text = "T1 M6\nG43 H1\n\n\n\n\n\nS900 M3\nG0 X10 Y5\nG0 Z2\nG1 Z-3 F100\nX50\nG0 Z9\nM2\n"
    made, _ = taken_up(text, 13, "linuxcnc")

    assert made.program is not None
    assert made.program.lines[-8:-1] == [
        "G0 G43 H1 Z50", "S900", "M3", "G0 X50 Y5", "G0 Z2", "G1 Z-3 F100", "G0 Z9",
    ]  # fmt: skip


TURNED = """G21 G18 G7 G90
T1 M6
G43 H1
S900 M3
G95 F0.2
G0 X80 Z60
{moves}
M2
"""


@pytest.mark.parametrize(
    ("moves", "way"),
    [
        ("G0 X44 Z2\nX40\nG1 Z-20\nG0 X44\nZ2\nX38\nG1 Z-15 F0.1", ["X80", "Z-15", "X40", "G1 X38 F0.1"]),
        ("G0 X0 Z3\nG1 Z-20", ["Z60", "X0", "Z3", "G1 Z-20 F0.2"]),
        ("G0 X16 Z2\nG1 Z-9\nG0 X15\nZ2\nX18\nG1 Z-8\nX17", ["Z60", "X16", "Z-8", "G1 X17 F0.2"]),
        ("G0 X44 Z2\nG0 Z0\nG1 X20\nG0 Z1\nG0 X44\nZ-1\nG1 X30", ["Z60", "X30", "Z0", "G1 Z-1 F0.2"]),
    ],
)
def test_a_lathe_tool_comes_from_where_it_cuts(moves, way):
    text = TURNED.format(moves=moves)
    made, _ = taken_up(text, len(text.splitlines()), "linuxcnc")

    assert made.program is not None
    lines = [line.removeprefix("G0 ").removeprefix("G43 H1 ") for line in made.program.lines if line]
    begun = lines.index("G97 S900")
    assert [lines[begun - 1], *lines[begun + 2 : -1]] == way


def test_a_line_that_is_never_reached():
    made, _ = taken_up("G0 X1\no1 if [0]\nG0 X2\no1 endif\nG0 X3\nM2\n", 3, "linuxcnc")

    assert made.program is None and "never comes to it" in made.findings[0].message


def test_a_print_is_heated_lifted_and_homed_before_the_head_goes_down():
    line = PRINT.splitlines().index("G0 X20 Y20 F6000") + 1
    made, _ = taken_up(PRINT, line, "marlin")

    assert made.program is not None
    head = [text for text in made.program.lines[: line + 20] if text and not text.startswith(";")]
    assert head[: head.index("G0 X20 Y20 F6000")] == [
        "G21", "G90", "M201 X1000 Y1000", "M204 S800", "M106 S128", "M140 S60", "M104 S210", "M190 S60", "M109 S210",
        "G1 Z4 F300", "G28 X Y", "M82", "G92 E0.8", "G1 E0 F1800", "G1 X40 Y40 F6000", "G1 Z0.2 F300", "G92 E2.7",
        "M82", "G1 F1800",
    ]  # fmt: skip
    assert [finding.code for finding in made.findings] == ["GS149"]


def test_what_a_printer_did_before_is_told():
    text = "START_PRINT BED=60\nG28\nG29\nG1 X10 Y10 E1 F1200\nG1 X20 E2\n"
    made, _ = taken_up(text, 5, "klipper")

    assert [finding.message.partition(" ")[0] for finding in made.findings] == ["Z", "START_PRINT", "G29"]
