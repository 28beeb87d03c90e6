"""Warnings of a few lines, read by each lane."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from gcodesim.diagnostics import Severity, SourceText
from gcodesim.rs274 import Settings, ToolEntry, ToolTable, interpret

HEAD = "G21 G90 G17 G94\n"
TOOLS = ToolTable(
    {
        1: ToolEntry(number=1, pocket=1, offset=(0, 0, 0.05, 0, 0, 0, 0, 0, 0), diameter=6e-3),
        2: ToolEntry(number=2, pocket=2, offset=(0, 0, 0.0625, 0, 0, 0, 0, 0, 0), diameter=10e-3),
        21: ToolEntry(number=21, pocket=21, offset=(0, 0, 0.051, 0, 0, 0, 0, 0, 0), diameter=6e-3),
    }
)
Warned = Callable[..., list[tuple[str, int, int]]]


@pytest.fixture
def warned() -> Warned:
    """Code, line and column of all warnings of a program; lines count from 1 in `text`, whose end is M2 by itself."""

    def read(text: str, *, end: str = "\nM2\n", **settings: object) -> list[tuple[str, int, int]]:
        source = SourceText("p.ngc", (text + end).encode())
        run = interpret(source, Settings(tool_table=TOOLS, **settings))  # type: ignore[arg-type]
        for _ in run:
            pass
        assert run.failed is None, run.failed
        return [(f.code, f.span.line, f.span.column) for f in run.findings if f.level is Severity.WARNING]

    return read
