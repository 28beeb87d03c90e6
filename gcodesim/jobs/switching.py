"""How a program switches its tools: never, for nothing, in rapids, through a change, on nothing, or out of range."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import ToolChange
from gcodesim.cell.signal_values import number_after, value_after
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.diagnostics.events import Flags
from gcodesim.executor.signals import signals_of_rows
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import RAPID, ToolPath
from gcodesim.processes import PROCESSES
from gcodesim.processes.signal import ACTIVE

if TYPE_CHECKING:
    from gcodesim.cell import Cell
    from gcodesim.processes.protocol import Process
    from gcodesim.sensors.sensor import Sensor
    from gcodesim.shop import Shop
    from gcodesim.tools.tool import Tool

_HINT = "the cell says what switches it: `m_codes` (`tool: activate`) or `signals`"


@frozen(eq=False)
class SwitchedTool:
    """A tool with a process that is switched, in the rows `held` (n,) in which it is in use; `on` (n,) by the words."""

    tool: Tool
    process: type[Process]
    held: Flags
    on: Flags


def switching_findings(path: ToolPath, shop: Shop) -> Iterator[Diagnostic]:
    """GS508, GS509, GS514, GS539, GS542, GS549 from the words of a program; a print by E words switches none."""
    if not len(path):
        return
    yield from _out_of_range(path, shop)
    yield from _without_amount(path, shop)
    for switched in switched_tools(path, shop):
        yield from _of_tool(path, shop, switched)


def switched_tools(path: ToolPath, shop: Shop) -> Iterator[SwitchedTool]:
    """The tools in use along a path that words of the program switch; one that prints by E words is not among them."""
    return _switched(path, shop, lambda process, signals, tool: process.is_on(signals, tool))


def tools_seen_on(path: ToolPath, shop: Shop) -> Iterator[SwitchedTool]:
    """The same of those tools that show that they are on; see `Process.is_seen_on`."""
    return _switched(path, shop, lambda process, signals, tool: process.is_seen_on(signals, tool))


def _switched(
    path: ToolPath, shop: Shop, asked: Callable[[type[Process], dict[str, NDArray[Any]], Tool], Flags | None]
) -> Iterator[SwitchedTool]:
    """The tools in use of whose processes `asked` knows whether they are on."""
    signals: dict[str, NDArray[Any]] | None = None
    for tool, held in _tools_in_use(path, shop):
        for kind in tool.processes:
            if signals is None:
                mode = shop.cell.channels[shop.channel].laser_mode
                signals = signals_of_rows(path, shop.signal_sources, shop.signals, mode)
            on = asked(PROCESSES[kind], _of_process(PROCESSES[kind], signals, len(path)), tool)
            if on is not None:
                yield SwitchedTool(tool=tool, process=PROCESSES[kind], held=held, on=on)


def _tools_in_use(path: ToolPath, shop: Shop) -> Iterator[tuple[Tool, Flags]]:
    """The tools that a path uses, and in which of its rows (n,); one that prints by E words is not among them."""
    for number, tool in sorted(shop.cell.tools.items()):
        held = np.array([state.tool == number for state in path.states])[path.state]
        if held.any() and not (path.extrude[held] != 0.0).any():
            yield tool, held


def _of_process(process: type[Process], signals: Mapping[str, NDArray[Any]], n: int) -> dict[str, NDArray[Any]]:
    """What it reads, in each of n rows."""
    return {s.name: signals.get(s.name, np.full(n, s.default)) for s in process.reads}


def _of_tool(path: ToolPath, shop: Shop, switched: SwitchedTool) -> Iterator[Diagnostic]:
    tool, held, on = switched.tool, switched.held, switched.on
    lit, moves = held & on, path.length > 0.0
    work = {"stock": shop.cell.stocks, "surface": shop.cell.coats}.get(switched.process.acts_on, {})
    if not work and switched.process.acts_on == "stock" and lit.any():  # of guns the cell itself is told: GS536
        hint = "describe the work, or the bed that a print stands on, as `stock`"
        message = f"{tool.name} is switched on, and the cell has no `stock` that it could work on"
        yield _told(path, np.flatnonzero(lit), "GS508", message, hint)
    codes, feeds = switched.process.told_by_words, held & (path.kind != RAPID) & moves
    never = bool(work) and feeds.any() and not lit.any()
    if "GS542" in codes and never and not _turned_on(path, shop, switched.process):
        message = f"{tool.name} moves along its path and is never on"
        yield _told(path, np.flatnonzero(feeds), "GS542", message, _HINT)
    rapid = lit & (path.kind == RAPID) & moves
    if "GS539" in codes and rapid.any():
        count = int(rapid.sum())
        message = f"{tool.name} is on in {count} rapid{'s' if count > 1 else ''}"
        yield _told(path, np.flatnonzero(rapid), "GS539", message, "switch it off before the move")
    changes = {noted.row: noted.event for noted in path.events if isinstance(noted.event, ToolChange)}
    for row, event in changes.items():
        if 0 < row < len(path) and lit[row - 1] and not held[row] and on[row]:
            yield Diagnostic(
                code="GS514",
                span=event.span,
                message=f"{tool.name} is on while it is changed for T{event.tool}",
                hint="switch it off before the change",
            )


def _turned_on(path: ToolPath, shop: Shop, process: type[Process]) -> bool:
    """Whether any word switches it on, and be it for a stay only, after which it is off before the next move."""
    switches = [signal for signal in process.reads if signal.set_by]
    values = (value_after(noted.event, each, shop.signal_sources) for noted in path.events for each in switches)
    return any(value is not None and value > 0.0 for value in values)


def _out_of_range(path: ToolPath, shop: Shop) -> Iterator[Diagnostic]:
    """GS509 at the first word that sets a signal to what it cannot be, once for each signal."""
    for name, source in shop.signal_sources.items():
        signal = shop.signals.get(name)
        if signal is None:
            continue
        heard = ((noted.event.span, number_after(noted.event, source)) for noted in path.events)
        off = [(span, v) for span, v in heard if v is not None and not signal.least <= v <= signal.most]
        if off:
            span, value = off[0]
            limit = signal.least if value < signal.least else signal.most
            unit = f" {signal.unit}" if signal.unit else ""
            reach = f"from {signal.least:g} to {signal.most:g}{unit}" if np.isfinite(signal.most) else "0 or more"
            yield Diagnostic(
                code="GS509",
                span=span,
                message=f"`{name}` is set to {value:.4g}{unit}; it can be {reach}",
                hint=f"check the number, and `per` of `signals: {{{name}: …}}` in the cell",
                count=len(off),
                value=value,
                limit=limit,
                unit=signal.unit or None,
            )


def _without_amount(path: ToolPath, shop: Shop) -> Iterator[Diagnostic]:
    """GS549 of tools that are switched on while a signal that they need is 0 as long as they are in use."""
    mode = shop.cell.channels[shop.channel].laser_mode
    signals: dict[str, NDArray[Any]] | None = None
    for tool, held in _tools_in_use(path, shop):
        for process in (PROCESSES[kind] for kind in tool.processes):
            if not process.needs(tool):
                continue
            signals = signals or signals_of_rows(path, shop.signal_sources, shop.signals, mode)
            on = _first_switch(path, shop, process, held)
            for name in (signal.name for signal in process.needs(tool)):
                if on is not None and name in signals and not signals[name][held].any():
                    why, hint = _why_nothing(name, shop)
                    message = f"{tool.name} is switched on, and its `{name}` is 0 all along: {why}"
                    yield Diagnostic(code="GS549", span=on, message=message, hint=hint)


def _why_nothing(name: str, shop: Shop) -> tuple[str, str]:
    """Why a signal stays 0, and what to do."""
    source = shop.signal_sources.get(name)
    if source is None:
        return "the script sets it so", "set another value before it is switched on"
    text = source.word.text
    if source.word.type in ("speed", "turning"):
        return f"the cell gives it by {text}, which counts only while the spindle turns", "say M3 with S before"
    return f"the cell gives it by {text}, and no word sets it", f"say {text} with its number before"


def _first_switch(path: ToolPath, shop: Shop, process: type[Process], held: Flags) -> Span | None:
    """Where a process is first switched on while its tool is `held` (n,), by a word or with the path; None: nowhere."""
    switches = [signal for signal in process.reads if signal.set_by]
    for noted in path.events:
        values = (value_after(noted.event, signal, shop.signal_sources) for signal in switches)
        if held[min(noted.row, len(held) - 1)] and any(value is not None and value > 0.0 for value in values):
            return noted.event.span
    rows = np.flatnonzero(held & path.active)
    return path.span(int(rows[0])) if len(rows) and ACTIVE in process.reads else None


def untriggered(cell: Cell) -> list[Sensor]:
    """The sensors that stand in the cell and read at M-codes: those without a word of their own."""
    return [each.sensor for each in cell.sensors.values() if each.mount.trigger is None]


def _told(path: ToolPath, rows: NDArray[np.intp], code: str, message: str, hint: str) -> Diagnostic:
    return Diagnostic(code=code, span=path.span(int(rows[0])), message=message, hint=hint, count=len(rows))
