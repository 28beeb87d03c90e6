"""Chatter: how deep a mill may cut before its own waves grow.

The zero-order solution of Altintas and Budak (1995): the directional factors of a turning cutter are averaged over a
pitch, the dynamics are one mode in each direction of the plane. Good for cuts that are not thin; process damping at low
speed and period doubling in thin cuts are left out.
"""

from __future__ import annotations

from math import inf, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.elementary import atan, cos, sin
from gcodesim.frozen import frozen

Array = NDArray[np.float64]

_EVEN, _NEAR = 2001, 2001  # chatter frequencies that are tried: between the limits, and around each mode
_BELOW, _ABOVE = 0.5, 2.0  # of the natural frequencies, between which they lie


@frozen
class Mode:
    """One mode of the tip: `frequency` [Hz], `stiffness` [N/m], `damping` ratio [-]."""

    frequency: float
    stiffness: float
    damping: float

    def response(self, frequency: Array) -> tuple[Array, Array]:
        """Real and imaginary part of the compliance [m/N] at frequencies [Hz]."""
        r = frequency / self.frequency
        a, b = 1.0 - r * r, 2.0 * self.damping * r
        scale = self.stiffness * (a * a + b * b)
        return a / scale, -b / scale


@frozen(eq=False)
class Lobes:
    """n points of the stability limit before lobes are counted: chatter frequency [Hz], depth [m], phase [rad].

    `goes_on` (n - 1): whether the next point is the neighbour on the same curve. Lobe k of a point is at `speed(k)`.
    """

    frequency: Array
    depth: Array
    phase: Array
    goes_on: NDArray[np.bool_]
    teeth: int

    @property
    def limit(self) -> tuple[float, float]:
        """The depth [m] that is stable at any speed, infinite if all are, and the chatter frequency [Hz] there.

        Between points it is the least of the parabola through the lowest and its neighbours.
        """
        if not len(self.depth):
            return inf, 0.0
        least = int(np.argmin(self.depth))
        if 0 < least < len(self.depth) - 1 and self.goes_on[least - 1] and self.goes_on[least]:
            return _lowest(self.frequency[least - 1 : least + 2], self.depth[least - 1 : least + 2])
        return float(self.depth[least]), float(self.frequency[least])

    def speed(self, k: int) -> Array:
        """Speeds (n,) [rad/s] of lobe k: one tooth passes in (phase + 2 k pi) / chatter frequency."""
        return 2.0 * pi * self.frequency * 2.0 * pi / (self.teeth * (self.phase + 2.0 * pi * k))

    def depth_at(self, spindle: float) -> float:
        """The depth [m] up to which a cut at `spindle` [rad/s] is stable, infinite if any is: the lowest of its lobes.

        Waves from one tooth to the next, less the phase, are a whole number k, from 0, on lobe k.
        """
        if not len(self.depth):
            return inf
        waves = self.frequency * (2.0 * pi / (self.teeth * spindle)) - self.phase / (2.0 * pi)
        a, b = waves[:-1], waves[1:]
        first, last = np.maximum(np.ceil(np.minimum(a, b)), 0.0), np.floor(np.maximum(a, b))
        at = np.flatnonzero(self.goes_on & (first <= last))
        if not len(at):
            return inf
        wide = np.where(b[at] == a[at], 1.0, b[at] - a[at])
        low, high = self.depth[at], self.depth[at + 1]
        return min(float((low + (k[at] - a[at]) / wide * (high - low)).min()) for k in (first, last))


def lobes(x: Mode, y: Mode, *, ktc: float, ratio: float, teeth: int, entry: float, exit: float) -> Lobes:
    """The limit with one mode along the feed and one across; `ktc` [Pa], `ratio` of radial to tangential force.

    Contact runs from `entry` to `exit` [rad], clockwise from left of the feed. Altintas and Budak 1995, eqs. 14 to 24.
    """
    xx, xy, yx, yy = _factors(ratio, exit) - _factors(ratio, entry)
    frequency = _tried(x, y)
    ax, bx = x.response(frequency)
    ay, by = y.response(frequency)
    # a0 L^2 + a1 L + 1 = 0 in complex numbers, as real and imaginary parts
    area = xx * yy - xy * yx
    a0r, a0i = (ax * ay - bx * by) * area, (ax * by + bx * ay) * area
    a1r, a1i = xx * ax + yy * ay, xx * bx + yy * by
    dr, di = a1r * a1r - a1i * a1i - 4.0 * a0r, 2.0 * a1r * a1i - 4.0 * a0i
    size = np.sqrt(dr * dr + di * di)
    rr = np.sqrt(np.maximum(0.5 * (size + dr), 0.0))
    ri = np.copysign(np.sqrt(np.maximum(0.5 * (size - dr), 0.0)), di)
    turned = np.append(False, rr[1:] * rr[:-1] + ri[1:] * ri[:-1] < 0.0)
    way = np.where(np.logical_xor.accumulate(turned), -1.0, 1.0)  # the root goes on smoothly, and each curve with it
    found: list[tuple[NDArray[Any], ...]] = []
    for family, sign in enumerate((way, -way)):
        pr, pi_ = -(a1r + sign * rr), -(a1i + sign * ri)
        below = 2.0 * (a0r * a0r + a0i * a0i)
        lr, li = (pr * a0r + pi_ * a0i) / below, (pi_ * a0r - pr * a0i) / below
        good = np.flatnonzero(lr < 0.0)  # elsewhere no depth is the limit
        kappa = li[good] / lr[good]
        depth = -2.0 * pi * lr[good] / (teeth * ktc) * (1.0 + kappa * kappa)
        phase = np.array([pi - 2.0 * atan(value) for value in kappa])
        found.append((frequency[good], depth, phase, good + family * (len(frequency) + 1)))
    chosen = [np.concatenate(parts) for parts in zip(*found, strict=True)]
    return Lobes(
        frequency=chosen[0], depth=chosen[1], phase=chosen[2], goes_on=np.diff(chosen[3]) == 1, teeth=teeth
    )  # fmt: skip


def _tried(x: Mode, y: Mode) -> Array:
    """Frequencies (n,) [Hz], rising: closest where a mode answers most sharply, a thousandth of its damping apart."""
    low, high = _BELOW * min(x.frequency, y.frequency), _ABOVE * max(x.frequency, y.frequency)
    around = np.linspace(-1.0, 1.0, _NEAR)
    parts = [np.linspace(low, high, _EVEN)]
    parts += [mode.frequency * (1.0 + mode.damping * around + around * around * around) for mode in (x, y)]
    every = distinct(np.concatenate(parts))
    return every[(every >= low) & (every <= high)]


def _lowest(x: Array, y: Array) -> tuple[float, float]:
    """The least value, and where it is, of the parabola through three points of which the middle one is lowest."""
    left, right = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
    bend = (right - left) / (x[2] - x[0])
    if not bend > 0.0:
        return float(y[1]), float(x[1])
    slope = left + bend * (x[1] - x[0])
    aside = -0.5 * slope / bend
    return float(y[1] + (slope + bend * aside) * aside), float(x[1] + aside)


def _factors(ratio: float, phi: float) -> Array:
    """The directional factors xx, xy, yx, yy up to an angle (Altintas and Budak 1995, eq. 15)."""
    c, s = cos(2.0 * phi), sin(2.0 * phi)
    return 0.5 * np.array(
        [
            c - 2.0 * ratio * phi + ratio * s,
            -s - 2.0 * phi + ratio * c,
            -s + 2.0 * phi + ratio * c,
            -c - 2.0 * ratio * phi - ratio * s,
        ]
    )


def least_width(mode: Mode, pressure: float, orientation: float = 1.0) -> float:
    """The width of cut [m] that is stable at any speed in turning: -1 / (2 K Re G least), with one mode (Tlusty 1963).

    The least real part of the compliance is -1 / (4 k d (1 + d)); `orientation` is the share of the force and of the
    motion along the normal of the cut.
    """
    d = mode.damping
    return 2.0 * mode.stiffness * d * (1.0 + d) / (pressure * orientation)


def turning_frequency(mode: Mode) -> float:
    """The chatter frequency [Hz] at that limit: f sqrt(1 + 2 d)."""
    return mode.frequency * sqrt(1.0 + 2.0 * mode.damping)
