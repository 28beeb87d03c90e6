"""Questions to a log: what it is and from what it came, and the course of any of its numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf.message import DecodeError
from numpy.typing import NDArray

from gcodesim.log.fields import parse_path, value_at
from gcodesim.log.logfile import LogFile, LogReadError, RawMessage
from gcodesim.log.schema import decoder


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicSummary:
    """How often a topic comes: `rate` in messages per second of the log."""

    name: str
    schema: str
    count: int
    rate: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A program line."""

    file: str
    line: int
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LogSummary:
    """What `gcodesim info` tells. `run` and `result` are the records of the log, as texts.

    `complete`: the file has its end and the run came to its own. `state` is
    finished, failed, interrupted or, without an end, running. `problem` says
    what is missing of the file. `stopped_at` is the last program line there is.
    `events` counts by severity.
    """

    path: Path
    complete: bool
    state: str
    problem: str
    stopped_at: Place | None
    duration_ns: int
    library: str
    run: Mapping[str, str]
    result: Mapping[str, str]
    topics: tuple[TopicSummary, ...]
    attachments: Mapping[str, int]
    events: Mapping[str, int]

    @property
    def verdict(self) -> str:
        """One line: how the run ended, and where when it did not come to its end."""
        place = f" at {self.stopped_at.file}:{self.stopped_at.line}" if self.stopped_at else ""
        if self.complete:
            return self.state if self.state == "finished" else f"{self.state}{place}"
        return f"incomplete, stopped{place}" if place else "incomplete"


def summary(path: Path) -> LogSummary:
    """What the log at `path` is; a `.part` beside it is read when the log itself is missing.

    OSError when there is no such file, LogReadError when it is no log.
    """
    log = LogFile.open(path)
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
    try:
        for _, event in _decoded(log, "/event", "gcodesim.Event"):
            events[event.severity] = events.get(event.severity, 0) + 1
            interrupted |= event.code == "interrupted"
        last = next(_decoded(log, "/program", "gcodesim.Program", backwards=True), None)
        if last is not None and last[1].line:
            stopped_at = Place(file=last[1].file, line=last[1].line, text=last[1].text)
    except LogReadError as error:
        problem = problem or str(error)
    result = log.metadata.get("gcodesim.result", {})
    state = "interrupted" if interrupted else result.get("state", "running")
    return LogSummary(
        path=log.path,
        complete=log.complete and not problem and not interrupted,
        state=state,
        problem=problem,
        stopped_at=stopped_at,
        duration_ns=end_ns,
        library=log.library,
        run=dict(log.metadata.get("gcodesim.run", {})),
        result=dict(result),
        topics=topics,
        attachments={name: size for name, (_, size) in log.attachments.items()},
        events=events,
    )


def read_attachment(path: Path, name: str) -> bytes:
    """A file that the log carries. KeyError when it carries none of that name."""
    return LogFile.open(path).attachment(name)


def read_messages(path: Path, topic: str) -> Iterator[tuple[int, Any]]:
    """Time [ns] and decoded message of one topic, in order. KeyError when the log has no such topic."""
    log = LogFile.open(path)
    if log.channel_id(topic) is None:
        raise KeyError(topic)
    return _decoded(log, topic)


def read_columns(path: Path, topic: str, fields: Sequence[str]) -> dict[str, NDArray[Any]]:
    """Numbers and texts of a topic over time: `t_ns` (n,) and one array for each of `fields`.

    A field is a path such as `force_n`, `force.x`, `joints[2].position` or
    `joints[arm/joint_1].position`. A repeated field without an item gives an
    axis: `joints.position` is (n, j).
    KeyError when the log has no such topic, ValueError when its messages have
    no such field, or not equally many of a repeated one.
    """
    paths = [parse_path(field) for field in fields]
    times: list[int] = []
    values: list[list[Any]] = [[] for _ in fields]
    for t_ns, message in read_messages(path, topic):
        times.append(t_ns)
        for column, parts in zip(values, paths, strict=True):
            column.append(value_at(message, parts))
    columns: dict[str, NDArray[Any]] = {"t_ns": np.array(times, dtype=np.int64)}
    for name, column in zip(fields, values, strict=True):
        try:
            columns[name] = np.array(column, dtype=object if _holds_text(column) else None)
        except ValueError as error:
            raise ValueError(f"{topic}: not equally many of '{name}' in every message") from error
    return columns


def read_all(path: Path, topics: Sequence[str] = ()) -> Iterator[tuple[str, int, Any]]:
    """Topic, time [ns] and decoded message of all `topics` (none: every one) in the order of the log.

    KeyError when the log has no such topic.
    """
    log = LogFile.open(path)
    wanted = {}
    for topic in topics or [channel.topic for channel in log.channels.values()]:
        channel = log.channel_id(topic)
        if channel is None:
            raise KeyError(topic)
        wanted[channel] = (topic, decoder_of(log, channel))
    for message in log.messages():
        if message.channel in wanted:
            topic, decode = wanted[message.channel]
            yield topic, message.t_ns, decode(message)


def _decoded(log: LogFile, topic: str, wanted: str = "", *, backwards: bool = False) -> Iterator[tuple[int, Any]]:
    """Messages of a topic; none when it is not there or not of the `wanted` schema."""
    channel = log.channel_id(topic)
    if channel is None or (wanted and log.schema_name(channel) != wanted):
        return
    decode = decoder_of(log, channel)
    for message in log.messages(channel, backwards=backwards):
        yield message.t_ns, decode(message)


def decoder_of(log: LogFile, channel: int) -> Callable[[RawMessage], Any]:
    """A function that decodes messages of a channel. LogReadError when its schema is damaged or no protobuf."""
    topic, schema = log.channels[channel].topic, log.schemas.get(log.channels[channel].schema_id)
    if schema is None or schema.encoding != "protobuf":
        raise LogReadError(f"{topic} is coded as '{schema.encoding if schema else ''}', not as protobuf")
    try:
        kind = decoder(schema.name, schema.data)
    except (DecodeError, TypeError, KeyError) as error:
        raise LogReadError(f"the schema of {topic} is damaged") from error

    def decode(message: RawMessage) -> Any:
        try:
            return kind.FromString(message.data)
        except DecodeError as error:
            raise LogReadError(f"{topic} at {message.t_ns * 1e-9:.3f} s does not agree with its schema") from error

    return decode


def _holds_text(column: Any) -> bool:
    while isinstance(column, list) and column:
        column = column[0]
    return isinstance(column, str)
