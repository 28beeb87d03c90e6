"""A log as one table: a row for each instant, the program line beside the numbers."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, Final, TextIO

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics.plain import table_text
from gcodesim.export.exporter import RANGE, Exporter, NoExportError, Option, Request, counted
from gcodesim.export.select import TimeRange
from gcodesim.log.fields import leaves, parse_path, value_at
from gcodesim.log.reader import decoder_of
from gcodesim.log.shop_units import without_twins
from gcodesim.numbers import rounded
from gcodesim.playback.columns import UnitSystem, column_of, joint_kinds
from gcodesim.playback.recording import PERIODIC_TOPICS, Recording
from gcodesim.units import NS_PER_SECOND

USUAL_TOPICS: Final = ("/motion", "/process", "/wrench", "/target", "/tcp", "/joint_states")
_DIGITS: Final = 9  # of numbers that were converted


class NoTableError(NoExportError):
    """The topics do not make a table; the text says why."""


def seconds_text(t_ns: int) -> str:
    """A time [ns] in seconds with all its digits."""
    return f"{t_ns // NS_PER_SECOND}.{t_ns % NS_PER_SECOND:09d}"


def write_table(
    recording: Recording,
    out: TextIO,
    topics: Sequence[str] = (),
    part: TimeRange | None = None,
    units: UnitSystem = "si",
) -> int:
    """Rows of CSV with a head of names that end in units; returns how many rows.

    Periodic topics share their instants and make one table, with the program
    line in force. Any other topic is a table of its own, as logged, one row a
    message. NoTableError for topics that the log has not, that do not go
    together, or that hold scenes.
    """
    topics, part = tuple(topics) or USUAL_TOPICS, part or TimeRange()
    for topic in topics:
        if recording.log.channel_id(topic) is None:
            raise NoTableError(f"the log has no topic {topic}")
        if topic.startswith("/scene/"):
            raise NoTableError(f"{topic} holds drawings, which are no table; `--to glb` writes them")
    if all(topic in PERIODIC_TOPICS for topic in topics):
        return _write_periodic(recording, out, topics, part, units)
    if len(topics) > 1:
        other = next(topic for topic in topics if topic not in PERIODIC_TOPICS)
        raise NoTableError(f"{other} does not come at the same times as the other topics; export it by itself")
    return _write_changes(recording, out, topics[0], part)


class Csv(Exporter):
    """`--to csv`."""

    kind: ClassVar[str] = "csv"
    says: ClassVar[str] = "a table: one row an instant, the program line beside the numbers; names end in units"
    suffix: ClassVar[str] = ".csv"
    takes: ClassVar[frozenset[Option]] = RANGE | {"units"}

    def write(self, recording: Recording, out: TextIO, request: Request) -> str:
        return counted(write_table(recording, out, request.topics, request.part, request.units), "row")


def _write_periodic(
    recording: Recording, out: TextIO, topics: Sequence[str], part: TimeRange, units: UnitSystem
) -> int:
    kinds = joint_kinds(recording)
    t_ns = recording.series(topics[0]).t_ns
    index = part.chosen(t_ns)
    times = t_ns[index]
    line = recording.timeline
    block = line.at(times)
    modals = [line.modals[line.modal[b]] if b >= 0 else None for b in block]
    head = ["time_s", "file", "line", "tool", "motion"]
    columns: list[list[Any]] = [
        [seconds_text(int(t)) for t in times],
        [m.file if m else "" for m in modals],
        [int(line.line[b]) if b >= 0 else "" for b in block],
        [m.tool if m else "" for m in modals],
        [m.motion if m else "" for m in modals],
    ]
    for topic in topics:
        series = recording.series(topic)
        rows = np.searchsorted(series.t_ns, times)
        if len(series.t_ns) != len(t_ns) or not np.array_equal(series.t_ns, t_ns):
            raise NoTableError(f"{topic} and {topics[0]} were not logged at the same times; export them one by one")
        for name in without_twins(series.names):
            column = series.column(name)
            shown, divisor = column_of(topic, name, kinds, units)
            head.append(shown)
            columns.append(_numbers(column[rows], divisor))
        for name, texts in series.texts.items():
            if name == "kind":
                head.append(column_of(topic, name, kinds).name)
                columns.append([texts[i] for i in rows])
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(map(table_text, head))
    writer.writerows(map(_row, zip(*columns, strict=True)))
    return len(times)


def _row(cells: Iterable[Any]) -> list[Any]:
    """Cells whose text no spreadsheet takes for a formula."""
    return [table_text(cell) if isinstance(cell, str) else cell for cell in cells]


def _numbers(column: NDArray[np.float64], divisor: float) -> list[float | int]:
    """As logged when no unit is changed, else without the last bits that the division leaves; whole numbers bare."""
    values = column.tolist() if divisor == 1.0 else [rounded(v, _DIGITS) for v in (column / divisor).tolist()]
    return [int(v) if v.is_integer() and abs(v) < 1e15 else v for v in values]


def _write_changes(recording: Recording, out: TextIO, topic: str, part: TimeRange) -> int:
    log = recording.log
    channel = log.channel_id(topic)
    assert channel is not None
    decode = decoder_of(log, channel)
    writer = csv.writer(out, lineterminator="\n")
    names: list[str] = []
    count = 0
    for raw in log.messages([channel], first_ns=part.first_ns, last_ns=part.last_ns):
        message = decode(raw)
        if not names:
            names = [name for name in leaves(message) if "[" not in name]
            writer.writerow(["time_s", *map(table_text, names)])
        row = [value_at(message, parse_path(name)) for name in names]
        writer.writerow([seconds_text(raw.t_ns), *_row(int(v) if isinstance(v, bool) else v for v in row)])
        count += 1
    return count
