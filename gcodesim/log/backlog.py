"""Messages that wait until it is their turn in the log."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frozen import frozen
from gcodesim.log.byte_kernels import place
from gcodesim.log.byte_strings import ByteStrings

Ints = NDArray[np.int64]

LARGE: Final = 1 << 14  # bytes: a message that is copied by itself, once


class SingleMessage(NamedTuple):
    """One message by itself."""

    t_ns: int
    channel: int
    data: bytes


@frozen(kw_only=False, eq=False)
class Messages:
    """m messages in the order of time, then of channel (the topic table), then of arrival.

    `t_ns`, `channel`, `size` (m,); message i lies in `pools[pool[i]]` from `begin[i]` on. A pool that cannot be written
    is one large message.
    """

    t_ns: Ints
    channel: Ints
    size: Ints
    pool: Ints
    begin: Ints
    pools: tuple[NDArray[np.uint8], ...]

    def __len__(self) -> int:
        return len(self.t_ns)

    def __getitem__(self, index: int) -> SingleMessage:
        start = int(self.begin[index])
        data = self.pools[int(self.pool[index])][start : start + int(self.size[index])]
        return SingleMessage(int(self.t_ns[index]), int(self.channel[index]), data.tobytes())

    def __iter__(self) -> Iterator[SingleMessage]:
        for index in range(len(self)):
            yield self[index]

    def copy_to(self, out: NDArray[np.uint8], at: Ints, part: slice) -> None:
        """Copy the contents of the messages of a `part` to `out`, each from its `at` on."""
        numbers, begin, size = self.pool[part], self.begin[part], self.size[part]
        for number in distinct(numbers).tolist():
            mine, pool = np.flatnonzero(numbers == number), self.pools[number]
            if pool.flags.writeable:
                place(at[mine], out, pool, begin[mine], size[mine])
            else:  # a large message, as it was given
                (only,) = mine
                out[at[only] : at[only] + size[only]] = pool


class _Run:
    """Messages that were given together, in order of time; the first ones may already have been taken."""

    __slots__ = ("arrival", "channel", "data", "next", "starts", "t_ns")

    def __init__(self, t_ns: Ints, channel: Ints, arrival: Ints, strings: ByteStrings) -> None:
        self.t_ns, self.channel, self.arrival = t_ns, channel, arrival
        self.data, self.starts = strings.data, strings.starts
        self.next = 0


class Backlog:
    """Takes messages in any order and returns them in the order of the log.

    Messages that are given together stay together until they are due, so handing over a whole program at its
    start costs little.
    """

    def __init__(self) -> None:
        self._single: list[tuple[int, int, int, bytes]] = []
        self._runs: list[_Run] = []
        self._arrivals = 0

    def add(self, channel: int, t_ns: int, message: bytes) -> None:
        """One message."""
        self._single.append((t_ns, channel, self._arrivals, message))
        self._arrivals += 1

    def add_many(self, channel: int, t_ns: Ints, messages: Sequence[bytes]) -> None:
        """Messages of one channel at times (m,) that do not decrease."""
        strings = messages if isinstance(messages, ByteStrings) else ByteStrings.of(messages)
        count = len(t_ns)
        if len(strings) != count:
            raise ValueError(f"{len(strings)} messages at {count} times")
        arrival = np.arange(self._arrivals, self._arrivals + count, dtype=np.int64)
        self._runs.append(_Run(t_ns, np.full(count, channel, dtype=np.int64), arrival, strings))
        self._arrivals += count

    def due(self, before_ns: int) -> Messages:
        """Remove and return all messages earlier than `before_ns`, in order."""
        if self._single:
            self._single.sort(key=lambda one: one[0])
            self._take([one for one in self._single if len(one[3]) < LARGE])
            for one in self._single:
                if len(one[3]) >= LARGE:
                    self._take([one])
            self._single = []
        found: list[tuple[_Run, slice]] = []
        for run in self._runs:
            last = int(np.searchsorted(run.t_ns, before_ns))
            if last > run.next:
                found.append((run, slice(run.next, last)))
                run.next = last
        self._runs = [run for run in self._runs if run.next < len(run.t_ns)]
        return _in_order(found)

    def _take(self, singles: Sequence[tuple[int, int, int, bytes]]) -> None:
        """Single messages, sorted, become a run."""
        if not singles:
            return
        t_ns, channel, arrival = np.array([one[:3] for one in singles], dtype=np.int64).T
        data = [one[3] for one in singles]
        large = len(data[0]) >= LARGE
        strings = ByteStrings.rows(np.frombuffer(data[0], dtype=np.uint8)[None]) if large else ByteStrings.of(data)
        self._runs.append(_Run(t_ns, channel, arrival, strings))

    def __bool__(self) -> bool:
        return bool(self._single or self._runs)


def _in_order(found: Sequence[tuple[_Run, slice]]) -> Messages:
    """Parts of runs as one sequence."""
    none = np.zeros(0, dtype=np.int64)
    t_ns = np.concatenate([none, *(run.t_ns[part] for run, part in found)])
    channel = np.concatenate([none, *(run.channel[part] for run, part in found)])
    arrival = np.concatenate([none, *(run.arrival[part] for run, part in found)])
    begin = np.concatenate([none, *(run.starts[:-1][part] for run, part in found)])
    size = np.concatenate([none, *(run.starts[1:][part] for run, part in found)]) - begin
    pool = np.repeat(np.arange(len(found), dtype=np.int64), [part.stop - part.start for _, part in found])
    order = np.lexsort((arrival, channel, t_ns))
    pools = tuple(run.data for run, _ in found)
    return Messages(t_ns[order], channel[order], size[order], pool[order], begin[order], pools)
