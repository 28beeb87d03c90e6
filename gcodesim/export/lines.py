"""A log as JSON lines: every message as it was logged."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any, TextIO

from google.protobuf.json_format import MessageToDict

from gcodesim.export.select import Part
from gcodesim.export.table import NoTableError
from gcodesim.log.reader import decoder_of
from gcodesim.playback.recording import Recording


def write_lines(recording: Recording, out: TextIO, topics: Sequence[str] = (), part: Part | None = None) -> int:
    """One object a line: topic, t_ns, message; of `topics`, else of all, in the order of the log. Returns how many.

    A period thins each topic on its own. NoTableError when the log has no such topic.
    """
    part = part or Part()
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
        fields = MessageToDict(
            decode(message), preserving_proto_field_name=True, always_print_fields_with_no_presence=True
        )
        out.write(json.dumps({"topic": topic, "t_ns": message.t_ns, "message": fields}, ensure_ascii=False) + "\n")
        count += 1
    return count
