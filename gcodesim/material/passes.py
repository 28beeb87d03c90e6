"""What tools did to a stock, piece by piece: asked afterwards which of them made a face.

They are kept only for runs with a target. Cutting needs nothing of them, so its kernels stay as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.material.pass_kernels import PassBodies, PassPieces

if TYPE_CHECKING:
    from gcodesim.material.pass_tree_kernels import PassTree

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_SAME_WAY = 1.0e-5
"""Pieces [rad] of which the directions differ by less go on straight."""

_TOUCHING = 1.0e-8
"""Distance [m] up to which the end of a piece is the start of the next."""


@frozen(eq=False)
class Makers:
    """Who made n faces: path row (n,), -1 for nobody, and which program; gap (n,) [m] between piece and face."""

    row: Ints
    program: Ints
    gap: Array


class Passes:
    """Pieces in the order in which they ran; `rows` are path rows, `program` tells several programs apart."""

    def __init__(self, *, lathe: bool = False) -> None:
        self._lathe = lathe
        self._outlines: list[Array] = []
        self._parts: list[tuple[PassPieces, Ints, Ints]] = []
        self._known: tuple[PassPieces, PassTree] | None = None

    def add(self, outline: Array, pieces: PassPieces, rows: Ints, program: int = 0) -> None:
        """Go on with pieces of the body of `outline` (k, 2) [m], across and along its axis; rows (c,).

        Straight neighbours of one row become one piece.
        """
        number = next((k for k, known in enumerate(self._outlines) if np.array_equal(known, outline)), None)
        if number is None:
            number = len(self._outlines)
            self._outlines.append(outline)
        begin, end = _runs(pieces, rows)
        kept = PassPieces(
            starts=pieces.starts[begin],
            ends=pieces.ends[end],
            axes_start=pieces.axes_start[begin],
            axes_end=pieces.axes_end[end],
            body=np.full(len(begin), number, dtype=np.int32),
        )
        self._parts.append((kept, rows[begin], np.full(len(begin), program, dtype=np.int64)))

    def makers(
        self, points: Array, slack: float, wanted: Sequence[NDArray[np.bool_]] | None = None, *, within: bool = False
    ) -> Makers:
        """For each point (n, 3) [m] in S the first pass that came to within `slack` [m], else the nearest one.

        `wanted`: for each program, which of its path rows count. `within`: only passes count that came so near.
        """
        from gcodesim.material.pass_tree_kernels import makers_of

        pieces, rows, programs = self._joined()
        chosen = np.ones(len(rows), dtype=bool)
        for number, own in enumerate(wanted or ()):
            mine = programs == number
            chosen[mine] = own[rows[mine]]
        maker, gap = np.full(len(points), -1, dtype=np.int64), np.full(len(points), np.inf)
        if len(rows) and len(points):
            places = np.ascontiguousarray(points)
            makers_of(places, pieces, self._bodies(), self._tree(), chosen, slack, within, maker, gap)
        known = maker >= 0
        row = np.full(len(points), -1, dtype=np.int64)
        program = np.zeros(len(points), dtype=np.int64)
        row[known], program[known] = rows[maker[known]], programs[maker[known]]
        return Makers(row=row, program=program, gap=gap)

    def through(self, point: Array, reach: float) -> list[tuple[int, int]]:
        """Program and row of all passes that came to within `reach` [m] of a point (3,), in the order of the run.

        A row that was as near already where it began only goes away from where the one before it has led.
        """
        from gcodesim.material.pass_kernels import nearest_pass, pass_distance

        near = self.beside(point, reach)
        pieces, rows, programs = near._joined()
        if not len(rows):
            return []
        bodies = near._bodies()
        found: list[tuple[int, int]] = []
        done: set[tuple[int, int]] = set()
        for piece, own in enumerate(zip(programs.tolist(), rows.tolist(), strict=True)):
            begins = piece == 0 or rows[piece - 1] != rows[piece] or programs[piece - 1] != programs[piece]
            if begins and pass_distance(pieces, bodies, piece, 0.0, point) <= reach:
                done.add(own)
            if own not in done and nearest_pass(pieces, bodies, piece, point, reach, reach) <= reach:
                done.add(own)
                found.append(own)
        return found

    def beside(self, point: Array, reach: float) -> Passes:
        """Those that may come to within `reach` [m] of a point (3,)."""
        pieces, rows, programs = self._joined()
        near = _near(pieces, self._bodies(), point[None], reach) if len(rows) else np.zeros(0, dtype=bool)
        own = Passes(lathe=self._lathe)
        own._outlines, own._parts = self._outlines, [(_only(pieces, near), rows[near], programs[near])]
        return own

    def _joined(self) -> tuple[PassPieces, Ints, Ints]:
        if not self._parts:
            none = np.zeros((0, 3))
            nothing: Ints = np.zeros(0, dtype=np.int64)
            return PassPieces(none, none, none, none, np.zeros(0, np.int32)), nothing, nothing
        if len(self._parts) > 1:
            parts = [np.concatenate(arrays) for arrays in zip(*(own for own, _, _ in self._parts), strict=True)]
            rows, programs = (np.concatenate([part[k] for part in self._parts]) for k in (1, 2))
            self._parts = [(PassPieces(*map(np.ascontiguousarray, parts)), rows, programs)]
        return self._parts[0]

    def _tree(self) -> PassTree:
        """Of all pieces until now."""
        from gcodesim.material.pass_tree import pass_tree

        pieces = self._joined()[0]
        if self._known is None or self._known[0] is not pieces:
            self._known = pieces, pass_tree(pieces, self._bodies())
        return self._known[1]

    def _bodies(self) -> PassBodies:
        first = np.cumsum([0, *(len(outline) for outline in self._outlines)], dtype=np.int64)
        extent = [
            (np.abs(o[:, 0]).max(), o[:, 1].min(), o[:, 1].max(), np.sqrt(np.square(o).sum(axis=1).max()))
            for o in self._outlines
        ]
        points = np.ascontiguousarray(np.concatenate(self._outlines), dtype=float)
        return PassBodies(points, first, np.array(extent, dtype=float), self._lathe)


def _near(pieces: PassPieces, bodies: PassBodies, points: Array, slack: float) -> NDArray[np.bool_]:
    """Which pieces (c,) may come to within `slack` [m] of any of some points."""
    reach = bodies.extent[pieces.body, 3][:, None]
    if bodies.lathe:
        radius = np.sqrt(np.square(points[:, :2]).sum(axis=1))
        points = np.stack([radius, np.zeros(len(points)), points[:, 2]], axis=1)
        low, high = np.minimum(pieces.starts, pieces.ends) - reach, np.maximum(pieces.starts, pieces.ends) + reach
    else:
        widest = bodies.extent[pieces.body, 0][:, None]
        tops = [
            tip + axis * bodies.extent[pieces.body, which][:, None]
            for tip, axis in ((pieces.starts, pieces.axes_start), (pieces.ends, pieces.axes_end))
            for which in (1, 2)
        ]
        bend = np.abs(pieces.axes_end - pieces.axes_start).sum(axis=1)[:, None] * reach
        low, high = np.minimum.reduce(tops) - widest - bend, np.maximum.reduce(tops) + widest + bend
    beside = (points.min(axis=0) > high + slack) | (points.max(axis=0) < low - slack)
    near: NDArray[np.bool_] = ~beside.any(axis=1)
    return near


def _only(pieces: PassPieces, chosen: Any) -> PassPieces:
    return PassPieces(
        starts=pieces.starts[chosen],
        ends=pieces.ends[chosen],
        axes_start=pieces.axes_start[chosen],
        axes_end=pieces.axes_end[chosen],
        body=pieces.body[chosen],
    )


def _runs(pieces: PassPieces, rows: Ints) -> tuple[Ints, Ints]:
    """First and last piece of each stretch of one row that goes on straight, with an axis that stays."""
    way = pieces.ends - pieces.starts
    length = np.sqrt(np.square(way).sum(axis=1))
    unit = way / np.maximum(length, 1e-300)[:, None]
    goes_on = rows[1:] == rows[:-1]
    goes_on &= np.abs(pieces.starts[1:] - pieces.ends[:-1]).max(axis=1, initial=0.0) <= _TOUCHING
    goes_on &= np.abs(unit[1:] - unit[:-1]).max(axis=1, initial=0.0) <= _SAME_WAY
    goes_on &= (pieces.axes_start[1:] == pieces.axes_end[:-1]).all(axis=1)
    still = (pieces.axes_start == pieces.axes_end).all(axis=1)
    goes_on &= still[1:] & still[:-1]
    breaks = np.flatnonzero(~goes_on) + 1
    begin = np.concatenate(([0], breaks)).astype(np.int64) if len(rows) else np.zeros(0, np.int64)
    end = np.concatenate((breaks, [len(rows)])).astype(np.int64)[: len(begin)] - 1
    return begin, end
