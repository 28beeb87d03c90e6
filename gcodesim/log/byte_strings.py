"""Many byte strings of different lengths as two arrays, and how messages are put together from them.

A program of 100,000 blocks makes hundreds of thousands of short messages. As objects they would cost more than their
contents, so they lie one after another in one array of bytes, and their parts are copied there by columns.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import overload

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.log.byte_kernels import place
from gcodesim.log.wire import BYTES, tag, varint

Bytes = NDArray[np.uint8]
Ints = NDArray[np.int64]


@frozen(kw_only=False, eq=False)
class ByteStrings(Sequence[bytes]):
    """m byte strings: number i is `data[starts[i]:starts[i + 1]]`; `starts` (m + 1,) do not decrease."""

    data: Bytes
    starts: Ints

    @staticmethod
    def of(strings: Iterable[bytes]) -> ByteStrings:
        """Each of `strings`, copied."""
        given = list(strings)
        return ByteStrings(np.frombuffer(bytearray().join(given), dtype=np.uint8), _starts(list(map(len, given))))

    @staticmethod
    def rows(matrix: Bytes) -> ByteStrings:
        """The rows of `matrix` (m, width), sharing its memory."""
        count, width = matrix.shape
        return ByteStrings(matrix.reshape(-1), np.arange(count + 1, dtype=np.int64) * width)

    @staticmethod
    def joined(parts: Sequence[ByteStrings]) -> ByteStrings:
        """String i is the concatenation of strings i of all `parts`, which have equal numbers of strings."""
        ends = np.cumsum([part.sizes for part in parts], axis=0)
        starts = _starts(ends[-1])
        data = np.empty(starts[-1], dtype=np.uint8)
        for part, end in zip(parts, ends, strict=True):
            part.copy_to(data, starts[:-1] + end - part.sizes)
        return ByteStrings(data, starts)

    @staticmethod
    def mixed(groups: Sequence[tuple[NDArray[np.integer], ByteStrings]]) -> ByteStrings:
        """Strings of several groups in one order: each group with the places (k,) of its strings; all are taken."""
        sizes = np.zeros(sum(len(places) for places, _ in groups), dtype=np.int64)
        for places, strings in groups:
            sizes[places] = strings.sizes
        starts = _starts(sizes)
        data = np.empty(starts[-1], dtype=np.uint8)
        for places, strings in groups:
            strings.copy_to(data, starts[places])
        return ByteStrings(data, starts)

    @staticmethod
    def cut(source: Bytes, begin: Ints, end: Ints) -> ByteStrings:
        """The bytes of `source` from `begin` (m,) to `end` (m,), copied."""
        starts = _starts(end - begin)
        data = np.empty(starts[-1], dtype=np.uint8)
        place(starts[:-1], data, source, begin, end - begin)
        return ByteStrings(data, starts)

    def chosen(self, index: NDArray[np.integer]) -> ByteStrings:
        """Strings `index` (k,), in that order and with repetitions."""
        return ByteStrings.cut(self.data, self.starts[:-1][index], self.starts[1:][index])

    def as_field(self, number: int) -> ByteStrings:
        """Each string as the content of a protobuf field of type string, bytes or message."""
        lengths, which = np.unique(self.sizes, return_inverse=True)
        heads = ByteStrings.of(tag(number, BYTES) + varint(length) for length in lengths.tolist())
        return ByteStrings.joined([heads.chosen(which), self])

    @property
    def sizes(self) -> Ints:
        """Length (m,) of each string."""
        return np.diff(self.starts)

    def copy_to(self, out: Bytes, at: Ints) -> None:
        """Copy string i to `out` from `at[i]` on."""
        place(at, out, self.data, self.starts[:-1], self.sizes)

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, index: int) -> bytes: ...
    @overload
    def __getitem__(self, index: slice) -> ByteStrings: ...
    def __getitem__(self, index: int | slice) -> bytes | ByteStrings:
        if isinstance(index, slice):
            first, last, _ = index.indices(len(self))
            return ByteStrings(self.data, self.starts[first : max(first, last) + 1])
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        i = index % len(self)
        return self.data[self.starts[i] : self.starts[i + 1]].tobytes()

    def __iter__(self) -> Iterator[bytes]:
        for i in range(len(self)):
            yield self[i]


def _starts(sizes: Sequence[int] | Ints) -> Ints:
    starts = np.zeros(len(sizes) + 1, dtype=np.int64)
    np.cumsum(sizes, out=starts[1:])
    return starts
