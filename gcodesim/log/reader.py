"""Questions to a log: what it is and from what it came, and the course of any of its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.logfile import LogFile, LogReadError
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
            schema=log.schemas[channel.schema_id].name if channel.schema_id in log.schemas else "",
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

    A field is a path such as `force_n`, `force.x` or `joints[2].position`. A
    repeated field without an index gives an axis: `joints.position` is (n, j).
    KeyError when the log has no such topic, ValueError when its messages have
    no such field, or not equally many of a repeated one.
    """
    paths = [_parse(path_text) for path_text in fields]
    times: list[int] = []
    values: list[list[Any]] = [[] for _ in fields]
    for t_ns, message in read_messages(path, topic):
        times.append(t_ns)
        for column, parts in zip(values, paths, strict=True):
            column.append(_value(message, parts))
    columns: dict[str, NDArray[Any]] = {"t_ns": np.array(times, dtype=np.int64)}
    for name, column in zip(fields, values, strict=True):
        try:
            columns[name] = np.array(column, dtype=object if _holds_text(column) else None)
        except ValueError as error:
            raise ValueError(f"{topic}: not equally many of '{name}' in every message") from error
    return columns


def _decoded(log: LogFile, topic: str, wanted: str = "", *, backwards: bool = False) -> Iterator[tuple[int, Any]]:
    """Messages of a topic; none when it is not there or not of the `wanted` schema."""
    channel = log.channel_id(topic)
    if channel is None:
        return
    schema = log.schemas.get(log.channels[channel].schema_id)
    if schema is None or (wanted and schema.name != wanted):
        return
    if schema.encoding != "protobuf":
        raise LogReadError(f"{topic} is coded as '{schema.encoding or 'nothing known'}', not as protobuf")
    kind = decoder(schema.name, schema.data)
    for message in log.messages(channel, backwards=backwards):
        yield message.t_ns, kind.FromString(message.data)


def _parse(path: str) -> list[tuple[str, int | None]]:
    parts: list[tuple[str, int | None]] = []
    for part in path.split("."):
        name, bracket, index = part.partition("[")
        if bracket and not (index.endswith("]") and index[:-1].isdigit()):
            raise ValueError(f"not a field: '{path}'")
        parts.append((name, int(index[:-1]) if bracket else None))
    return parts


def _value(message: Any, parts: list[tuple[str, int | None]]) -> Any:
    (name, index), rest = parts[0], parts[1:]
    if not hasattr(message, "DESCRIPTOR") or name not in message.DESCRIPTOR.fields_by_name:
        raise ValueError(f"no field '{name}'")
    value = getattr(message, name)
    repeated = not hasattr(value, "DESCRIPTOR") and not isinstance(value, (str, bytes, bool, int, float))
    if repeated and index is None:
        return [_value(item, rest) for item in value] if rest else list(value)
    if repeated:
        if index is not None and index >= len(value):
            raise ValueError(f"'{name}' has no item {index}")
        value = value[index]
    elif index is not None:
        raise ValueError(f"'{name}' is not repeated")
    return _value(value, rest) if rest else value


def _holds_text(column: Any) -> bool:
    while isinstance(column, list) and column:
        column = column[0]
    return isinstance(column, str)
