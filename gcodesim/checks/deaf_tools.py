"""Words that switch a tool on, while the spindle has none that they switch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache

from gcodesim.canon import Action, ToolChange, ToolNumber
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.motion.tool_path import ToolPath
from gcodesim.processes import PROCESSES
from gcodesim.tools.tool import Tool


def deaf_tool_findings(path: ToolPath, tools: Mapping[int, Tool], loaded: int) -> Iterator[Diagnostic]:
    """GS507 for actions that switch on what the tool in the spindle, at first `loaded`, is not: one for each tool.

    At its first place, with the count.
    """
    mounted, found = loaded, dict[tuple[int, str, str], list[Span]]()
    for noted in path.events:
        event = noted.event
        if isinstance(event, ToolChange | ToolNumber):
            mounted = event.tool
        elif isinstance(event, Action):
            tool = tools.get(mounted)
            hears = tool is not None and any(_switches(kind, event.target, event.verb) for kind in tool.processes)
            if not hears and is_switch(event.target, event.verb):
                found.setdefault((mounted, event.target, event.verb), []).append(event.span)
    for (number, target, verb), spans in found.items():
        held = tools.get(number)
        what = "no tool is in the spindle" if held is None else f"{held.name} is of type `{held.kind}`"
        yield Diagnostic(
            code="GS507",
            span=spans[0],
            message=f"`{target}: {verb}` switches nothing on: {what}",
            hint="call the tool that it is meant for before this word, or take the word out",
            count=len(spans),
        )


@cache
def is_switch(target: str, verb: str) -> bool:
    """Whether an action switches on what tools of ours do."""
    return any(_switches(kind, target, verb) for kind in PROCESSES.own())


def _switches(kind: str, target: str, verb: str) -> bool:
    actions = [action for signal in PROCESSES[kind].reads for action in signal.set_by]
    return any((own.target, own.verb) == (target, verb) and own.value > 0.0 for own in actions)
