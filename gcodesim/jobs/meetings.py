"""Programs of one run that wait for each other: their plans on a common clock, and what is wrong with their marks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gcodesim.canon import Action, ToolAwaited, ToolReturned
from gcodesim.cell.placement import bounds_of
from gcodesim.checks.sharing import Occupant, SharedZone, sharing_findings
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import WORLD
from gcodesim.frozen import frozen
from gcodesim.jobs.borne_work import bears_work, displaced, moving_work
from gcodesim.jobs.marks import Meeting, is_stop, lone_mark, name_of
from gcodesim.motion.waits import with_waits
from gcodesim.numbers import rounded
from gcodesim.planning.marks import is_wait
from gcodesim.planning.meetings import Agenda, Arrival, Fetching, Halt, Returning, Stop, Timetable, timetable
from gcodesim.planning.waiting import waiting
from gcodesim.shop import side_by_side

if TYPE_CHECKING:
    from gcodesim.jobs.job import Job
    from gcodesim.motion.trajectory import TimedEvent
    from gcodesim.planning.plan import Plan

_ROUNDS: Final = 8  # of planning until all work stands where it was planned for


@frozen
class Appointments:
    """How the programs of a run meet; `marks` are the events of each channel at which it may wait, in order."""

    table: Timetable
    marks: Mapping[str, Sequence[Meeting]]

    def at(self, standing: Halt) -> Meeting:
        """The event at which a channel stands."""
        return self.marks[standing.channel][standing.index]

    def waits(self, channel: str) -> list[dict[str, Any]]:
        """The waits of a channel as in `results.json`."""
        pairs = zip(self.table.waits[channel], self.marks[channel], strict=False)
        return [
            {
                "mark": name_of(mark),
                "file": mark.span.file,
                "line": mark.span.line,
                "begin_s": rounded(wait.begin),
                "end_s": None if wait.end is None else rounded(wait.end),
            }
            for wait, mark in pairs
            if isinstance(mark, Action) or wait.end is None or wait.seconds > 0.0
        ]

    def as_json(self) -> dict[str, Any]:
        table = self.table
        return {
            "total_s": None if table.total is None else rounded(table.total),
            "stopped_at_s": rounded(table.stopped_at),
            "circle": [self._place(standing) for standing in table.circle],
            "ended": [self._place(standing) | {"by": by} for standing, by in table.ended],
            "lone": [self._place(standing) for standing in table.lone],
        }

    def _place(self, standing: Halt) -> dict[str, Any]:
        mark = self.at(standing)
        return {
            "channel": standing.channel,
            "file": mark.span.file,
            "line": mark.span.line,
            "mark": name_of(mark),
        }


def meet(jobs: Sequence[Job], read_again: Callable[[Job, int | None], None]) -> Appointments:
    """Put the programs of `jobs` on one clock: their plans get waits, and the first job the findings about them.

    A program that waits for ever is read and planned again up to there by `read_again(job, stops passed)`; one that
    works on what others move, all of it (None) as soon as it is known where that stands.
    """
    meetings = _appointments(jobs)
    for _ in range(_ROUNDS if bears_work(jobs) else 0):
        stale = displaced(jobs, _plans_together(jobs, meetings), _ends_of_waits(jobs, meetings))
        if not stale:
            break
        for job in stale:
            read_again(job, None)
        meetings = _appointments(jobs)
    table = meetings.table
    for job in jobs:
        waits = table.waits[job.channel]
        if table.ends[job.channel] is None:
            read_again(job, _stops_before(job, len(waits) - 1))
        _delay(job, [wait.seconds for wait in waits])
    jobs[0].findings.extend(findings(meetings))
    jobs[0].findings.extend(_sharing(jobs))
    if bears_work(jobs):
        jobs[0].findings.extend(moving_work(jobs))
    return meetings


def together(jobs: Sequence[Job]) -> Appointments:
    """Planned programs that wait for nobody."""
    ends: dict[str, float | None] = {}
    for job in jobs:
        assert job.plan is not None
        ends[job.channel] = job.plan.trajectory.duration
    table = Timetable(waits=dict.fromkeys(ends, ()), ends=ends, circle=(), ended=(), lone=())
    return Appointments(table=table, marks=dict.fromkeys(ends, ()))


def _appointments(jobs: Sequence[Job]) -> Appointments:
    """When programs meet, all of them planned to their ends."""
    marks: dict[str, list[Meeting]] = {}
    agendas: dict[str, Agenda] = {}
    for job in jobs:
        for _ in iter(lambda job=job: job.legs.onward() if job.legs is not None else None, None):  # type: ignore[misc]
            pass
        assert job.plan is not None
        marks[job.channel], agendas[job.channel] = _agenda(job)
    return Appointments(table=timetable(agendas), marks=marks)


def _plans_together(jobs: Sequence[Job], meetings: Appointments) -> dict[str, Plan]:
    """The plans of movers, by their names, with their waits."""
    found = {}
    for job in jobs:
        assert job.plan is not None and job.shop is not None
        waits = _waits_in(job.plan, [wait.seconds for wait in meetings.table.waits[job.channel]])
        found[job.shop.name] = _late(job.plan, waits)
    return found


def _ends_of_waits(jobs: Sequence[Job], meetings: Appointments) -> dict[str, list[float]]:
    """When the waits of each channel end [s]; of one that never ends, when it begins."""
    return {
        job.channel: [
            wait.begin if wait.end is None else wait.end
            for wait, item in zip(meetings.table.waits[job.channel], meetings.marks[job.channel], strict=False)
            if is_wait(item)
        ]
        for job in jobs
    }


def _sharing(jobs: Sequence[Job]) -> Iterator[Diagnostic]:
    """What is wrong with zones and tools that the programs share."""
    cell = jobs[0].cell
    assert cell is not None
    zones = []
    for name, zone in cell.zones.items():
        low, high = bounds_of(zone.shape)
        X_W = cell.frames[zone.place.frame or WORLD] @ zone.place.X
        zones.append(SharedZone(name=name, X_W=X_W, low=np.array(low), high=np.array(high)))
    occupants = []
    for job in jobs:
        assert job.plan is not None and job.shop is not None
        loaded = cell.channels[job.channel].loaded_tool or 0
        occupants.append(
            Occupant(channel=job.channel, plan=job.plan, X_WB=job.shop.X_WB, tools=cell.tools, loaded=loaded)
        )
    return sharing_findings(zones, sorted(occupants, key=lambda each: each.channel))


def share_shop(job: Job) -> None:
    """Let all programs of a run act on the stock of the first, in one scene."""
    assert job.shop is not None
    others = [other.shop for other in job.others if other.shop is not None]
    for each, shop in zip(job.all, side_by_side(job.shop, others), strict=True):
        each.shop = shop


def _agenda(job: Job) -> tuple[list[Meeting], Agenda]:
    """Where a program meets others, and when it comes there."""
    assert job.plan is not None and job.cell is not None
    trajectory = job.plan.trajectory
    timed = _meetings(trajectory.events)
    loaded = job.cell.channels[job.channel].loaded_tool or 0
    holds = frozenset((f"T{loaded}",) if loaded else ())
    agenda = Agenda(arrivals=[_stop(event) for _, event in timed], duration=trajectory.duration, holds=holds)
    return [event.event for _, event in timed], agenda  # type: ignore[misc]


def _meetings(events: Sequence[TimedEvent]) -> list[tuple[int, TimedEvent]]:
    """The events at which a program meets others, with their numbers."""
    return [(index, event) for index, event in enumerate(events) if is_wait(event.event) or _returns(event.event)]


def _returns(item: object) -> bool:
    return isinstance(item, ToolReturned)


def _stop(timed: TimedEvent) -> Stop:
    event = timed.event
    if isinstance(event, ToolAwaited):
        return Fetching(thing=f"T{event.tool}", time=timed.time)
    if isinstance(event, ToolReturned):
        return Returning(thing=f"T{event.tool}", time=timed.time)
    assert isinstance(event, Action)
    return Arrival(mark=event.verb, time=timed.time)


def _stops_before(job: Job, meeting: int) -> int:
    """How many marks and tool changes a program passes before it comes to the meeting of this number."""
    assert job.plan is not None
    events = job.plan.trajectory.events
    index, _ = _meetings(events)[meeting]
    return sum(is_stop(each.event) for each in events[:index])


def _delay(job: Job, seconds: Sequence[float]) -> None:
    """Put the waits into the plan of `job`, and let its findings be as late as what they are about."""
    plan = job.plan
    assert plan is not None
    waits = _waits_in(plan, seconds)
    if not waits:
        return
    job.plan = _late(plan, waits)

    def late(time: float) -> float:
        return time + sum(wait for _, begin, wait in waits if begin <= time)

    job.findings.change({one: replace(one, time=late(one.time)) for one in job.findings if one.time is not None})
    job.probings = [replace(probing, time=late(probing.time)) for probing in job.probings]


def _waits_in(plan: Plan, seconds: Sequence[float]) -> list[tuple[int, float, float]]:
    """The waits of a plan that last: the number of the event, its time and how long it is waited there [s]."""
    timed = _meetings(plan.trajectory.events)
    return [(index, event.time, wait) for (index, event), wait in zip(timed, seconds, strict=False) if wait > 0.0]


def _late(plan: Plan, waits: Sequence[tuple[int, float, float]]) -> Plan:
    return waiting(plan, with_waits(plan.trajectory, {index: wait for index, _, wait in waits}))


def findings(meetings: Appointments) -> Iterator[Diagnostic]:
    """GS620 to GS622: programs that wait in a circle, for one that has ended, and at marks that nobody else uses."""
    table = meetings.table
    if table.circle:
        yield _deadlock(meetings)
    for standing, by in table.ended:
        yield _abandoned(meetings, standing, by)
    for standing in table.lone:
        mark = meetings.at(standing)
        assert isinstance(mark, Action)
        yield lone_mark(standing.channel, mark)


def _abandoned(meetings: Appointments, standing: Halt, by: str) -> Diagnostic:
    """GS621 for a channel that waits for `by`, whose program has ended."""
    mark, name = meetings.at(standing), name_of(meetings.at(standing))
    begin = meetings.table.waits[standing.channel][-1].begin
    if not isinstance(mark, Action):
        return Diagnostic(
            code="GS621",
            span=mark.span,
            message=f"`{standing.channel}` waits for {name}, which `{by}` has, whose program has ended",
            hint=f"let `{by}` put {name} back (T0 M6) before it ends",
            time=begin,
        )
    return Diagnostic(
        code="GS621",
        span=mark.span,
        message=f"`{standing.channel}` waits at `{name}` for `{by}`, whose program has ended "
        f"after coming there {_times(meetings, by, name)}",
        hint=f"`{standing.channel}` comes here for the {_ordinal(_count(meetings, standing))} time; "
        "both programs must come to a mark equally often",
        time=begin,
    )


def _deadlock(meetings: Appointments) -> Diagnostic:
    circle = meetings.table.circle
    marks = [meetings.at(standing) for standing in circle]
    following = [*circle[1:], circle[0]]
    told = "; ".join(
        f"`{one.channel}` waits in {_named(mark.span)} {_awaits(mark, other.channel)}"
        for one, mark, other in zip(circle, marks, following, strict=True)
    )
    tools = dict.fromkeys(name_of(mark) for mark in marks if not isinstance(mark, Action))
    names = " and ".join(f"`{name}`" for name in dict.fromkeys(name_of(mark) for mark in marks) if name not in tools)
    order = f"let all of them come to {names} in one order"
    back = f"put {' and '.join(tools)} back (T0 M6) before waiting for another program or tool"
    return Diagnostic(
        code="GS620",
        span=marks[0].span,
        message=f"programs wait for each other in a circle: {told}",
        hint=back if tools else order,
        related=marks[1].span,
        time=max(meetings.table.waits[standing.channel][-1].begin for standing in circle),
    )


def _awaits(mark: Meeting, other: str) -> str:
    if isinstance(mark, Action):
        return f"at `{mark.verb}` for `{other}`"
    return f"for {name_of(mark)}, which `{other}` has"


def _named(span: Span) -> str:
    return f"line {span.line} of {span.file}"


def _count(meetings: Appointments, standing: Halt) -> int:
    """How often a channel has come to the mark at which it stands, this time included."""
    mark = name_of(meetings.at(standing))
    passed = meetings.marks[standing.channel][: standing.index + 1]
    return sum(isinstance(each, Action) and each.verb == mark for each in passed)


def _times(meetings: Appointments, channel: str, mark: str) -> str:
    count = sum(isinstance(each, Action) and each.verb == mark for each in meetings.marks[channel])
    return "once" if count == 1 else "twice" if count == 2 else f"{count} times"


def _ordinal(count: int) -> str:
    ending = "th" if count % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(count % 10, "th")
    return f"{count}{ending}"
