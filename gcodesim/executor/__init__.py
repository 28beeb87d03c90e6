"""The only place that advances time: plan, world, process and stock, window by window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gcodesim.executor.loop import Execution, Progress, execute

__all__ = ["Execution", "Progress", "execute"]


def __getattr__(name: str) -> Any:
    """Load the loop when it is asked for: results and checks need the totals alone."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from gcodesim.executor import loop

    return getattr(loop, name)
