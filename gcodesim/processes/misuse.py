"""What no machinist would do with a cutter: rapids through stock, feeding with the spindle off, shanks in stock.

An event continues over rows that are free of it until the tool leaves with a rapid that touches nothing, or tool
or spindle change; it is reported once, at its first row, with the worst number of all its rows.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic
from gcodesim.diagnostics.events import Flags, runs
from gcodesim.processes.repeated import folded
from gcodesim.processes.rows import Rows
from gcodesim.tools.cutter import Cutter
from gcodesim.units import MM, MM3, UM

Array = NDArray[np.float64]
Event = NDArray[np.intp]
"""Numbers of the rows of one event."""

RUB: Final = 2.0 * UM
"""[m] of its own wall that an arm may take when it comes back with a different deflection than before."""

_PROBES: Final = frozenset(("G31", "G38.2", "G38.3", "G38.4", "G38.5"))  # what they touch ends them on the machine
_LEFT_TAPS: Final = frozenset(("G74",))


def cutter_findings(rows: Rows) -> list[Diagnostic]:
    """GS401 to GS405, GS407, GS409, GS501 and GS502, from the columns that `Milling` writes."""
    # on its way out of a hole: the tool has been down there already
    rapid_cut = _but(rows["rapid_cut"], rows.retreat)
    stopped = _but(rows["stopped_cut"], rows.retreat | rows.with_word(_PROBES) | _never_turns(rows))
    backwards = _but(rows["reversed_cut"], rows.retreat | rows.with_word(_LEFT_TAPS))
    shank, holder, inside = rows["shank_depth"], rows["holder_depth"], rows["inside"]
    found: list[Diagnostic] = []
    # this is asked of the whole program again and again, and most of these columns are empty
    deep = shank.any() or holder.any()
    if deep or rapid_cut.any():
        grazed = rows["rapid_bound"] + _least(rows, rows["rapid_depth"])
        found += _rapids(rows, rapid_cut, grazed)
    if inside.any():
        found += _inside(rows, inside)
    if deep:
        fault = (shank > 0.0) | (holder > 0.0) | (stopped > 0.0) | (backwards > 0.0)
        away = rows.rapid & ~fault & (rapid_cut <= grazed) & (inside <= 0.0)
        found += _in_stock(rows, "shank", shank, away)
        found += _in_stock(rows, "holder", holder, away)
    for code, taken in {"GS501": stopped, "GS502": backwards}.items():
        if taken.any():
            found += _spindle(rows, code, taken)
    if rows["sideways_cut"].any():
        found += _sideways(rows)
    return [*folded(found), *_blind(rows)]


def _but(column: Array, never: Flags) -> Array:
    """A column (n,), zero in the rows that `never` count."""
    return np.where(never, 0.0, column) if column.any() else column


def _least(rows: Rows, depth: Array | None = None) -> Array:
    """What each row (n,) may remove [m³] without counting as a cut: a cell, or rubbing at the tool's own wall.

    That is as high as the flutes, or as the tool is in the stock if its `depth` (n,) [m] is known.
    """
    least = np.full(len(rows), rows.grain)
    for number, tool in rows.tools.items():
        if isinstance(tool, Cutter):
            own = rows.tool == number
            height = tool.flute_length if depth is None else np.minimum(depth[own], tool.flute_length)
            least[own] = np.maximum(rows.grain, RUB * np.pi * tool.diameter * height)
    return least


def _never_turns(rows: Rows) -> Flags:
    """Rows (n,) with a tool that cuts without turning: a drag knife."""
    still = [number for number, tool in rows.tools.items() if isinstance(tool, Cutter) and not tool.turns]
    found: Flags = np.isin(rows.tool, still)
    return found


def _blind(rows: Rows) -> list[Diagnostic]:
    """GS407: cuts while a rotary axis of unknown place turns, one for each stretch of such rows."""
    found = []
    removed = rows["removed"]
    for letter, turns in rows.turns.items():
        for event in runs(turns & (removed > 0.0)):
            taken = float(removed[event].sum()) / MM3
            message = (
                f"{taken:.1f} mm³ of stock are cut while axis {letter} turns, whose place is not known; "
                "the cut is computed as if it stood still"
            )
            hint = f"give axis {letter} of the machine its `at: [x, y, z]`, a point on the axis"
            found.append(rows.told(event, "GS407", message, hint, (taken, 0.0, "mm^3")))
    return folded(found)


def _rapids(rows: Rows, cut: Array, bound: Array) -> Iterator[Diagnostic]:
    for event in rows.events(rows.rapid & (cut > bound)):
        volume, allowed = cut[event].sum() / MM3, bound[event].sum() / MM3
        message = (
            f"rapid move of {rows.tool_name(int(event[0]))} takes {volume:.1f} mm³ of stock away; "
            f"{allowed:.1f} mm³ could be an error of the grid"
        )
        hint = "retract before the move, or make it a feed move"
        yield rows.told(event, "GS401", message, hint, (volume, allowed, "mm^3"))


def _inside(rows: Rows, inside: Array) -> Iterator[Diagnostic]:
    for event in runs(inside > 0.0, group=np.cumsum(rows.changed)):
        first = int(event[0])
        # a tool that is in the spindle before anything has moved is there from the start
        late = bool(rows.changed[1 : first + 1].any())
        when = "where it is put into the spindle" if late else "when the program starts"
        yield Diagnostic(
            code="GS403" if late else "GS402",
            message=f"{rows.tool_name(first)} stands in stock {when}; it cuts nothing for {inside[event].sum():.3f} s, "
            "until it has left the stock",
            span=rows.change_spans.get(first) or rows.span(first),
            hint="retract before the tool change" if late else "check `stock`, `work_offsets` and `home` of the cell",
            time=float(rows.time[first]),
            value=float(inside[event].sum()),
            limit=0.0,
            unit="s",
        )


_IN_STOCK: Final = {
    "shank": ("GS404", "the flutes are too short for this depth"),
    "holder": ("GS405", "use a longer tool or a slimmer holder, or cut less deep beside the wall"),
}


def _in_stock(rows: Rows, part: str, depth: Array, away: Flags) -> Iterator[Diagnostic]:
    code, hint = _IN_STOCK[part]
    for event in rows.events(depth > 0.0, away):
        worst = float(depth[event].max()) / MM
        message = f"{part} of {rows.tool_name(int(event[0]))} runs into stock, {worst:.3f} mm deep"
        yield rows.told(event, code, message, hint, (worst, 0.0, "mm"))


def _sideways(rows: Rows) -> Iterator[Diagnostic]:
    cut, least = rows["sideways_cut"], _least(rows)
    for event in rows.events(cut > 0.0):
        taken = float(cut[event].sum())
        if taken <= least[event].max():
            continue  # its own wall, as the grid shows it
        tool = rows.tools.get(int(rows.tool[event[0]]))
        kind = "tool" if tool is None else tool.kind.replace("_", " ")
        name = rows.tool_name(int(event[0]))
        message = f"{name} takes {taken / MM3:.1f} mm³ sideways, and a {kind} cuts along its axis"
        yield rows.told(event, "GS409", message, "lift it before the move, or use a mill", (taken / MM3, 0.0, "mm^3"))


_TURNS: Final = {
    "GS501": ("the spindle stopped", "start it with `S` and `M3` before this line"),
    "GS502": ("the spindle turning backwards (M4)", "use `M3`"),
}


def _spindle(rows: Rows, code: str, volume: Array) -> Iterator[Diagnostic]:
    how, hint = _TURNS[code]
    least = rows["rapid_bound"] + _least(rows)
    never = np.zeros(len(rows), dtype=np.bool_)  # one cause, until tool or spindle change
    for event in rows.events(volume > 0.0, never):
        taken = float(volume[event].sum()) / MM3
        if volume[event].sum() <= least[event].max():
            continue  # a tap on its way out, in its own thread: below what the grid can show
        message = f"{rows.tool_name(int(event[0]))} feeds through {taken:.1f} mm³ of stock with {how}"
        yield rows.told(event, code, message, hint, (taken, 0.0, "mm^3"))
