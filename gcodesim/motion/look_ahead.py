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

    `corners_count`: arcs that round corners are blocks too, as they are in LinuxCNC's queue.
    """

    blocks: int
    corners_count: bool = False


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
