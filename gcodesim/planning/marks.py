"""Where programs wait for each other."""

from __future__ import annotations

from gcodesim.canon import Action, ToolAwaited
from gcodesim.cell.channel import WAIT


def is_mark(item: object) -> bool:
    """Whether an event is a mark at which programs wait for each other."""
    return isinstance(item, Action) and item.target == WAIT


def is_wait(item: object) -> bool:
    """Whether the machine may stand at an event because of other programs: at a mark, or for a tool."""
    return is_mark(item) or isinstance(item, ToolAwaited)
