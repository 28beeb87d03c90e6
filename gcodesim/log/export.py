"""A log as CSV and as JSON lines."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

from google.protobuf.json_format import MessageToDict

from gcodesim.log.fields import leaves, parse_path, value_at
from gcodesim.log.reader import read_all, read_messages

_NS = 1_000_000_000


def seconds_text(t_ns: int) -> str:
    """A time [ns] in seconds with all its digits."""
    return f"{t_ns // _NS}.{t_ns % _NS:09d}"


def write_csv(path: Path, topic: str, out: TextIO, fields: Sequence[str] = ()) -> int:
    """Rows of `time_s` and `fields` of one topic; without `fields` all that its first message has. Returns how many.

    Paths as in `read_columns`, each of them one number or text. KeyError when
    the log has no such topic, ValueError when a message lacks a field or the
    field is repeated: scenes are no tables.
    """
    writer = csv.writer(out, lineterminator="\n")
    names, count = list(fields), 0
    parts = [parse_path(name) for name in names]
    for t_ns, message in read_messages(path, topic):
        if not count:
            names = names or list(leaves(message))
            parts = [parse_path(name) for name in names]
            writer.writerow(["time_s", *names])
        row = [value_at(message, part) for part in parts]
        for name, value in zip(names, row, strict=True):
            if not isinstance(value, (str, bool, int, float)):
                raise ValueError(f"'{name}' of {topic} is no single number or text; name an item, as in `joints[0]`")
        writer.writerow([seconds_text(t_ns), *(int(v) if isinstance(v, bool) else v for v in row)])
        count += 1
    return count


def write_json_lines(path: Path, out: TextIO, topics: Sequence[str] = ()) -> int:
    """One object a line: topic, t_ns, message; of `topics`, else of all, in the order of the log. Returns how many.

    KeyError when the log has no such topic.
    """
    count = 0
    for topic, t_ns, message in read_all(path, topics):
        fields = MessageToDict(message, preserving_proto_field_name=True, always_print_fields_with_no_presence=True)
        out.write(json.dumps({"topic": topic, "t_ns": t_ns, "message": fields}, ensure_ascii=False) + "\n")
        count += 1
    return count
