"""The tool of one machine as the log draws it: which one is in use, how far its fingers are open, whether it is on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import ToolChange
from gcodesim.executor.record import StepRecord
from gcodesim.log import DrawnShape, LogWriter
from gcodesim.recorder.bodies import tool_shapes, tools_in_stands
from gcodesim.recorder.plumes import Plumes, plume_shapes
from gcodesim.recorder.tool_times import ToolTimes
from gcodesim.tools.gripper import Gripper

if TYPE_CHECKING:
    from gcodesim.executor.window import StepWindow
    from gcodesim.jobs.job import Job
    from gcodesim.planning import Plan
    from gcodesim.tools.tool import Tool

Switch = tuple[int, int, bool]
"""When [ns] a tool, by its number, is seen to be switched on, or off."""


class ToolShown:
    """Draws the tool of a job's machine in `frame`; that of the first channel draws those in stands for all machines.

    `writer` is set before the run begins.
    """

    writer: LogWriter

    def __init__(self, job: Job, frame: str, *, is_first: bool) -> None:
        assert job.shop is not None and job.plan is not None and job.cell is not None
        self._shop, self._plan, self._frame, self._is_first = job.shop, job.plan, frame, is_first
        self._step_ns = job.cell.simulation.step_ns
        self._tool = -1
        self._fingers = (-1, 1.0)
        self._switched: Switch = (0, -1, False)
        self._plumes = Plumes(job.shop, job.plan.path, job.plan.trajectory.duration_ns)
        self._together = [] if job.alone else [job, *job.others]
        self._tool_times = self._known_times()

    def _known_times(self) -> list[ToolTimes]:
        """Which tools the machines have when, where several work side by side, as far as that is known."""
        return [ToolTimes.of(each, self._step_ns) for each in self._together if each.plan is not None]

    def start(self, window: StepWindow) -> None:
        """The tool before the first step."""
        if self._tool_times:
            self._tool, _ = self._tool_times[0].at(0)
            self._draw(0, self._shop.tool(self._tool))
            self._known_changes(0, -1, ())
        else:
            self._changes_in(window, at_start=True)

    def follow(self, plan: Plan) -> None:
        """The run goes on with a leg; `plan` is that of all legs so far."""
        self._plan = plan
        self._tool_times = self._known_times()
        self._plumes.follow(plan.path)

    def take(self, record: StepRecord, t_ns: NDArray[np.int64], logged: NDArray[np.intp], from_ns: int) -> None:
        """A window from `from_ns` on; the log has its instants at times `t_ns` (m,), in steps `logged` (m,)."""
        switches = self._switches(record, t_ns, logged)
        if self._tool_times:
            self._known_changes(from_ns, record.window.end * self._step_ns, switches)
        else:
            self._changes_in(record.window, at_start=False)
        self._moves_of_fingers(record, t_ns, logged)
        for at_ns, number, is_on in switches:
            self._switched = (at_ns, number, is_on)
            if number == self._tool or not self._tool_times:  # it may have been changed since then
                tool = self._shop.tool(number)
                self._draw(at_ns, tool, plume=plume_shapes(tool) if is_on else ())

    def end(self, t_ns: int) -> None:
        """Draw the tool as it is after the last words of the program, when no step is left."""
        if self._plumes.goes_off_at_end:
            self._draw(t_ns, self._shop.tool(self._tool))

    # ---- inside

    def _changes_in(self, window: StepWindow, *, at_start: bool) -> None:
        """Write the tool in the spindle when it has changed."""
        for k in np.flatnonzero(np.diff(window.tool, prepend=self._tool) != 0):
            number = int(window.tool[k])
            t_ns = 0 if at_start else int(window.ticks[k]) * self._step_ns
            span = self._change_span(number, int(window.row[k]))
            self._tool = number
            self._draw(t_ns, self._shop.tool(number))
            if not at_start or span[1]:  # at the start: put there by the first change, or by nobody
                self._tell(t_ns, *span)

    def _known_changes(self, from_ns: int, to_ns: int, switches: Sequence[Switch]) -> None:
        """Of programs that run side by side: a tool that several use is in one place, in a spindle or in its stand."""
        own, *others = self._tool_times
        for t_ns in sorted({t_ns for times in (own, *others) for t_ns in times.changes(from_ns, to_ns)}):
            number, span = own.at(t_ns)
            changed, self._tool = number != self._tool, number
            opening = self._fingers[1] if self._fingers[0] == number else 1.0
            tool = self._shop.tool(number)
            self._draw(t_ns, tool, opening, plume_shapes(tool) if self._is_on(t_ns, number, switches) else ())
            if changed and span is not None:
                self._tell(t_ns, span.file, span.line)

    def _tell(self, t_ns: int, file: str, line: int) -> None:
        tool = self._shop.tool(self._tool)
        name = "no tool" if self._tool == 0 else tool.name if tool is not None else f"T{self._tool}"
        self.writer.event(t_ns, "toolchange", name, file=file, line=line)

    def _draw(self, t_ns: int, tool: Tool | None, opening: float = 1.0, plume: Sequence[DrawnShape] = ()) -> None:
        """Draw the tool in the spindle; the first channel also draws those that wait in stands, for all machines."""
        waiting = []
        if self._is_first:
            in_use = self._tool if tool is None else tool.number
            waiting = tools_in_stands(self._shop, {in_use, *(times.at(t_ns)[0] for times in self._tool_times[1:])})
        self.writer.tool(t_ns, (*tool_shapes(tool, opening), *plume), self._frame, waiting)

    def _moves_of_fingers(self, record: StepRecord, t_ns: NDArray[np.int64], logged: NDArray[np.intp]) -> None:
        """Draw a gripper anew when its fingers stand elsewhere than in the instant before."""
        if "opening" not in record.columns:
            return
        for at_ns, k in zip(t_ns.tolist(), logged.tolist(), strict=True):
            tool = self._shop.tool(int(record.window.tool[k]))
            if not isinstance(tool, Gripper) or not tool.widest:
                continue
            opening = min(float(record["opening"][k]) / tool.widest, 1.0)
            if (tool.number, opening) != self._fingers:
                self._fingers = (tool.number, opening)
                if tool.number == self._tool:
                    self._draw(at_ns, tool, opening)

    def _switches(self, record: StepRecord, t_ns: Any, logged: NDArray[np.intp]) -> Sequence[Switch]:
        """When in a window tools are seen to be switched on or off."""
        window = record.window
        changes = self._plumes.changes(window.row[logged], window.tool[logged], t_ns)
        return [(int(t_ns[k]), int(window.tool[logged[k]]), is_on) for k, is_on in changes]

    def _is_on(self, t_ns: int, number: int, switches: Sequence[Switch]) -> bool:
        """Whether a tool is seen to be on at a time; `switches` are those of this window."""
        *_, (_, switched, is_on) = (self._switched, *(each for each in switches if each[0] <= t_ns))
        return is_on and switched == number

    def _change_span(self, number: int, row: int) -> tuple[str, int]:
        """Where the tool was changed that is in the spindle in a path row: the last such block up to there."""
        if number == 0 and self._shop.cell.magazine.stands:  # on its way from one stand to the next
            return self._plan.path.span(row).file, self._plan.path.span(row).line
        changes = [
            timed
            for timed in self._plan.trajectory.events
            if isinstance(timed.event, ToolChange) and timed.event.tool == number
        ]
        if not changes:
            return "", 0
        span = next((timed for timed in reversed(changes) if timed.row <= row), changes[0]).event.span
        return span.file, span.line
