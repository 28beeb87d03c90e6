"""Messages of fixed length, built for many times at once.

A `Piece` is a part of a message with slots; a `Template` repeats it n times as
a byte matrix into which numpy writes whole columns. Every number has a fixed
width: doubles are written also when they are 0, and integers are padded to
five bytes, which every reader accepts as it accepts the shortest form.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.wire import BYTES, FIXED64, VARINT, tag, text, varint

STAMP_WIDTH: Final = 12
_NS: Final = 1_000_000_000
_DTYPES: Final = {"f8": "<f8", "bool": "u1", "stamp": "V12", "u4": "<u4", "u8": "<u8"}


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


def padded_varints(number: int, values: NDArray[np.integer]) -> NDArray[np.uint8]:
    """Integer fields (n, 6) of field `number` < 16 for values (n,) from 0 to 2³⁵ - 1."""
    values = np.asarray(values, dtype=np.int64)
    out = np.empty((len(values), 6), dtype=np.uint8)
    out[:, 0] = number << 3 | VARINT
    for group in range(5):
        more = 128 if group < 4 else 0
        out[:, group + 1] = values >> 7 * group & 127 | more
    return out


def padded_stamps(t_ns: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Contents of Timestamp messages (n, 12) for times (n,) [ns]."""
    return np.concatenate([padded_varints(1, t_ns // _NS), padded_varints(2, t_ns % _NS)], axis=1)


class Template:
    """A message, or several in a row, of fixed length."""

    def __init__(self, piece: Piece) -> None:
        self._bytes = np.frombuffer(piece.data, dtype=np.uint8)
        self._fills = tuple(_fills(piece.slots))

    def fill(self, t_ns: NDArray[np.int64], arrays: Mapping[str, NDArray[Any]]) -> NDArray[np.uint8]:
        """Messages (n, length) at the times `t_ns` (n,) from `arrays` of shape (n, columns)."""
        n, width = len(t_ns), len(self._bytes)
        columns = {**arrays, "": padded_stamps(t_ns).view("V12")}
        data = np.empty((n, width), dtype=np.uint8)
        data[:] = self._bytes
        for fill in self._fills if n else ():
            target = np.ndarray((n, fill.count), fill.dtype, data, fill.offset, (width, fill.step))
            target[:] = columns[fill.array][:, fill.column : fill.column + fill.count]
        return data


@dataclass(frozen=True, slots=True)
class _Fill:
    """Neighbouring slots that are filled from neighbouring columns in one assignment."""

    offset: int
    step: int
    dtype: str
    array: str
    column: int
    count: int


def _fills(slots: tuple[Slot, ...]) -> Iterator[_Fill]:
    """Slots joined where columns and distances go on evenly."""
    run: list[Slot] = []
    for slot in slots:
        joins = bool(run) and slot.kind == "f8" == run[-1].kind and slot.array == run[-1].array
        joins = joins and slot.column == run[-1].column + 1
        joins = joins and (len(run) == 1 or slot.offset - run[-1].offset == run[1].offset - run[0].offset)
        if not joins and run:
            yield _fill_of(run)
            run = []
        run.append(slot)
    if run:
        yield _fill_of(run)


def _fill_of(run: list[Slot]) -> _Fill:
    step = run[1].offset - run[0].offset if len(run) > 1 else 0
    return _Fill(run[0].offset, step, _DTYPES[run[0].kind], run[0].array, run[0].column, len(run))
