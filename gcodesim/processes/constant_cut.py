"""Forces of a cutter in a cut of known size, without stock: what the calculator tells.

Sums over teeth, heights and angles of the mechanistic model (Altintas 2012, sec. 2.8), integrated by Gauss-Legendre
quadrature between the limits of each tooth's contact, so that nothing depends on a grid. A run uses the same laws and
the same outlines of edges, but reads the engagement from the stock and samples it at fixed angles (`force_kernels`);
tests hold both together. Frame K: X along the feed, Z to the holder, Y to the left; phi clockwise from Y; forces act
on the tool.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from math import ceil, floor, pi
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos, asin, cos, cos_sin, power, sin, tan
from gcodesim.frozen import frozen
from gcodesim.processes.constant_cut_kernels import (
    CHIP,
    COLUMNS,
    COS_KAPPA,
    COS_PHI,
    RADIUS,
    SENSE,
    SIN_KAPPA,
    SIN_PHI,
    SUMS,
    WIDTH,
    add_elements,
)
from gcodesim.processes.drill_point import chisel_push, edge_law
from gcodesim.processes.laws import Kienzle, Law
from gcodesim.processes.uneven import senses_of
from gcodesim.tools.cutter import Cutter
from gcodesim.tools.teeth import helices_of, late_at, starts_of

Array = NDArray[np.float64]

Mode = Literal["up", "down", "slot", "centred"]
MODES: Final = ("up", "down", "slot", "centred")

_HEIGHT_NODES: Final = 24
_ANGLE_NODES: Final = 160
_TURN_ANGLES: Final = 360
_CHIP_HEIGHTS: Final = 49
_UPRIGHT: Final = 1e-12
"""Cosine of kappa below which an edge is part of a cylinder."""


@frozen
class ConstantCut:
    """A cut of constant size: `up` (conventional), `down` (climb), `slot` or `centred`; depth `ap`, width `ae` [m].

    Contact runs over the same angles at every height: up 0 to acos(1 - 2 ae/D), down from 180 degrees minus that to
    180, slot 0 to 180, centred the same way to both sides of 90; `entry` and `exit` [rad] replace them.
    `feed_per_tooth` [m]; `spindle` [rad/s] matters for power and removal rate only.
    """

    mode: Mode
    ap: float
    ae: float
    feed_per_tooth: float
    spindle: float = 0.0
    entry: float | None = None
    exit: float | None = None

    def limits(self, diameter: float) -> tuple[float, float]:
        """First and last angle of contact [rad] of a cutter of `diameter` [m]."""
        swept = acos(min(max(1.0 - 2.0 * self.ae / diameter, -1.0), 1.0))
        half = asin(min(max(self.ae / diameter, 0.0), 1.0))
        first, last = {
            "slot": (0.0, pi),
            "up": (0.0, swept),
            "down": (pi - swept, pi),
            "centred": (0.5 * pi - half, 0.5 * pi + half),
        }[self.mode]
        return (first if self.entry is None else self.entry, last if self.exit is None else self.exit)


@frozen
class RunOut:
    """The axis of the edges stands `offset` [m] beside that of the spindle (Kline and DeVor 1983, eq. 1).

    The radius of a tooth that stands `at` [rad] ahead of tooth 0 at the tip is larger by offset cos(angle - at); for
    even teeth at = 2 pi j / N - 2 z tan(helix) / D. `angle` [rad] is that of the offset.
    """

    offset: float
    angle: float = 0.0

    def growth(self, at: Array) -> Array:
        """By how much the radius of teeth is larger (…) [m] that stand at angles (…) [rad]."""
        grown: Array = self.offset * cos(np.ascontiguousarray(self.angle - at))
        return grown


@frozen(eq=False)
class CutForces:
    """Force (3,) [N] in K, torque [N·m] and power [W], mean over a revolution; `mrr` removal rate [m³/s].

    peak_force (3,): greatest absolute value of each component over the rotation; peak: of its magnitude; likewise
    peak_torque.
    """

    force: Array
    torque: float
    power: float
    mrr: float
    peak_force: Array
    peak: float
    peak_torque: float


@frozen(eq=False)
class _Nodes:
    """Nodes (n,) along an edge: radius, height [m], kappa [rad], width b [m] (weights of the quadrature included)."""

    r: Array
    z: Array
    kappa: Array
    b: Array


@cache
def _legendre(count: int) -> tuple[Array, Array]:
    x, w = np.polynomial.legendre.leggauss(count)
    return x, w


def _quadrature(a: float, b: float, count: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on [a, b]."""
    return _quadratures(np.array([a]), np.array([b]), count)


def _quadratures(a: Array, b: Array, count: int) -> tuple[Array, Array]:
    """Nodes and weights on each of the stretches from a to b (m,), one stretch after another (m count,)."""
    x, w = _legendre(count)
    half, middle = 0.5 * (b - a)[:, None], 0.5 * (a + b)[:, None]
    return (half * x + middle).reshape(-1), (half * w).reshape(-1)


def _pieces(cutter: Cutter, ap: float, lead_angle: float | None) -> Iterator[tuple[Array, float, float]]:
    """Pieces of the edge below `ap` as (row of `Cutter.edge`, lower and upper z [m]); flat bottoms are left out.

    No piece goes on where the helix turns back.
    """
    for row, z0, z1 in _whole_pieces(cutter, ap, lead_angle):
        border = z1 if cutter.up_cut is None else min(max(cutter.up_cut, z0), z1)
        if border > z0:
            yield row, z0, border
        if z1 > border:
            yield row, border, z1


def _whole_pieces(cutter: Cutter, ap: float, lead_angle: float | None) -> Iterator[tuple[Array, float, float]]:
    if lead_angle is not None:
        row = np.array([0.0, cutter.radius, 0.0, lead_angle, lead_angle, ap / sin(lead_angle), 0.0, ap])
        yield row, 0.0, ap
        return
    for row in cutter.edge:
        if row[7] > row[6] and row[6] < ap:
            yield row, float(row[6]), min(float(row[7]), ap)


def _between(row: Array, z0: float, z1: float, lead_angle: float | None) -> _Nodes:
    """Nodes on the part z0..z1 [m] of one piece."""
    return _between_all(row, np.array([z0]), np.array([z1]), lead_angle)


def _between_all(row: Array, z0: Array, z1: Array, lead_angle: float | None) -> _Nodes:
    """Nodes on parts z0..z1 (m,) [m] of one piece, one after another; db = dz / sin(kappa), on arcs radius dkappa."""
    if row[0] > 0.0:
        ends = [acos(np.clip((row[2] - z) / row[0], -1.0, 1.0)) for z in (z0, z1)]
        kappa, w = _quadratures(ends[0], ends[1], _HEIGHT_NODES)
        cosine, sine = cos_sin(kappa)
        return _Nodes(r=row[1] + row[0] * sine, z=row[2] - row[0] * cosine, kappa=kappa, b=row[0] * w)
    z, w = _quadratures(z0, z1, _HEIGHT_NODES)
    kappa = np.full_like(z, row[3])
    slope = 0.0 if lead_angle is not None else cos(float(row[3])) / sin(float(row[3]))
    return _Nodes(r=row[1] + (z - row[2]) * slope, z=z, kappa=kappa, b=w / sin(float(row[3])))


def _uncut(cutter: Cutter, cut: ConstantCut, run_out: RunOut | None, tooth: int, z: Array, sin_phi: Array) -> Array:
    """Radial thickness [m] of the chip of a tooth at heights z (n,); below 0 it passes through air.

    sin_phi (…, n). Teeth that differ take what is left by the deepest of those before them (Kline and DeVor 1983).
    """
    thickness = cut.feed_per_tooth * sin_phi
    if run_out is None and not cutter.uneven:
        return np.maximum(thickness, 0.0)
    teeth = cutter.flutes
    at = starts_of(cutter)[:, None] - late_at(cutter, z)
    growth = np.zeros_like(at) if run_out is None else run_out.growth(at)
    least = teeth * thickness
    for before in range(1, teeth):
        ahead = (tooth + before) % teeth
        gap = float(before) if cutter.pitches is None and cutter.helices is None else _gap(at[ahead] - at[tooth], teeth)
        least = np.minimum(least, gap * thickness + (growth[tooth] - growth[ahead]))
    return least


def _differ(cutter: Cutter, run_out: RunOut | None) -> bool:
    """Whether the teeth of a cutter differ, so that a whole turn has to be looked at."""
    return run_out is not None or (cutter.uneven and cutter.flutes > 1)


def _gap(angle: Array, teeth: int) -> Array:
    """An angle (n,) [rad] from 0 to a turn, in mean pitches."""
    found: Array = (angle - 2.0 * pi * np.floor(angle / (2.0 * pi))) * (teeth / (2.0 * pi))
    return found


def _lag(cutter: Cutter, tooth: int, z: float) -> tuple[float, float]:
    """How late a tooth would be at the tip if its helix at z [m] went on so [rad], and for each metre [rad/m]."""
    slope = 2.0 * tan(helices_of(cutter)[tooth]) / cutter.diameter
    if cutter.up_cut is None or z < cutter.up_cut:
        return 0.0, slope
    return 2.0 * slope * cutter.up_cut, -slope


def _elements(
    nodes: _Nodes, width: Array, phi: Array, chip: Array, sense: Array | float = 1.0, *, along: bool = False
) -> Array:
    """Elements (n, COLUMNS) for the kernel; width, phi and chip have one shape, the last axis that of nodes.

    `along`: chips are as thick already as the edge is fed along its normal.
    """
    out = np.empty((*chip.shape, COLUMNS))
    cos_phi, sin_phi = cos_sin(np.ascontiguousarray(phi))
    cos_kappa, sin_kappa = cos_sin(nodes.kappa)
    cos_kappa[np.abs(cos_kappa) < _UPRIGHT] = 0.0
    out[..., RADIUS], out[..., WIDTH] = nodes.r, width
    out[..., SIN_KAPPA], out[..., COS_KAPPA] = sin_kappa, cos_kappa
    out[..., SIN_PHI], out[..., COS_PHI] = sin_phi, cos_phi
    out[..., SENSE] = sense
    out[..., CHIP] = np.where(chip < 0.0, -1.0, chip if along else chip * sin_kappa)
    return out.reshape(-1, COLUMNS)


def _summed(law: Law, parts: list[Array]) -> tuple[Array, float]:
    """Force (3,) in K and torque of all elements."""
    sums = np.zeros(SUMS)
    elements = np.concatenate(parts) if parts else np.zeros((0, COLUMNS))
    add_elements(np.ascontiguousarray(elements), law.packed, sums)
    return sums[:3], float(sums[3])


def instantaneous_forces(
    cutter: Cutter,
    law: Law,
    cut: ConstantCut,
    theta: Array,
    lead_angle: float | None = None,
    run_out: RunOut | None = None,
) -> tuple[Array, Array]:
    """Forces (n, 3) [N] in K and torques (n,) [N·m] with tooth 0 at angles `theta` (n,) [rad] at the tip.

    A tooth lags by 2 z tan(helix) / D at height z; each stretch of edge between the limits of contact is integrated
    on its own. lead_angle [rad]: kappa of an edge at constant radius, instead of the cutter's own outline.
    """
    start, end = cut.limits(cutter.diameter)
    at = starts_of(cutter)
    parts, whose = [np.zeros((0, COLUMNS))], [np.zeros(0, dtype=np.int64)]  # elements, and of which angle each is
    for row, z0, z1 in _pieces(cutter, cut.ap, lead_angle):
        for tooth in range(cutter.flutes):
            late, lag = _lag(cutter, tooth, 0.5 * (z0 + z1))
            tips = theta + float(at[tooth]) - late
            found = [
                (i, a, b) for i, tip in enumerate(tips.tolist()) for a, b in _contacts(tip, lag, start, end, z0, z1)
            ]
            if not found:
                continue
            of_stretch = np.array([i for i, _, _ in found])
            low, high = np.array([(a, b) for _, a, b in found]).T
            nodes = _between_all(row, low, high, lead_angle)
            of_node = np.repeat(of_stretch, _HEIGHT_NODES)
            phi = tips[of_node] - lag * nodes.z
            chip = _uncut(cutter, cut, run_out, tooth, nodes.z, sin(phi))
            parts.append(_elements(nodes, nodes.b, phi, chip, senses_of(cutter, nodes.z)))
            whose.append(of_node)
    angles = np.concatenate(whose)
    order = np.argsort(angles, kind="stable")
    elements, bounds = np.concatenate(parts)[order], np.searchsorted(angles[order], np.arange(len(theta) + 1))
    law = edge_law(cutter, law)
    sums = [_summed(law, [elements[a:b]]) for a, b in pairwise(bounds.tolist())]
    return np.array([force for force, _ in sums]).reshape(-1, 3), np.array([torque for _, torque in sums])


def _contacts(tip: float, lag: float, start: float, end: float, z0: float, z1: float) -> Iterator[tuple[float, float]]:
    """Stretches of height (a, b) in z0..z1 where a tooth that is at angle `tip` at the tool's tip is in contact."""
    limits = [z0, z1]
    if lag != 0.0:
        low, high = sorted((tip - lag * z0, tip - lag * z1))
        for limit in (start, end):
            first, last = ceil((low - limit) / (2.0 * pi)), floor((high - limit) / (2.0 * pi))
            limits += [(tip - limit - 2.0 * pi * turn) / lag for turn in range(first, last + 1)]
    limits.sort()
    for a, b in pairwise(limits):
        if b > a:
            phi = (tip - lag * 0.5 * (a + b)) % (2.0 * pi)
            if start <= phi <= end:
                yield a, b


@frozen(eq=False)
class OneTurn:
    """Forces (n, 3) [N] in K and torque (n,) [N·m] with tooth 0 at `angle` (n,) [rad]."""

    angle: Array
    force: Array
    torque: Array


def revolution(
    cutter: Cutter,
    law: Law,
    cut: ConstantCut,
    lead_angle: float | None = None,
    run_out: RunOut | None = None,
    angles: int = _TURN_ANGLES,
) -> OneTurn:
    """One revolution, at `angles` even steps."""
    theta: Array = np.arange(angles, dtype=np.float64) * (2.0 * pi / angles)
    force, torque = instantaneous_forces(cutter, law, cut, theta, lead_angle, run_out)
    return OneTurn(angle=theta, force=force, torque=torque)


def end_mill_forces(
    cutter: Cutter,
    law: Law,
    cut: ConstantCut,
    *,
    lead_angle: float | None = None,
    run_out: RunOut | None = None,
    peaks: bool = True,
) -> CutForces:
    """Mean and peak forces of `cutter` in a cut of constant size.

    The mean over a revolution does not depend on the helix; kappa follows the outline of the cutter (flat bottoms do
    not cut in a horizontal feed), or is `lead_angle` [rad] at constant radius. Power is torque times `cut.spindle`.
    """
    start, end = cut.limits(cutter.diameter)
    force, torque, section = np.zeros(3), 0.0, 0.0
    if end > start and cut.ap > 0.0:
        phi, w = _quadrature(start, end, _ANGLE_NODES)
        alike = 1 if _differ(cutter, run_out) else cutter.flutes
        share = alike / (2.0 * pi)
        parts: list[Array] = []
        for row, z0, z1 in _pieces(cutter, cut.ap, lead_angle):
            nodes = _between(row, z0, z1, lead_angle)
            angle = np.broadcast_to(phi[:, None], (len(phi), len(nodes.z)))
            width = share * w[:, None] * nodes.b[None, :]
            for tooth in range(cutter.flutes // alike):
                chip = _uncut(cutter, cut, run_out, tooth, nodes.z, sin(np.ascontiguousarray(angle)))
                parts.append(_elements(nodes, width, angle, chip, senses_of(cutter, nodes.z)))
            section += float((nodes.r * nodes.b * sin(nodes.kappa)).sum()) * (cos(start) - cos(end))
        force, torque = _summed(edge_law(cutter, law), parts)
    feed = cut.feed_per_tooth * cutter.flutes * cut.spindle / (2.0 * pi)
    peak_force, peak, peak_torque = np.zeros(3), 0.0, 0.0
    if peaks and end > start and cut.ap > 0.0:
        theta = _peak_angles(cutter, cut, _differ(cutter, run_out))
        now, moment = instantaneous_forces(cutter, law, cut, theta, lead_angle, run_out)
        peak_force = np.abs(now).max(axis=0)
        peak = float(np.sqrt((now * now).sum(axis=1)).max())
        peak_torque = max(float(moment.max()), 0.0)
    return CutForces(
        force=force, torque=torque, power=torque * cut.spindle, mrr=section * feed,
        peak_force=peak_force, peak=peak, peak_torque=peak_torque,
    )  # fmt: skip


def _peak_angles(cutter: Cutter, cut: ConstantCut, whole_turn: bool) -> Array:
    """Angles of tooth 0 [rad] at which peaks are looked for: over one pitch, and beside those of entry and exit.

    A tooth that comes in may also lower a component of the force: then the most is what the others give just before.
    """
    pitch = 2.0 * pi / cutter.flutes
    start, end = cut.limits(cutter.diameter)
    heights = [0.0, cut.ap] if cutter.up_cut is None else [0.0, min(cutter.up_cut, cut.ap), cut.ap]
    turns, late = cutter.flutes if whole_turn else 1, late_at(cutter, np.array(heights))
    even = [i * pitch / _TURN_ANGLES for i in range(_TURN_ANGLES)]
    found = []
    for tooth, at in enumerate(starts_of(cutter)[:turns].tolist()):
        corners = [
            limit + aside + lag for limit in (start, end) for aside in (-1e-9, 1e-9) for lag in late[tooth].tolist()
        ]
        found += [angle + tooth * pitch for angle in even] + [angle - at for angle in corners]
    return np.array(found)


def tooth_chips(
    cutter: Cutter, cut: ConstantCut, run_out: RunOut | None = None, lead_angle: float | None = None
) -> Array:
    """Greatest chip thickness (flutes,) [m] of each tooth within the angles and heights of contact."""
    start, end = cut.limits(cutter.diameter)
    most = np.zeros(cutter.flutes)
    if end <= start:
        return most
    phi = np.append(np.linspace(start, end, _TURN_ANGLES + 1), min(max(0.5 * pi, start), end))
    for row, z0, z1 in _pieces(cutter, cut.ap, lead_angle):
        z = np.linspace(z0, z1, _CHIP_HEIGHTS)
        sine = np.full_like(z, sin(row[3]))
        if row[0] > 0.0:
            along = np.clip((row[2] - z) / row[0], -1.0, 1.0)
            sine = np.sqrt(1.0 - along * along)
        for tooth in range(cutter.flutes):
            chip = _uncut(cutter, cut, run_out, tooth, z, sin(phi)[:, None]) * sine
            most[tooth] = max(most[tooth], float(chip.max()))
    return most


def plunge_forces(cutter: Cutter, law: Law, *, feed_per_rev: float, spindle: float = 0.0) -> CutForces:
    """Forces of straight plunging or drilling in solid material, edges in to the full diameter; constant in time.

    A drill: two lips (or `flutes`), each D / (2 sin sigma) long with h = f_z sin sigma, sigma half the point angle;
    thrust from the normal force, torque from the tangential one at D/4 on average; and its chisel edge, see
    `tools.chisel_edge`. A flat end mill: bottom edges with kappa = 0, db = dr and h = f_z.
    """
    c = feed_per_rev / cutter.flutes
    parts: list[Array] = []
    for row in cutter.edge:
        if row[0] > 0.0:
            kappa, w = _quadrature(float(row[3]), float(row[4]), _HEIGHT_NODES)
            nodes = _Nodes(r=row[1] + row[0] * sin(kappa), z=kappa, kappa=kappa, b=row[0] * w)
        elif abs(cos(float(row[3]))) > 1e-12:
            s, w = _quadrature(0.0, float(row[5]), _HEIGHT_NODES)
            nodes = _Nodes(r=row[1] + s * cos(float(row[3])), z=s, kappa=np.full_like(s, row[3]), b=w)
        else:
            continue
        width, none = row[8] * nodes.b * cutter.flutes, np.zeros_like(nodes.kappa)
        parts.append(_elements(nodes, width, none, c * cos(nodes.kappa), along=True))
    force, torque = _summed(edge_law(cutter, law), parts)
    force[:2] = 0.0  # all lips together push nowhere to the side
    if cutter.chisel_length > 0.0:
        force[2] += chisel_push(cutter, law)
    magnitude = abs(float(force[2]))
    return CutForces(
        force=force, torque=torque, power=torque * spindle,
        mrr=pi * (cutter.radius * cutter.radius) * feed_per_rev * spindle / (2.0 * pi),
        peak_force=np.abs(force), peak=magnitude, peak_torque=torque,
    )  # fmt: skip


def mean_chip_thickness(cutter: Cutter, cut: ConstantCut, lead_angle: float | None = None) -> float:
    """h_m = c 2 ae / (D phi_s) ap / l [m]: averaged over the angle of contact phi_s and the length l of edge below ap.

    On a straight edge ap / l is sin(kappa); ae / D is (cos(entry) - cos(exit)) / 2.
    """
    start, end = cut.limits(cutter.diameter)
    length = sum(float(_between(*piece, lead_angle).b.sum()) for piece in _pieces(cutter, cut.ap, lead_angle))
    if end <= start or length <= 0.0:
        return 0.0
    return cut.feed_per_tooth * (cos(start) - cos(end)) / (end - start) * min(cut.ap / length, 1.0)


def handbook_power(law: Kienzle, cutter: Cutter, cut: ConstantCut, lead_angle: float | None = None) -> float:
    """kc(h_m) ap ae v_f [W], as handbooks give it: never below the exact mean (Jensen), equal only for mc = 0."""
    h = mean_chip_thickness(cutter, cut, lead_angle)
    if h <= 0.0:
        return 0.0
    start, end = cut.limits(cutter.diameter)
    feed = cut.feed_per_tooth * cutter.flutes * cut.spindle / (2.0 * pi)
    return law.specific_force(h) * cut.ap * cutter.radius * (cos(start) - cos(end)) * feed


def handbook_pressure(law: Kienzle, diameter: float, cut: ConstantCut) -> tuple[float, float]:
    """Mean chip thickness [m] of an upright edge, and kc [Pa] there, as handbooks take them for the power."""
    start, end = cut.limits(diameter)
    h = cut.feed_per_tooth * (cos(start) - cos(end)) / (end - start)
    return h, law.specific_force(h)


def chip_force(law: Law, *, width: float, chip: float) -> tuple[float, float, float]:
    """Tangential, normal and axial force [N] on one edge `width` [m] wide at chip thickness `chip` [m].

    A chip of zero thickness leaves the edge force alone; a negative one is no contact.
    """
    if chip < 0.0 or width <= 0.0:
        return 0.0, 0.0, 0.0
    force = [float(width * ((k * power(chip, p) if chip > 0.0 else 0.0) + e)) for k, p, e in law.packed]
    return force[0], force[1], force[2]
