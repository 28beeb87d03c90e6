"""Protobuf's wire format, as far as the log builds messages without message objects.

Two forms: `bytes` for messages of any length, and `Piece` for messages of
fixed length with slots that numpy fills for many messages at once (`rows.py`).
In a piece every number has a fixed width: doubles are written also when they
are 0, and the integers of a time stamp are padded to five bytes, which every
reader accepts as it accepts the shortest form.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5
STAMP_WIDTH: Final = 12
_NS: Final = 1_000_000_000
_F8: Final = struct.Struct("<d")


def varint(value: int) -> bytes:
    """An unsigned integer in groups of seven bits, low group first."""
    if value < 128:
        return bytes((value,))
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)
    return bytes(out)


def tag(number: int, kind: int) -> bytes:
    """The key in front of field `number` of wire type `kind`."""
    return varint(number << 3 | kind)


def chunk(number: int, data: bytes) -> bytes:
    """A bytes, string or message field."""
    return tag(number, BYTES) + varint(len(data)) + data


def text(number: int, value: str) -> bytes:
    """A string field; nothing when it is empty."""
    return chunk(number, value.encode()) if value else b""


def unsigned(number: int, value: int) -> bytes:
    """An integer, enumeration or bool field; nothing when it is 0."""
    return tag(number, VARINT) + varint(value) if value else b""


def double(number: int, value: float) -> bytes:
    """A double field, also when it is 0."""
    return tag(number, FIXED64) + _F8.pack(value)


def stamp(number: int, t_ns: int) -> bytes:
    """A Timestamp field of a time [ns]."""
    seconds, nanos = divmod(t_ns, _NS)
    return chunk(number, unsigned(1, seconds) + unsigned(2, nanos))


def vectors(number: int, rows: NDArray[np.float64]) -> bytes:
    """A repeated field of messages x, y, z: points or vectors (n, 3)."""
    n = len(rows)
    record = np.empty(n, dtype=_VECTOR)
    record["head"] = int.from_bytes(tag(number, BYTES) + bytes((27,)), "little")
    for i, name in enumerate("xyz"):
        record[f"{name}_tag"] = i + 1 << 3 | FIXED64
        record[name] = rows[:, i]
    return record.tobytes()


VECTOR_WIDTH: Final = 29
_VECTOR: Final = np.dtype(
    [("head", "<u2"), ("x_tag", "u1"), ("x", "<f8"), ("y_tag", "u1"), ("y", "<f8"), ("z_tag", "u1"), ("z", "<f8")]
)


def packed_fixed32(number: int, values: NDArray[np.integer]) -> bytes:
    """A packed repeated fixed32 field, such as the indices of a mesh; nothing when there are none."""
    return chunk(number, np.ascontiguousarray(values, dtype="<u4").tobytes()) if len(values) else b""


@dataclass(frozen=True, slots=True)
class Slot:
    """A place in a row: where it lies, and which column of which array fills it."""

    offset: int
    kind: str  # f8, bool, stamp, u4, u8
    array: str = ""
    column: int = 0


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a message of fixed length, with slots to fill."""

    data: bytes
    slots: tuple[Slot, ...] = ()

    def __add__(self, other: Piece) -> Piece:
        shift = len(self.data)
        moved = tuple(Slot(s.offset + shift, s.kind, s.array, s.column) for s in other.slots)
        return Piece(self.data + other.data, self.slots + moved)


def nested(number: int, *parts: Piece) -> Piece:
    """A message field made of `parts`."""
    body = sum(parts, Piece(b""))
    return Piece(tag(number, BYTES) + varint(len(body.data))) + body


def text_piece(number: int, value: str) -> Piece:
    return Piece(text(number, value))


def double_slot(number: int, array: str, column: int = 0) -> Piece:
    """A double field filled from `column` of `array`."""
    head = tag(number, FIXED64)
    return Piece(head + bytes(8), (Slot(len(head), "f8", array, column),))


def bool_slot(number: int, array: str) -> Piece:
    head = tag(number, VARINT)
    return Piece(head + bytes(1), (Slot(len(head), "bool", array),))


def stamp_slot(number: int) -> Piece:
    """A Timestamp field filled with the row's time."""
    return nested(number, Piece(bytes(STAMP_WIDTH), (Slot(0, "stamp"),)))


def padded_stamps(t_ns: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Contents of Timestamp messages (n, 12) for times (n,) [ns]."""
    out = np.empty((len(t_ns), STAMP_WIDTH), dtype=np.uint8)
    for start, value in ((0, t_ns // _NS), (6, t_ns % _NS)):
        out[:, start] = 8 if start == 0 else 16
        for group in range(5):
            more = 128 if group < 4 else 0
            out[:, start + 1 + group] = value >> 7 * group & 127 | more
    return out
