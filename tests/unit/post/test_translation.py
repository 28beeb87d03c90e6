"""Programs for other controls that read G-code: the same canonical events, or an error with its line."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from gcodesim import canon
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.post.translation import Translation, translated
from gcodesim.rs274 import Settings, ToolTable, interpret
from gcodesim.rs274.assumed import assumed_tools

ROOT = Path(__file__).parents[3]
DATA = ROOT / "tests" / "data" / "conformance"
TABLE = "T1 P1 Z+50 D+6\nT2 P2 Z+60 D+8\n"


def settings(dialect: str = "linuxcnc") -> Settings:
    return Settings(dialect=dialect, tool_table=ToolTable.read(SourceText("tool.tbl", TABLE.encode()))[0])


def posted(text: str, dialect: str, source: str = "linuxcnc") -> Translation:
    return translated(SourceText("part.nc", text.encode()), settings(source), dialect)


def moves(text: str, dialect: str) -> list[tuple[Any, ...]]:
    """What a control does with a text, in mm and mm/min: written down apart from the code that is tested."""
    found = []
    source = SourceText("x", text.encode())
    printer = dialect in ("marlin", "klipper")
    own = Settings(dialect=dialect, tool_table=assumed_tools(source)) if printer else settings(dialect)
    run = interpret(source, own)
    for event in run:
        if isinstance(event, canon.ArcFeed):
            found.append(("arc", *mm(event.end), *mm(event.center), round(math.degrees(event.sweep), 3), feed(event)))
        elif isinstance(event, canon.LinearFeed):
            found.append(("line", *mm(event.end), feed(event)))
        elif isinstance(event, canon.Rapid):
            found.append(("rapid", *mm(event.end)))
        elif isinstance(event, canon.Dwell):
            found.append(("dwell", event.seconds))
        elif isinstance(event, canon.ToolChange):
            found.append(("tool", event.tool))
        elif isinstance(event, canon.Spindle) and event.span.line:
            found.append(("spindle", event.direction, round(event.speed * 30 / math.pi, 6)))
        elif isinstance(event, canon.Coolant) and event.span.line:
            found.append(("coolant", event.flood, event.mist))
    assert not [finding for finding in run.findings if finding.level >= Severity.ERROR]
    return found


def mm(point: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(round(v * 1000, 3) + 0.0 for v in point[:3])


def feed(event: canon.LinearFeed | canon.ArcFeed) -> float:
    return round(event.feed * (60000 if event.feed_unit == "m/s" else 1000), 4)


LOOP = """G20 G90 G17
T1 M6 G43 H1
S3000 M3 M8
#1 = 0
o10 while [#1 LT 2]
#1 = [#1 + 1]
G0 X[#1] Y0 Z0.1
G1 Z-0.05 F10
G2 X[#1] Y1 I0 J0.5
G81 X[#1 + 2] Y2 Z-0.2 R0.1
o10 endwhile
G80 G4 P0.5
M9 M5
M2
"""


@pytest.mark.parametrize("dialect", ["linuxcnc", "rs274", "fanuc"])
def test_loops_cycles_and_inches_are_unrolled(dialect: str) -> None:
    found = posted(LOOP, dialect)

    assert found.text is not None
    assert moves(found.text, dialect) == moves(LOOP, "linuxcnc")
    assert not any(word in found.text for word in ("while", "G81", "#", "G20"))
    assert "G43 H1" in found.text


def test_the_first_tool_of_grbl_is_put_in_by_hand() -> None:
    found = posted(LOOP.replace("G43 H1", ""), "grbl")

    assert found.text is not None
    assert moves(found.text, "grbl") == [act for act in moves(LOOP, "linuxcnc") if act[0] != "tool"]
    assert [finding.code for finding in found.findings] == ["GS802"]
    again = posted("T1 M6\nG0 X1\nT2 M6\nG0 X2\nM2\n", "grbl")
    assert again.text is None and again.findings[0].span.line == 3


@pytest.mark.parametrize(
    ("text", "dialect", "line"),
    [
        ("G0 X1\nM64 P1\nM2\n", "fanuc", 2),
        ("G0 X1 S100 M3\nG33.1 Z-5 K1\nM2\n", "grbl", 2),
        ("G0 X1\nG2 X1 I5 P3 F100\nM2\n", "fanuc", 2),
        ("G0 X1\nG0 A90\nM2\n", "grbl", 2),
        ("G0 X1\nG38.3 Z-5 F100\nM2\n", "rs274", 2),
        ("G0 X1\nG59.1\nG0 X2\nM2\n", "grbl", 2),
        ("G0 X1\nG28\nM2\n", "fanuc", 2),
        ("G0 X1\no<sub> sub\nG0 X2\nM19 R90\no<sub> endsub\no<sub> call\nM2\n", "rs274", 4),
    ],
)
def test_what_cannot_be_said_is_an_error_with_its_line(text: str, dialect: str, line: int) -> None:
    found = posted(text, dialect)

    assert found.text is None
    assert [(finding.code, finding.span.line) for finding in found.findings] == [("GS801", line)]


def test_a_program_with_errors_is_refused_with_them() -> None:
    found = posted("G0 X1\nG99999\nM2\n", "fanuc")
    assert found.text is None
    assert [finding.span.line for finding in found.findings] == [2]


def test_lengths_and_radii_of_unknown_tools() -> None:
    """G43 is kept, whatever the length; a radius that nobody knows may not become part of the path."""
    bare = Settings()
    found = translated(SourceText("part.nc", b"T3 M6\nG43 H3\nG0 Z5\nG43 H4\nG0 Z5\nG49\nG0 Z9\nM2\n"), bare, "fanuc")
    assert found.text is not None
    assert [line for line in found.text.splitlines() if line.startswith("G4")] == ["G43 H3", "G43 H4", "G49"]

    beside = translated(SourceText("part.nc", b"T3 M6\n(G41)\nG1 G42 D3 X5 F100\nX9\nM2\n"), bare, "fanuc")
    assert beside.text is None and beside.findings[0].span.line == 3
    known = posted("T1 M6\nG42 D1\nG1 X5 Y5 F100\nX9\nG40\nG1 X20\nM2\n", "grbl")
    assert known.text is not None and "G42" not in known.text


def test_printers() -> None:
    text = "G21\nG90\nG28\nM82\nT0\nG92 E0\nG1 X20 Y20 Z0.2 F3000\nG1 X40 E1 F1200\nG10\nG1 X60 E2\nG4 P250\n"
    found = translated(SourceText("p.gcode", text.encode()), Settings(dialect="marlin"), "klipper")

    assert found.text is not None, found.findings
    assert moves(found.text, "klipper") == moves(text, "marlin")
    mill = translated(SourceText("p.gcode", text.encode()), Settings(dialect="marlin"), "fanuc")
    assert mill.text is None


def corpus(folder: str) -> list[Path]:
    return sorted((DATA / folder / "valid").glob("*.n*c"))


def translate_all(folder: str, dialect: str, paths: list[Path]) -> int:
    """How many of these programs are posted; each of them is proven the same, and each refusal has a line."""
    table = ToolTable.read(SourceText.read(DATA / folder / "tools.tbl"))[0]
    source = "linuxcnc" if folder == "rs274" else folder
    own = Settings(dialect=source, tool_table=table, subroutines=(DATA / folder / "subs",))
    count = 0
    for path in paths:
        found = translated(SourceText.read(path), own, dialect)
        if found.text is None:
            assert found.findings and found.findings[0].code.startswith("GS")
            assert "something else" not in found.findings[0].message or path.stem in ODD
        else:
            count += 1
    return count


ODD = {"tool_offsets_in_x_and_y"}
"""G43 of Fanuc is about Z alone."""


@pytest.mark.parametrize(
    ("folder", "dialect", "least"), [("rs274", "linuxcnc", 0.95), ("rs274", "fanuc", 0.8), ("fanuc", "linuxcnc", 0.9)]
)
def test_a_part_of_the_conformance_programs(folder: str, dialect: str, least: float) -> None:
    paths = corpus(folder)[:: 6 if folder == "rs274" else 2]
    assert translate_all(folder, dialect, paths) >= least * len(paths)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("folder", "dialect", "least"),
    [
        ("rs274", "linuxcnc", 0.98),
        ("rs274", "rs274", 0.85),
        ("rs274", "fanuc", 0.82),
        ("rs274", "grbl", 0.8),
        ("fanuc", "linuxcnc", 0.9),
        ("fanuc", "fanuc", 0.9),
        ("fanuc", "grbl", 0.9),
    ],
)
def test_all_conformance_programs(folder: str, dialect: str, least: float) -> None:
    paths = corpus(folder)
    assert translate_all(folder, dialect, paths) >= least * len(paths)


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted((ROOT / "programs").glob("*.n*c")), ids=lambda path: path.stem)
def test_all_shipped_programs(path: Path) -> None:
    source = SourceText.read(path)
    own = Settings(tool_table=assumed_tools(source), subroutines=(path.parent,), has_cell=True)
    for dialect in ("linuxcnc", "fanuc"):
        found = translated(source, own, dialect)
        assert found.text is not None or found.findings[0].span.line > 0
