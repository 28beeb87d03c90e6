"""Filament that is pushed while the head has no nozzle."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gcodesim.cell import Cell
from gcodesim.diagnostics import Diagnostic
from gcodesim.motion.tool_path import ToolPath
from gcodesim.tools.extruder import Extruder
from gcodesim.units import MM


def unused_filament_findings(path: ToolPath, cell: Cell) -> Iterator[Diagnostic]:
    """GS548 where E words push filament and the tool in the head is no extruder; at the first such move."""
    pushed = np.flatnonzero(path.extrude > 0.0)
    if not len(pushed):
        return
    numbers = np.array([state.tool for state in path.states])[path.state[pushed]]
    lost = np.array([not isinstance(cell.tools.get(int(number)), Extruder) for number in numbers])
    if not lost.any():
        return
    first = int(np.flatnonzero(lost)[0])
    number, length = int(numbers[first]), float(path.extrude[pushed[lost]].sum())
    tool = cell.tools.get(number)
    why = "there is no tool in the head" if tool is None else f"T{number} is no extruder"
    nozzles = sorted(each for each, known in cell.tools.items() if isinstance(known, Extruder))
    hint = "`tools: {0: {type: extruder, bead_width: 0.45, bead_height: 0.2, filament_diameter: 1.75}}` is one"
    if nozzles:
        hint = "the cell has " + ", ".join(f"T{each}" for each in nozzles) + ": choose it before the first E word"
    yield Diagnostic(
        code="GS548",
        span=path.span(int(pushed[first])),
        message=f"{length / MM:.1f} mm of filament go nowhere: {why}",
        hint=hint,
        count=int(lost.sum()),
        value=length / MM,
        limit=0.0,
        unit="mm",
    )
