"""Messages of a log, decoded, and the course of any of its numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from google.protobuf.message import DecodeError

from gcodesim.log.description import ProcessField
from gcodesim.log.logfile import LogFile, LogReadError, RawMessage
from gcodesim.log.schema import FIRST_MORE, decoder


def read_messages(path: Path, topic: str) -> Iterator[tuple[int, Any]]:
    """Time [ns] and decoded message of one topic, in order. KeyError when the log has no such topic."""
    log = LogFile.open(path)
    if log.channel_id(topic) is None:
        raise KeyError(topic)
    return decoded(log, topic)


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
