"""First cells for programs of lathes: what they cut runs in them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.simulation import check, prepare, run
from gcodesim.starter.first_cell import first_cell
from gcodesim.starter.needs import guesses_of, needs_of

TOP = Path(__file__).parents[3]
LINUXCNC = """(SHAFT)
G7 G18 G21 G90 G95 G40
T1 M6 (ROUGH CNMG120408)
G43
G96 D2400 S150 M3
F0.2
G0 X36 Z0
G1 X-1
G0 X28 Z2
G1 Z-30
G0 X60 Z60
T2 M6 (DRILL 8)
G43
G97 S900 M3
G0 X0 Z3
G1 Z-20 F0.1
G0 Z60
M5
M2
"""


def made(text: str) -> tuple[dict, str]:
    cell = first_cell(SourceText("p.ngc", text.encode()))
    source = cell.text()
    loaded = read_cell(SourceText("cell.yaml", source), Path("cell.yaml"))
    assert not [f for f in loaded.findings if f.level is Severity.ERROR]
    job = prepare(SourceText("p.ngc", text.encode()), loaded)
    assert not [f for f in check(job).findings if f.level is Severity.ERROR]
    return {number: tool.kind for number, tool in job.cell.tools.items()}, source.decode()


def test_fanuc_with_turret_cycles_and_threads() -> None:
    tools, text = made((TOP / "programs" / "pin.nc").read_text())

    assert "dialect: fanuc_lathe" in text and "model: lathe_xz" in text
    assert tools == {1: "turning_tool", 2: "turning_tool", 3: "grooving_tool", 4: "threading_tool"}
    assert "insert: CNMG120408" in text and "insert: VBMT160404" in text and "spindle_speed: 2500 rpm" in text
    assert "cylinder: [32 mm, 94 mm]" in text  # turned to 31 mm, faced at Z0, parted off at Z-63


def test_linuxcnc_with_diameters() -> None:
    tools, text = made(LINUXCNC)

    assert "dialect: linuxcnc" in text and "spindle_speed: 2400 rpm" in text
    assert tools == {1: "turning_tool", 2: "drill"}
    assert "cylinder: [29 mm, 61 mm]" in text and "xyz: [0, 0, -60]" in text


def test_a_program_that_calls_no_tool_has_one() -> None:
    tools, text = made("G8 G18 G21 G90 G95 F0.2\nM3 S900\nG0 X20 Z2\nX15\nG1 Z-10\nG0 X20\nM5\nM2\n")

    assert tools == {1: "turning_tool"} and "loaded_tool: 1" in text


def test_what_is_needed_and_what_is_guessed() -> None:
    cell = first_cell(SourceText("p.ngc", LINUXCNC.encode()))

    rows = needs_of(cell)

    assert rows[0] == ("dialect", "linuxcnc (`G7` in line 2)")
    assert [text.partition(" (")[0] for _, text in rows[1:3]] == ["T1 turning tool", "T2 drill"]
    assert "29 mm" in rows[-1][1] and "the bar and its chuck" in guesses_of(cell)


def test_a_mill_is_no_lathe() -> None:
    cell = first_cell(SourceText("p.ngc", b"G21 G90\nT1 M6\nG43\nS900 M3\nG0 X0 Y0 Z5\nG1 Z-1 F100\nX20 Y9\nM2\n"))

    assert b"lathe" not in cell.text()


@pytest.mark.parametrize("comment", ["", "(WEAR ; A # B)"])
def test_comments_stay_comments(comment: str) -> None:
    tools, _ = made(LINUXCNC.replace("(ROUGH CNMG120408)", comment))

    assert tools[1] == "turning_tool"


RETREATS = """G21 G18 G99
G53 G0 X0 Z0
T0101
G50 S2500
G97 S800 M3
G0 X42 Z2
G1 Z-20 F0.2
X60
G53 G0 X0
G53 G0 Z0
M5
M30
"""


def test_the_axes_count_from_where_the_turret_rests() -> None:
    """G53 X0 Z0 is the way to the turret's rest of Haas and Fanuc lathes, not into the chuck."""
    tools, text = made(RETREATS)

    assert tools == {1: "turning_tool"} and "nose: {X: -150 mm, Z: -600 mm}" in text


def test_on_linuxcnc_they_do_where_the_program_says_so() -> None:
    plain = "G7 G18 G21 G90 G95 F0.2\nT1 M6 G43\nM3 S900\nG0 X20 Z2\nX15\nG1 Z-10\nG0 X20\nM5\nM2\n"

    assert "nose" not in made(plain)[1] and "machine: lathe_xz" in made(plain)[1]
    assert "nose" in made(plain.replace("M5\n", "G53 G0 X0\nG53 G0 Z0\nM5\n"))[1]
    assert "nose" not in made(plain.replace("M5\n", "(G53 G0 X0)\nM5\n"))[1]


THREAD = """%
O1234
G00 G18 G20 G40 G80 G99
T0303
G97 S500 M03
G00 G54 X0.7 Z0.2
G76 X0.4069 Z-0.75 K0.0491 D0.01 F0.0769
G53 G00 X0.0
M30
%
"""


def test_a_program_that_only_threads_gets_a_bar_as_thick_as_its_thread() -> None:
    tools, text = made(THREAD)

    assert "dialect: fanuc_lathe" in text and tools == {3: "threading_tool"}
    assert "cylinder: [14 mm" in text  # 0.5051 in = 12.8 mm


APPROACH = """%
O2001
G18 G20 G40 G80 G97 G99
T0101 (****)
G50 S2500
G96 S800 M03
G54 G00 X2.1 Z.1
G71 P10 Q20 U0.0 W0.0 D.05 F0.01
N10 G01 X0.
Z0.
X.45
Z-.45
X1.4
Z-1.6
N20 G01 X2.1
M30
%
"""


def test_a_contour_that_begins_before_the_bar_is_no_facing() -> None:
    """It comes to the axis at Z0.1 and goes on to the face: were that in the bar, each rapid back would cut it."""
    tools, text = made(APPROACH)
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))
    results, _ = run(prepare(SourceText("p.ngc", APPROACH.encode()), loaded))

    assert tools == {1: "turning_tool"} and "****" not in text
    assert "GS401" not in {finding.code for finding in results.findings}


def test_a_list_of_tools_in_comments_says_what_their_tips_are() -> None:
    """Haas counts the tip of an outside tool as 3, that of an inside tool as 2; letters O stand for zeros."""
    _, text = made(
        "%\nO2004\n(TO1 = 80* Rough Turning Tool, Insert: 02-0083, Tool Nose Radius: .0315, Tool Tip: 3)\n"
        "(T02 = 35* Boring Tool, Tool Nose Radius: .4 mm, Tool Tip: 2)\n(T04 = Turning Tool, Tool Tip: 4)\n"
        "G20 G99\nG50 S1000\nT0101\nG96 S500 M03\nG00 X1.6 Z0.1\nG01 X1.2 F0.01\nZ-1.\nX1.6\n"
        "T0202\nG00 X0.5 Z0.1\nG01 Z-.5\nG00 Z1.\nT0404\nG00 X1.6\nG01 Z-1.\nM30\n%\n"
    )

    assert "1: {type: turning_tool, nose_radius: 0.8 mm, tip_angle: 80 deg}    # 80* Rough Turning Tool" in text
    assert "2: {type: boring_tool, nose_radius: 0.4 mm, tip_angle: 35 deg}    # 35* Boring" in text
    assert "4: {type: turning_tool, orientation: 1}" in text


def test_a_bar_is_hollow_where_a_tool_goes_in_and_nothing_drills() -> None:
    """The rapid between two passes of the borer goes through what a solid bar would have there."""
    text = (TOP / "programs" / "bushing.nc").read_text()
    tools, cell = made(text)
    assert tools[1] == "boring_tool" and "bore: 14 mm" in cell  # it draws back to X15

    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    results, _ = run(prepare(SourceText("p.ngc", text.encode()), loaded))
    assert "GS401" not in {finding.code for finding in results.findings}

    tools, cell = made(
        text.replace("T1 M6\n", "T4 M6 (DRILL 16)\nG43 H4\nS1200 M3\nG0 X0 Z3\nG1 Z-24\nG0 Z40\nT1 M6\n")
    )
    assert tools[4] == "drill" and "bore" not in cell.replace("boring", "")


def test_code_system_b_is_known_by_its_codes() -> None:
    tools, text = made(
        "O1\nG90 G95 G21\nG92 S2500\nT0101\nG96 S180 M3\nG0 X42. Z2.\nG77 X38. Z-20. F0.2\nX34.\nG0 X60. Z60.\n"
        "T0202\nG97 S800\nG0 X40. Z4.\nG33 Z-18. F1.5\nG0 X60.\nZ60.\nM5\nM30\n"
    )

    assert "dialect: fanuc_lathe_b" in text and "spindle_speed: 2500 rpm" in text
    assert tools == {1: "turning_tool", 2: "threading_tool"}


def test_a_bar_is_thinner_than_where_rapids_pass_it() -> None:
    """Parting off alone: the blade goes along the bar at X38, so that this is not as thick as that."""
    text = (
        "O1\nG21 G99\nT0101 (CUT OFF)\nG50 S2500\nG97 S800 M3\nG0 X38. Z2.\nZ-50.\nG1 X-1. F0.1\nG0 X60.\nZ60.\nM30\n"
    )

    assert "cylinder: [38 mm, 80 mm]" in made(text)[1]
    results, _ = run(
        prepare(
            SourceText("p.nc", text.encode()),
            read_cell(SourceText("cell.yaml", first_cell(SourceText("p.nc", text.encode())).text()), Path("cell.yaml")),
        )
    )
    assert "GS401" not in {f.code for f in results.findings}
