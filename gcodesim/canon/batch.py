"""A run of plain moves as columns: what the compiled lane of the reader yields in place of one event a move."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import repeat
from typing import TYPE_CHECKING, Any, Final, Literal

from gcodesim.canon.events import ArcFeed, Dwell, Event, FeedUnit, LinearFeed, PathMode, Rapid, Spindle
from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gcodesim.diagnostics.span_table import Origin

# kinds of moves
RAPID: Final = 0
LINE: Final = 1
ARC_CW: Final = 2
ARC_CCW: Final = 3

# acts between moves
EXACT: Final = 0
BACK: Final = 1
DWELL: Final = 2
S_WORD: Final = 3

_AT_A_TIME: Final = 1024  # moves that exist as events, where only the first ones may be wanted


@frozen(eq=False)
class MoveBatch:
    """n moves, and nothing else but what canned cycles do between them, and S words.

    `kind` (n,): RAPID, LINE, ARC_CW, ARC_CCW; `word` (n,) the number of the motion word, 81 for G81; `end` (n, 6)
    [m, rad]; `feed` (n,) as in `LinearFeed`, 0 for rapids, in rad where `rotary` (n,), per revolution where
    `per_revolution`. `place` (n, 3) is line, column and end column, in that file and under that chain of callers
    which `origin` (n,) names among the `origins`; `block` (n,) is the block number. Moves of one block stand together.
    The arcs among them, in order, have the m rows `shapes` (m, 8): centre, normal, sweep, turns.
    `extrude` (n,) [m] is the filament that goes along, None where the program has none. `between` are states and
    filament alone (`SectionStart`, `Extrude`), each before the move that its number names.
    `acts` (k, 2) happen before the move that the first number names: EXACT path control for a hole, BACK to `path`,
    DWELL for `dwell` seconds, S_WORD for `speed` (n,) [rad/s] of a spindle that turns in `direction`. `speed` means
    nothing where no such act stands, and is None without one.
    """

    origins: tuple[Origin, ...]
    kind: NDArray[np.int32]
    word: NDArray[np.int32]
    end: NDArray[np.float64]
    feed: NDArray[np.float64]
    rotary: NDArray[np.bool_]
    per_revolution: bool
    place: NDArray[np.int32]
    origin: NDArray[np.int32]
    block: NDArray[np.int32]
    shapes: NDArray[np.float64]
    acts: NDArray[np.int32]
    path: PathMode
    dwell: float
    extrude: NDArray[np.float64] | None = None
    between: tuple[tuple[int, Event], ...] = ()
    speed: NDArray[np.float64] | None = None
    direction: Literal["off", "cw", "ccw"] = "off"

    def __len__(self) -> int:
        return len(self.kind)

    def span(self, row: int) -> Span:
        """Where move `row` stands."""
        line, column, end_column = self.place[row].tolist()
        file, callers = self.origins[int(self.origin[row])]
        return Span(file, line, column, line, end_column, callers)

    def act(self, row: int, what: int) -> PathMode | Dwell | Spindle:
        """The event of an act before move `row`."""
        span = self.span(row - 1 if what == BACK else row)
        if what == S_WORD:
            assert self.speed is not None
            return Spindle(span=span, direction=self.direction, speed=float(self.speed[row]))
        if what == DWELL:
            return Dwell(span=span, seconds=self.dwell)
        return PathMode(span=span, mode="exact_path") if what == EXACT else replace(self.path, span=span)

    def events(self) -> Iterator[Event]:
        """The moves and acts one by one, as the grammar's lane would have yielded them."""
        arcs = 0
        acts = [*self.between, *((row, self.act(row, what)) for row, what in self.acts.tolist())]
        acts.reverse()
        for first in range(0, len(self), _AT_A_TIME):
            rows = slice(first, first + _AT_A_TIME)
            count = int((self.kind[rows] > LINE).sum())
            for row, event in enumerate(self._some(rows, slice(arcs, arcs + count)), first):
                while acts and acts[-1][0] <= row:
                    yield acts.pop()[1]
                yield event
            arcs += count
        while acts:
            yield acts.pop()[1]

    def _some(self, rows: slice, arcs: slice) -> Iterator[Event]:
        units: tuple[FeedUnit, FeedUnit] = ("m/rev", "rad/rev") if self.per_revolution else ("m/s", "rad/s")
        moves: Iterator[Any] = zip(
            self.kind[rows].tolist(),
            self.word[rows].tolist(),
            map(tuple, self.end[rows].tolist()),
            self.feed[rows].tolist(),
            self.rotary[rows].tolist(),
            self.place[rows].tolist(),
            self.origin[rows].tolist(),
            self.block[rows].tolist(),
            strict=True,
        )
        shapes = iter(self.shapes[arcs].tolist())
        extrudes = repeat(0.0) if self.extrude is None else iter(self.extrude[rows].tolist())
        span, last = Span(""), -1
        for kind, number, end, feed, rotary, (line, column, end_column), origin, block in moves:
            if block != last:  # the events of a block share their span
                last = block
                file, callers = self.origins[origin]
                span = Span(file, line, column, line, end_column, callers)
            word, unit, extrude = f"G{number}", units[rotary], next(extrudes)
            if kind == RAPID:
                yield Rapid(span=span, end=end, block=block, word=word)
            elif kind == LINE:
                yield LinearFeed(span=span, end=end, block=block, word=word, feed=feed, feed_unit=unit, extrude=extrude)
            else:
                *points, sweep, turns = next(shapes)
                yield ArcFeed(
                    span=span,
                    end=end,
                    block=block,
                    word=word,
                    center=tuple(points[:3]),
                    normal=tuple(points[3:]),
                    ccw=kind == ARC_CCW,
                    turns=int(turns),
                    sweep=sweep,
                    feed=feed,
                    feed_unit=unit,
                    extrude=extrude,
                )

    def after(self, rows: int) -> MoveBatch:
        """The batch without its first `rows` moves and what happens before them."""
        if rows == 0:
            return self
        acts = self.acts[self.acts[:, 0] >= rows]
        acts[:, 0] -= rows
        return replace(
            self,
            kind=self.kind[rows:],
            word=self.word[rows:],
            end=self.end[rows:],
            feed=self.feed[rows:],
            rotary=self.rotary[rows:],
            place=self.place[rows:],
            origin=self.origin[rows:],
            block=self.block[rows:],
            shapes=self.shapes[int((self.kind[:rows] > LINE).sum()) :],
            acts=acts,
            extrude=None if self.extrude is None else self.extrude[rows:],
            speed=None if self.speed is None else self.speed[rows:],
            between=tuple((row - rows, event) for row, event in self.between if row >= rows),
        )
