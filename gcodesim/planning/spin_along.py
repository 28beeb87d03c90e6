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
    """Spins as Hermite splines through knots: at `way` (k,) [m] the `spin` (k,) [rad], its `slope` (k,) [rad/m].

    Splines are cubic, and their second derivative steps at knots; with a `bend` (k,) [rad/m²] at knots they are of the
    fifth degree and it does not, so that a limit of jerk can be kept.
    `begin` (m,) is the way at which each piece begins, and `fixed` (m,) marks joint moves, at whose ends splines
    begin: no spline runs across one. With the `gain` (m,) [1/m] of a piece, s counts for s + gain s².
    """

    begin: Array
    fixed: NDArray[np.bool_]
    way: Array
    spin: Array
    slope: Array
    gain: Array
    bend: Array | None = None

    @staticmethod
    def through(
        pieces: Pieces, piece: list[NDArray[np.int64]], s: list[Array], spin: list[Array], *, soft: bool
    ) -> SpinAlong:
        """Splines through spins (k,) at places `s` (k,) of `piece` (k,), one list entry for each chain.

        Slopes are those of the parabola through a knot and its neighbours, so speed of turning has no steps; `soft`
        splines have its second derivative too, so neither has acceleration. Where a spin stands, from one knot to the
        next, it does not move: an axis at the end of its travel would go beyond it. On a piece
        where two rows overlap ds/dt is that of the first row all along; there the way grows from that evenly to the
        speed of the second.
        """
        length = np.where(pieces.fixed, _APART, pieces.length)
        lap = (pieces.kind == OVERLAP) & ~pieces.fixed
        gain = np.where(lap, 0.5 * (pieces.ratio - 1.0) / np.maximum(pieces.length, 1e-300), 0.0)
        length = length + gain * length * length
        begin = np.cumsum(length) - length
        ways = [_way(begin, pieces.fixed, p, at, gain) for p, at in zip(piece, s, strict=True)]
        slopes = [_slopes(way, value) for way, value in zip(ways, spin, strict=True)]
        knots = np.concatenate(ways), np.concatenate(spin), np.concatenate(slopes)
        bend = np.concatenate([_bends(way, value) for way, value in zip(ways, spin, strict=True)]) if soft else None
        return SpinAlong(begin, pieces.fixed.copy(), *knots, gain, bend)

    def at(self, piece: NDArray[np.int64], s: Array) -> tuple[Array, Array]:
        """Spins (k,) [rad] and their derivatives by the way (k,) [rad/m] at `s` (k,) of `piece` (k,)."""
        asked = _way(self.begin, self.fixed, piece, s, self.gain)
        after = np.clip(np.searchsorted(self.way, asked, side="left"), 1, max(len(self.way) - 1, 1))
        before, after = after - 1, np.minimum(after, len(self.way) - 1)
        span = np.maximum(self.way[after] - self.way[before], 1e-300)
        u = np.clip((asked - self.way[before]) / span, 0.0, 1.0)
        rise = self.spin[after] - self.spin[before]
        m0, m1 = self.slope[before] * span, self.slope[after] * span
        if self.bend is not None:
            c0, c1 = self.bend[before] * (span * span), self.bend[after] * (span * span)
            spin, slope = _fifth_degree(u, self.spin[before], rise, (m0, m1), (c0, c1))
            return spin, slope / span * (1.0 + 2.0 * self.gain[piece] * s)
        spin = self.spin[before] + u * (m0 + u * (3.0 * rise - 2.0 * m0 - m1 + u * (m0 + m1 - 2.0 * rise)))
        slope = (m0 + u * (2.0 * (3.0 * rise - 2.0 * m0 - m1) + 3.0 * u * (m0 + m1 - 2.0 * rise))) / span
        return spin, slope * (1.0 + 2.0 * self.gain[piece] * s)


def _way(begin: Array, fixed: NDArray[np.bool_], piece: NDArray[np.int64], s: Array, gain: Array) -> Array:
    """How far along the path places are; on a joint move, its end."""
    way: Array = begin[piece] + np.where(fixed[piece], _APART, s + gain[piece] * s * s)
    return way


def _slopes(way: Array, spin: Array) -> Array:
    if len(way) < 3:
        return np.zeros(len(way))
    step = np.maximum(np.diff(way), 1e-12)
    rate = np.diff(spin) / step
    inner = (rate[:-1] * step[1:] + rate[1:] * step[:-1]) / (step[:-1] + step[1:])
    return np.concatenate([[0.0], np.where(_stands(rate), 0.0, inner), [0.0]])


def _bends(way: Array, spin: Array) -> Array:
    """Second derivatives of the parabolas that `_slopes` are of; 0 at both ends."""
    if len(way) < 3:
        return np.zeros(len(way))
    step = np.maximum(np.diff(way), 1e-12)
    rate = np.diff(spin) / step
    inner = 2.0 * np.diff(rate) / (step[:-1] + step[1:])
    return np.concatenate([[0.0], np.where(_stands(rate), 0.0, inner), [0.0]])


def _stands(rate: Array) -> NDArray[np.bool_]:
    """Whether knots (k - 2,) between stretches with this `rate` (k - 1,) begin or end one on which nothing turns."""
    stands: NDArray[np.bool_] = (rate[:-1] == 0.0) | (rate[1:] == 0.0)
    return stands


def _fifth_degree(
    u: Array, begin: Array, rise: Array, slopes: tuple[Array, Array], bends: tuple[Array, Array]
) -> tuple[Array, Array]:
    """The polynomial from `begin` at u = 0 to `rise` above it at 1 with these derivatives there; it and its slope."""
    (m0, m1), (c0, c1) = slopes, bends
    r, m, c = rise - m0 - 0.5 * c0, m1 - m0 - c0, c1 - c0
    k3, k4, k5 = 10.0 * r - 4.0 * m + 0.5 * c, 7.0 * m - 15.0 * r - c, 6.0 * r - 3.0 * m + 0.5 * c
    value = begin + u * (m0 + u * (0.5 * c0 + u * (k3 + u * (k4 + u * k5))))
    slope = m0 + u * (c0 + u * (3.0 * k3 + u * (4.0 * k4 + u * (5.0 * k5))))
    return value, slope
