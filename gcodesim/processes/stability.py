"""Chatter: how deep a mill may cut before its own waves grow.

The zero-order solution of Altintas and Budak (1995): the directional factors of a turning cutter are averaged over a
pitch, the dynamics are one mode in each direction of the plane. Good for cuts that are not thin; process damping at low
speed and period doubling in thin cuts are left out.
"""

from __future__ import annotations

from math import inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import atan, cos, sin
from gcodesim.frozen import frozen

Array = NDArray[np.float64]

_SPREAD = 4001  # chatter frequencies that are tried
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

    Neighbours are `step` [Hz] apart where nothing is missing between them. Lobe k of a point is at `speed(k)`.
    """

    frequency: Array
    depth: Array
    phase: Array
    teeth: int
    step: float

    @property
    def limit(self) -> tuple[float, float]:
        """The depth [m] that is stable at any speed, infinite if all are, and the chatter frequency [Hz] there."""
        if not len(self.depth):
            return inf, 0.0
        least = int(np.argmin(self.depth))
        return float(self.depth[least]), float(self.frequency[least])

    def speed(self, k: int) -> Array:
        """Speeds (n,) [rad/s] of lobe k: one tooth passes in (phase + 2 k pi) / chatter frequency."""
        return 2.0 * pi * self.frequency * 2.0 * pi / (self.teeth * (self.phase + 2.0 * pi * k))

    def depth_at(self, spindle: float, most: int = 60) -> float:
        """The depth [m] up to which a cut at `spindle` [rad/s] is stable: the lowest of its lobes."""
        found = inf
        gaps = np.diff(self.frequency)
        for k in range(most):
            speed = self.speed(k)
            before, after = speed[:-1] - spindle, speed[1:] - spindle
            at = np.flatnonzero((before * after <= 0.0) & (gaps > 0.0) & (gaps < 1.5 * self.step))
            for i in at:
                wide = before[i] - after[i]
                part = before[i] / wide if wide != 0.0 else 0.0
                found = min(found, float(self.depth[i] + part * (self.depth[i + 1] - self.depth[i])))
        return found


def lobes(x: Mode, y: Mode, *, ktc: float, ratio: float, teeth: int, entry: float, exit: float) -> Lobes:
    """The limit with one mode along the feed and one across; `ktc` [Pa], `ratio` of radial to tangential force.

    Contact runs from `entry` to `exit` [rad], clockwise from left of the feed. Altintas and Budak 1995, eqs. 14 to 24.
    """
    xx, xy, yx, yy = _factors(ratio, exit) - _factors(ratio, entry)
    frequency = np.linspace(_BELOW * min(x.frequency, y.frequency), _ABOVE * max(x.frequency, y.frequency), _SPREAD)
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
    found: list[tuple[Array, Array, Array]] = []
    for sign in (1.0, -1.0):
        pr, pi_ = -(a1r + sign * rr), -(a1i + sign * ri)
        below = 2.0 * (a0r * a0r + a0i * a0i)
        lr, li = (pr * a0r + pi_ * a0i) / below, (pi_ * a0r - pr * a0i) / below
        kappa = li / lr
        depth = -2.0 * pi * lr / (teeth * ktc) * (1.0 + kappa * kappa)
        good = depth > 0.0
        phase = np.array([pi - 2.0 * atan(value) for value in kappa[good]])
        found.append((frequency[good], depth[good], phase))
    chosen = [np.concatenate(parts) for parts in zip(*found, strict=True)]
    return Lobes(
        frequency=chosen[0], depth=chosen[1], phase=chosen[2], teeth=teeth, step=float(frequency[1] - frequency[0])
    )


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
