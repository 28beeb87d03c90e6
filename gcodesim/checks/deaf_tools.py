"""Words that switch a tool on, while the spindle has none that they switch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache

from gcodesim.canon import Action, Output, ToolChange, ToolNumber
from gcodesim.cell.signal_values import number_after
from gcodesim.cell.signals import SignalSource
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.motion.tool_path import ToolPath
from gcodesim.processes import PROCESSES
from gcodesim.processes.signal import Signal
from gcodesim.sensors.orders import orders_of, orders_of_all
from gcodesim.sensors.sensor import Sensor
from gcodesim.tools.tool import Tool


def deaf_tool_findings(
    path: ToolPath,
    tools: Mapping[int, Tool],
    loaded: int,
    mounted_sensors: Sequence[Sensor],
    sources: Mapping[str, SignalSource],
    signals: Mapping[str, Signal],
) -> Iterator[Diagnostic]:
    """GS507 for actions that switch on what the tool in the spindle, at first `loaded`, is not: one for each tool.

    The same for outputs that are the `sources` of switches among the `signals`, and for words at which sensors read,
    where neither the tool in use nor one of the `mounted_sensors` does. At its first place, with the count.
    """
    orders, everywhere = sensor_orders(), orders_of(mounted_sensors)
    switches = {name: source for name, source in sources.items() if _is_switch(signals.get(name), source)}
    mounted, found = loaded, dict[tuple[int, str, str], list[Span]]()
    for noted in path.events:
        event = noted.event
        if isinstance(event, ToolChange | ToolNumber):
            mounted = event.tool
        elif isinstance(event, Action):
            tool = tools.get(mounted)
            order = (event.target, event.verb)
            if order in orders:
                hears = order in everywhere or (tool is not None and order in orders_of(_sensor_of(tool)))
            else:
                hears = tool is not None and any(_switches(kind, *order) for kind in tool.acts_by)
            if not hears and (order in orders or is_switch(*order)):
                found.setdefault((mounted, event.target, event.verb), []).append(event.span)
        if isinstance(event, Action | Output):
            for name, source in switches.items():
                value = number_after(event, source)
                if value is not None and value > 0.0 and not _reads(tools.get(mounted), name):
                    found.setdefault((mounted, name, ""), []).append(event.span)
    for (number, target, verb), spans in found.items():
        held = tools.get(number)
        missed = "finds no sensor that reads" if (target, verb) in orders else "switches nothing on"
        said = f"{target}: {verb}" if verb else target
        what = "no tool is in the spindle" if held is None else f"{held.name} is of type `{held.kind}`"
        yield Diagnostic(
            code="GS507",
            span=spans[0],
            message=f"`{said}` {missed}: {what}",
            hint="call the tool that it is meant for before this word, or take the word out",
            count=len(spans),
        )


def _is_switch(signal: Signal | None, source: SignalSource) -> bool:
    """Whether an output switches tools of a kind on and off; a spindle's words mean the spindle, too."""
    return signal is not None and bool(signal.set_by) and source.word.type not in ("speed", "turning")


def _reads(tool: Tool | None, name: str) -> bool:
    return tool is not None and any(signal.name == name for kind in tool.acts_by for signal in PROCESSES[kind].reads)


@cache
def is_switch(target: str, verb: str) -> bool:
    """Whether an action switches on what tools of ours do."""
    return any(_switches(kind, target, verb) for kind in PROCESSES.own())


def _sensor_of(tool: Tool) -> tuple[Sensor, ...]:
    return () if tool.sensor is None else (tool.sensor,)


@cache
def sensor_orders() -> frozenset[tuple[str, str]]:
    """All words at which sensors read, by target and verb."""
    return frozenset((target, verb) for target, verbs in orders_of_all().items() for verb in verbs)


def _switches(kind: str, target: str, verb: str) -> bool:
    actions = [action for signal in PROCESSES[kind].reads for action in signal.set_by]
    return any((own.target, own.verb) == (target, verb) and own.value > 0.0 for own in actions)
