"""GS178: filament that is drawn back while the head moves."""

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, ToolTable, interpret

HEAD = "G28\nG1 Z1 F3000\n"


def found(text: str, **settings) -> list[tuple[int, str]]:
    run = interpret(
        SourceText("p.gcode", (HEAD + text).encode()), Settings(dialect="marlin", tool_table=ToolTable(), **settings)
    )
    for _ in run:
        pass
    return [(finding.span.line, finding.message) for finding in run.findings if finding.code == "GS178"]


def row(count: int, e, first: int = 1) -> str:
    return "".join(f"G1 X{k % 7 + first} Y{k % 5} E{e(k):.4f} F1200\n" for k in range(count))


def test_a_slicer_that_retracts_wipes_and_loads_filament_is_right() -> None:
    """As PrusaSlicer writes it: a wipe of 0.8 mm over two moves, a retraction alone, unloading 80 mm at the end."""
    layer = row(30, lambda k: 0.2 * (k + 1)) + "G1 E5.7 F2100\nG1 X3 E5.5\nG1 X4 E5.2\nG1 X40\nG1 E6 F2100\nG92 E0\n"

    assert found(layer * 5 + "G1 E-80 F3000\n") == []
    assert found("M83\n" + row(200, lambda k: 0.2) + "G1 E-0.8\nG1 X50\nG1 E0.8\n" + row(20, lambda k: 0.1)) == []


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_an_e_that_begins_anew_without_g92(lane: str) -> None:
    layer = row(400, lambda k: 0.2 * (k + 1))

    (line, message), *more = found(layer + "G1 Z2\n" + layer, lane=lane)

    assert not more
    assert line == 2 + 400 + 2 and "79.8 mm" in message


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_steps_where_places_are_read(lane: str) -> None:
    """Steps of 0.1 to 0.3 mm: every other one is less than the one before."""
    (line, message), *more = found(row(400, lambda k: 0.1 + 0.2 * (k % 2)), lane=lane)

    assert not more
    assert line == 2 + 3 and "199 of 400" in message


def test_a_few_moves_say_nothing_of_shares() -> None:
    assert found(row(6, lambda k: 0.1 + 0.2 * (k % 2))) == []


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_an_end_that_counts_from_here_where_e_still_counts_from_zero(lane: str) -> None:
    """Cura's usual end: G91 makes E relative for Marlin, and not for RepRapFirmware, which unloads two metres."""
    text = "M82\n" + row(400, lambda k: 5.0 * (k + 1)) + "G91\nG1 E-1 F300\n"

    assert found(text, lane=lane) == []

    run = interpret(
        SourceText("p.gcode", (HEAD + text).encode()),
        Settings(dialect="reprapfirmware", tool_table=ToolTable(), lane=lane),
    )
    for _ in run:
        pass
    (told,) = [finding for finding in run.findings if finding.code == "GS178"]
    assert told.span.line == 2 + 1 + 400 + 2 and told.message.startswith("E falls by 2001 mm at once")
