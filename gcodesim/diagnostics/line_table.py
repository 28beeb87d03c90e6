"""The lines of a long file: where each one begins, and its text on demand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final, overload

import numpy as np
from numpy.typing import NDArray

_LF, _CR = 10, 13
_TOGETHER: Final = 10_000  # lines that are cut at once where all are gone through


class LineTable(Sequence[str]):
    """Reads like a list of lines without their ends, but keeps the bytes: 8 bytes a line instead of a string.

    `starts` (n + 1,) holds the offset at which each line begins in `data`, and the length of `data` last.
    """

    def __init__(self, raw: bytes, begin: int, encoding: str) -> None:
        """Lines of `raw` from offset `begin` on (behind a byte order mark)."""
        self._raw = raw
        self._encoding = encoding
        self.data: NDArray[np.uint8] = np.frombuffer(raw, dtype=np.uint8)
        self.starts = _starts(self.data, begin, has_cr=b"\r" in raw)

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> list[str]: ...
    def __getitem__(self, index: int | slice) -> str | list[str]:
        if isinstance(index, slice):
            first, last, step = index.indices(len(self))
            return self._between(first, last) if step == 1 else [self[at] for at in range(first, last, step)]
        if index < 0:
            index += len(self)
        if not 0 <= index < len(self):
            raise IndexError(index)
        return self._cut(self.starts[index], self.starts[index + 1])

    def __iter__(self) -> Iterator[str]:
        for first in range(0, len(self), _TOGETHER):
            yield from self._between(first, first + _TOGETHER)

    def _between(self, first: int, last: int) -> list[str]:
        """The lines with the indices from `first` to before `last`; whole numbers of Python cut faster than numpy's."""
        bounds = self.starts[first : last + 1].tolist()
        return [self._cut(begin, end) for begin, end in pairwise(bounds)]

    def _cut(self, begin: int, end: int) -> str:
        return self._raw[begin:end].removesuffix(b"\n").removesuffix(b"\r").decode(self._encoding)

    def with_any(self, letters: bytes) -> list[int]:
        """Indices of the lines that hold one of the bytes `letters`, ascending."""
        wanted = np.zeros(256, dtype=bool)
        wanted[list(letters)] = True
        places = np.flatnonzero(wanted[self.data])
        lines = np.searchsorted(self.starts, places, side="right") - 1
        return list(dict.fromkeys(lines[lines >= 0].tolist()))


def _starts(data: NDArray[np.uint8], begin: int, *, has_cr: bool) -> NDArray[np.int64]:
    ends = data == _LF
    if has_cr:
        lone = data == _CR
        lone[:-1] &= ~ends[1:]  # in CR LF the line feed ends the line
        ends |= lone
    found = np.flatnonzero(ends)
    starts = np.empty(len(found) + 2, dtype=np.int64)
    starts[0], starts[-1] = begin, len(data)
    np.add(found, 1, out=starts[1:-1])
    if starts[-2] == len(data):  # an end after the last line opens no new one
        starts = starts[:-1]
    return starts
