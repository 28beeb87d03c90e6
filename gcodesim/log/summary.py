"""What a log is, what it was made from, how its run ended, and what is missing from it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from gcodesim.frozen import frozen
from gcodesim.log.damage import Damage
from gcodesim.log.event import LogEvent, settled
from gcodesim.log.logfile import LogFile, LogReadError
from gcodesim.log.reader import decoded


@frozen
class TopicSummary:
    """How often a topic comes: `rate` in messages per second of the log."""

    name: str
    schema: str
    count: int
    rate: float


@frozen
class ProgramLine:
    """A program line."""

    file: str
    line: int
    text: str


@frozen
class LogSummary:
    """The content of `gcodesim info`. `run` and `result` are the records of the log, as text.

    `complete`: the file has its end, nothing in it is damaged, and the run came to its own. `state` is
    finished, failed, interrupted, without an end running, or unknown. `problem` says
    what is wrong with the file, `missing` which parts of a complete log are not there,
    `damage` which parts are there but cannot be read.
    `stopped_at` is the last program line in the log. `events` counts by severity.
    """

    path: Path
    complete: bool
    state: str
    problem: str
    missing: tuple[str, ...]
    damage: tuple[Damage, ...]
    stopped_at: ProgramLine | None
    duration_ns: int
    library: str
    size: int
    chunks: int
    run: Mapping[str, str]
    result: Mapping[str, str]
    topics: tuple[TopicSummary, ...]
    attachments: Mapping[str, int]
    events: Mapping[str, int]
    findings: tuple[LogEvent, ...]

    @property
    def verdict(self) -> str:
        """One line: how the run ended, and where it stopped if it did not come to its end."""
        if not self.run and self.complete:
            return "an MCAP file, but no log of gcodesim"
        place = f" at {self.stopped_at.file}:{self.stopped_at.line}" if self.stopped_at else ""
        if self.complete:
            return self.state if self.state == "finished" else f"{self.state}{place}"
        if self.state == "finished":
            return f"finished, but the file is {'damaged' if self.damage else 'incomplete'}"
        return f"incomplete, stopped{place}" if place else "incomplete"


def summary(path: Path, *, check: bool = True) -> LogSummary:
    """The summary of the log at `path`; if the log itself is missing, a `.part` beside it is read.

    Reads the whole file, for its checksum; without `check` the index and the
    chunks with events and with the last program line, so that damage elsewhere
    is not seen. OSError when there is no such file, LogReadError when it is no log.
    """
    log = LogFile.open(path, lenient=True)
    if check:
        log.check()
    end_ns = log.end_ns
    seconds = end_ns * 1e-9
    topics = tuple(
        TopicSummary(
            name=channel.topic,
            schema=log.schema_name(i),
            count=log.counts.get(i, 0),
            rate=log.counts.get(i, 0) / seconds if seconds > 0.0 else 0.0,
        )
        for i, channel in sorted(log.channels.items())
    )
    problem, events, interrupted, stopped_at = log.problem, {"note": 0, "warning": 0, "error": 0}, False, None
    told: list[LogEvent] = []
    try:
        for t_ns, message in decoded(log, "/event", "gcodesim.Event"):
            event = LogEvent.of(t_ns, message)
            events[event.severity] = events.get(event.severity, 0) + 1
            interrupted |= event.code == "interrupted"
            if event.is_finding:
                told.append(event)
        stopped_at = _place_at(log, end_ns)
    except LogReadError as error:
        problem = problem or str(error)
    result = log.metadata.get("gcodesim.result", {})
    if log.damage:
        problem = problem or f"{len(log.damage)} part{'' if len(log.damage) == 1 else 's'} of it cannot be read"
    return LogSummary(
        path=log.path,
        complete=log.complete and not problem and not interrupted,
        state="interrupted" if interrupted else result.get("state", "unknown" if log.complete else "running"),
        problem=problem,
        missing=() if log.complete and not problem else _missing(log, stopped_at),
        damage=tuple(log.damage),
        stopped_at=stopped_at,
        duration_ns=end_ns,
        library=log.library,
        size=log.size,
        chunks=len(log.chunks),
        run=dict(log.metadata.get("gcodesim.run", {})),
        result=dict(result),
        topics=topics,
        attachments={name: size for name, (_, size) in log.attachments.items()},
        events=events,
        findings=settled(told),
    )


def _missing(log: LogFile, last: ProgramLine | None) -> tuple[str, ...]:
    """What is missing from a log that is damaged or has no end, in words."""
    missing = [_in_words(log, damage) for damage in log.damage]
    ended = "gcodesim.result" in log.metadata  # the run did, though not the file
    if last is not None and not ended and not log.complete:
        missing.append(f"what came after {log.end_ns * 1e-9:.3f} s, in or after {last.file}:{last.line}")
    if not log.chunks:
        missing.append("every message")
    if log.size > log.whole and not log.complete:
        missing.append(f"the last {log.size - log.whole} bytes, which hold no whole record")
    if not log.complete:
        missing.append("the index")
    if not ended:
        missing.append("the result")
    expected = ("program.nc", "cell.yaml", "layout.json", "results.json")
    return (*missing, *(name for name in expected if name not in log.attachments))


def _place_at(log: LogFile, t_ns: int) -> ProgramLine | None:
    """The program line in force at a time, as far as the log says."""
    programs = decoded(log, "/program", "gcodesim.Program", last_ns=t_ns, backwards=True)
    last = next((program for _, program in programs), None)
    return ProgramLine(file=last.file, line=last.line, text=last.text) if last is not None and last.line else None


def _in_words(log: LogFile, damage: Damage) -> str:
    """What is damaged, and for a chunk, from which program line on."""
    if damage.what != "chunk" or damage.first_ns is None:
        return str(damage)
    number = [chunk.offset for chunk in log.chunks].index(damage.offset) + 1
    place = _place_at(log, damage.first_ns - 1)
    where = f", in or after {place.file}:{place.line}" if place is not None else ""
    return f"{damage.span}{where}: chunk {number} of {len(log.chunks)}, at byte {damage.offset}, {damage.reason}"
