"""The only place that advances time: plan, world, process and stock, window by window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gcodesim.executor.execution import Execution, Progress
    from gcodesim.executor.loop import execute, execute_together
    from gcodesim.executor.track import TrackPlan

_PLACES = {
    "Execution": "execution",
    "Progress": "execution",
    "TrackPlan": "track",
    "execute": "loop",
    "execute_together": "loop",
}

__all__ = ["Execution", "Progress", "TrackPlan", "execute", "execute_together"]


def __getattr__(name: str) -> Any:
    """Load the loop when it is asked for: results and checks need the totals alone."""
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
