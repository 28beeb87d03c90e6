"""How far ahead a control sees."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend import remnants
from gcodesim.motion.pieces import OVERLAP, Pieces
from gcodesim.motion.sight_kernels import Queue


@frozen
class LookAhead:
    """A control knows `blocks` whole blocks behind the one that runs, and half of one more, which it has just read.

    `corners_count`: arcs that round corners are blocks too, as they are in LinuxCNC's queue. Such a control knows no
    more than half of the last block before its queue runs empty: one that never came might have taken the rest.
    """

    blocks: int
    corners_count: bool = False


def known_of_last(pieces: Pieces, piece: NDArray[np.int64], square: Array) -> tuple[NDArray[np.intp], Array]:
    """Pieces behind which the last one before a stop of the program begins, and how fast they may end (k,).

    `square` (m,) is that of the speed from which each of m segments, of pieces `piece` (m,), could come to rest. The
    control plans as if it came to rest in the middle of that piece (`tpRunOptimization` in tp.c: it is not finalized).
    """
    stops = np.concatenate([[0], np.cumsum(pieces.path.stop)])
    following = np.append(pieces.row_first[1:], len(pieces.path))
    ends = (stops[following] > stops[pieces.row_last]) & ~pieces.joint
    ends[-1] = True
    lasts = np.flatnonzero(ends[1:] & ~(pieces.fixed | ends | (pieces.kind == OVERLAP))[:-1] & ~pieces.fixed[1:])
    halves = 0.5 * np.bincount(piece, square, minlength=len(pieces))
    return lasts, np.sqrt(halves[lasts + 1])


def queue_of(pieces: Pieces, last: NDArray[np.intp], junction: Array, look_ahead: LookAhead) -> Queue:
    """How pieces come in that end with the segments `last` (n,), at speeds up to `junction` (n,).

    Where two of them overlap the control plans a rest, as at a stop.
    """
    lapped = pieces.kind == OVERLAP
    apart = pieces.fixed | lapped
    rest = apart | (junction == 0.0)
    rest[:-1] |= apart[1:]
    cornered = np.append(pieces.joint[1:] & ~lapped[1:], False)
    cut = np.where(cornered, 0.5 * np.append(pieces.length[1:], 0.0), 0.0)  # what the corner will take of it
    counted = ~pieces.joint
    if look_ahead.corners_count:
        counted = pieces.joint | ~remnants(pieces, cornered)
    return Queue(
        last=last.astype(np.int64), half=0.5 * (pieces.length + cut), joint=pieces.joint, counted=counted, rest=rest
    )
