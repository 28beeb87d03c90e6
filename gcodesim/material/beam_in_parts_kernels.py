"""Beams on several stocks that stand in each other, such as the layers of a plate or a screw in it.

Each ray goes from one to the next in the order in which it meets them, with what it has left; what each gives up is
the affair of its own material. So a layer shades what lies below it until it is gone, and the sum of all doses and
volumes is that of one ray. See `beam_kernels` for what a ray does to one stock.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.beam_kernels import (
    CROWDED,
    MOST_INTERVALS,
    PEAK,
    Ablating,
    BeamForm,
    BeamWay,
    Ray,
    aim_at,
    distance_to,
    follow_ray,
    line_of,
)

Array = NDArray[np.float64]

STAGES = 64  # stocks that a ray may enter, one after the other


class Together(NamedTuple):
    """How m stocks stand: the origins of their frames (m, 3) [m], seen from that of number `home`, whose columns are
    the finest; rays stand at most `widest` [m] apart."""

    at: Array
    home: int
    widest: float


class StruckParts(NamedTuple):
    """What became of c pieces in m stocks: `taken` (c, m) [m³]; (c,) what of `given` met material, the least distance
    [m] from the focus to where it did (infinite: nowhere), and the greatest dose of a column so far [per m²]."""

    taken: Array
    met: Array
    off: Array
    dose: Array


@kernel
def first_met(on: Ablating, at: Array, ray: Ray, t: float) -> float:
    """How far [m] along a ray it first meets material of a stock that stands at (3,), beyond t [m]; infinite: none."""
    peak = on.notes[PEAK]
    x, y, z = ray.x - at[0] + ray.dx * t, ray.y - at[1] + ray.dy * t, ray.z - at[2] + ray.dz * t
    _, _, first = follow_ray(on, Ray(x, y, z, ray.dx, ray.dy, ray.dz, ray.far - t, 0.0, 0.0))
    on.notes[PEAK] = peak
    return t + first


@kernel
def follow_through(
    ons: tuple[Ablating, ...], together: Together, ray: Ray, takes: Array, gone: Array
) -> tuple[float, float]:
    """One ray with its share of the beam in `length`, through all stocks, which take `takes` (m,) [m³] of a whole beam.

    `dose` is its share of what is given. What is taken is added to `gone` (m,) [m³]. Returns the share of the ray that
    met nothing, and how far along it [m] it first met material.
    """
    left, t, start = 1.0, 0.0, math.inf
    for _ in range(STAGES):
        first, second, which = math.inf, math.inf, -1
        for k in range(len(ons)):
            met = first_met(ons[k], together.at[k], ray, t)
            if met < first:
                first, second, which = met, first, k
            elif met < second:
                second = met
        if which < 0:
            break
        start = min(start, first)
        on, at = ons[which], together.at[which]
        area = on.field.grid.dx * on.field.grid.dy
        until = min(max(second, first + 1.0e-9 * on.field.grid.dx), ray.far)
        part = Ray(
            ray.x - at[0] + ray.dx * t, ray.y - at[1] + ray.dy * t, ray.z - at[2] + ray.dz * t,
            ray.dx, ray.dy, ray.dz, until - t, left * ray.length * takes[which] / area, left * ray.dose / area,
        )  # fmt: skip
        rest, length, _ = follow_ray(on, part)
        gone[which] += length * area
        left *= rest
        t = until
        if left <= 0.0 or t >= ray.far:
            break
    return left, start


@kernel
def shine_through(
    ons: tuple[Ablating, ...],
    together: Together,
    form: BeamForm,
    p: Array,
    d: Array,
    takes: Array,
    given: float,
    gone: Array,
) -> tuple[float, float]:
    """A beam with its tip at p (3,) [m], in the direction d (3,), could take `takes` (m,) [m³] of each stock.

    What it takes is added to `gone` (m,) [m³]. Returns the part of `given` that met material, and the least distance
    [m] from the focus to where it did.
    """
    s = math.inf
    for k in range(len(ons)):
        s = min(s, distance_to(ons[k], p - together.at[k], d, form))
    aim = aim_at(ons[together.home].field, form, p, d, s, together.widest)
    met, off = 0.0, math.inf
    for a in range(aim.bundle.na):
        for b in range(aim.bundle.nb):
            if aim.weights[a * aim.bundle.nb + b] / aim.total <= 0.0:
                continue
            line = line_of(form, aim, d, a, b)
            ray = Ray(
                line.x, line.y, line.z, line.dx, line.dy, line.dz, line.far, line.weight, line.weight * given,
            )  # fmt: skip
            left, far = follow_through(ons, together, ray, takes, gone)
            met += line.weight * (1.0 - left)
            if far < math.inf:
                off = min(off, abs(far / line.size + form.mouth - form.focus))
    return met * given, off


@kernel
def strike_through(
    ons: tuple[Ablating, ...],
    together: Together,
    form: BeamForm,
    way: BeamWay,
    volume: Array,
    first: int,
    struck: StruckParts,
) -> int:
    """Pieces `first` … of a beam's way in order; the index of the piece before which columns get more room, or their
    number. `volume` (c, m) [m³] is what each could take of each stock. What is `struck` is added to."""
    stride = math.inf
    for k in range(len(ons)):
        stride = min(stride, 0.5 * min(ons[k].field.grid.dx, ons[k].field.grid.dy))
    p, d, takes = np.empty(3), np.empty(3), np.empty(len(ons))
    for c in range(first, len(volume)):
        if way.given[c] <= 0.0:
            continue
        length = 0.0
        for n in range(3):
            d[n] = -way.axes[c, n]
            length += (way.ends[c, n] - way.starts[c, n]) * (way.ends[c, n] - way.starts[c, n])
        steps = max(1, math.ceil(math.sqrt(length) / stride))
        for k in range(len(ons)):
            takes[k] = volume[c, k] / steps
        for i in range(steps):
            share = (i + 0.5) / steps
            for n in range(3):
                p[n] = way.starts[c, n] + share * (way.ends[c, n] - way.starts[c, n])
            met, off = shine_through(ons, together, form, p, d, takes, way.given[c] / steps, struck.taken[c])
            struck.met[c] += met
            struck.off[c] = min(struck.off[c], off)
        crowded = False
        for k in range(len(ons)):
            on = ons[k]
            struck.dose[c] = max(struck.dose[c], on.notes[PEAK])
            on.notes[PEAK] = 0.0
            if on.notes[CROWDED] > 0.0 and on.field.columns.lo.shape[2] < MOST_INTERVALS:
                crowded = True
        if crowded:
            return c + 1
    return len(volume)
