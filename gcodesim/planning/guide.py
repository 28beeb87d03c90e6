"""What changes the place of the flange along a path besides the tip: the attitude that is commanded, external axes.

The columns a, b, c of a path hold what the letters of the program say. On an arm these lean the tool, or are values
of external axes. External axes that the planner chooses run along splines instead.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.planning.flange_kernels import Holding, lean_frames

if TYPE_CHECKING:
    from gcodesim.kinematics.assembly import Assembly
    from gcodesim.kinematics.attitude import AttitudeLaw
    from gcodesim.motion.pieces import Pieces
    from gcodesim.planning.spin_along import SpinAlong
    from gcodesim.planning.surface_axis import WordsAlong

Rows = NDArray[np.intp] | NDArray[np.int32] | NDArray[np.int64]
TURN = 0.1
"""Of a word [-, rad] between two places at which joints are worked out."""
CHOSEN = -1
"""The column of an external axis that no word commands."""
GROUND = -1
"""The platform of work that no external axis carries."""


@frozen(eq=False)
class Outside:
    """The external axes of an `assembly`: `columns` (e,) is which of a, b, c each is, or `CHOSEN`.

    Chosen ones are at `rest` (e,) until they run `along` splines, one for each axis (None: commanded).
    """

    assembly: Assembly
    columns: NDArray[np.int64]
    rest: Array
    along: tuple[SpinAlong | None, ...] = ()

    def commanded(self, positions: Array) -> Array:
        """Values (k, e) with the path at `positions` (k, 6); chosen axes at rest."""
        values = np.tile(self.rest, (len(positions), 1))
        own = self.columns != CHOSEN
        values[:, own] = positions[:, 3 + self.columns[own]]
        return values

    def values(self, piece: NDArray[np.int64], s: Array, positions: Array) -> Array:
        """Values (k, e) at places `s` (k,) of `piece` (k,)."""
        values = self.commanded(positions)
        for axis, spline in enumerate(self.along):
            if spline is not None:
                values[:, axis] = spline.at(piece, s)[0]
        return values

    def slopes(self, piece: NDArray[np.int64], s: Array, slope: Array) -> Array:
        """The derivatives of `values` by the way, where the path has the derivative `slope` (k, 6)."""
        slopes = np.zeros((len(slope), len(self.columns)))
        own = self.columns != CHOSEN
        slopes[:, own] = slope[:, 3 + self.columns[own]]
        for axis, spline in enumerate(self.along):
            if spline is not None:
                slopes[:, axis] = spline.at(piece, s)[1]
        return slopes


@frozen(eq=False)
class Guide:
    """By `law` the frame O leans, about `axes` (n, 3, 3) of each row in B; None: it does not.

    `outside` are the external axes, None without; `platform` (n,) is which of them carries the work of each row.
    With a surface words come from `words_at` points of the path (k, 3), and along its pieces from `turning`.
    """

    law: AttitudeLaw | None
    axes: Array
    outside: Outside | None
    platform: NDArray[np.int64]
    words_at: Callable[[Array], Array] | None = None
    turning: WordsAlong | None = None

    def leaning(self, R_BO: Array, row: Rows, positions: Array, words: Array | None = None) -> Array:
        """R_BO (k, 3, 3) upright, leaned as the path says at `positions` (k, 6) in rows `row` (k,), or by `words`."""
        if self.law is None:
            return R_BO
        if words is None:
            words = positions[:, 3:] if self.words_at is None else self.words_at(positions[:, :3])
        Q = self.axes[row]
        leaned: Array = multiplied(Q, self.law.rotations(words), Q.swapaxes(1, 2), R_BO)
        return leaned

    def frames(self, holding: Holding, row: NDArray[np.int64], words: Array) -> Array:
        """What `leaning` says by `words` (k, 3) in rows `row` (k,) of a path that is held so."""
        if self.law is None:
            return holding.R_BO[row]
        out = np.empty((len(row), 3, 3))
        lean_frames(self.law.rotations(words), row, holding, out)
        return out

    def words(self, piece: NDArray[np.int64], s: Array, positions: Array) -> Array:
        """Words (k, 3) at places `s` (k,) of `piece` (k,), which are at `positions` (k, 6)."""
        said = positions[:, 3:]
        return said if self.turning is None else self.turning.at(piece, s, said)

    def parts(self, pieces: Pieces) -> Array | float:
        """Into how many parts (m,) each piece has to be cut, so that what `turning` says lies on few of its knots."""
        if self.turning is None:
            return 0.0
        return self.turning.parts(np.arange(len(pieces)), TURN)

    def externals(self, piece: NDArray[np.int64], s: Array, positions: Array) -> Array | None:
        """Values (k, e) of the external axes; None without any."""
        return None if self.outside is None else self.outside.values(piece, s, positions)

    def from_arm(self, p: Array, R: Array, row: Rows, values: Array | None) -> tuple[Array, Array]:
        """Points (k, 3) and axes (k, 3, 3) given in the work, as the base of the arm sees them."""
        if self.outside is None or values is None:
            return p, R
        assembly = self.outside.assembly
        X = inverse_pose(assembly.base(values))
        for index in range(len(assembly.platforms)):
            here = self.platform[row] == index
            if here.any():
                X[here] = multiplied(X[here], assembly.platform(index, values[here]))
        return applied(X[:, :3, :3], p) + X[:, :3, 3], multiplied(X[:, :3, :3], R)
