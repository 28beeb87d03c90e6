"""Messages and rows in the order of the file, and chunks cut out of them.

Between two rows of periodic messages there are often messages of blocks, tiles and arrows. Sorting them in, heads,
sequence, places and indexes are computed for a whole window at once; what is left for each message is to be joined.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.backlog import Message
from gcodesim.log.rows import MESSAGE_HEAD, MESSAGE_OPCODE, Rows

Ints = NDArray[np.int64]
HEAD: Final = np.dtype(
    [("opcode", "u1"), ("size", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("t_ns", "<u8"), ("publish_ns", "<u8")]
)
"""Record head and message head of a message, as they lie in the file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """A part of a chunk: records one after the other, and by channel the index entries of its messages."""

    parts: list[bytes | memoryview]
    size: int
    count: int
    first_ns: int
    last_ns: int
    index: dict[int, bytes]


class Ordered:
    """What a window brings, in the order of time and then of the topic table: messages, and rows of `channels`.

    The first of the `channels` is the first in the table of those that come in rows; who stands before it is written
    before the rows of the same time, all others after them.
    """

    def __init__(
        self, messages: Sequence[Message], rows: Sequence[Rows], channels: Sequence[int], counts: NDArray[np.int64]
    ) -> None:
        """`messages` sorted, `rows` in time order; `counts` by channel number are raised by what comes."""
        self._channels = channels
        self._rows = rows
        self._data = [message.data for message in messages]
        self._times = np.array([message.t_ns for message in messages], dtype=np.int64)
        self._channel = np.array([message.channel for message in messages], dtype=np.int64)
        instants = np.array([len(r.times) for r in rows], dtype=np.int64)
        self._row_times = np.concatenate([np.asarray(r.times, dtype=np.int64) for r in rows] or [np.zeros(0, np.int64)])
        self._row_of = np.repeat(np.arange(len(rows)), instants)
        self._row_borders = [0, *np.cumsum(instants).tolist()]
        after = self._channel > channels[0]
        self._before = np.where(  # rows in front of each message
            after,
            np.searchsorted(self._row_times, self._times, side="right"),
            np.searchsorted(self._row_times, self._times, side="left"),
        )
        self._at = np.arange(len(messages)) + self._before  # places in the order of both
        self._row_at = np.arange(len(self._row_times))
        self._row_at += np.searchsorted(self._before, np.arange(len(self._row_times)), side="right")
        self._heads = self._made_heads(counts)
        counts[list(channels)] += len(self._row_times)
        sizes = np.empty(len(messages) + len(self._row_times), dtype=np.int64)
        sizes[self._at] = HEAD.itemsize + np.fromiter(map(len, self._data), np.int64, len(messages))
        sizes[self._row_at] = np.array([r.width for r in rows], dtype=np.int64)[self._row_of] if len(rows) else 0
        self._ends = np.cumsum(sizes)

    def _made_heads(self, counts: NDArray[np.int64]) -> bytes:
        """Heads of all messages, one after the other."""
        heads = np.empty(len(self._data), dtype=HEAD)
        heads["opcode"] = MESSAGE_OPCODE
        heads["size"] = MESSAGE_HEAD + np.fromiter(map(len, self._data), np.int64, len(self._data))
        heads["channel"] = self._channel
        heads["t_ns"] = heads["publish_ns"] = self._times
        grouped = np.argsort(self._channel, kind="stable")
        number = np.bincount(self._channel, minlength=len(counts))
        first = np.cumsum(number) - number
        rank = np.empty(len(grouped), dtype=np.int64)
        rank[grouped] = np.arange(len(grouped)) - np.repeat(first, number)
        heads["sequence"] = counts[self._channel] + rank
        counts += number
        return heads.tobytes()

    def cut(self, filled: int, most: int) -> Iterator[Cut]:
        """Parts of chunks: the first for one that has `filled` bytes; all but the last fill theirs beyond `most`."""
        first, start = 0, 0
        while first < len(self._ends):
            last = min(int(np.searchsorted(self._ends, start + most - filled, side="right")) + 1, len(self._ends))
            yield self._between(first, last, start, filled)
            first, start, filled = last, int(self._ends[last - 1]), 0

    def _between(self, first: int, last: int, start: int, filled: int) -> Cut:
        """Records from place `first` to `last`; they begin at byte `start` of all, and at `filled` of their chunk."""
        a, b = np.searchsorted(self._at, [first, last]).tolist()
        r, s = np.searchsorted(self._row_at, [first, last]).tolist()
        begins = np.concatenate([[start], self._ends[first : last - 1]]) - start + filled
        times = np.concatenate([self._times[a:b], self._row_times[r:s]])
        return Cut(
            parts=self._parts(a, b, r, s),
            size=int(self._ends[last - 1]) - start,
            count=b - a + (s - r) * len(self._channels),
            first_ns=int(times.min()),
            last_ns=int(times.max()),
            index={**self._message_index(a, b, begins, first), **self._row_index(r, s, begins, first)},
        )

    def _message_index(self, a: int, b: int, begins: Ints, first: int) -> dict[int, bytes]:
        entries = np.empty((b - a, 2), dtype="<u8")
        entries[:, 0], entries[:, 1] = self._times[a:b], begins[self._at[a:b] - first]
        channel = self._channel[a:b]
        grouped = np.argsort(channel, kind="stable")
        entries = entries[grouped]
        numbers, starts = np.unique(channel[grouped], return_index=True)
        borders = [*starts.tolist(), b - a]
        return {
            number: entries[i:j].tobytes()
            for number, i, j in zip(numbers.tolist(), borders[:-1], borders[1:], strict=True)
        }

    def _row_index(self, r: int, s: int, begins: Ints, first: int) -> dict[int, bytes]:
        if r == s:
            return {}
        entries = np.empty((s - r, 2), dtype="<u8")
        entries[:, 0] = self._row_times[r:s]
        at, places = begins[self._row_at[r:s] - first], np.array([rows.starts for rows in self._rows])
        index = {}
        for k, channel in enumerate(self._channels):
            entries[:, 1] = at + places[self._row_of[r:s], k]
            index[channel] = entries.tobytes()
        return index

    def _parts(self, a: int, b: int, r: int, s: int) -> list[bytes | memoryview]:
        """Messages a ≤ i < b and rows r ≤ j < s, joined later."""
        parts: list[bytes | memoryview] = []
        heads, width = memoryview(self._heads), HEAD.itemsize
        for i, before in enumerate(self._before[a:b].tolist(), start=a):
            if before > r:
                parts += [rows.data for rows in self._rows_between(r, before)]
                r = before
            parts.append(heads[i * width : (i + 1) * width])
            parts.append(self._data[i])
        if s > r:
            parts += [rows.data for rows in self._rows_between(r, s)]
        return parts

    def each(self) -> Iterator[Message | Rows]:
        """Messages, and rows between them, one after the other."""
        r = 0
        for i, before in enumerate(self._before.tolist()):
            if before > r:
                yield from self._rows_between(r, before)
                r = before
            yield Message(int(self._times[i]), int(self._channel[i]), i, self._data[i])
        yield from self._rows_between(r, len(self._row_times))

    def _rows_between(self, first: int, last: int) -> Iterator[Rows]:
        """Rows first ≤ j < last, in as few parts as they lie in."""
        k = bisect_right(self._row_borders, first) - 1
        while first < last:
            begin, end = self._row_borders[k], min(last, self._row_borders[k + 1])
            yield self._rows[k].part(first - begin, end - begin)
            first, k = end, k + 1
