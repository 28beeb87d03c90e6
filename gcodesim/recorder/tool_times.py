"""Which tools the machines of a run have when, where several programs are known from the start."""

from __future__ import annotations

from math import ceil

from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen
from gcodesim.jobs.job import Job
from gcodesim.planning.handing_over import tools_in_time


@frozen
class ToolTimes:
    """The tools of one machine one after the other, as (since when [ns], number, by which block), the first from 0."""

    entries: tuple[tuple[int, int, Span | None], ...]

    @staticmethod
    def of(job: Job, step_ns: int) -> ToolTimes:
        """A machine has a tool from the first step on in the middle of which it has it, as in the records of a run."""
        assert job.plan is not None and job.cell is not None
        loaded = job.cell.channels[job.channel].loaded_tool or 0
        own = tools_in_time(job.plan, loaded, driven=bool(job.cell.magazine.stands))
        steps = (max(ceil(each.begin * 1e9 / step_ns - 0.5), 0) for each in own)
        entries = ((step * step_ns, each.tool, each.span) for step, each in zip(steps, own, strict=True))
        return ToolTimes(entries=tuple(entries))

    def at(self, t_ns: int) -> tuple[int, Span | None]:
        """The tool at a time [ns], and the block that put it there."""
        return max((entry for entry in enumerate(self.entries) if entry[1][0] <= t_ns), key=lambda each: each[0])[1][1:]

    def changes(self, from_ns: int, to_ns: int) -> list[int]:
        """The times [ns] after the first and up to the second at which the tool changes."""
        return [since for since, *_ in self.entries if from_ns < since <= to_ns]
