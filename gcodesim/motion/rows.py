"""Collects the rows of a tool path, singly or in batches, and makes columns of them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import Axes
from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import Span
from gcodesim.diagnostics.span_table import SpanTable, join
from gcodesim.frames import Array
from gcodesim.motion.tool_path import ARC, EXACT_STOP, PathEvent, ToolPath, ToolState


class Tags(NamedTuple):
    """What rows take from the modes in force; arrays where the rows of a batch differ."""

    mode: int | NDArray[np.int_]
    tolerance: float | Array
    naive: float | Array
    active: bool


class _Piece(NamedTuple):
    """Some rows; a column with one value for all of them is that value."""

    n: int
    columns: dict[str, Any]
    spans: SpanTable
    arcs: dict[str, Any]  # the rows of the arcs, from 0, and their columns


class PathRows:
    """Grows row by row; `path` makes the columns."""

    def __init__(self) -> None:
        self._pieces: list[_Piece] = []
        self._done = 0  # rows in `_pieces`
        self._stops: list[int] = []
        self._jumps: list[tuple[int, Axes]] = []
        self._clear()

    def _clear(self) -> None:
        self._kind: list[int] = []
        self._end: list[Axes] = []
        self._feed: list[float] = []
        self._rotary: list[bool] = []
        self._block: list[int] = []
        self._extrude: list[float] = []
        self._state: list[int] = []
        self._tags: list[Tags] = []
        self._source: list[int] = []
        self._spans: list[Span] = []
        self._arcs: list[tuple[int, float, float, float, float, float, float, float]] = []
        self._last_span: Span | None = None

    def __len__(self) -> int:
        return self._done + len(self._kind)

    def add(
        self,
        kind: int,
        end: Axes,
        feed: float,
        *,
        rotary: bool,
        block: int,
        state: int,
        span: Span,
        tags: Tags,
        extrude: float = 0.0,
    ) -> None:
        """One row; the same span object as before is one place."""
        if span is not self._last_span:
            self._last_span = span
            self._spans.append(span)
        self._kind.append(kind)
        self._end.append(end)
        self._feed.append(feed)
        self._rotary.append(rotary)
        self._block.append(block)
        self._extrude.append(extrude)
        self._state.append(state)
        self._tags.append(tags)
        self._source.append(len(self._spans) - 1)

    def shape(self, center: tuple[float, ...], normal: tuple[float, ...], sweep: float) -> None:
        """The next row is this arc."""
        self._arcs.append((len(self._kind), *center, *normal, sweep))  # type: ignore[arg-type]

    def add_batch(self, batch: MoveBatch, *, feed: Array, state: int | NDArray[np.int32], tags: Tags) -> None:
        """The rows of a batch, with `feed` (n,) as a path has it and the index of each row's tool state, or of all."""
        self._flush()
        n = len(batch)
        begins = np.ones(n, dtype=bool)  # moves of one block have one place
        begins[1:] = batch.block[1:] != batch.block[:-1]
        spans = SpanTable(batch.origins, batch.origin[begins], batch.place[begins][:, (0, 1, 0, 2)])
        columns = {
            "kind": np.minimum(batch.kind, ARC),
            "end": batch.end,
            "feed": feed,
            "rotary_feed": batch.rotary,
            "block": batch.block,
            "state": state,
            "source": np.cumsum(begins) - 1,
            "extrude": 0.0 if batch.extrude is None else batch.extrude,
            **tags._asdict(),
        }
        arcs: dict[str, Any] = {}
        if len(batch.shapes):
            rows, shapes = np.flatnonzero(batch.kind >= ARC), batch.shapes
            arcs = {"rows": rows, "center": shapes[:, :3], "normal": shapes[:, 3:6], "sweep": shapes[:, 6]}
        self._pieces.append(_Piece(n, columns, spans, arcs))
        self._done += n

    def stop(self) -> None:
        """The last row ends at rest."""
        self.stop_at(len(self) - 1)

    def stop_at(self, *rows: int) -> None:
        """These rows end at rest; no row before the first does."""
        self._stops += [row for row in rows if row >= 0]

    def jump(self, at: Axes) -> None:
        """The next row begins at `at`, not where the last one ended."""
        self._jumps.append((len(self), at))

    def _flush(self) -> None:
        n = len(self._kind)
        if n == 0:
            return
        columns: dict[str, Any] = {
            "kind": self._kind,
            "end": self._end,
            "feed": self._feed,
            "rotary_feed": self._rotary,
            "block": self._block,
            "state": self._state,
            "source": self._source,
            "extrude": self._extrude,
        }
        columns |= dict(zip(Tags._fields, zip(*self._tags, strict=True), strict=True))
        arcs: dict[str, Any] = {}
        if self._arcs:
            table = np.array(self._arcs)
            rows = table[:, 0].astype(np.int64)
            arcs = {"rows": rows, "center": table[:, 1:4], "normal": table[:, 4:7], "sweep": table[:, 7]}
        self._pieces.append(_Piece(n, columns, SpanTable.of(self._spans), arcs))
        self._done += n
        self._clear()

    def path(self, first: Axes, states: tuple[ToolState, ...], events: tuple[PathEvent, ...]) -> ToolPath:
        """All rows; the path begins at `first`. Can be called only once, because the pieces are released one by one."""
        self._flush()
        n = self._done
        columns = _empty_columns(n)
        tables = []
        at = sources = 0
        self._pieces.reverse()
        while self._pieces:
            piece = self._pieces.pop()
            rows = slice(at, at + piece.n)
            for name, values in piece.columns.items():
                columns[name][rows] = values
            columns["source"][rows] += sources
            if piece.arcs:
                arcs = piece.arcs["rows"] + at
                for name in ("center", "normal", "sweep"):
                    columns[name][arcs] = piece.arcs[name]
            tables.append(piece.spans)
            at += piece.n
            sources += len(piece.spans)
        start, end, stop = columns["start"], columns["end"], columns["stop"]
        start[:1] = first
        start[1:] = end[:-1]
        for row, point in self._jumps:
            if row < n:
                start[row] = point
        stop[:] = columns["mode"] == EXACT_STOP
        stop[self._stops] = True
        stop[-1:] = True
        spans = join(tables) if tables else SpanTable.of((Span(""),))
        return ToolPath(**columns, states=states or (ToolState(),), spans=spans, events=events)


def _empty_columns(n: int) -> dict[str, NDArray[Any]]:
    # zeros that are never written take no memory, such as columns of arcs in a program without arcs
    return {
        "kind": np.empty(n, dtype=np.uint8),
        "start": np.empty((n, 6)),
        "end": np.empty((n, 6)),
        "center": np.zeros((n, 3)),
        "normal": np.zeros((n, 3)),
        "sweep": np.zeros(n),
        "feed": np.empty(n),
        "rotary_feed": np.empty(n, dtype=np.bool_),
        "mode": np.empty(n, dtype=np.uint8),
        "tolerance": np.empty(n),
        "naive": np.empty(n),
        "state": np.empty(n, dtype=np.int32),
        "source": np.empty(n, dtype=np.int32),
        "block": np.empty(n, dtype=np.int32),
        "active": np.empty(n, dtype=np.bool_),
        "stop": np.empty(n, dtype=np.bool_),
        "extrude": np.zeros(n),
    }
