"""Where the flange of an arm has to be along a path, for the controlled point and the attitude that are commanded.

What is commanded is the nose N of the tool, from which the tool points straight out. With most tools that is the
flange; a bent one holds its nose elsewhere.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.batches import batches
from gcodesim.arithmetic.elementary import cos_sin
from gcodesim.arithmetic.matrices import applied, greatest
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.pieces import Pieces
from gcodesim.planning.flange_kernels import Holding, hold_tools, turn_flanges, twists_between
from gcodesim.planning.flange_poses import flange_origins, flange_poses, tool_rotation, unbent
from gcodesim.planning.guide import Guide
from gcodesim.planning.spin_along import SpinAlong

_PROBE: Final = 1e-5  # [m, rad] over which a slope is taken


@frozen(slots=False, kw_only=False, eq=False)
class Flange:
    """Where the flange has to be when the controlled point is somewhere on the pieces.

    A `guide` turns the frame O along the path, or carries the work or the arm; without one O stands still in each row.
    `loose`: the arm turns the tool about itself as it has to, whatever the spin is.
    """

    pieces: Pieces
    R_BO: Array  # of every row (n, 3, 3)
    offset: Array  # of every row (n, 3) [m]
    spin: float
    turning: SpinAlong | None = None  # of the tool about itself along the path, on top of `spin`
    guide: Guide | None = None
    bend: Array | None = None  # X_NF of every row (n, 4, 4) where some tool is bent
    loose: bool = False

    def poses(self, piece: NDArray[np.int64], s: Array, positions: Array) -> Array:
        """X_BF (k, 4, 4) with the controlled point at `positions` (k, 6), which are at `s` (k,) of `piece` (k,)."""
        X = np.empty((len(piece), 4, 4))
        for some in batches(len(piece)):
            self._put(piece[some], s[some], positions[some], X[some])
        return X

    def bend_of(self, piece: NDArray[np.int64]) -> Array | None:
        """X_NF (k, 4, 4) on these pieces (k,); None where no tool is bent."""
        return None if self.bend is None else self.bend[self.pieces.row_first[piece]]

    def _put(self, piece: NDArray[np.int64], s: Array, positions: Array, X: Array) -> None:
        """Write the poses into X (k, 4, 4)."""
        self._put_noses(piece, s, positions, X)
        bend = self.bend_of(piece)
        if bend is not None:
            X[:] = unbent(X, bend)

    def _put_noses(self, piece: NDArray[np.int64], s: Array, positions: Array, X: Array) -> None:
        self._put_unturned_noses(piece, s, positions, X)
        if self.turning is not None:
            turn_flanges(X, *cos_sin(self.turning.at(piece, s)[0]))

    def _unturned_noses(self, piece: NDArray[np.int64], s: Array, positions: Array) -> Array:
        X = np.empty((len(piece), 4, 4))
        self._put_unturned_noses(piece, s, positions, X)
        return X

    def _put_unturned_noses(self, piece: NDArray[np.int64], s: Array, positions: Array, X: Array) -> None:
        row = self.pieces.row_first[piece].astype(np.int64)
        if self.guide is None:
            R = self.R_BO[row]
        else:
            R = self.guide.frames(self._holding, row, self.guide.words(piece, s, positions))
        externals = None if self.guide is None else self.guide.externals(piece, s, positions)
        if self.guide is not None and externals is not None:
            p = flange_origins(positions[:, :3], self.offset[row], R)
            X[:] = flange_poses(*self.guide.from_arm(p, R, row, externals), self.spin)
        else:
            hold_tools(np.ascontiguousarray(positions), R, row, self._holding, X)

    @cached_property
    def _holding(self) -> Holding:
        axes = np.zeros((0, 3, 3)) if self.guide is None else self.guide.axes
        R_BO, axes, offset = (np.require(table, np.float64, ["C", "W"]) for table in (self.R_BO, axes, self.offset))
        return Holding(R_BO, axes, offset, tool_rotation(self.spin))

    def at(self, piece: NDArray[np.int64], s: Array) -> Array:
        """X_BF (k, 4, 4) at places `s` (k,) of `piece` (k,)."""
        X = np.empty((len(piece), 4, 4))
        for some in batches(len(piece)):
            self._put(piece[some], s[some], self.pieces.points(piece[some], s[some])[0], X[some])
        return X

    def velocities(self, piece: NDArray[np.int64], s: Array) -> Array:
        """Velocity (k, 3) of the flange by the way, or (k, 6) with the angular one, where it turns."""
        if self.guide is not None:
            twists = np.empty((len(piece), 6))
            for some in batches(len(piece)):
                twists[some] = self._twists(piece[some], s[some])
            return twists
        v = self.pieces.points(piece, s)[1][:, :3]
        if self.turning is None:
            return v
        rate = self.turning.at(piece, s)[1]
        w = -rate[:, None] * self.R_BO[self.pieces.row_first[piece]][:, :, 2]
        if self.bend is not None:
            nose = np.empty((len(piece), 4, 4))
            self._put_noses(piece, s, self.pieces.points(piece, s)[0], nose)
            v = v + np.cross(w, applied(nose[:, :3, :3], self.bend[self.pieces.row_first[piece]][:, :3, 3]))
        return np.concatenate([v, w], axis=1)

    def _twists(self, piece: NDArray[np.int64], s: Array) -> Array:
        """The same (k, 6) by the difference of two neighbours on the tangent."""
        points, slope = self.pieces.points(piece, s)
        step = _PROBE / np.maximum(greatest(np.abs(slope)), 1e-12)
        ahead, behind = (self._unturned_noses(piece, s + d, points + d[:, None] * slope) for d in (step, -step))
        if self.turning is not None:
            middle, rate = self.turning.at(piece, s)
            turn_flanges(ahead, *cos_sin(middle + step * rate))
            turn_flanges(behind, *cos_sin(middle - step * rate))
        ahead, behind = (unbent(X, self.bend_of(piece)) for X in (ahead, behind))
        out = np.empty((len(step), 6))
        twists_between(behind, ahead, 2.0 * step, out)
        return out

    def unturned(self) -> Flange:
        """The same with a spin of 0 all along."""
        return replace(self, spin=0.0, turning=None)

    @property
    def last_spin(self) -> float | None:
        """The spin [rad] at the end of the path; None where it is loose."""
        if self.loose:
            return None
        return self.spin if self.turning is None else self.spin + float(self.turning.spin[-1])
