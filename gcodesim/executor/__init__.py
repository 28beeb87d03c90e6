"""The only place that advances time: plan, world, process and stock, window by window."""

from gcodesim.executor.loop import Execution, Progress, execute

__all__ = ["Execution", "Progress", "execute"]
