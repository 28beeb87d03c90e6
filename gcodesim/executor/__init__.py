"""The only place that advances time: plan, world, process and stock, window by window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gcodesim.executor.execution import Execution, Progress
    from gcodesim.executor.loop import execute, execute_together
    from gcodesim.executor.track import TrackPlan

__all__ = ["Execution", "Progress", "TrackPlan", "execute", "execute_together"]


def __getattr__(name: str) -> Any:
    """Load the loop when it is asked for: results and checks need the totals alone."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from gcodesim.executor import execution, loop, track

    return getattr(loop if name.startswith("execute") else track if name == "TrackPlan" else execution, name)
