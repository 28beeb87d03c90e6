"""Who receives what M-codes do, and who reads the signals of a channel: the processes of the cell's tools."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from gcodesim.cell.channel import CALL, WAIT
from gcodesim.cell.signals import SignalSource
from gcodesim.declarations.reading import Path, Reading, Unread, suggestion
from gcodesim.declarations.units import find, measures, names
from gcodesim.processes.signal import Signal, signals_read_by
from gcodesim.sensors.orders import orders_of

if TYPE_CHECKING:
    from gcodesim.cell.cell import Cell
    from gcodesim.cell.channel import Channel
    from gcodesim.sensors.sensor import Sensor

_PLAIN: Final = "ratio"


def with_signals(cell: Cell, to: Reading) -> Cell:
    """`cell` with what one of each word means in SI; findings for signals and actions that nobody takes.

    Nothing is said about a cell whose tools are not all known.
    """
    asked = [channel for channel in cell.channels.values() if channel.m_codes or channel.signals]
    if not asked or ("tools",) in to.broken or len(to.names_in("tools")) != len(cell.tools):
        return cell
    read = signals_read_by(cell.tools.values())
    sensors = orders_of(_obeying(cell))
    channels = dict(cell.channels)
    for name, channel in channels.items():
        path: Path = ("channels", name) if ("channels", name) in to.spans else ()
        _check_actions(channel, read, sensors, path, to)
        sources = {}
        for signal, source in channel.signals.items():
            scaled = _scaled(source, signal, read, (*path, "signals", signal), to)
            sources[signal] = source if isinstance(scaled, Unread) else scaled
        channels[name] = replace(channel, signals=sources)
    return replace(cell, channels=channels)


def _obeying(cell: Cell) -> list[Sensor]:
    """The sensors that read at actions of M-codes: those of the cell without a word of their own, and tools."""
    own = [mounted.sensor for mounted in cell.sensors.values() if mounted.mount.trigger is None]
    return own + [tool.sensor for tool in cell.tools.values() if tool.sensor is not None]


def _check_actions(
    channel: Channel, read: Mapping[str, Signal], orders: Collection[tuple[str, str]], path: Path, to: Reading
) -> None:
    received = {f"{action.target}: {action.verb}": None for signal in read.values() for action in signal.set_by}
    received |= {f"{target}: {verb}": None for target, verb in orders}
    for word, code in channel.m_codes.items():
        action = f"{code.target}: {code.verb}"
        if action in received or code.target in (WAIT, CALL):
            continue
        takers = "tools and sensors" if orders else "tools"
        listed = ", ".join(f"`{each}`" for each in received)
        hint = f"{takers} of this cell receive {listed}" if listed else "no tool of this cell receives an action"
        to.fault(
            "GS735",
            to.span((*path, "m_codes", word)),
            f"{word} does `{action}`, and nothing in this cell receives it",
            f"{hint}; add the tool that is meant, or delete the entry",
        )


def _scaled(
    source: SignalSource, name: str, read: Mapping[str, Signal], path: Path, to: Reading
) -> SignalSource | Unread:
    if name not in read:
        known = suggestion(name, sorted(read)) or "no tool of this cell has a process that reads signals"
        return to.fault("GS712", to.key(path), f"no tool of this cell reads a signal `{name}`", known)
    unit, per = read[name].unit, source.per
    if per is None:
        return source
    dimensions = _dimensions(unit)
    if per.unit == unit:
        return replace(source, factor=per.value)
    span = to.span((*path, "per"))
    if not per.unit:
        own = next((each for d in dimensions if (each := to.plain.of(d)) is not None), None)
        if own is not None:
            return replace(source, factor=per.value * own.factor)
        message = f"`per` is {per.value:g} without a unit; the signal `{name}` is in {unit}"
        return to.fault("GS708", span, message, f"write for example `{per.value:g} {unit}`")
    for dimension in dimensions:
        found = find(per.unit, dimension)
        if found is not None:
            return replace(source, factor=per.value * found.factor, zero=found.offset)
    units = ", ".join(dict.fromkeys(each for d in dimensions for each in names(d))) or unit
    return to.fault(
        "GS709",
        span,
        f"`per` is {per.value:g} {per.unit}; the signal `{name}` is in {unit or 'plain numbers'}",
        f"its units: {units}" if units else "write the number alone",
    )


def _dimensions(unit: str) -> tuple[str, ...]:
    """What an SI unit measures; a plain number is a ratio. Empty for a unit that no table has."""
    if not unit:
        return (_PLAIN,)
    return tuple(d for d in measures(unit) if (found := find(unit, d)) is not None and found.factor == 1.0)
