"""Cells from text, for tests."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

from gcodesim.cell import Cell, LoadedCell, read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.show import as_text

NOWHERE = Path(__file__).parents[2] / "data" / "cells" / "sound" / "cell.yaml"


def loaded(text: str, path: Path = NOWHERE) -> LoadedCell:
    return read_cell(SourceText("cell.yaml", dedent(text).encode()), path)


def sound(text: str, path: Path = NOWHERE) -> Cell:
    """The cell of a text without errors."""
    result = loaded(text, path)
    assert result.cell is not None, "\n".join(as_text(f, result.sources) for f in result.findings)
    return result.cell


def codes(text: str, path: Path = NOWHERE) -> list[str]:
    return [finding.code for finding in loaded(text, path).findings]
