"""Every kind of broken cell gives its codes at its places: `# expect: CODE LINE:COLUMN` stands in the last lines."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import Severity, code_of
from gcodesim.diagnostics.show import as_text

FOLDER = Path(__file__).parents[2] / "data" / "cells" / "broken"
_EXPECT = re.compile(rb"# expect: (GS\d{3}) (\d+):(\d+)")


def expected(path: Path) -> list[tuple[str, int, int]]:
    return [(code.decode(), int(line), int(column)) for code, line, column in _EXPECT.findall(path.read_bytes())]


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.yaml")), ids=lambda path: path.stem)
def test_findings_have_code_line_and_column(path: Path) -> None:
    loaded = load_cell(path)

    errors = [f for f in loaded.findings if f.level is Severity.ERROR]
    found = [(f.code, f.span.line, f.span.column) for f in errors]
    shown = "\n".join(as_text(f, loaded.sources) for f in errors)
    assert found == sorted(expected(path), key=lambda e: (e[1], e[2])), shown
    assert loaded.cell is None


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.yaml")), ids=lambda path: path.stem)
def test_messages_are_one_good_line(path: Path) -> None:
    loaded = load_cell(path)
    for finding in loaded.findings:
        assert "\n" not in finding.message and finding.message and not finding.message.endswith(".")
        assert code_of(finding.code).remedy
        assert str(path.parent) not in finding.message + finding.hint  # nothing of this machine
        assert finding.span.file in loaded.sources
        assert not finding.span.line or (finding.span.end_line, finding.span.end_column) > (
            finding.span.line,
            finding.span.column,
        )


def test_there_are_many_kinds() -> None:
    assert len(list(FOLDER.glob("*.yaml"))) >= 80
