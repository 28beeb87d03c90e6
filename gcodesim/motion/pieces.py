"""The result of blending a path: pieces that are run one after another without a step in direction."""

from __future__ import annotations

from dataclasses import field
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.curve_kernels import ROUND, STRAIGHT
from gcodesim.motion.curves import Curves
from gcodesim.motion.piece_kernels import PieceColumns, points
from gcodesim.motion.tool_path import ToolPath

# kinds of pieces
PART: Final = 0  # a part of one curve
OVERLAP: Final = 1  # the end of one curve added to the start of the next


@frozen(eq=False)
class AxisLimits:
    """Greatest speed (6,) [m/s, rad/s], acceleration (6,) [m/s², rad/s²] and jerk (6,) [m/s³, rad/s³] of x y z a b c.

    inf: none. Blending looks at the first two; jerk counts for axes that run by themselves.
    """

    speed: Array
    acceleration: Array
    jerk: Array = field(default_factory=lambda: np.full(6, np.inf))

    @property
    def arrays(self) -> Array:
        """(3, 6): speeds, accelerations, jerks; "none" is a number that is finite and never reached."""
        table: Array = np.array([self.speed, self.acceleration, self.jerk], dtype=float)
        table[:2] = np.minimum(table[:2], 1e6)
        table[2] = np.minimum(table[2], 1e30)
        return table


@frozen(slots=False, kw_only=False, eq=False)
class Pieces:
    """m pieces in the order of motion, each with a parameter s from 0 to `length`.

    A PART runs curve `curve` from `begin` to ``begin + length``. In an
    OVERLAP `curve` slows evenly from speed v1 = `speed` to rest while `second`
    starts evenly up to speed `ratio` v1, which it has after the share `rise` of
    the time; its s is v1 t, and it is run at constant ds/dt. `speed`, `acceleration` are the caps along the piece,
    `junction` the cap on its end speed; the next piece starts with `ratio`
    times the end speed of this one. Where `fixed`, s is time itself. Rows
    `row_first` to `row_last` are the rows that the piece represents; a `joint` (corner
    arc or overlap) belongs half to each of its two rows. A piece that is `ramped` changes its speed evenly if it lasts
    but a moment.
    """

    path: ToolPath
    limits: AxisLimits
    curves: Curves
    kind: NDArray[np.uint8]
    curve: NDArray[np.int32]
    second: NDArray[np.int32]
    begin: Array
    length: Array
    speed: Array
    acceleration: Array
    junction: Array
    ratio: Array
    rise: Array
    fixed: NDArray[np.bool_]
    joint: NDArray[np.bool_]
    ramped: NDArray[np.bool_]
    row_first: NDArray[np.int32]
    row_last: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.curve)

    @cached_property
    def are_lines(self) -> NDArray[np.bool_]:
        """Which of them (m,) are parts of lines."""
        line: NDArray[np.bool_] = (self.curves.kind[self.curve] == STRAIGHT) & (self.kind == PART)
        return line

    @cached_property
    def are_timed(self) -> NDArray[np.bool_]:
        """Which of them (m,) run by a clock."""
        form = self.curves.kind[self.curve]
        timed: NDArray[np.bool_] = (form != STRAIGHT) & (form != ROUND)
        return timed

    def points(self, piece: NDArray[np.intp] | NDArray[np.int32], s: Array) -> tuple[Array, Array]:
        """Positions (k, 6) and their derivatives by s (k, 6) at `s` (k,) on pieces `piece` (k,)."""
        return points(
            np.ascontiguousarray(piece, dtype=np.int64),
            np.ascontiguousarray(s, dtype=float),
            self.arrays,
            self.curves.arrays,
        )

    @property
    def arrays(self) -> PieceColumns:
        """The columns that kernels take, and the limits; those of `curves` come beside them."""
        return PieceColumns(
            self.kind,
            self.curve,
            self.second,
            self.begin,
            self.length,
            self.ratio,
            self.rise,
            self.limits.arrays,
        )

    def inner_ends(self) -> tuple[NDArray[np.int64], Array, NDArray[np.int64]]:
        """Where rows end inside merged chords: piece, s and row, in proportion to the programmed lengths."""
        many = np.flatnonzero((self.row_first < self.row_last) & ~self.joint)
        first = self.row_first[many].astype(np.int64)
        count = self.row_last[many].astype(np.int64) - first
        index = np.repeat(np.arange(len(many)), count)
        row = first[index] + np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count)
        way = np.concatenate([[0.0], np.cumsum(self.path.length)])
        piece = many[index]
        whole = way[self.row_last[piece] + 1] - way[first[index]]
        s = (
            (way[row + 1] - way[first[index]])
            / np.where(whole > 0.0, whole, 1.0)
            * self.curves.length[self.curve[piece]]
        )
        return piece, np.clip(s - self.begin[piece], 0.0, self.length[piece]), row

    def resting(self) -> Pieces:
        """One piece of no length at the start of the path, for a path on which nothing moves."""
        start = self.path.start[:1] if len(self.path) else np.zeros((1, 6))
        flat, none, one = np.zeros((1, 3)), np.zeros(1), np.zeros(1, dtype=np.int32)
        curves = Curves(
            np.zeros(1, dtype=np.uint8), start, start.copy(), flat, flat, flat, flat, none, none, np.ones(1)
        )
        no = np.zeros(1, dtype=bool)
        kind = np.zeros(1, dtype=np.uint8)
        return Pieces(
            self.path, self.limits, curves, kind, one, one - 1, none, none, none, none, none, none + 1.0,
            none + 1.0, no, no, no, one, one,
        )  # fmt: skip
