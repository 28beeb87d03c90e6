"""Lines along Z against slabs of a body of revolution, standing or swept.

A body is a stack of slabs across its axis: frusta (k + g h is the radius at the height h) and slices of balls. A slab
is convex, so a line meets it in one interval; and where the axis keeps its direction, the slab swept along a straight
way is convex again, so what a line shares with the sweep is one interval as well, and exact: in the plane of s (place
on the line) and t (share of the way) it is the extent in s of a conic between lines. Its ends are where the conic
turns, or lie on a border: the ends of the way, or the faces of the slab.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel

EVEN = 1.0e-14
"""Coefficients below this are none: the line is parallel to what it would meet."""


class Slab(NamedTuple):
    """Heights h0 to h1 [m] of a body. Frustum: radius k + g h. Ball (round 1): k is its radius, g its centre's h."""

    round: float
    h0: float
    h1: float
    k: float
    g: float
    widest: float


class ColumnLine(NamedTuple):
    """A line along Z seen from the tip of a tool with the unit axis (ax, ay, az): at (u, v), height H at s = 0.

    (mu, mv, mw) is the way of the tip [m] and climb its part along the axis. g00 … g22 are the coefficients of
    G(s, t) = g11 s² + 2 g12 s t + g22 t² + 2 g01 s + 2 g02 t + g00, which is negative inside of the slab's mantle.
    """

    az: float
    height: float
    climb: float
    g00: float
    g01: float
    g02: float
    g11: float
    g12: float
    g22: float


@kernel(lean=True)
def line_of(
    u: float, v: float, ax: float, ay: float, az: float, mu: float, mv: float, mw: float, slab: Slab
) -> ColumnLine:
    """The line at (u, v) from the tip at t = 0."""
    height = u * ax + v * ay
    climb = mu * ax + mv * ay + mw * az
    q00, q01, q02 = u * u + v * v, 0.0, -(u * mu + v * mv)
    q11, q12, q22 = 1.0, -mw, mu * mu + mv * mv + mw * mw
    if slab.round > 0.0:
        centre = slab.g
        q00 += centre * centre - slab.k * slab.k - 2.0 * centre * height
        q01 -= centre * az
        q02 += centre * climb
    else:
        # minus height² minus radius², both linear in s and t
        radius, along, across = slab.k + slab.g * height, slab.g * az, -slab.g * climb
        q00 -= height * height + radius * radius
        q01 -= height * az + radius * along
        q02 -= -height * climb + radius * across
        q11 -= az * az + along * along
        q12 -= -az * climb + along * across
        q22 -= climb * climb + across * across
    return ColumnLine(az, height, climb, q00, q01, q02, q11, q12, q22)


@kernel(lean=True)
def at_pose(line: ColumnLine, slab: Slab, t: float) -> tuple[float, float]:
    """The interval (low, high) of s in which the line is inside of the slab at the share t of the way; (1, 0): none."""
    level = line.height - t * line.climb
    if abs(line.az) > EVEN:
        one, other = (slab.h0 - level) / line.az, (slab.h1 - level) / line.az
        low, high = min(one, other), max(one, other)
    elif slab.h0 <= level <= slab.h1:
        low, high = -np.inf, np.inf
    else:
        return 1.0, 0.0
    a = line.g11
    b = line.g01 + t * line.g12
    c = line.g00 + 2.0 * t * line.g02 + t * t * line.g22
    if abs(a) < EVEN:  # parallel to the mantle
        if abs(b) <= EVEN * slab.widest:
            if c > 0.0:
                return 1.0, 0.0
        elif b > 0.0:
            high = min(high, -0.5 * c / b)
        else:
            low = max(low, -0.5 * c / b)
    else:
        square = b * b - a * c
        if a > 0.0:
            if square < 0.0:
                return 1.0, 0.0
            root = np.sqrt(square)
            low, high = max(low, (-b - root) / a), min(high, (-b + root) / a)
        elif square > 0.0:
            # a steep line in a cone is inside beyond both; the slab is in the half where the radius is positive
            root = np.sqrt(square)
            if slab.g * line.az > 0.0:
                low = max(low, (-b - root) / a)
            else:
                high = min(high, (-b + root) / a)
    if low < high:
        return low, high
    return 1.0, 0.0


@kernel(lean=True)
def on_face(line: ColumnLine, slab: Slab, h: float) -> tuple[float, float]:
    """The extent (low, high) of s where the face at the height h of a slab passes along its way; (1, 0): nowhere."""
    if abs(line.az) <= EVEN:
        if abs(line.climb) <= EVEN * slab.widest:
            return 1.0, 0.0
        t = (line.height - h) / line.climb
        if t < 0.0 or t > 1.0:
            return 1.0, 0.0
        b = line.g01 + t * line.g12
        c = line.g00 + 2.0 * t * line.g02 + t * t * line.g22
        square = b * b - line.g11 * c
        if square <= 0.0 or line.g11 <= EVEN:
            return 1.0, 0.0
        root = np.sqrt(square)
        return (-b - root) / line.g11, (-b + root) / line.g11
    # s = begin + rate t on the face: a quadric in t
    begin, rate = (h - line.height) / line.az, line.climb / line.az
    a = line.g11 * rate * rate + 2.0 * line.g12 * rate + line.g22
    b = line.g11 * begin * rate + line.g12 * begin + line.g01 * rate + line.g02
    c = line.g11 * begin * begin + 2.0 * line.g01 * begin + line.g00
    first, last = 0.0, 1.0
    if a > EVEN * slab.widest * slab.widest:
        square = b * b - a * c
        if square < 0.0:
            return 1.0, 0.0
        root = np.sqrt(square)
        first, last = max(first, (-b - root) / a), min(last, (-b + root) / a)
    elif c > 0.0:  # a disc that moves along the line itself
        return 1.0, 0.0
    if first > last:
        return 1.0, 0.0
    one, other = begin + rate * first, begin + rate * last
    return min(one, other), max(one, other)


@kernel(lean=True)
def swept(line: ColumnLine, slab: Slab) -> tuple[float, float]:
    """The interval (low, high) of s that a slab sweeps from t = 0 to 1 with its axis as it is; (1, 0): none."""
    low, high = np.inf, -np.inf
    for end in range(2):
        one, other = at_pose(line, slab, float(end))
        if one <= other:
            low, high = min(low, one), max(high, other)
        one, other = on_face(line, slab, slab.h1 if end == 1 else slab.h0)
        if one <= other:
            low, high = min(low, one), max(high, other)
    if abs(line.g22) > EVEN * slab.widest * slab.widest:  # where the conic turns: dG/dt = 0
        slope = -line.g12 / line.g22
        shift = -line.g02 / line.g22
        a = line.g11 + line.g12 * slope
        b = line.g01 + line.g12 * shift
        c = line.g00 + line.g02 * shift
        square = b * b - a * c
        if abs(a) > EVEN and square >= 0.0:
            root = np.sqrt(square)
            for side in range(2):
                s = (-b + (root if side == 1 else -root)) / a
                t = shift + slope * s
                level = line.height + s * line.az - t * line.climb
                if 0.0 <= t <= 1.0 and slab.h0 <= level <= slab.h1:
                    low, high = min(low, s), max(high, s)
    if low < high:
        return low, high
    return 1.0, 0.0
