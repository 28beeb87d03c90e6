"""What a control has in force before the first block of a program."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from gcodesim.canon.batch import MoveBatch
from gcodesim.cell.loader import LoadedCell, read_cell
from gcodesim.cell.show import cell_as_text
from gcodesim.diagnostics import Severity, SourceText, Span
from gcodesim.rs274 import interpret
from gcodesim.simulation import prepare, settings_in_cell

NOWHERE = Span("p.nc")
PROGRAM = "G0 X1 Y2\nG1 X2 F10\nG1 Y3\nM2\n"
PRINT = "G1 X1 Y2 F60\nG1 X2 E1\nG1 X3 E0.5\n"


def loaded(startup: str, dialect: str = "linuxcnc") -> LoadedCell:
    text = f"gcodesim: 1\nmachine: gantry_xyz\ndialect: {dialect}\n{startup}\n"
    return read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))


def events(cell: LoadedCell, program: str = PROGRAM, lane: str = "auto") -> list[str]:
    """All that the program tells the machine, but not where that stands."""
    assert cell.cell is not None
    settings, _ = settings_in_cell(cell.cell)
    stream = interpret(SourceText("p.nc", program.encode()), replace(settings, lane=lane)).stream()
    told = [one for item in stream for one in (item.events() if isinstance(item, MoveBatch) else [item])]
    return [repr(replace(event, span=NOWHERE)) for event in told]


@pytest.mark.parametrize(
    ("words", "dialect"),
    [
        ("G20", "linuxcnc"),
        ("g20 g91 g64p0.001", "linuxcnc"),
        ("G20 G95 F0.1", "linuxcnc"),
        ("G20 G91", "grbl"),
        ("G20 G91", "fanuc"),
        ("G20", "marlin"),
        ("M83", "marlin"),
        ("m83", "klipper"),
    ],
)
@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_the_program_runs_as_if_it_began_with_these_words(words: str, dialect: str, lane: str) -> None:
    program = PRINT if "83" in words else PROGRAM
    begun = [one for one in events(loaded("", dialect), f"{words}\n{program}", lane) if "PathMode" not in one]
    assert [
        one for one in events(loaded(f"startup: {words}", dialect), f"\n{program}", lane) if "PathMode" not in one
    ] == begun
    assert begun != events(loaded("", dialect), program, lane=lane)


def test_a_printer_takes_several_commands_of_one_line() -> None:
    """A line of its programs has one; each of these counts."""
    both = events(loaded("startup: G20 M83", "marlin"), f"\n\n{PRINT}")
    assert both == events(loaded("", "marlin"), f"G20\nM83\n{PRINT}")
    assert both != events(loaded("startup: M83", "marlin"), f"\n\n{PRINT}")
    assert both != events(loaded("startup: G20", "marlin"), f"\n\n{PRINT}")


@pytest.mark.parametrize(("words", "dialect"), [("M83", "linuxcnc"), ("F600", "marlin")])
def test_words_of_other_controls_are_told(words: str, dialect: str) -> None:
    job = prepare(SourceText("p.nc", PROGRAM.encode()), loaded(f"startup: {words}", dialect))
    assert [(f.span.file, f.span.line) for f in job.findings if f.level is Severity.ERROR] == [("cell.yaml", 4)]


def test_the_program_has_the_last_word() -> None:
    said = f"G21\n{PROGRAM}"
    assert events(loaded("startup: G20"), said) == events(loaded(""), said)


def test_words_that_a_control_refuses_are_told_at_their_place_in_the_cell() -> None:
    job = prepare(SourceText("p.nc", PROGRAM.encode()), loaded("startup: G20 G96"))

    (found,) = [finding for finding in job.findings if finding.code == "GS105"]
    assert (found.span.file, found.span.line, found.span.column) == ("cell.yaml", 4, 14)


@pytest.mark.parametrize(
    ("startup", "alien"),
    [
        ("G20 M3 S100", "M3"),
        ("G0", "G0"),
        ("G28", "G28"),
        ("G20 G92 X1", "G92 X1"),
        ("G201", "G201"),
        ("G20 M52 P1", "M52 P1"),
        ("''", ""),
    ],
)
def test_only_modes_stand_there(startup: str, alien: str) -> None:
    (found,) = loaded(f"startup: {startup}").findings

    assert found.code == "GS711" and (not alien or f"`{alien}` belongs into the program" in found.hint)


def test_it_is_shown_as_it_was_written() -> None:
    cell = loaded("startup: G20 G64 P0.001").cell
    assert cell is not None
    assert "startup: G20 G64 P0.001" in cell_as_text(cell)
