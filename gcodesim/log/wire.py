"""Protobuf's wire format, as far as the log builds messages without message objects."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from functools import cache
from itertools import chain
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.units import NS_PER_SECOND

Part = bytes | memoryview
"""A part of a message; a memoryview is of bytes."""

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5
_F8: Final = struct.Struct("<d")
_DOUBLE_KEYS: Final = tuple(number << 3 | FIXED64 for number in range(1, 16))


_SHORT: Final = [bytes((value,)) for value in range(128)]


def varint(value: int) -> bytes:
    """An unsigned integer in groups of seven bits, low group first."""
    if 0 <= value < 128:
        return _SHORT[value]
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)
    return bytes(out)


def tag(number: int, kind: int) -> bytes:
    """The key in front of field `number` of wire type `kind`."""
    key = number << 3 | kind
    return _SHORT[key] if key < 128 else varint(key)


def chunk(number: int, data: bytes) -> bytes:
    """A bytes, string or message field."""
    return tag(number, BYTES) + varint(len(data)) + data


def wrap(number: int, parts: Sequence[Part]) -> list[Part]:
    """`chunk` of data that stays in parts, which are joined once, when the message is complete."""
    return [tag(number, BYTES) + varint(sum(map(len, parts))), *parts]


def text(number: int, value: str) -> bytes:
    """A string field; nothing when it is empty."""
    return chunk(number, value.encode()) if value else b""


def unsigned(number: int, value: int) -> bytes:
    """An integer, enumeration or bool field; nothing when it is 0."""
    return tag(number, VARINT) + varint(value) if value else b""


def double(number: int, value: float) -> bytes:
    """A double field, also when it is 0."""
    return tag(number, FIXED64) + _F8.pack(value)


def doubles(*values: float) -> bytes:
    """Double fields 1, 2, … of up to 15 values."""
    return _fields_of(len(values)).pack(*chain.from_iterable(zip(_DOUBLE_KEYS, values, strict=False)))


@cache
def _fields_of(count: int) -> struct.Struct:
    """Keys of a byte and doubles, by turns."""
    return struct.Struct("<" + "Bd" * count)


def stamp(number: int, t_ns: int) -> bytes:
    """A Timestamp field of a time [ns]."""
    seconds, nanos = divmod(t_ns, NS_PER_SECOND)
    return chunk(number, unsigned(1, seconds) + unsigned(2, nanos))


def packed_fixed32(number: int, values: NDArray[np.integer]) -> list[Part]:
    """A packed repeated fixed32 field, such as the indices of a mesh, in parts; nothing when there are none."""
    if not len(values):
        return []
    same = values.dtype == np.int32 and values.flags.c_contiguous  # to the bit, as none is negative
    return wrap(number, [(values if same else np.ascontiguousarray(values, dtype="<u4")).view(np.uint8).data])
