"""First cells for programs of lathes: what they cut runs in them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.simulation import check, prepare
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
