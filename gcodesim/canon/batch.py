"""A run of plain moves as columns: what the compiled lane of the reader yields in place of one event a move."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from gcodesim.canon.events import ArcFeed, FeedUnit, LinearFeed, Motion, Rapid
from gcodesim.diagnostics import Caller, Span

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

RAPID: Final = 0
LINE: Final = 1
ARC_CW: Final = 2
ARC_CCW: Final = 3
WORDS: Final = ("G0", "G1", "G2", "G3")
"""Motion word of each kind."""

_AT_A_TIME: Final = 1024  # moves that exist as events, where only the first ones may be wanted


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MoveBatch:
    """n moves, one a line of the program, between which nothing but moves happens.

    `kind` (n,): RAPID, LINE, ARC_CW, ARC_CCW; `end` (n, 6) [m, rad]; `feed` (n,) as in `LinearFeed`, 0 for rapids,
    in rad where `rotary` (n,), per revolution where `per_revolution`. The m arcs among them, in order, have
    `center`, `normal` (m, 3), `sweep` (m,) and `turns` (m,). `place` (n, 3) is line, column and end column in
    `file`; the block number of a move is its line plus `block_shift`.
    """

    file: str
    callers: tuple[Caller, ...]
    kind: NDArray[np.uint8]
    end: NDArray[np.float64]
    feed: NDArray[np.float64]
    rotary: NDArray[np.bool_]
    per_revolution: bool
    place: NDArray[np.int32]
    block_shift: int
    center: NDArray[np.float64]
    normal: NDArray[np.float64]
    sweep: NDArray[np.float64]
    turns: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.kind)

    def span(self, row: int) -> Span:
        """Where move `row` stands."""
        line, column, end_column = self.place[row].tolist()
        return Span(self.file, line, column, line, end_column, self.callers)

    def events(self) -> Iterator[Motion]:
        """The moves one by one, as the grammar's lane would have yielded them."""
        arcs = 0
        for first in range(0, len(self), _AT_A_TIME):
            rows = slice(first, first + _AT_A_TIME)
            count = int((self.kind[rows] > LINE).sum())
            yield from self._some(rows, slice(arcs, arcs + count))
            arcs += count

    def _some(self, rows: slice, arcs: slice) -> Iterator[Motion]:
        units: tuple[FeedUnit, FeedUnit] = ("m/rev", "rad/rev") if self.per_revolution else ("m/s", "rad/s")
        moves = zip(
            self.kind[rows].tolist(),
            map(tuple, self.end[rows].tolist()),
            self.feed[rows].tolist(),
            self.rotary[rows].tolist(),
            self.place[rows].tolist(),
            strict=True,
        )
        shapes = zip(
            self.center[arcs].tolist(),
            self.normal[arcs].tolist(),
            self.sweep[arcs].tolist(),
            self.turns[arcs].tolist(),
            strict=True,
        )
        file, callers, shift = self.file, self.callers, self.block_shift
        for kind, end, feed, rotary, (line, column, end_column) in moves:
            span = Span(file, line, column, line, end_column, callers)
            block, word, unit = line + shift, WORDS[kind], units[rotary]
            if kind == RAPID:
                yield Rapid(span=span, end=end, block=block, word=word)
            elif kind == LINE:
                yield LinearFeed(span=span, end=end, block=block, word=word, feed=feed, feed_unit=unit)
            else:
                center, normal, sweep, turns = next(shapes)
                yield ArcFeed(
                    span=span,
                    end=end,
                    block=block,
                    word=word,
                    center=tuple(center),
                    normal=tuple(normal),
                    ccw=kind == ARC_CCW,
                    turns=turns,
                    sweep=sweep,
                    feed=feed,
                    feed_unit=unit,
                )

    def after(self, rows: int) -> MoveBatch:
        """The batch without its first `rows` moves."""
        if rows == 0:
            return self
        arcs = int((self.kind[:rows] > LINE).sum())
        return replace(
            self,
            kind=self.kind[rows:],
            end=self.end[rows:],
            feed=self.feed[rows:],
            rotary=self.rotary[rows:],
            place=self.place[rows:],
            center=self.center[arcs:],
            normal=self.normal[arcs:],
            sweep=self.sweep[arcs:],
            turns=self.turns[arcs:],
        )
