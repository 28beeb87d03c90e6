"""Where a program meets others: marks, and tools that others may have or want."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

from gcodesim.canon import Action, Event, ToolAwaited, ToolChange, ToolReturned
from gcodesim.cell.channel import WAIT
from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.planning.marks import is_mark

Meeting: TypeAlias = Action | ToolAwaited | ToolReturned
"""Where the program of a channel meets those of others: a mark, or a tool that others may have or want."""


def is_stop(item: object) -> bool:
    """Whether a program may wait for ever at an event of its own: a mark, or a tool change."""
    return is_mark(item) or isinstance(item, ToolChange)


def name_of(item: Meeting) -> str:
    """The mark, or the tool, for which a program waits."""
    return item.verb if isinstance(item, Action) else f"T{item.tool}"


def lone_mark(channel: str, mark: Action) -> Diagnostic:
    """GS622 for a mark that only `channel` uses."""
    return Diagnostic(
        code="GS622",
        span=mark.span,
        message=f"`{channel}` waits for nobody at `{mark.verb}`: no other program that runs comes to this mark",
        hint=f"it goes on at once; let another program come to `{mark.verb}`, or take the word out",
    )


def lone_marks(channel: str, events: Sequence[Event]) -> list[Diagnostic]:
    """GS622 for each mark in the `events` of a program that runs alone."""
    first: dict[str, Action] = {}
    for event in events:
        if isinstance(event, Action) and event.target == WAIT:
            first.setdefault(event.verb, event)
    return [replace(lone_mark(channel, mark), severity=Severity.NOTE) for mark in first.values()]
