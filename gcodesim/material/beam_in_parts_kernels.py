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
    PEAK,
    Ablating,
    BeamForm,
    BeamWay,
    Ray,
    StruckParts,
    aim_at,
    follow_ray,
    line_of,
    needs_room,
    steps_of,
    tip_at,
)
from gcodesim.material.field_kernels import Bytes, Columns, Field, Grid, Ints, Singles

Array = NDArray[np.float64]

STAGES = 64  # stocks that a ray may enter, one after the other


class Together(NamedTuple):
    """How m stocks stand: the origins `at` (m, 3) [m] and the axes, as columns of `turns` (m, 3, 3), of their frames,
    seen from that of number `home`, whose columns are the finest; rays stand at most `widest` [m] apart."""

    at: Array
    turns: Array
    home: int
    widest: float


class AblatingParts(NamedTuple):
    """m stocks side by side, in arrays with a row for each, of what `Ablating` has of one; `grids` (m, 4).

    The columns are as many as the widest and the longest stock have; those beyond a stock's own are empty.
    """

    lo: Array
    hi: Array
    number: Ints
    grids: Array
    walls: Singles
    dirty: Bytes
    tops: Array
    dose: Array
    threshold: float
    notes: Array


@kernel(inlined=True)
def part_of(parts: AblatingParts, k: int) -> Ablating:
    """Stock k of those that stand side by side."""
    columns = Columns(parts.lo[k], parts.hi[k], parts.number[k])
    grid = Grid(parts.grids[k, 0], parts.grids[k, 1], parts.grids[k, 2], parts.grids[k, 3])
    field = Field(columns, grid, parts.walls[k], parts.dirty[k], parts.tops[k])
    return Ablating(field, parts.dose[k], parts.threshold, parts.notes[k])


@kernel
def seen_by(together: Together, k: int, ray: Ray, t: float, until: float) -> Ray:
    """The part of a ray between t and `until` [m], in the frame of stock k; it takes nothing and gives nothing."""
    at, R = together.at[k], together.turns[k]
    x, y, z = ray.x - at[0] + ray.dx * t, ray.y - at[1] + ray.dy * t, ray.z - at[2] + ray.dz * t
    return Ray(
        R[0, 0] * x + R[1, 0] * y + R[2, 0] * z,
        R[0, 1] * x + R[1, 1] * y + R[2, 1] * z,
        R[0, 2] * x + R[1, 2] * y + R[2, 2] * z,
        R[0, 0] * ray.dx + R[1, 0] * ray.dy + R[2, 0] * ray.dz,
        R[0, 1] * ray.dx + R[1, 1] * ray.dy + R[2, 1] * ray.dz,
        R[0, 2] * ray.dx + R[1, 2] * ray.dy + R[2, 2] * ray.dz,
        until - t, 0.0, 0.0, 0.0,
    )  # fmt: skip


@kernel
def first_met(on: Ablating, ray: Ray) -> float:
    """How far [m] along a ray it first meets material; infinite: none."""
    peak = on.notes[PEAK]
    first = follow_ray(on, ray)[2]
    on.notes[PEAK] = peak
    return first


@kernel
def follow_through(
    parts: AblatingParts, together: Together, ray: Ray, takes: Array, gone: Array
) -> tuple[float, float]:
    """One ray with its share of the beam in `length`, through all stocks, which take `takes` (m,) [m³] of a whole beam.

    `dose` is its share of what is given. What is taken is added to `gone` (m,) [m³]. Returns the share of the ray that
    met nothing, and how far along it [m] it first met material.
    """
    left, t, start = 1.0, 0.0, math.inf
    for _ in range(STAGES):
        first, second, which = math.inf, math.inf, -1
        for k in range(len(parts.lo)):
            met = t + first_met(part_of(parts, k), seen_by(together, k, ray, t, ray.far))
            if met < first:
                first, second, which = met, first, k
            elif met < second:
                second = met
        if which < 0:
            break
        start = min(start, first)
        on = part_of(parts, which)
        area = on.field.grid.dx * on.field.grid.dy
        until = min(max(second, first + 1.0e-9 * on.field.grid.dx), ray.far)
        own = seen_by(together, which, ray, t, until)
        rest, length, _ = follow_ray(
            on,
            Ray(
                own.x, own.y, own.z, own.dx, own.dy, own.dz, own.far,
                left * ray.length * takes[which] / area, left * ray.dose / area, ray.width,
            ),
        )  # fmt: skip
        gone[which] += length * area
        left *= rest
        t = until
        if left <= 0.0 or t >= ray.far:
            break
    return left, start


@kernel
def shine_through(
    parts: AblatingParts,
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
    begin, far = form.mouth, form.reach - form.mouth
    axis = Ray(p[0] + d[0] * begin, p[1] + d[1] * begin, p[2] + d[2] * begin, d[0], d[1], d[2], far, 0.0, 0.0, 0.0)
    for k in range(len(parts.lo)):
        s = min(s, begin + follow_ray(part_of(parts, k), seen_by(together, k, axis, 0.0, far))[2])
    aim = aim_at(part_of(parts, together.home).field, form, p, d, s, together.widest)
    met, off = 0.0, math.inf
    for a in range(aim.bundle.na):
        for b in range(aim.bundle.nb):
            if aim.weights[a * aim.bundle.nb + b] / aim.total <= 0.0:
                continue
            line = line_of(form, aim, d, a, b)
            ray = Ray(
                line.x, line.y, line.z, line.dx, line.dy, line.dz, line.far, line.weight, line.weight * given,
                aim.width,
            )  # fmt: skip
            left, far = follow_through(parts, together, ray, takes, gone)
            met += line.weight * (1.0 - left)
            if far < math.inf:
                off = min(off, abs(far / line.size + form.mouth - form.focus))
    return met * given, off


@kernel
def strike_through(
    parts: AblatingParts,
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
    for k in range(len(parts.lo)):
        stride = min(stride, 0.5 * min(parts.grids[k, 2], parts.grids[k, 3]))
    p, d, takes = np.empty(3), np.empty(3), np.empty(len(parts.lo))
    for c in range(first, len(volume)):
        if way.given[c] <= 0.0:
            continue
        steps = steps_of(way, c, stride, d)
        for k in range(len(parts.lo)):
            takes[k] = volume[c, k] / steps
        for i in range(steps):
            tip_at(way, c, (i + 0.5) / steps, p)
            met, off = shine_through(parts, together, form, p, d, takes, way.given[c] / steps, struck.taken[c])
            struck.met[c] += met
            struck.off[c] = min(struck.off[c], off)
        crowded = False
        for k in range(len(parts.lo)):
            struck.dose[c] = max(struck.dose[c], parts.notes[k, PEAK])
            parts.notes[k, PEAK] = 0.0
            if needs_room(parts.notes[k], parts.lo.shape[3]):
                crowded = True
        if crowded:
            return c + 1
    return len(volume)
