"""Times and volumes of a program's lines from its last run, for the lines of an editor."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from gcodesim.diagnostics.plain import table_text
from gcodesim.editor.state_text import number

if TYPE_CHECKING:
    from gcodesim.editor.program_document import ProgramDocument

_MOST: Final = 500
"""Lines with a remark; in a long program the slowest."""

_MOST_BYTES: Final = 50_000_000


class LineUse(NamedTuple):
    """What the last run says of a line, from 0."""

    line: int
    text: str


def line_uses(document: ProgramDocument) -> list[LineUse]:
    """Time and removed volume of each line in the last run; nothing if that was of another text."""
    folder = document.choices.out or document.path.parent / "out"
    try:
        rows = _rows(folder, document)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return []  # there is no run, or what is there was not written by one
    slowest = sorted(rows, key=lambda row: (-row[1], row[0]))[:_MOST]
    return [LineUse(line, _text(time, removed)) for line, time, removed in sorted(slowest)]


def _rows(folder: Path, document: ProgramDocument) -> list[tuple[int, float, float]]:
    program = json.loads(_read(folder / "results.json"))["inputs"]["program"]
    if program["sha256"] != document.source.sha256:
        return []
    table = csv.DictReader(io.StringIO(_read(folder / "lines.csv")))
    name = table_text(document.source.name)
    own = [row for row in table if row["file"] == name]
    return [(int(row["line"]) - 1, float(row["time_s"]), float(row.get("removed_mm3") or 0.0)) for row in own]


def _read(path: Path) -> str:
    if path.stat().st_size > _MOST_BYTES:
        raise ValueError("too long to be shown beside lines")
    return path.read_text(encoding="utf-8")


def _text(time: float, removed: float) -> str:
    return f"{number(time)} s" + (f", {number(removed)} mm³ removed" if removed else "")
