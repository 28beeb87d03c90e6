"""How much filament has gone through the nozzle at moments of a run."""

from __future__ import annotations

from typing import Final

import numpy as np

from gcodesim.frames import Array
from gcodesim.motion.trajectory import Samples, Trajectory

LEAST: Final = 1e-11
"""[m] What is less is rounding of the sum, on a way without filament."""


def filament_between(trajectory: Trajectory, samples: Samples) -> Array | None:
    """Filament (n - 1,) [m] that goes forward between consecutive samples (n,); None where the path has none.

    It goes along with the way of each row. Corners that were rounded give what they have to the rest of their rows.
    """
    pieces = trajectory.pieces
    extrude = pieces.path.extrude
    if not len(samples) or not len(pieces) or not extrude.any():
        return None
    first, last = int(samples.piece.min()), int(samples.piece.max()) + 1
    begin, end = pieces.row_first[first:last].astype(np.int64), pieces.row_last[first:last].astype(np.int64) + 1
    row = int(begin[0])
    way = np.concatenate([[0.0], np.cumsum(np.maximum(extrude[row : int(end.max())], 0.0))])
    joint = pieces.joint[first:last]
    amount = np.where(joint, 0.0, way[end - row] - way[begin - row])
    base = way[np.where(joint, end - 1, begin) - row]
    at = samples.piece - first
    through: Array = np.diff(base[at] + amount[at] * np.clip(samples.fraction, 0.0, 1.0))
    through[through < LEAST] = 0.0
    return through
