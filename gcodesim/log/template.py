"""Messages of fixed length, built for many times at once.

A `TemplatePiece` is a part of a message with slots; a `Template` repeats it n times as
a byte matrix and fills the slots from columns. Every number has a fixed width:
doubles are written also when they are 0, and integers are padded to five bytes,
which every reader accepts as it accepts the shortest form.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.log.row_kernels import RowSlots, fill_rows
from gcodesim.log.wire import BYTES, FIXED64, VARINT, tag, text, varint
from gcodesim.units import NS_PER_SECOND

STAMP_WIDTH: Final = 12


@frozen(kw_only=False)
class Slot:
    """A place in a row: where it lies, and which column of which array fills it."""

    offset: int
    kind: str  # number, flag, stamp, time (8 bytes), sequence (4 bytes)
    array: str = ""
    column: int = 0


@frozen(kw_only=False)
class TemplatePiece:
    """A part of a message of fixed length, with slots to fill."""

    data: bytes
    slots: tuple[Slot, ...] = ()

    def __add__(self, other: TemplatePiece) -> TemplatePiece:
        shift = len(self.data)
        moved = tuple(Slot(s.offset + shift, s.kind, s.array, s.column) for s in other.slots)
        return TemplatePiece(self.data + other.data, self.slots + moved)


def nested(number: int, *parts: TemplatePiece) -> TemplatePiece:
    """A message field made of `parts`."""
    body = sum(parts, TemplatePiece(b""))
    return TemplatePiece(tag(number, BYTES) + varint(len(body.data))) + body


def text_piece(number: int, value: str) -> TemplatePiece:
    return TemplatePiece(text(number, value))


def double_slot(number: int, array: str, column: int = 0) -> TemplatePiece:
    """A double field filled from `column` of `array`."""
    head = tag(number, FIXED64)
    return TemplatePiece(head + bytes(8), (Slot(len(head), "number", array, column),))


def bool_slot(number: int, array: str) -> TemplatePiece:
    head = tag(number, VARINT)
    return TemplatePiece(head + bytes(1), (Slot(len(head), "flag", array),))


def stamp_slot(number: int) -> TemplatePiece:
    """A Timestamp field filled with the row's time."""
    return nested(number, TemplatePiece(bytes(STAMP_WIDTH), (Slot(0, "stamp"),)))


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
    return np.concatenate([padded_varints(1, t_ns // NS_PER_SECOND), padded_varints(2, t_ns % NS_PER_SECOND)], axis=1)


class Template:
    """A message, or several in a row, of fixed length."""

    def __init__(self, piece: TemplatePiece, columns: Mapping[str, int] | None = None) -> None:
        """`columns`: with which column each array of the slots begins; by default they stand in order of appearance."""
        self._bytes = np.frombuffer(bytearray(piece.data), dtype=np.uint8)
        begin = _side_by_side(piece.slots) if columns is None else columns

        def at(kind: str) -> NDArray[np.int64]:
            return np.array([slot.offset for slot in piece.slots if slot.kind == kind], dtype=np.int64)

        def source(kind: str) -> NDArray[np.int64]:
            columns = [begin[slot.array] + slot.column for slot in piece.slots if slot.kind == kind]
            return np.array(columns, dtype=np.int64)

        self._slots = RowSlots(
            number_at=at("number"),
            number_from=source("number"),
            flag_at=at("flag"),
            flag_from=source("flag"),
            stamp_at=at("stamp"),
            time_at=at("time"),
            sequence_at=at("sequence"),
        )

    @property
    def width(self) -> int:
        return len(self._bytes)

    def fill(self, t_ns: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.uint8]:
        """Messages (n, width) at the times `t_ns` (n,) of `values` (n, c)."""
        data = np.empty((len(t_ns), self.width), dtype=np.uint8)
        self.fill_in(data.reshape(-1), np.arange(len(t_ns)) * self.width, t_ns, t_ns, values)
        return data

    def fill_in(
        self,
        data: NDArray[np.uint8],
        at: NDArray[np.int64],
        t_ns: NDArray[np.int64],
        sequence: NDArray[np.int64],
        values: NDArray[np.float64],
    ) -> None:
        """The same with sequences (n,), into `data` from each place of `at` (n,) on."""
        given = _plain(values, np.float64)
        numbers = _plain(t_ns, np.int64), _plain(sequence, np.int64), _plain(at, np.int64)
        fill_rows(self._bytes, self._slots, given, given.view(np.uint8), *numbers, data)


def _plain(array: NDArray[Any], kind: Any) -> NDArray[Any]:
    """As the kernel wants it; an array that is read-only would be compiled for once more."""
    return np.require(array, kind, ["C", "W"])


def _side_by_side(slots: tuple[Slot, ...]) -> dict[str, int]:
    """The first column of each array when they stand side by side, each as wide as its slots ask for."""
    widths: dict[str, int] = {}
    for slot in slots:
        if slot.array:
            widths[slot.array] = max(widths.get(slot.array, 0), slot.column + 1)
    ends = np.cumsum(list(widths.values())).tolist()
    return {name: end - width for (name, width), end in zip(widths.items(), ends, strict=True)}
