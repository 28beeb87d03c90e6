"""What acts at a distance on the columns of a stock: a beam of rays that takes material where each ray strikes first.

A beam is a bundle of rays about an axis. Each carries its share of the whole, by where it lies in the footprint. At a
place a ray gives its column a dose, and takes from it the volume that belongs to its share; what a column cannot give
goes on along the ray to whatever stands behind. So volume and energy are kept, a slope gets what falls on it (the
cosine of the incidence comes by itself), and a place in the shade of another gets nothing.

Rays stand where the columns are: in the plane through the place that the axis strikes, each column has the same
number of them, so an even floor stays even.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.power_kernels import exp
from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH_SHIFT, Columns, Field
from gcodesim.material.removal_kernels import subtract
from gcodesim.material.wall_kernels import shorten_walls

Array = NDArray[np.float64]

GAUSSIAN, TOP_HAT, FLAT = 0.0, 1.0, 2.0  # profiles of a footprint

GAUSSIAN_REACH = 1.7  # radii beyond which 0.3 % of a Gaussian beam lies, which is left out
NARROWEST = 0.1  # of the radius at the focus: no beam narrows to less
ACROSS = 3.0  # rays across the radius of a Gaussian beam, at least
TO_THE_RIM = 10.0  # of one with a sharp rim
MOST_RAYS = 8  # across a column
STEEP = 0.3  # cosine of the incidence on a level plane, below which rays stand in a plane across the beam
PARALLEL = 1.0e-6  # a direction with less beside Z is along Z
THIN = 1.0e-12  # [m]


class BeamForm(NamedTuple):
    """The shape of a beam, seen from the tip of its tool; lengths [m].

    `radius` at `focus`, which is so far beyond the tip; at the distance s from there it is
    radius sqrt(1 + (s / rayleigh)²) + slope s. It begins at `mouth` (below zero: before the tip) and ends at `reach`.
    """

    profile: float
    radius: float
    focus: float
    rayleigh: float
    slope: float
    mouth: float
    reach: float


class BeamWay(NamedTuple):
    """c pieces of the way of a beam: tips (c, 3) [m] at both ends, unit vectors (c, 3) from the tip to the holder;
    `volume` (c,) [m³] that it could take during each and `given` (c,), energy [J] or whatever its dose is made of."""

    starts: Array
    ends: Array
    axes: Array
    volume: Array
    given: Array


class Struck(NamedTuple):
    """What became of c pieces, each (c,): volume taken [m³]; what of `given` met material; the least distance [m] from
    the focus to where it met some, infinite where it met none; the greatest dose of a column so far [per m²]."""

    taken: Array
    met: Array
    off: Array
    dose: Array


class StruckParts(NamedTuple):
    """What became of c pieces in m stocks: `taken` (c, m) [m³]; (c,) what of `given` met material, the least distance
    [m] from the focus to where it did (infinite: nowhere), and the greatest dose of a column so far [per m²]."""

    taken: Array
    met: Array
    off: Array
    dose: Array


class Ray(NamedTuple):
    """A ray from (x, y, z) [m] in the direction (dx, dy, dz), over the distance `far` [m]; `length` [m] is the height
    of a column that it could take, `dose` [per m²] what it gives to one; `width` [m] is the side of its section."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float
    far: float
    length: float
    dose: float
    width: float


class Ablating(NamedTuple):
    """What a beam acts on: the field, the `dose` (nx, ny) [per m²] of its columns so far, the dose that goes by before
    material is taken; `notes` (2,): the greatest dose of a column, and whether one had no room for an interval (1), or
    would have none for the next cut into its side (2)."""

    field: Field
    dose: Array
    threshold: float
    notes: Array


PEAK, CROWDED = 0, 1  # of the notes
MOST_INTERVALS, MOST_ACROSS = 16, 64  # more of them for cuts into the sides of columns, one above the other


@kernel
def radius_at(form: BeamForm, s: float) -> float:
    """The radius [m] of a beam at the distance s [m] beyond the tip."""
    away = s - form.focus
    widened = form.radius * math.sqrt(1.0 + (away / form.rayleigh) * (away / form.rayleigh)) + form.slope * away
    return max(widened, NARROWEST * form.radius)


@kernel
def growth_at(form: BeamForm, s: float) -> float:
    """How fast the radius grows with the distance [-]."""
    away = s - form.focus
    u = away / form.rayleigh
    if radius_at(form, s) <= NARROWEST * form.radius:
        return 0.0
    return form.radius * u / form.rayleigh / math.sqrt(1.0 + u * u) + form.slope


@kernel
def share_within(profile: float, u: float) -> float:
    """The share of a beam within u of its radius.

    Gaussian: 1 - exp(-2 u²), the radius is where the intensity is 1/e² of the greatest. Top hat: u². Flat: the
    distribution whose sum along any line is the same, 1 - sqrt(1 - u²) (Archimedes' hat box), so that a jet that moves
    leaves a level floor.
    """
    if profile == GAUSSIAN:
        return 1.0 - exp(-2.0 * u * u)
    inside = min(u, 1.0)
    if profile == TOP_HAT:
        return inside * inside
    return 1.0 - math.sqrt(1.0 - inside * inside)


@kernel
def weight_at(profile: float, radius: float, r: float, spread: float) -> float:
    """The density [per m²] of a beam at the distance r from its axis, over a ring as wide as `spread` [m]."""
    inner, outer = max(r - 0.5 * spread, 0.0), r + 0.5 * spread
    area = math.pi * (outer * outer - inner * inner)
    return (share_within(profile, outer / radius) - share_within(profile, inner / radius)) / area


@kernel
def topmost(columns: Columns, i: int, j: int, low: float, high: float) -> tuple[int, float]:
    """The highest interval of a column with material between `low` and `high` [m], and the top of that; -1: none."""
    lo, hi, count = columns
    for k in range(count[i, j] - 1, -1, -1):
        if hi[i, j, k] - lo[i, j, k] <= THIN:
            continue
        if lo[i, j, k] < high and hi[i, j, k] > low:
            return k, min(hi[i, j, k], high)
    return -1, 0.0


@kernel
def lowest(columns: Columns, i: int, j: int, low: float, high: float) -> tuple[int, float]:
    """The lowest interval of a column with material between `low` and `high` [m], and the bottom of that; -1: none."""
    lo, hi, count = columns
    for k in range(count[i, j]):
        if hi[i, j, k] - lo[i, j, k] <= THIN:
            continue
        if lo[i, j, k] < high and hi[i, j, k] > low:
            return k, max(lo[i, j, k], low)
    return -1, 0.0


@kernel
def take(on: Ablating, i: int, j: int, k: int, bottom: float, top: float) -> tuple[float, float]:
    """Take [bottom, top] out of interval k of a column: length that is gone, and with it that of walls [m].

    Where the column has no room for one more interval, as much is taken from the end of the interval.
    """
    columns = on.field.columns
    lo, hi = columns.lo[i, j, k], columns.hi[i, j, k]
    gone = subtract(columns, i, j, bottom, top)
    if gone < 0.0:
        length = top - bottom
        on.notes[CROWDED] = max(on.notes[CROWDED], 1.0)
        if hi - top <= bottom - lo:
            gone = subtract(columns, i, j, hi - length, hi)
        else:
            gone = subtract(columns, i, j, lo, lo + length)
    if gone <= 0.0:
        return 0.0, 0.0
    on.field.dirty[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = 1
    return gone, gone + shorten_walls(on.field.walls, i, j, gone)


@kernel
def strike_column(
    on: Ablating, i: int, j: int, entry: float, leave: float, ray: Ray, share: float, across: bool
) -> tuple[float, float, float]:
    """A ray passes through a column, from height `entry` to `leave` [m], with the `share` of it that is left.

    Returns the share that is left behind the column, the length that is gone [m], and the height where it met
    material, not a number where it met none. Downwards it eats from above, upwards from below; a ray that comes in
    through the side, as one does that goes `across`, takes no more than lies on its way.
    """
    columns = on.field.columns
    met, gone_all, came = math.nan, 0.0, share
    down = leave <= entry
    for _ in range(64):
        if down:
            k, at = topmost(columns, i, j, leave, entry)
        else:
            k, at = lowest(columns, i, j, entry, leave)
        if k < 0:
            break
        if met != met:
            met = at
            before, after = on.dose[i, j], on.dose[i, j] + share * ray.dose
            if on.threshold > 0.0 and ray.dose > 0.0:
                share = min(share, max(after - max(before, on.threshold), 0.0) / ray.dose)
        if share * ray.length <= 0.0:
            share = 0.0
            break
        lo, hi = columns.lo[i, j, k], columns.hi[i, j, k]
        end = lo if down else hi
        side = across or ((at < hi) if down else (at > lo))
        if side:
            end = max(lo, leave) if down else min(hi, leave)
        wanted, room = share * ray.length, abs(at - end)
        part = min(wanted, room)
        gone, counted = take(on, i, j, k, at - part if down else at, at if down else at + part)
        gone_all += counted
        if side and columns.number[i, j] == columns.lo.shape[2]:
            on.notes[CROWDED] = 2.0  # the next cut into its side finds no room
        share = 0.0 if wanted <= room or gone <= 0.0 else max(share - gone / ray.length, 0.0)
        if share <= 0.0:
            break
    if met == met:
        on.dose[i, j] += (came - share) * ray.dose
        on.notes[PEAK] = max(on.notes[PEAK], on.dose[i, j])
    return share, gone_all, met


@kernel
def follow_ray(on: Ablating, ray: Ray) -> tuple[float, float, float]:
    """One ray through the field: the share that met nothing, the length [m] of column that is gone, and how far along
    the ray [m] it first met material (infinite: not at all).

    One that goes across the columns acts on as much of their height as its own section has, since it stays as high.
    """
    grid = on.field.grid
    nx, ny = on.field.columns.number.shape
    first, gone_all = math.inf, 0.0
    if abs(ray.dx) < PARALLEL and abs(ray.dy) < PARALLEL:
        i, j = math.floor((ray.x - grid.x) / grid.dx), math.floor((ray.y - grid.y) / grid.dy)
        if i < 0 or j < 0 or i >= nx or j >= ny:
            return 1.0, 0.0, first
        left, gone, met = strike_column(on, i, j, ray.z, ray.z + ray.dz * ray.far, ray, 1.0, False)
        return left, gone, abs(met - ray.z) if met == met else first
    begin, end = 0.0, ray.far  # where the ray is over the grid
    for axis in range(2):
        at, d = (ray.x, ray.dx) if axis == 0 else (ray.y, ray.dy)
        low = grid.x if axis == 0 else grid.y
        high = low + (grid.dx * nx if axis == 0 else grid.dy * ny)
        if d == 0.0:
            if at < low or at >= high:
                return 1.0, 0.0, first
            continue
        a, b = (low - at) / d, (high - at) / d
        begin, end = max(begin, min(a, b)), min(end, max(a, b))
    if begin >= end:
        return 1.0, 0.0, first
    left, t = 1.0, begin
    nudge = 1.0e-9 * min(grid.dx, grid.dy)
    i = min(max(math.floor((ray.x + ray.dx * (t + nudge) - grid.x) / grid.dx), 0), nx - 1)
    j = min(max(math.floor((ray.y + ray.dy * (t + nudge) - grid.y) / grid.dy), 0), ny - 1)
    step_i, step_j = (1 if ray.dx > 0.0 else -1), (1 if ray.dy > 0.0 else -1)
    across = ray.width > 0.0 and abs(ray.dz) < STEEP
    height = ray.width / math.sqrt(ray.dx * ray.dx + ray.dy * ray.dy) if across else 0.0
    while t < end:
        to_x = (grid.x + grid.dx * (i + (step_i > 0)) - ray.x) / ray.dx if ray.dx != 0.0 else math.inf
        to_y = (grid.y + grid.dy * (j + (step_j > 0)) - ray.y) / ray.dy if ray.dy != 0.0 else math.inf
        until = max(min(to_x, to_y, end), t)
        entry, leave = ray.z + ray.dz * t, ray.z + ray.dz * until
        if across and abs(leave - entry) < height:
            middle, half = 0.5 * (entry + leave), 0.5 * height if leave <= entry else -0.5 * height
            entry, leave = middle + half, middle - half
        if leave == entry:
            leave = entry - nudge
        left, gone, met = strike_column(on, i, j, entry, leave, ray, left, across)
        gone_all += gone
        if met == met and first == math.inf:
            first = t if across or ray.dz == 0.0 else max(t, (met - ray.z) / ray.dz)
        if left <= 0.0:
            return 0.0, gone_all, first
        t = until
        if to_x <= to_y:
            i += step_i
        else:
            j += step_j
        if i < 0 or j < 0 or i >= nx or j >= ny:
            break
    return left, gone_all, first


@kernel
def distance_to(on: Ablating, p: Array, d: Array, form: BeamForm) -> float:
    """How far [m] beyond the tip at p (3,) the axis along d (3,) first strikes material; infinite: nowhere."""
    begin, far = form.mouth, form.reach - form.mouth
    axis = Ray(p[0] + d[0] * begin, p[1] + d[1] * begin, p[2] + d[2] * begin, d[0], d[1], d[2], far, 0.0, 0.0, 0.0)
    return begin + follow_ray(on, axis)[2]


class Bundle(NamedTuple):
    """Where the rays of a beam stand: at `corner` + a · first + b · second (3,), a in 0 … na - 1, b in 0 … nb - 1."""

    corner: Array
    first: Array
    second: Array
    na: int
    nb: int


@kernel
def length_of(v: Array) -> float:
    """The length of a vector (3,)."""
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def bundle_of(field: Field, centre: Array, d: Array, finest: float, outer: float) -> Bundle:
    """The rays of a beam through `centre` (3,) along d (3,), out to `outer` and at most `finest` [m] apart."""
    grid = field.grid
    if abs(d[2]) >= STEEP:
        per = min(max(1, math.ceil(max(grid.dx, grid.dy) / finest)), MOST_RAYS)
        sx, sy = grid.dx / per, grid.dy / per
        hx = outer * math.sqrt(1.0 + (d[0] / d[2]) * (d[0] / d[2])) + sx
        hy = outer * math.sqrt(1.0 + (d[1] / d[2]) * (d[1] / d[2])) + sy
        a0, a1 = math.floor((centre[0] - hx - grid.x) / sx), math.ceil((centre[0] + hx - grid.x) / sx)
        b0, b1 = math.floor((centre[1] - hy - grid.y) / sy), math.ceil((centre[1] + hy - grid.y) / sy)
        corner = np.array([grid.x + (a0 + 0.5) * sx, grid.y + (b0 + 0.5) * sy, centre[2]])
        return Bundle(corner, np.array([sx, 0.0, 0.0]), np.array([0.0, sy, 0.0]), a1 - a0, b1 - b0)
    step = min(0.5 * min(grid.dx, grid.dy), finest)
    level = math.sqrt(d[0] * d[0] + d[1] * d[1])
    e = np.array([-d[1] / level, d[0] / level, 0.0])
    f = np.array([-d[2] * e[1], d[2] * e[0], d[0] * e[1] - d[1] * e[0]])
    half = math.ceil(outer / step + 0.5)
    corner = centre - half * step * (e + f)
    return Bundle(corner, e * step, f * step, 2 * half + 1, 2 * half + 1)


class BeamAim(NamedTuple):
    """A beam that stands at one place: its rays, how much of it each has (`weights` (na · nb,), together `total`), the
    side of the section of each, `width` [m], and where its axis first strikes: `centre` (3,), at the distance `s` [m]
    beyond the tip, with its `radius` and `growth` there."""

    bundle: Bundle
    width: float
    weights: Array
    total: float
    centre: Array
    s: float
    radius: float
    growth: float


class RayLine(NamedTuple):
    """Where a ray goes: from (x, y, z) [m] in the direction (dx, dy, dz), over the distance `far` [m], on which the
    axis comes 1 / `size` as far; `weight` is its share of the beam."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float
    far: float
    size: float
    weight: float


@kernel
def aim_at(field: Field, form: BeamForm, p: Array, d: Array, s: float, widest: float) -> BeamAim:
    """A beam with its tip at p (3,) [m], in the direction d (3,), whose axis strikes at the distance s [m] beyond it.

    Its rays stand by the columns of `field`, at most `widest` [m] apart.
    """
    if s == math.inf:
        s = form.focus
    radius, growth = radius_at(form, s), growth_at(form, s)
    centre = np.array([p[0] + d[0] * s, p[1] + d[1] * s, p[2] + d[2] * s])
    outer = radius * (GAUSSIAN_REACH if form.profile == GAUSSIAN else 1.0)
    finest = min(radius / (ACROSS if form.profile == GAUSSIAN else TO_THE_RIM), widest)
    bundle = bundle_of(field, centre, d, finest, outer)
    apart = math.sqrt(length_of(bundle.first) * length_of(bundle.second))
    spread = max(apart, 1.0e-3 * radius)
    level = bundle.first[2] == 0.0 and bundle.second[2] == 0.0
    width = apart * math.sqrt(abs(d[2])) if level else apart
    total = 0.0
    weights = np.empty(bundle.na * bundle.nb)
    for a in range(bundle.na):
        for b in range(bundle.nb):
            qx = bundle.corner[0] + a * bundle.first[0] + b * bundle.second[0] - centre[0]
            qy = bundle.corner[1] + a * bundle.first[1] + b * bundle.second[1] - centre[1]
            qz = bundle.corner[2] + a * bundle.first[2] + b * bundle.second[2] - centre[2]
            along = qx * d[0] + qy * d[1] + qz * d[2]
            r = math.sqrt(max(qx * qx + qy * qy + qz * qz - along * along, 0.0))
            # the ring of a ray beyond a sharp rim still has a part of the beam, and a flat one is densest there
            w = weight_at(form.profile, radius, r, spread) if r < outer + 0.5 * spread else 0.0
            weights[a * bundle.nb + b] = w
            total += w
    if total <= 0.0:  # thinner than the rays stand apart: its axis alone
        bundle = Bundle(centre, np.zeros(3), np.zeros(3), 1, 1)
        weights[0] = total = 1.0
        width = math.sqrt(math.pi) * radius
    return BeamAim(bundle, width, weights, total, centre, s, radius, growth)


@kernel
def line_of(form: BeamForm, aim: BeamAim, d: Array, a: int, b: int) -> RayLine:
    """The ray (a, b) of a beam along d (3,)."""
    bundle, centre = aim.bundle, aim.centre
    x = bundle.corner[0] + a * bundle.first[0] + b * bundle.second[0]
    y = bundle.corner[1] + a * bundle.first[1] + b * bundle.second[1]
    z = bundle.corner[2] + a * bundle.first[2] + b * bundle.second[2]
    qx, qy, qz = x - centre[0], y - centre[1], z - centre[2]
    along = qx * d[0] + qy * d[1] + qz * d[2]
    g = aim.growth / aim.radius
    dx, dy, dz = (
        d[0] + g * (qx - along * d[0]),
        d[1] + g * (qy - along * d[1]),
        d[2] + g * (qz - along * d[2]),
    )
    size = math.sqrt(dx * dx + dy * dy + dz * dz)
    dx, dy, dz = dx / size, dy / size, dz / size
    back = (aim.s + along - form.mouth) * size
    far = (form.reach - form.mouth) * size
    weight = aim.weights[a * bundle.nb + b] / aim.total
    return RayLine(x - back * dx, y - back * dy, z - back * dz, dx, dy, dz, far, size, weight)


@kernel
def shine(on: Ablating, form: BeamForm, p: Array, d: Array, volume: float, given: float) -> tuple[float, float, float]:
    """A beam stands with its tip at p (3,) [m], in the direction d (3,), and could take `volume` [m³].

    Returns the volume taken, the part of `given` that met material, and the least distance [m] from the focus to
    where it did.
    """
    area = on.field.grid.dx * on.field.grid.dy
    aim = aim_at(on.field, form, p, d, distance_to(on, p, d, form), math.inf)
    gone, met, off = 0.0, 0.0, math.inf
    for a in range(aim.bundle.na):
        for b in range(aim.bundle.nb):
            if aim.weights[a * aim.bundle.nb + b] / aim.total <= 0.0:
                continue
            line = line_of(form, aim, d, a, b)
            ray = Ray(
                line.x, line.y, line.z, line.dx, line.dy, line.dz, line.far,
                line.weight * volume / area, line.weight * given / area, aim.width,
            )  # fmt: skip
            left, length, far = follow_ray(on, ray)
            gone += length
            met += line.weight * (1.0 - left)
            if far < math.inf:
                off = min(off, abs(far / line.size + form.mouth - form.focus))
    return gone * area, met * given, off


@kernel
def steps_of(way: BeamWay, c: int, stride: float, d: Array) -> int:
    """In how many steps of at most `stride` [m] piece `c` is gone through; its direction (3,) is left in `d`."""
    length = 0.0
    for n in range(3):
        d[n] = -way.axes[c, n]
        length += (way.ends[c, n] - way.starts[c, n]) * (way.ends[c, n] - way.starts[c, n])
    return max(1, math.ceil(math.sqrt(length) / stride))


@kernel
def tip_at(way: BeamWay, c: int, share: float, p: Array) -> None:
    """The tip `p` (3,) [m] at a share of piece `c`."""
    for n in range(3):
        p[n] = way.starts[c, n] + share * (way.ends[c, n] - way.starts[c, n])


@kernel(inlined=True)
def needs_room(notes: Array, room: int) -> bool:
    """Whether columns with room for so many intervals are to get more."""
    return (notes[CROWDED] > 0.0 and room < MOST_INTERVALS) or (notes[CROWDED] > 1.0 and room < MOST_ACROSS)


@kernel
def strike(on: Ablating, form: BeamForm, way: BeamWay, first: int, struck: Struck) -> int:
    """Pieces `first` … of a beam's way in order; the index of the piece before which columns get more room, or their
    number. What is `struck` is added to. Each piece is gone through in steps of at most a column."""
    field = on.field
    grid = field.grid
    room = field.columns.lo.shape[2]
    stride = 0.5 * min(grid.dx, grid.dy)
    p, d = np.empty(3), np.empty(3)
    for c in range(first, len(way.volume)):
        if way.given[c] <= 0.0:
            continue
        steps = steps_of(way, c, stride, d)
        for k in range(steps):
            tip_at(way, c, (k + 0.5) / steps, p)
            taken, met, off = shine(on, form, p, d, way.volume[c] / steps, way.given[c] / steps)
            struck.taken[c] += taken
            struck.met[c] += met
            struck.off[c] = min(struck.off[c], off)
        struck.dose[c] = on.notes[PEAK]
        on.notes[PEAK] = 0.0
        if needs_room(on.notes, room):
            return c + 1
    return len(way.volume)
