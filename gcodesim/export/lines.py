"""A log as JSON lines: every message as it was logged."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, ClassVar, TextIO

from google.protobuf.json_format import MessageToDict

from gcodesim.export.exporter import RANGE, Exporter, Option, Request, counted
from gcodesim.export.select import TimeRange
from gcodesim.export.table import NoTableError
from gcodesim.log.reader import decoder_of
from gcodesim.playback.recording import Recording


def write_lines(recording: Recording, out: TextIO, topics: Sequence[str] = (), part: TimeRange | None = None) -> int:
    """One object per line: topic, t_ns, message; for `topics`, else for all, in the order of the log. Returns how many.

    Fields are in the order of their schema, so that lines of one topic are alike.

    A period thins each topic on its own. NoTableError when the log has no such topic.
    """
    part = part or TimeRange()
    log = recording.log
    for topic in topics:
        if log.channel_id(topic) is None:
            raise NoTableError(f"the log has no topic {topic}")
    decoders: dict[int, tuple[str, Callable[[Any], Any]]] = {}
    for channel, record in log.channels.items():
        if not topics or record.topic in topics:
            decoders[channel] = (record.topic, decoder_of(log, channel))
    slots: dict[int, int] = {}
    count = 0
    for message in log.messages(decoders, first_ns=part.first_ns, last_ns=part.last_ns):
        if part.period_ns:
            slot = (message.t_ns - part.first_ns) // part.period_ns
            if slots.get(message.channel) == slot:
                continue
            slots[message.channel] = slot
        topic, decode = decoders[message.channel]
        value = decode(message)
        fields = _in_order(
            MessageToDict(value, preserving_proto_field_name=True, always_print_fields_with_no_presence=True),
            value.DESCRIPTOR,
        )
        out.write(json.dumps({"topic": topic, "t_ns": message.t_ns, "message": fields}, ensure_ascii=False) + "\n")
        count += 1
    return count


class JsonLines(Exporter):
    """`--to jsonl`."""

    kind: ClassVar[str] = "jsonl"
    says: ClassVar[str] = "every message as logged, one JSON object a line"
    suffix: ClassVar[str] = ".jsonl"
    takes: ClassVar[frozenset[Option]] = RANGE

    def write(self, recording: Recording, out: TextIO, request: Request) -> str:
        return counted(write_lines(recording, out, request.topics, request.part), "message")


def _in_order(fields: dict[str, Any], kind: Any) -> dict[str, Any]:
    """`fields` of a message of `kind` (its descriptor) as its schema has them; protobuf puts those that are 0 last."""
    ordered = {}
    for name, inner in _fields_of(kind):
        if name not in fields:
            continue
        value = fields[name]
        if inner is not None:
            if isinstance(value, dict):
                value = _in_order(value, inner)
            elif isinstance(value, list):
                value = [_in_order(one, inner) if isinstance(one, dict) else one for one in value]
        ordered[name] = value
    return ordered


@cache
def _fields_of(kind: Any) -> tuple[tuple[str, Any], ...]:
    """Names of the fields of a descriptor, with the descriptor of what is in them when that is a message."""
    return tuple(
        (
            field.name,
            None if field.message_type is None or field.message_type.GetOptions().map_entry else field.message_type,
        )
        for field in kind.fields
    )
