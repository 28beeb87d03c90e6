"""What is wrong with how a beam was used: on in a rapid, on nothing, never on, out of focus, without gas."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic
from gcodesim.diagnostics.events import Flags
from gcodesim.processes.rows import Rows
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.processes.beam import Beam

Array = NDArray[np.float64]

LEAST: Final = 0.01
"""[s] for which a beam may be on in a row that is not meant: a step at the border of two rows counts as one of them."""
ROUNDED: Final = 1e-5
"""Of the full power, by which the power that is asked for may be beyond it: `per` of a signal has few digits."""


def beam_findings(rows: Rows, kind: type[Beam]) -> Iterator[Diagnostic]:
    """GS540 to GS546 from the columns that beams write; one for each kind of misuse and tool."""
    for number, tool in sorted(rows.tools.items()):
        if kind.kind not in tool.processes:
            continue
        mine = rows.tool == number
        if mine.any():
            yield from _of_tool(rows, kind, tool, mine)


def _of_tool(rows: Rows, kind: type[Beam], tool: Any, mine: Flags) -> Iterator[Diagnostic]:
    lit, landed = rows["beam"], rows[kind.landed]
    name = rows.tool_name(int(np.argmax(mine)))
    rapid = mine & rows.rapid & (rows["beam_in_rapid"] > LEAST)
    if rapid.any():
        seconds = float(rows["beam_in_rapid"][rapid].sum())
        yield rows.told(np.flatnonzero(rapid), "GS540", f"{name} is on for {seconds:.3f} s of rapid moves",
                    "switch it off before the move", (seconds, 0.0, "s"))  # fmt: skip
    missed = mine & ~rows.rapid & (lit > LEAST) & (landed <= 0.0)
    if missed.any():
        seconds = float(lit[missed].sum())
        yield rows.told(np.flatnonzero(missed), "GS541", f"{name} is on for {seconds:.3f} s and strikes no stock",
                    "check the path and the height, or switch it on later", (seconds, 0.0, "s"))  # fmt: skip
    if rows.ended and not lit[mine].any() and (mine & ~rows.rapid).any():
        hint = "the cell says what switches it: `signals` (`power`, `beam`), `m_codes` (`tool: activate`), `laser_mode`"
        message = f"{name} moves along its path and is never on"
        yield rows.told(np.flatnonzero(mine & ~rows.rapid), "GS542", message, hint)
    lit_rows = mine & (landed > 0.0)
    unknown = getattr(tool, "specific_energy", 0.0) is None
    if rows.ended and unknown and lit_rows.any() and not rows["removed"][mine].any():
        hint = "give the tool a `specific_energy`, such as `3 J/mm^3`, if it is to engrave or cut"
        message = f"{name} gives {float(landed[mine].sum()):.4g} J and takes nothing: nobody knows what that would need"
        yield rows.told(np.flatnonzero(lit_rows), "GS546", message, hint)
    # a row that has begun where it is meant to may go deep: the beam stands in its own hole
    off = np.where(mine & (rows["in_focus"] <= 0.0), rows["out_of_focus"], 0.0)
    if off.any():
        worst, allowed = float(off.max()) / MM, tool.tolerance / MM
        message = f"{name} strikes {worst:.3g} mm from where it is meant to; {allowed:.3g} mm are allowed"
        hint = "check the height, `stand_off`, `focus` and `tolerance`"
        yield rows.told(np.flatnonzero(off > 0.0), "GS543", message, hint, (worst, allowed, "mm"))
    beyond = np.where(mine, rows["beam_too_much"], 0.0)
    if beyond.any() and float(beyond.max()) > (1.0 + ROUNDED) * float(tool.power):
        most, full = float(beyond.max()), float(tool.power)
        message = f"the program asks {name} for {most:.4g} W; it has {full:.4g} W"
        hint = "it runs with full power; check `signals` and `power`"
        yield rows.told(np.flatnonzero(beyond > 0.0), "GS544", message, hint, (most, full, "W"))
    dry = mine & (rows["beam_without_gas"] > LEAST)
    if dry.any():
        seconds = float(rows["beam_without_gas"][dry].sum())
        yield rows.told(np.flatnonzero(dry), "GS545", f"{name} cuts for {seconds:.3f} s without gas",
                    "switch the gas on before the beam", (seconds, 0.0, "s"))  # fmt: skip
