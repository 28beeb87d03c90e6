"""What no turner would do: rapids through the work, back edges and shanks that cut, tools in the chuck."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic
from gcodesim.diagnostics.events import runs
from gcodesim.processes.repeated import folded
from gcodesim.processes.rows import Rows
from gcodesim.units import MM, MM3

Event = NDArray[np.intp]
"""Numbers of the rows of one event."""

_GRAZED: Final = 0.05 * MM3
"""What a rapid may take without being told [m³]: rounding along a wall."""

_RUBS: Final = 2.0e-6
"""How deep [m] a shank may be in material, or a tool in chuck or tailstock, without being told: they touch."""


def turning_findings(rows: Rows) -> list[Diagnostic]:
    """GS401, GS431 to GS434 and GS501, from the columns that `Turning` writes, once for each kind and place.

    A block of a cycle makes many passes.
    """
    return folded(_events(rows))


def _events(rows: Rows) -> Iterator[Diagnostic]:
    for event in rows.events(rows["lathe_rapid"] > _GRAZED):
        taken = float(rows["lathe_rapid"][event].sum()) / MM3
        message = f"rapid move of {_name(rows, event)} takes {taken:.1f} mm³ of stock away"
        hint = "retract before the move, or make it a feed move"
        yield rows.told(event, "GS401", message, hint, (taken, 0.0, "mm^3"))
    never = np.zeros(len(rows), dtype=np.bool_)
    for event in rows.events(rows["lathe_still"] > _GRAZED, never):
        taken = float(rows["lathe_still"][event].sum()) / MM3
        message = f"{_name(rows, event)} feeds through {taken:.1f} mm³ of stock with the spindle stopped"
        yield rows.told(event, "GS501", message, "start it with `S` and `M3` before this line", (taken, 0.0, "mm^3"))
    for event in rows.events(rows["back_edge"] > _GRAZED):
        taken = float(rows["back_edge"][event].sum()) / MM3
        message = f"gouge: the back edge of {_name(rows, event)} cuts {taken:.2f} mm³ that its tip does not reach"
        hint = "take an insert with a smaller tip angle, another holder, or come from the other side"
        yield rows.told(event, "GS431", message, hint, (taken, 0.0, "mm^3"))
    for event in rows.events(rows["lathe_shank"] > _RUBS):
        worst = float(rows["lathe_shank"][event].max()) / MM
        message = f"the shank of {_name(rows, event)} runs into the work, {worst:.3f} mm deep"
        yield rows.told(event, "GS432", message, "cut less deep, or use a tool with longer edges", (worst, 0.0, "mm"))
    for event in rows.events(rows["lathe_guard"] > _RUBS):
        worst = float(rows["lathe_guard"][event].max()) / MM
        message = f"{_name(rows, event)} runs into chuck or tailstock, {worst:.3f} mm deep"
        hint = "hold the work longer out of the jaws, or stop earlier"
        yield rows.told(event, "GS433", message, hint, (worst, 0.0, "mm"))
    for event in runs(rows["lathe_inside"] > 0.0, group=np.cumsum(rows.changed)):
        first = int(event[0])
        late = bool(rows.changed[1 : first + 1].any())
        when = "where it is put into the turret" if late else "when the program starts"
        seconds = float(rows["lathe_inside"][event].sum())
        message = f"{_name(rows, event)} stands in stock {when}; it cuts nothing until it has left the stock"
        hint = "go farther away before the tool change, or check `length` of the tools"
        found = rows.told(event, "GS403" if late else "GS402", message, hint, (seconds, 0.0, "s"))
        yield replace(found, span=rows.change_spans.get(first) or found.span)
    for event in rows.events(rows["lathe_aside"] > 0.0, never):
        message = f"{_name(rows, event)} drills beside the middle of work that turns"
        yield rows.told(event, "GS434", message, "go to X0 before it drills", (0.0, 0.0, "mm"))


def _name(rows: Rows, event: Event) -> str:
    return rows.tool_name(int(event[0]))
