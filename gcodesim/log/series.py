"""Periodic topics as columns: all numbers of many messages of the same layout at once.

Messages of one topic differ in their numbers but seldom in their layout, so the
places of the numbers are found once, and numpy takes them from a byte matrix.
A message of another layout is read by protobuf, which is slower and
gives the same result.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.log.fields import item_name, leaves, parse_path, value_at
from gcodesim.log.logfile import LogFile, RawMessage
from gcodesim.log.reader import decoder_of

_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_MOST_BUILDS: Final = 32  # layouts of a topic's messages that are read by columns; the rest is read message by message

Array = NDArray[np.float64]


@frozen(kw_only=False, eq=False)
class Series:
    """A topic over time: `t_ns` (n,), numbers `values` (n, k) of the fields `names` (k), texts by field and message.

    Paths as in `log/fields.py`: `force_n`, `joints[arm/joint_1].position`.
    A field that a message leaves out is 0, as protobuf has it.
    """

    t_ns: NDArray[np.int64]
    names: tuple[str, ...]
    values: Array
    texts: dict[str, list[str]]

    def column(self, name: str) -> Array:
        """One field (n,). KeyError when the topic has no such number."""
        if name not in self.names:
            raise KeyError(name)
        return self.values[:, self.names.index(name)]

    def columns(self, *names: str) -> Array:
        """Several fields (n, len(names)); zeros where the topic has no field of that name."""
        found = np.zeros((len(self.t_ns), len(names)))
        for k, name in enumerate(names):
            if name in self.names:
                found[:, k] = self.column(name)
        return found


class _Slot(NamedTuple):
    """Where a number is in a message; `kind` is double or bool."""

    path: str
    offset: int
    kind: str


def read_series(
    log: LogFile, topics: Sequence[str], *, first_ns: int = 0, last_ns: int | None = None, every_ns: int = 0
) -> dict[str, Series]:
    """Columns of the topics that the log has, read in one pass.

    `every_ns` leaves out messages whose time is not a multiple of it, except the
    last. LogReadError when the log is damaged.
    """
    wanted = {log.channel_id(topic): topic for topic in topics if log.channel_id(topic) is not None}
    times: dict[int, list[int]] = {channel: [] for channel in wanted if channel is not None}
    found: dict[int, list[bytes]] = {channel: [] for channel in times}
    left_out: dict[int, tuple[int, bytes]] = {}
    for message in log.messages(times, first_ns=first_ns, last_ns=last_ns):
        if every_ns and message.t_ns % every_ns:
            left_out[message.channel] = (message.t_ns, message.data)
            continue
        times[message.channel].append(message.t_ns)
        found[message.channel].append(message.data)
    for channel, (t_ns, data) in left_out.items():
        if not times[channel] or t_ns > times[channel][-1]:
            times[channel].append(t_ns)
            found[channel].append(data)
    return {
        wanted[channel]: _series(log, channel, np.array(times[channel], dtype=np.int64), found[channel])
        for channel in times
    }


def _series(log: LogFile, channel: int, t_ns: NDArray[np.int64], messages: list[bytes]) -> Series:
    if not messages:
        return Series(t_ns, (), np.zeros((0, 0)), {})
    decode_raw = decoder_of(log, channel)
    columns: dict[str, Array] = {}
    texts: dict[str, list[str]] = {}
    count = len(messages)

    def decode(i: int) -> Any:
        return decode_raw(RawMessage(channel, 0, int(t_ns[i]), messages[i]))

    def column(name: str) -> Array:
        if name not in columns:
            columns[name] = np.zeros(count)
        return columns[name]

    length = np.array([len(data) for data in messages])
    waiting = np.arange(count)
    for _ in range(_MOST_BUILDS):
        if not len(waiting):
            break
        same = waiting[length[waiting] == length[waiting[0]]]
        matrix = np.frombuffer(b"".join([messages[i] for i in same]), dtype=np.uint8).reshape(len(same), -1)
        build = _Build.of(decode(int(same[0])), messages[same[0]])
        agree = build.agrees(matrix)
        agree[0] = True
        for slot, values in build.numbers(matrix[agree]):
            column(slot.path)[same[agree]] = values
        for name, value in build.constants.items():
            column(name)[same[agree]] = value
        for name, text in build.texts.items():
            into = texts.setdefault(name, [""] * count)
            for i in same[agree]:
                into[i] = text
        waiting = np.setdiff1d(waiting, same[agree], assume_unique=True)
    for i in waiting:
        message = decode(int(i))
        for name in leaves(message):
            value = value_at(message, parse_path(name))
            if isinstance(value, str):
                texts.setdefault(name, [""] * count)[i] = value
            elif isinstance(value, (bool, int, float)):
                column(name)[i] = value
    values = np.stack(list(columns.values()), axis=1) if columns else np.zeros((count, 0))
    return Series(t_ns, tuple(columns), values, texts)


@dataclass(slots=True, eq=False)
class _Build:
    """How the bytes of a message are laid out: where its numbers are, and which bytes are the same in all alike."""

    slots: list[_Slot]
    texts: dict[str, str]
    constants: dict[str, float]
    fixed: NDArray[np.bool_]
    data: NDArray[np.uint8]

    @staticmethod
    def of(message: Any, data: bytes) -> _Build:
        build = _Build([], {}, {}, np.ones(len(data), dtype=bool), np.frombuffer(data, dtype=np.uint8))
        build._walk(data, 0, len(data), message, "")
        return build

    def agrees(self, matrix: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Which rows (n, length) have this layout."""
        same: NDArray[np.bool_] = (matrix[:, self.fixed] == self.data[self.fixed]).all(axis=1)
        return same

    def numbers(self, matrix: NDArray[np.uint8]) -> Iterator[tuple[_Slot, NDArray[Any]]]:
        for slot in self.slots:
            if slot.kind == "double":
                part = np.ascontiguousarray(matrix[:, slot.offset : slot.offset + 8])
                yield slot, part.view("<f8")[:, 0]
            else:
                yield slot, matrix[:, slot.offset]

    def _walk(self, data: bytes, at: int, end: int, message: Any, prefix: str) -> None:
        fields = message.DESCRIPTOR.fields_by_number
        seen: dict[str, int] = {}
        while at < end:
            key, at = _varint(data, at)
            number, wire = key >> 3, key & 7
            field = fields.get(number)
            if wire == _VARINT:
                value, after = _varint(data, at)
                if field is not None and field.cpp_type == field.CPPTYPE_BOOL:
                    self._slot(f"{prefix}{field.name}", at, 1, "bool")
                elif field is not None:  # part of the layout, so messages with another text are read separately
                    self.constants[f"{prefix}{field.name}"] = float(value)
                at = after
            elif wire == _FIXED64:
                if field is not None and field.cpp_type == field.CPPTYPE_DOUBLE:
                    self._slot(f"{prefix}{field.name}", at, 8, "double")
                at += 8
            elif wire == _FIXED32:
                at += 4
            else:
                size, at = _varint(data, at)
                if field is not None:
                    self._part(data, at, at + size, message, field, prefix, seen)
                at += size

    def _part(
        self, data: bytes, at: int, end: int, message: Any, field: Any, prefix: str, seen: dict[str, int]
    ) -> None:
        """A field of variable length: a text, a message, or one item of a repeated one."""
        value, path = getattr(message, field.name), f"{prefix}{field.name}"
        if field.cpp_type == field.CPPTYPE_STRING:
            if isinstance(value, str):
                self.texts[path] = value
        elif field.cpp_type == field.CPPTYPE_MESSAGE:
            if field.message_type.full_name == "google.protobuf.Timestamp":
                self.fixed[at:end] = False
                return
            if not hasattr(value, "DESCRIPTOR"):
                index = seen[field.name] = seen.get(field.name, -1) + 1
                value = value[index]
                path = f"{path}[{item_name(value) or index}]"
            self._walk(data, at, end, value, f"{path}.")

    def _slot(self, path: str, offset: int, size: int, kind: str) -> None:
        self.slots.append(_Slot(path, offset, kind))
        self.fixed[offset : offset + size] = False


def _varint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at += 1
        if byte < 0x80:
            return value, at
        shift += 7
