"""Places on a path at which joints are computed."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import greatest
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.curve_kernels import ROUND
from gcodesim.motion.pieces import OVERLAP, Pieces

SPACING: Final = 10e-3  # [m] between nodes to begin with
BEND: Final = 0.3  # [rad] of direction between nodes on arcs
STEP: Final = 0.1  # [rad] of a joint between nodes, beyond which more are put in
_MOST_PARTS: Final = 16  # of one segment in one refinement


@frozen(slots=False, kw_only=False, eq=False)
class Nodes:
    """k nodes in the order of motion, at `s` (k,) of `piece` (k,).

    A chain of nodes begins where a joint move ends (`head`, its only node); every
    other node ends a segment that begins at the node before.
    """

    piece: NDArray[np.int64]
    s: Array
    head: NDArray[np.bool_]

    @staticmethod
    def of(pieces: Pieces, at_home: NDArray[np.bool_], spacing: float = SPACING, parts: Array | float = 0.0) -> Nodes:
        """Nodes as dense as the geometry requires, in no fewer `parts` (m,) of each piece.

        In joint space there is one at the end, or none: `at_home` (m,).
        """
        turn = np.where(
            pieces.curves.kind == ROUND, np.abs(pieces.curves.sweep) / np.maximum(pieces.curves.length, 1e-300), 0.0
        )[pieces.curve]
        wanted = np.maximum(np.maximum(pieces.length / spacing, turn * pieces.length / BEND), parts)
        count = np.maximum(np.ceil(wanted), np.where(pieces.kind == OVERLAP, 4, 1)).astype(np.int64)
        count[pieces.fixed] = np.where(at_home, 0, 1)[pieces.fixed]
        piece = np.repeat(np.arange(len(pieces)), count)
        number = np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count) + 1
        s = pieces.length[piece] * number / np.maximum(count[piece], 1)
        return Nodes(piece, s, pieces.fixed[piece])

    def __len__(self) -> int:
        return len(self.piece)

    @cached_property
    def chains(self) -> list[tuple[int, int]]:
        """The first node of every chain, and the one after its last."""
        bounds = np.append(np.flatnonzero(self.head), len(self))
        return [(int(a), int(b)) for a, b in pairwise(bounds)]

    @cached_property
    def segments(self) -> NDArray[np.intp]:
        """Nodes that end a segment."""
        ends: NDArray[np.intp] = np.flatnonzero(~self.head)
        return ends

    @cached_property
    def begin(self) -> Array:
        """Where each segment begins on its piece."""
        i = self.segments
        start: Array = np.where(self.piece[i] == self.piece[i - 1], self.s[i - 1], 0.0)
        return start

    def way(self, first: int, end: int) -> Array:
        """How far (end - first,) [m, rad] nodes from `first` to the one before `end` are along the path from there."""
        length = np.zeros(end - first)
        inner = np.arange(first + 1, end)
        length[1:] = self.s[inner] - np.where(self.piece[inner] == self.piece[inner - 1], self.s[inner - 1], 0.0)
        along: Array = np.cumsum(length)
        return along

    def keys(self, lengths: Array) -> Array:
        """Numbers (k,) that grow along the path: piece and share of it; `lengths` are those of the pieces."""
        share = np.where(self.head, 1.0, self.s / np.maximum(lengths[self.piece], 1e-300))
        growing: Array = np.add(self.piece, share, dtype=np.float64)
        return growing

    def at_or_after(self, keys: Array, piece: NDArray[np.int64], s: Array, lengths: Array) -> NDArray[np.intp]:
        """For places `s` (n,) of `piece` (n,) the node that ends their segment, with `keys` for the same `lengths`."""
        asked = piece + np.clip(s / np.maximum(lengths[piece], 1e-300), 0.0, 1.0)
        found: NDArray[np.intp] = np.searchsorted(keys, asked, side="left")
        return np.minimum(found, max(len(self) - 1, 0))

    def refined(self, q: Array) -> Nodes | None:
        """More nodes where joints `q` (k, j) move far between two of them; None if they do nowhere."""
        i = self.segments
        step = greatest(np.abs(np.diff(q, axis=0)))[i - 1] if len(i) else np.zeros(0)
        return self.split(np.ceil(step / STEP))

    def denser(self, chain: int, count: int) -> Nodes:
        """The same with more nodes in a chain, none of them farther from the next than if there were `count` evenly."""
        i, (a, b) = self.segments, self.chains[chain]
        apart = max(float(self.way(a, b)[-1]) / count, 1e-300)
        mine = (i >= a) & (i < b)
        return self.split(np.where(mine, np.ceil((self.s[i] - self.begin) / apart), 1.0)) or self

    def split(self, parts: Array) -> Nodes | None:
        """More nodes, with so many `parts` (segments,) in place of each segment; None if each is one."""
        i = self.segments
        parts = np.minimum(parts, _MOST_PARTS).astype(np.int64)
        if not np.any(parts > 1):
            return None
        count = np.ones(len(self), dtype=np.int64)
        count[i] = np.maximum(parts, 1)
        begin = self.s.copy()
        begin[i] = self.begin
        old = np.repeat(np.arange(len(self)), count)
        number = np.arange(len(old)) - np.repeat(np.cumsum(count) - count, count) + 1
        last = number == count[old]
        s = np.where(last, self.s[old], begin[old] + (self.s[old] - begin[old]) * number / count[old])
        return Nodes(self.piece[old], s, self.head[old])
