"""Words that switch a tool on, while the spindle has none that they switch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache

from gcodesim.canon import Action, ToolChange, ToolNumber
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.motion.tool_path import ToolPath
from gcodesim.processes import PROCESSES
from gcodesim.sensors.orders import orders_of, orders_of_all
from gcodesim.sensors.sensor import Sensor
from gcodesim.tools.tool import Tool


def deaf_tool_findings(
    path: ToolPath, tools: Mapping[int, Tool], loaded: int, mounted_sensors: Sequence[Sensor]
) -> Iterator[Diagnostic]:
    """GS507 for actions that switch on what the tool in the spindle, at first `loaded`, is not: one for each tool.

    The same for words at which sensors read, where neither the tool in use nor one of the `mounted_sensors` does.
    At its first place, with the count.
    """
    orders, everywhere = sensor_orders(), orders_of(mounted_sensors)
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
                hears = tool is not None and any(_switches(kind, *order) for kind in tool.processes)
            if not hears and (order in orders or is_switch(*order)):
                found.setdefault((mounted, event.target, event.verb), []).append(event.span)
    for (number, target, verb), spans in found.items():
        held = tools.get(number)
        missed = "finds no sensor that reads" if (target, verb) in orders else "switches nothing on"
        what = "no tool is in the spindle" if held is None else f"{held.name} is of type `{held.kind}`"
        yield Diagnostic(
            code="GS507",
            span=spans[0],
            message=f"`{target}: {verb}` {missed}: {what}",
            hint="call the tool that it is meant for before this word, or take the word out",
            count=len(spans),
        )


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
