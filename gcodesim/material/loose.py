"""Pieces that a cut parts from their stock: found while it is cut, measured, and taken out.

Nearly all cuts cannot part anything, which is told from where the tool is, before it cuts. For the others the patches
that it may touch are kept. If fewer intervals of them, or sides across which these touch, are left afterwards, their
pieces are numbered; and only if one of them has become two here, those of the whole stock.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.field_kernels import PATCH

if TYPE_CHECKING:
    from gcodesim.material.lattice import Lattice
    from gcodesim.material.loose_kernels import BodyWays, PatchCopies, PieceSizes
    from gcodesim.material.piece_shape import PieceShape
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]

FEWEST: Final = 16
"""Columns of a piece, at least: less is what a grid leaves standing beside a wall."""

BESIDE: Final = 2.0
"""Cells beside a body that belong to what its cut may touch: neighbours of what it takes."""


class PartedPiece(NamedTuple):
    """A piece that hangs on nothing: its volume [m³] and its box, `low` and `high` (3,) [m] in S.

    `body` is what it is as a body, where somebody wants to know.
    """

    volume: float
    low: Array
    high: Array
    body: PieceShape | None = None


class Kept(NamedTuple):
    """A stock before a cut, as far as the cut may change it: marked patches, their contents, and what links these."""

    within: Bytes
    blocks: PatchCopies
    links: NDArray[np.int64]
    dirty: Bytes
    tops: Array
    doses: dict[str, Array]
    lattice: Lattice | None


class Parted(NamedTuple):
    """Which pieces came loose: of all intervals the number of their piece, the sizes, and the pieces less one."""

    label: Ints
    sizes: PieceSizes
    loose: tuple[int, ...]


class Parting:
    """Watches one stock. `whole`: every column is one interval still, and none begins above the height `floor` [m].

    `bodies`: pieces are wanted as bodies, too.
    """

    def __init__(self, stock: Stock) -> None:
        lo, _, number = stock.field.columns
        self._stock = stock
        self.whole = bool((number <= 1).all())
        self.floor = float(lo[:, :, 0][number > 0].max(initial=-np.inf))
        self.off = self.bodies = False

    def may_part(self, lowest: float, *, from_above: bool) -> bool:
        """Whether a cut may part something whose tip comes down to `lowest` [m]; True where nobody can tell.

        `from_above`: whatever it takes, it takes with all that stood above.
        """
        if self.off:
            return False
        safe = self.whole and from_above and lowest > self.floor
        self.whole = self.whole and from_above
        return not safe

    def keep(self, ways: BodyWays) -> Kept:
        """Remember what a body may change on these ways."""
        from gcodesim.material.loose_kernels import PatchCopies, copy_blocks, count_links, mark_patches

        stock, field = self._stock, self._stock.field
        beside = BESIDE * stock.cell
        within = np.zeros(field.dirty.shape, dtype=np.uint8)
        mark_patches(field.grid, ways._replace(low=ways.low - beside, high=ways.high + beside), within)
        patch = np.ascontiguousarray(np.argwhere(within), dtype=np.int64)
        m, k = len(patch), field.columns.lo.shape[2]
        blocks = PatchCopies(
            patch=patch,
            lo=np.empty((m, PATCH, PATCH, k)),
            hi=np.empty((m, PATCH, PATCH, k)),
            number=np.zeros((m, PATCH, PATCH), dtype=np.int32),
            walls=np.empty((m, len(field.walls), PATCH + 1, PATCH + 1), dtype=np.float32),
        )
        copy_blocks(field, blocks, 0)
        links = np.zeros(2, dtype=np.int64)
        count_links(field.columns, within, links)
        return Kept(
            within=within,
            blocks=blocks,
            links=links,
            dirty=field.dirty.copy(),
            tops=field.tops.copy(),
            doses={name: dose.copy() for name, dose in stock.doses.items()},
            lattice=None if stock.lattice is None else stock.lattice.copy(),
        )

    def put_back(self, kept: Kept) -> None:
        """Undo all cuts since then, which went along no other ways."""
        from gcodesim.material.loose_kernels import copy_blocks

        stock = self._stock
        kept = self._widened(kept)
        copy_blocks(stock.field, kept.blocks, 1)
        stock.field.dirty[:], stock.field.tops[:] = kept.dirty, kept.tops
        stock.doses = {name: dose.copy() for name, dose in kept.doses.items()}
        stock.lattice = None if kept.lattice is None else kept.lattice.copy()

    def parted(self, kept: Kept) -> Parted | None:
        """What has come loose since then; None if nothing has. Of what was one piece the greatest part stays."""
        from gcodesim.material.loose_kernels import count_links

        columns = self._stock.field.columns
        links = np.zeros(2, dtype=np.int64)
        count_links(columns, kept.within, links)
        if (links == kept.links).all():
            return None
        kept = self._widened(kept)
        near = self._families(kept, kept.within, 1)
        return near and self._families(kept, np.ones_like(kept.within), FEWEST)

    def _families(self, kept: Kept, within: Bytes, fewest: int) -> Parted | None:
        """The same, in marked patches alone, for pieces of at least `fewest` intervals."""
        from gcodesim.material.loose_kernels import PieceSizes, exchange, find_parents, measure_pieces, number_pieces

        field = self._stock.field
        columns, room = field.columns, np.empty(field.columns.lo.size, dtype=np.int64)
        label, before = np.zeros((2, *columns.lo.shape), dtype=np.int32)
        pieces = number_pieces(columns, within, label, room)
        if pieces < 2:
            return None
        exchange(field, kept.blocks)
        number_pieces(columns, within, before, room)
        exchange(field, kept.blocks)
        parent = np.zeros(pieces, dtype=np.int32)
        find_parents(columns, label, kept.blocks, before, parent)
        box = np.full((2, pieces, 3), np.inf)
        sizes = PieceSizes(np.zeros(pieces), np.zeros(pieces), box[0], -box[1])
        measure_pieces(columns, within, label, sizes)
        order = np.argsort(-sizes.length, kind="stable")
        own = [int(p) for p in order if parent[p] > 0 and sizes.intervals[p] >= fewest]
        known: set[int] = set()
        loose = []
        for p in own:
            if int(parent[p]) in known:
                loose.append(p)
            known.add(int(parent[p]))
        return Parted(label, sizes, tuple(loose)) if loose else None

    def _widened(self, kept: Kept) -> Kept:
        """The same with room for as many intervals in a column as the stock has by now."""
        more = self._stock.field.columns.lo.shape[2] - kept.blocks.lo.shape[3]
        if more <= 0:
            return kept
        wider = [np.pad(own, ((0, 0), (0, 0), (0, 0), (0, more))) for own in (kept.blocks.lo, kept.blocks.hi)]
        return kept._replace(blocks=kept.blocks._replace(lo=wider[0], hi=wider[1]))

    def take_out(self, parted: Parted) -> list[PartedPiece]:
        """Take what came loose out of the stock, greatest first; together they have the volume that the stock loses."""
        stock, sizes = self._stock, parted.sizes
        goes = np.zeros(len(sizes.length), dtype=np.uint8)
        goes[list(parted.loose)] = 1
        before, volume = stock.copy() if self.bodies else None, stock.volume
        _take(stock, parted.label, goes)
        corner, spacing = np.append(stock.origin, 0.0), np.append(stock.spacing, 1.0)
        beyond = np.array([1.0, 1.0, 0.0])
        per_length = (volume - stock.volume) / float(sum(sizes.length[p] for p in parted.loose))
        pieces = []
        for p in parted.loose:
            low, high = corner + spacing * sizes.low[p], corner + spacing * (sizes.high[p] + beyond)
            body = None if before is None else _body(before, stock, parted.label, p, low, high)
            pieces.append(PartedPiece(float(sizes.length[p]) * per_length, low, high, body))
        return pieces


def _body(before: Stock, stock: Stock, label: Ints, p: int, low: Array, high: Array) -> PieceShape:
    """Piece `p` of a stock as it was before pieces came out of it; `stock` is what is left."""
    from gcodesim.material.piece_shape import piece_shape

    alone = before.copy()
    others = np.ones(int(label.max()), dtype=np.uint8)
    others[p] = 0
    _take(alone, label, others)
    return piece_shape(alone, stock, low, high)


def _take(stock: Stock, label: Ints, goes: Bytes) -> None:
    """Take the pieces that `goes` names, by their number less one, out of a stock."""
    from gcodesim.material.kernels import patch_tops
    from gcodesim.material.loose_kernels import mark_gone, take_across, take_pieces

    if stock.lattice is not None:
        upright = stock.field.columns
        gone = np.zeros(label.shape, dtype=np.int32)
        mark_gone(label, upright.number, goes, gone)
        for along, field in enumerate(stock.lattice.fields):
            take_across(field, along, upright, stock.field.grid, gone)
    take_pieces(stock.field, label, goes)
    patch_tops(stock.field.columns, stock.field.tops)
