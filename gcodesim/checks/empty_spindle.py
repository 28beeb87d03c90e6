"""A program that feeds through the cell without any tool."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gcodesim.cell import Cell
from gcodesim.diagnostics import Diagnostic
from gcodesim.motion.tool_path import LINE, ToolPath
from gcodesim.units import MM


def empty_spindle_findings(path: ToolPath, cell: Cell) -> Iterator[Diagnostic]:
    """GS506 when the program feeds and no move of it has a tool, so that it can cut nothing; at the first such move.

    A program that pushes filament is GS548 instead.
    """
    if not cell.stocks or not len(path) or 0 in cell.tools or (path.extrude > 0.0).any():  # tool 0 is an extruder
        return
    tools = np.array([state.tool for state in path.states])[path.state]
    feeds = np.flatnonzero((path.kind >= LINE) & np.isfinite(path.feed) & (path.length > 0.0))
    if not len(feeds) or tools.any():
        return
    way = float(path.length[feeds].sum())
    numbers = sorted(cell.tools)
    hint = "name the tool in the spindle in the cell, as `loaded_tool: 1`, or call one with T1 M6"
    if not numbers:
        hint = "describe the tool under `tools:`, and name it as `loaded_tool: 1`"
    elif len(numbers) == 1:
        hint = f"say in the cell that T{numbers[0]} is in the spindle: `loaded_tool: {numbers[0]}`"
    yield Diagnostic(
        code="GS506",
        span=path.span(int(feeds[0])),
        message=f"the spindle is empty while the program feeds {way / MM:.1f} mm: nothing can be cut",
        hint=hint,
        value=0.0,
        limit=1.0,
    )
