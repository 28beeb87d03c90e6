"""The places of many moves as columns; a `Span` is made on demand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import overload

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics.finding import Caller, Span

Origin = tuple[str, tuple[Caller, ...]]


class SpanTable(Sequence[Span]):
    """A sequence of n spans.

    `origins` are the files with their chains of callers, `origin` (n,) says
    which of them a span has, `place` (n, 4) holds line, column, end line and
    end column.
    """

    def __init__(self, origins: tuple[Origin, ...], origin: NDArray[np.int32], place: NDArray[np.int32]) -> None:
        self.origins = origins
        self.origin = origin
        self.place = place

    @staticmethod
    def of(spans: Sequence[Span]) -> SpanTable:
        """A table of `spans`; a table comes back as it is."""
        if isinstance(spans, SpanTable):
            return spans
        origins: dict[Origin, int] = {}
        origin = [origins.setdefault((span.file, span.callers), len(origins)) for span in spans]
        place = [(span.line, span.column, span.end_line, span.end_column) for span in spans]
        return SpanTable(
            tuple(origins), np.array(origin, dtype=np.int32), np.array(place, dtype=np.int32).reshape(len(place), 4)
        )

    @property
    def lines(self) -> NDArray[np.int32]:
        """The line of each span (n,)."""
        return self.place[:, 0]

    def files(self) -> tuple[dict[str, int], NDArray[np.int64]]:
        """The files by name, numbered from 0 as they come; and the number (n,) of each span's file."""
        known: dict[str, int] = {}
        of_origin = np.array([known.setdefault(name, len(known)) for name, _ in self.origins], dtype=np.int64)
        return known, of_origin[self.origin]

    def __len__(self) -> int:
        return len(self.origin)

    @overload
    def __getitem__(self, index: int) -> Span: ...
    @overload
    def __getitem__(self, index: slice) -> SpanTable: ...
    def __getitem__(self, index: int | slice) -> Span | SpanTable:
        if isinstance(index, slice):
            return SpanTable(self.origins, self.origin[index], self.place[index])
        file, callers = self.origins[int(self.origin[index])]
        line, column, end_line, end_column = self.place[index].tolist()
        return Span(file, line, column, end_line, end_column, callers)

    def __iter__(self) -> Iterator[Span]:
        for index in range(len(self)):
            yield self[index]

    def __contains__(self, span: object) -> bool:
        return isinstance(span, Span) and self._find(span) >= 0

    def index(self, span: Span, start: int = 0, stop: int | None = None) -> int:
        """The first index from `start` on, before `stop`, at which `span` stands; ValueError when it does not."""
        found = self._find(span, start, stop)
        if found < 0:
            raise ValueError(f"{span} is not in the table")
        return found

    def __add__(self, other: Sequence[Span]) -> SpanTable:
        """These spans, then those of `other`."""
        return join([self, SpanTable.of(other)])

    def _find(self, span: Span, start: int = 0, stop: int | None = None) -> int:
        wanted = (span.file, span.callers)
        if wanted not in self.origins:
            return -1
        place = (span.line, span.column, span.end_line, span.end_column)
        rows = slice(start, stop)
        same = (self.origin[rows] == self.origins.index(wanted)) & (self.place[rows] == place).all(axis=1)
        return start + int(np.argmax(same)) if same.any() else -1


def join(tables: Sequence[SpanTable]) -> SpanTable:
    """One table after the other."""
    origins: dict[Origin, int] = {}
    renumbered = []
    for table in tables:
        numbers = [origins.setdefault(each, len(origins)) for each in table.origins]
        renumbered.append(np.array(numbers, dtype=np.int32)[table.origin])
    return SpanTable(
        tuple(origins),
        np.concatenate(renumbered) if renumbered else np.zeros(0, dtype=np.int32),
        np.concatenate([table.place for table in tables]) if tables else np.zeros((0, 4), dtype=np.int32),
    )
