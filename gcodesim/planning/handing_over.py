"""Where on its path a machine needs a tool that others may have, and where it gives one back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.canon import ToolAwaited, ToolChange, ToolNumber, ToolReturned
from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import PathEvent, ToolPath

if TYPE_CHECKING:
    from gcodesim.planning.plan import Plan


def changes_of_tool(path: ToolPath, mounted: int) -> Iterator[tuple[PathEvent, int, int, bool]]:
    """Every change of the tool in the spindle, at first `mounted`: the event, the old and the new tool, and whether

    it is done by hand.
    """
    for noted in path.events:
        event = noted.event
        if isinstance(event, ToolChange | ToolNumber) and event.tool != mounted:
            yield noted, mounted, event.tool, isinstance(event, ToolNumber)
            mounted = event.tool


def tool_after(path: ToolPath, mounted: int) -> int:
    """The tool in the spindle at the end of a path, if `mounted` is there at its start."""
    return next((now for *_, now, _ in reversed(list(changes_of_tool(path, mounted)))), mounted)


def with_handing_over(path: ToolPath, mounted: int) -> ToolPath:
    """The path with events where the machine waits for the next tool, and where others may have the old one.

    A change takes the new tool before it gives the old one back; where an arm drives to stands, `planning/stands.py`
    moves the events to where it sets the one down and sets out for the other.
    """
    all_changes = changes_of_tool(path, mounted)
    changes = {id(noted): (before, now) for noted, before, now, by_hand in all_changes if not by_hand}
    events: list[PathEvent] = []
    for noted in path.events:
        before, now = changes.get(id(noted), (0, 0))
        span = noted.event.span
        if now:
            events.append(PathEvent(noted.row, ToolAwaited(span=span, tool=now)))
        events.append(noted)
        if before:
            events.append(PathEvent(noted.row, ToolReturned(span=span, tool=before)))
    return replace(path, events=tuple(events))


@frozen
class ToolFrom:
    """A machine has `tool`, 0 for none, from `begin` [s] on, by the block at `span`; None: at the start already."""

    tool: int
    begin: float
    span: Span | None


def tools_in_time(plan: Plan, mounted: int, *, driven: bool) -> list[ToolFrom]:
    """The tools that a machine has one after the other, at first `mounted`; `driven`: it drives to stands for them."""
    if driven:
        return _carried(plan, mounted)
    found = [ToolFrom(tool=mounted, begin=0.0, span=None)]
    for timed in plan.trajectory.events:
        event = timed.event
        if isinstance(event, ToolChange | ToolNumber) and event.tool != found[-1].tool:
            found.append(ToolFrom(tool=event.tool, begin=timed.time, span=event.span))
    return found


def _carried(plan: Plan, mounted: int) -> list[ToolFrom]:
    """By the rows of the path: between two stands an arm has no tool."""
    path = plan.path
    found = [ToolFrom(tool=mounted, begin=0.0, span=None)]
    of_row = np.array([state.tool for state in path.states])[path.state] if len(path) else np.zeros(0, dtype=np.int64)
    for row in np.flatnonzero(np.diff(of_row, prepend=mounted) != 0).tolist():
        begin = float(plan.trajectory.row_end[row - 1]) if row else 0.0  # a change begins when the move before it ends
        found.append(ToolFrom(tool=int(of_row[row]), begin=begin, span=path.span(row)))
    return found
