"""Programs of several controls that wait for each other: a handshake over lines that are wired between two of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen
from gcodesim.planning.marks import is_mark
from gcodesim.post.moves import RobotAwait, RobotHalt, RobotStep, RobotSwitch

if TYPE_CHECKING:
    from gcodesim.jobs.job import Job


@frozen
class MeetingLines:
    """Of one control: the digital output that another one sees, and the digital input at which it sees that one's."""

    output: str
    input: str


@frozen
class ControlMeetings:
    """How the program of `channel` meets others: who comes to each mark (by its name), in order, and which lines lead
    to each of them."""

    channel: str
    partners: Mapping[str, Sequence[str]]
    lines: Mapping[str, MeetingLines]

    def unwired(self, mark: str) -> list[str]:
        """Whom this control cannot hear at a mark."""
        first, *others = self.partners[mark]
        return [name for name in (others if self.channel == first else [first]) if name not in self.lines]

    def at_begin(self, span: Span) -> Iterator[RobotStep]:
        """All lines off, whatever an earlier run has left."""
        met = {name for names in self.partners.values() for name in names}
        for name, line in self.lines.items():
            if name in met:
                yield _switch(span, line, False)

    def meet(self, span: Span, mark: str) -> Iterator[RobotStep]:
        """Come to a mark, and go on when all have come.

        The first of the partners leads. Each level stands until the other side has answered it, so none is missed by a
        control that looks seldom, and none counts twice.
        """
        first, *others = self.partners[mark]
        if missing := self.unwired(mark):
            yield RobotHalt(span=span, text=f"wait for {', '.join(missing)} at {mark}")
        elif self.channel == first:
            lines = [self.lines[name] for name in others]
            yield from (_await(span, line, False) for line in lines)  # they have left the mark before
            yield from (_switch(span, line, True) for line in lines)
            yield from (_await(span, line, True) for line in lines)
            yield from (_switch(span, line, False) for line in lines)
        else:
            line = self.lines[first]
            yield _await(span, line, True)
            yield _switch(span, line, True)
            yield _await(span, line, False)
            yield _switch(span, line, False)


def _await(span: Span, line: MeetingLines, on: bool) -> RobotStep:
    return RobotAwait(span=span, signal=line.input, on=on)


def _switch(span: Span, line: MeetingLines, on: bool) -> RobotStep:
    return RobotSwitch(span=span, signal=line.output, digital=True, value=float(on))


def meetings_of(job: Job, jobs: Sequence[Job], lines: Mapping[str, MeetingLines]) -> ControlMeetings:
    """Those of a job among all that run; `lines` of its control by the channel to which they lead."""
    partners: dict[str, list[str]] = {}
    for each in jobs:
        assert each.plan is not None
        for timed in each.plan.path.events:
            if is_mark(timed.event):
                known = partners.setdefault(timed.event.verb, [])  # type: ignore[attr-defined]
                if each.channel not in known:
                    known.append(each.channel)
    own = {mark: sorted(names) for mark, names in partners.items() if job.channel in names and len(names) > 1}
    return ControlMeetings(channel=job.channel, partners=own, lines=lines)
