"""Messages that wait for their turn in the log."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from typing import NamedTuple


class Message(NamedTuple):
    """Sorted by time, then channel (the order of the topic table), then arrival."""

    t_ns: int
    channel: int
    arrival: int
    data: bytes


class Backlog:
    """Takes messages in any order and gives them out in theirs.

    What arrived between two calls of `due` is sorted once, latest first, and
    then only loses its end. So it costs little to hand over a whole program at
    its start.
    """

    def __init__(self) -> None:
        self._arrived: list[Message] = []
        self._runs: list[list[Message]] = []
        self._arrivals = 0

    def add(self, channel: int, times: Iterable[int], messages: Iterable[bytes]) -> None:
        for t_ns, data in zip(times, messages, strict=True):
            self._arrived.append(Message(t_ns, channel, self._arrivals, data))
            self._arrivals += 1

    def due(self, before_ns: int) -> list[Message]:
        """All messages earlier than `before_ns`, in order; they are gone afterwards."""
        if self._arrived:
            self._arrived.sort(reverse=True)
            self._runs.append(self._arrived)
            self._arrived = []
        found: list[Message] = []
        for run in self._runs:
            first = bisect_right(run, -before_ns, key=lambda message: -message.t_ns)
            found += run[first:]
            del run[first:]
        self._runs = [run for run in self._runs if run]
        found.sort()
        return found

    def __bool__(self) -> bool:
        return bool(self._arrived or self._runs)
