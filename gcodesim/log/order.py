"""Messages and rows in the order of the file, and chunks cut out of them.

Between two rows of periodic messages there are often messages of blocks, tiles and arrows. Sorting them in, heads,
sequence, places and indexes are computed for a whole window at once; then the records are copied to their places.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.log.backlog import Messages, SingleMessage
from gcodesim.log.byte_strings import ByteStrings
from gcodesim.log.rows import MESSAGE_HEAD, MESSAGE_OPCODE, RecordRows

Ints = NDArray[np.int64]
HEAD: Final = np.dtype(
    [("opcode", "u1"), ("size", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("t_ns", "<u8"), ("publish_ns", "<u8")]
)
"""Record head and message head of a message, as they lie in the file."""


@frozen
class ChunkPiece:
    """A part of a chunk: `size` bytes of records, and by channel the index entries of their messages.

    `write` puts the records into the chunk's bytes, where the index says that they are.
    """

    size: int
    count: int
    first_ns: int
    last_ns: int
    index: dict[int, bytes]
    write: Callable[[NDArray[np.uint8]], None]


class Ordered:
    """The content of a window in the order of time and then of the topic table: messages, and rows of `channels`.

    The first of the `channels` is the first in the table of those that come in rows. Messages above it come
    before the rows of the same time, all others after them.
    """

    def __init__(
        self, messages: Messages, rows: Sequence[RecordRows], channels: Sequence[int], counts: NDArray[np.int64]
    ) -> None:
        """`rows` in time order; `counts` by channel number are raised by the new messages."""
        self._channels = channels
        self._rows = rows
        self._messages = messages
        instants = np.array([len(r.times) for r in rows], dtype=np.int64)
        self._row_times = np.concatenate([np.zeros(0, np.int64), *(r.times for r in rows)])
        self._row_of = np.repeat(np.arange(len(rows)), instants)
        self._row_borders = [0, *np.cumsum(instants).tolist()]
        after = messages.channel > channels[0]
        self._before = np.where(  # rows in front of each message
            after,
            np.searchsorted(self._row_times, messages.t_ns, side="right"),
            np.searchsorted(self._row_times, messages.t_ns, side="left"),
        )
        self._at = np.arange(len(messages)) + self._before  # places in the order of both
        self._row_at = np.arange(len(self._row_times))
        self._row_at += np.searchsorted(self._before, np.arange(len(self._row_times)), side="right")
        sizes = np.empty(len(messages) + len(self._row_times), dtype=np.int64)
        sizes[self._at] = HEAD.itemsize + messages.size
        sizes[self._row_at] = np.array([r.width for r in rows], dtype=np.int64)[self._row_of] if len(rows) else 0
        self._ends = np.cumsum(sizes)
        self._heads = self._made_heads(counts)
        counts[list(channels)] += len(self._row_times)

    def _made_heads(self, counts: NDArray[np.int64]) -> ByteStrings:
        """Heads of all messages."""
        messages, count = self._messages, len(self._messages)
        heads = np.empty(count, dtype=HEAD)
        heads["opcode"] = MESSAGE_OPCODE
        heads["size"] = MESSAGE_HEAD + messages.size
        heads["channel"] = messages.channel
        heads["t_ns"] = heads["publish_ns"] = messages.t_ns
        grouped = np.argsort(messages.channel, kind="stable")
        number = np.bincount(messages.channel, minlength=len(counts))
        first = np.cumsum(number) - number
        rank = np.empty(count, dtype=np.int64)
        rank[grouped] = np.arange(count) - np.repeat(first, number)
        heads["sequence"] = counts[messages.channel] + rank
        counts += number
        return ByteStrings.rows(heads.view(np.uint8).reshape(count, HEAD.itemsize))

    def cut(self, filled: int, most: int) -> Iterator[ChunkPiece]:
        """Parts of chunks: the first for one with `filled` bytes; all but the last fill their chunk beyond `most`."""
        first, start = 0, 0
        while first < len(self._ends):
            last = min(int(np.searchsorted(self._ends, start + most - filled, side="right")) + 1, len(self._ends))
            yield self._between(first, last, start, filled)
            first, start, filled = last, int(self._ends[last - 1]), 0

    def _between(self, first: int, last: int, start: int, filled: int) -> ChunkPiece:
        """Records from place `first` to `last`; they begin at byte `start` of all, and at `filled` of their chunk."""
        a, b = np.searchsorted(self._at, [first, last]).tolist()
        r, s = np.searchsorted(self._row_at, [first, last]).tolist()
        begins = np.concatenate([[start], self._ends[first : last - 1]]) - start + filled
        message_at, row_at = begins[self._at[a:b] - first], begins[self._row_at[r:s] - first]
        times = np.concatenate([self._messages.t_ns[a:b], self._row_times[r:s]])

        def write(data: NDArray[np.uint8]) -> None:
            self._heads[a:b].copy_to(data, message_at)
            self._messages.copy_to(data, message_at + HEAD.itemsize, slice(a, b))
            done = 0
            for rows in self._rows_between(r, s):
                rows.write(data, row_at[done : done + len(rows.times)])
                done += len(rows.times)

        return ChunkPiece(
            size=int(self._ends[last - 1]) - start,
            count=b - a + (s - r) * len(self._channels),
            first_ns=int(times.min()),
            last_ns=int(times.max()),
            index={**self._message_index(slice(a, b), message_at), **self._row_index(slice(r, s), row_at)},
            write=write,
        )

    def _message_index(self, part: slice, at: Ints) -> dict[int, bytes]:
        entries = np.stack([self._messages.t_ns[part], at], axis=1).astype("<u8")
        channel = self._messages.channel[part]
        grouped = np.argsort(channel, kind="stable")
        entries = entries[grouped]
        numbers, starts = np.unique(channel[grouped], return_index=True)
        borders = [*starts.tolist(), len(channel)]
        return {
            number: entries[i:j].tobytes()
            for number, i, j in zip(numbers.tolist(), borders[:-1], borders[1:], strict=True)
        }

    def _row_index(self, part: slice, at: Ints) -> dict[int, bytes]:
        if not len(at):
            return {}
        entries = np.empty((len(at), 2), dtype="<u8")
        entries[:, 0] = self._row_times[part]
        places = np.array([rows.starts for rows in self._rows])[self._row_of[part]]
        index = {}
        for k, channel in enumerate(self._channels):
            entries[:, 1] = at + places[:, k]
            index[channel] = entries.tobytes()
        return index

    def each(self) -> Iterator[SingleMessage | RecordRows]:
        """Messages, and rows between them, one after another."""
        r = 0
        for i, before in enumerate(self._before.tolist()):
            if before > r:
                yield from self._rows_between(r, before)
                r = before
            yield self._messages[i]
        yield from self._rows_between(r, len(self._row_times))

    def _rows_between(self, first: int, last: int) -> Iterator[RecordRows]:
        """Rows first ≤ j < last, in as few parts as they lie in."""
        k = bisect_right(self._row_borders, first) - 1
        while first < last:
            begin, end = self._row_borders[k], min(last, self._row_borders[k + 1])
            yield self._rows[k].part(first - begin, end - begin)
            first, k = end, k + 1
