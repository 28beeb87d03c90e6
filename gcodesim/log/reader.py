"""Messages of a log, decoded, and the course of any of its numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf.message import DecodeError
from numpy.typing import NDArray

from gcodesim.log.description import ProcessField
from gcodesim.log.fields import parse_path, value_at
from gcodesim.log.logfile import LogFile, LogReadError, RawMessage
from gcodesim.log.schema import FIRST_MORE, decoder


def read_attachment(path: Path, name: str) -> bytes:
    """A file that the log carries. KeyError if it carries none of this name."""
    return LogFile.open(path).attachment(name)


def read_messages(path: Path, topic: str) -> Iterator[tuple[int, Any]]:
    """Time [ns] and decoded message of one topic, in order. KeyError when the log has no such topic."""
    log = LogFile.open(path)
    if log.channel_id(topic) is None:
        raise KeyError(topic)
    return decoded(log, topic)


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


def decoded(
    log: LogFile, topic: str, wanted: str = "", *, last_ns: int | None = None, backwards: bool = False
) -> Iterator[tuple[int, Any]]:
    """Messages of a topic up to a time; none if the topic does not exist or does not have the `wanted` schema."""
    channel = log.channel_id(topic)
    if channel is None or (wanted and log.schema_name(channel) != wanted):
        return
    decode = decoder_of(log, channel)
    for message in log.messages([channel], last_ns=last_ns, backwards=backwards):
        yield message.t_ns, decode(message)


def process_fields_of(log: LogFile) -> tuple[ProcessField, ...]:
    """The fields of `/process` that only this log has, as its schema names them."""
    message = next((message for _, message in decoded(log, "/process")), None)
    if message is None:
        return ()
    more = [one for one in message.DESCRIPTOR.fields if one.number >= FIRST_MORE]
    return tuple(ProcessField(name=one.name, flag=one.type == one.TYPE_BOOL) for one in more)


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
