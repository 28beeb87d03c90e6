"""The spin of a tool that turns about itself along its path: a smooth function of the way."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.pieces import OVERLAP, Pieces

_APART: Final = 1.0  # [m] of way that a joint move counts for, so that spins on both sides of it lie apart


@frozen(kw_only=False, eq=False)
class SpinAlong:
    """Spins as cubic Hermite splines through knots: at `way` (k,) [m] the `spin` (k,) [rad], its `slope` (k,) [rad/m].

    `begin` (m,) is the way at which each piece begins, and `fixed` (m,) marks joint moves, at whose ends splines
    begin: no spline runs across one. With the `gain` (m,) [1/m] of a piece, s counts for s + gain s².
    """

    begin: Array
    fixed: NDArray[np.bool_]
    way: Array
    spin: Array
    slope: Array
    gain: Array

    @staticmethod
    def through(
        pieces: Pieces, piece: list[NDArray[np.int64]], s: list[Array], spin: list[Array]
    ) -> SpinAlong:
        """Splines through spins (k,) at places `s` (k,) of `piece` (k,), one list entry for each chain.

        Slopes are those of the parabola through a knot and its neighbours, so speed of turning has no steps. On a
        piece where two rows overlap ds/dt is that of the first row all along; there the way grows from that evenly to
        the speed of the second.
        """
        length = np.where(pieces.fixed, _APART, pieces.length)
        lap = (pieces.kind == OVERLAP) & ~pieces.fixed
        gain = np.where(lap, 0.5 * (pieces.ratio - 1.0) / np.maximum(pieces.length, 1e-300), 0.0)
        length = length + gain * length * length
        begin = np.cumsum(length) - length
        ways = [_way(begin, pieces.fixed, p, at, gain) for p, at in zip(piece, s, strict=True)]
        slopes = [_slopes(way, value) for way, value in zip(ways, spin, strict=True)]
        knots = np.concatenate(ways), np.concatenate(spin), np.concatenate(slopes)
        return SpinAlong(begin, pieces.fixed.copy(), *knots, gain)

    def at(self, piece: NDArray[np.int64], s: Array) -> tuple[Array, Array]:
        """Spins (k,) [rad] and their derivatives by the way (k,) [rad/m] at `s` (k,) of `piece` (k,)."""
        asked = _way(self.begin, self.fixed, piece, s, self.gain)
        after = np.clip(np.searchsorted(self.way, asked, side="left"), 1, max(len(self.way) - 1, 1))
        before, after = after - 1, np.minimum(after, len(self.way) - 1)
        span = np.maximum(self.way[after] - self.way[before], 1e-300)
        u = np.clip((asked - self.way[before]) / span, 0.0, 1.0)
        rise = self.spin[after] - self.spin[before]
        m0, m1 = self.slope[before] * span, self.slope[after] * span
        spin = self.spin[before] + u * (m0 + u * (3.0 * rise - 2.0 * m0 - m1 + u * (m0 + m1 - 2.0 * rise)))
        slope = (m0 + u * (2.0 * (3.0 * rise - 2.0 * m0 - m1) + 3.0 * u * (m0 + m1 - 2.0 * rise))) / span
        return spin, slope * (1.0 + 2.0 * self.gain[piece] * s)


def _way(
    begin: Array, fixed: NDArray[np.bool_], piece: NDArray[np.int64], s: Array, gain: Array
) -> Array:
    """How far along the path places are; on a joint move, its end."""
    way: Array = begin[piece] + np.where(fixed[piece], _APART, s + gain[piece] * s * s)
    return way


def _slopes(way: Array, spin: Array) -> Array:
    if len(way) < 3:
        return np.zeros(len(way))
    step = np.maximum(np.diff(way), 1e-12)
    rate = np.diff(spin) / step
    inner = (rate[:-1] * step[1:] + rate[1:] * step[:-1]) / (step[:-1] + step[1:])
    return np.concatenate([[0.0], inner, [0.0]])
