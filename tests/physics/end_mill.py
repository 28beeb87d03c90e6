"""Forces of an end mill or drill in a cut of known size, without stock: the truth for the kernels.

Sums over teeth, heights and angles of the mechanistic model (Altintas 2012, sec. 2.8), integrated by Gauss-Legendre
quadrature between the limits of each tooth's contact. Frame K: X along the feed, Z to the holder, Y to the left;
phi clockwise from Y; forces act on the tool.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import acos, cos, pi, sin, tan
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gcodesim.processes.laws import Kienzle, Law
from gcodesim.tools.cutter import Cutter
from gcodesim.units import MM

Array = NDArray[np.float64]

_HEIGHT_NODES = 24
_ANGLE_NODES = 160
_PEAK_ANGLES = 360


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantCut:
    """A cut of constant size: `up` (conventional), `down` (climb) or `slot`; depth `ap`, width `ae` [m].

    Contact runs over the same angles at every height: up 0 to acos(1 - 2 ae/D), down from 180 degrees minus that to
    180, slot 0 to 180. `feed_per_tooth` [m]; `spindle` [rad/s] matters for power and removal rate only.
    """

    mode: Literal["up", "down", "slot"]
    ap: float
    ae: float
    feed_per_tooth: float
    spindle: float = 0.0

    def limits(self, diameter: float) -> tuple[float, float]:
        """First and last angle of contact [rad] of a cutter of `diameter` [m]."""
        if self.mode == "slot":
            return 0.0, pi
        swept = acos(min(max(1.0 - 2.0 * self.ae / diameter, -1.0), 1.0))
        return (0.0, swept) if self.mode == "up" else (pi - swept, pi)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Elements:
    """Nodes along an edge: radius, height [m], kappa [rad], width b [m] (weights of the quadrature included)."""

    r: Array
    z: Array
    kappa: Array
    b: Array

    def part(self, chosen: slice) -> _Elements:
        return _Elements(r=self.r[chosen], z=self.z[chosen], kappa=self.kappa[chosen], b=self.b[chosen])


def _nodes(a: float, b: float, count: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on [a, b]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (b - a) * x + 0.5 * (a + b), 0.5 * (b - a) * w


def _pieces(cutter: Cutter, ap: float, lead_angle: float | None) -> Iterator[tuple[Array, float, float]]:
    """Pieces of the edge below `ap` as (row of `Cutter.edge`, lower and upper z [m]); flat bottoms are left out."""
    if lead_angle is not None:
        row = np.array([0.0, cutter.radius, 0.0, lead_angle, lead_angle, ap / sin(lead_angle), 0.0, ap])
        yield row, 0.0, ap
        return
    for row in cutter.edge:
        if row[7] > row[6] and row[6] < ap:
            yield row, float(row[6]), min(float(row[7]), ap)


def _between(row: Array, z0: float, z1: float, lead_angle: float | None) -> _Elements:
    """Nodes on the part z0..z1 [m] of one piece; db = dz / sin(kappa), on arcs db = radius dkappa."""
    if row[0] > 0.0:
        ends = [acos(min(max((row[2] - z) / row[0], -1.0), 1.0)) for z in (z0, z1)]
        kappa, w = _nodes(ends[0], ends[1], _HEIGHT_NODES)
        return _Elements(
            r=row[1] + row[0] * np.sin(kappa), z=row[2] - row[0] * np.cos(kappa), kappa=kappa, b=row[0] * w
        )
    z, w = _nodes(z0, z1, _HEIGHT_NODES)
    kappa = np.full_like(z, row[3])
    slope = 0.0 if lead_angle is not None else cos(row[3]) / sin(row[3])
    return _Elements(r=row[1] + (z - row[2]) * slope, z=z, kappa=kappa, b=w / sin(row[3]))


def element_forces(law: Law, chip: Array, b: Array, phi: Array, kappa: Array) -> tuple[Array, Array]:
    """Force (3, …) in K and tangential force [N] of edge elements in contact.

    chip: thickness [m] >= 0; b: width [m]; phi, kappa: angles [rad]; all of one shape. See the physics conventions in
    `force_kernels`.
    """
    laws = law.packed
    grown = [np.where(chip > 0.0, np.maximum(chip, 1e-300) ** p, 0.0) for p in laws[:, 1]]
    ft, fr, fa = (b * (laws[i, 0] * grown[i] + laws[i, 2]) for i in range(3))
    inward = fr * np.sin(kappa) + fa * np.cos(kappa)
    fx = -ft * np.cos(phi) - inward * np.sin(phi)
    fy = ft * np.sin(phi) - inward * np.cos(phi)
    fz = fr * np.cos(kappa) - fa * np.sin(kappa)
    return np.array([fx, fy, fz]), ft


def instantaneous_forces(
    cutter: Cutter, law: Law, cut: ConstantCut, theta: float, lead_angle: float | None = None
) -> tuple[Array, float]:
    """Force (3,) [N] in K and torque [N·m] with tooth 0 at `theta` [rad] at the tip.

    A tooth lags by 2 z tan(helix) / D at height z; each stretch of edge between the limits of contact is integrated
    on its own. lead_angle [rad]: kappa of an edge at constant radius, instead of the cutter's own outline.
    """
    start, end = cut.limits(cutter.diameter)
    lag = 2.0 * tan(cutter.helix) / cutter.diameter
    force, torque = np.zeros(3), 0.0
    for row, z0, z1 in _pieces(cutter, cut.ap, lead_angle):
        for tooth in range(cutter.flutes):
            tip = theta + tooth * 2.0 * pi / cutter.flutes
            for a, b in _contacts(tip, lag, start, end, z0, z1):
                part = _between(row, a, b, lead_angle)
                phi = tip - lag * part.z
                chip = np.maximum(cut.feed_per_tooth * np.sin(phi) * np.sin(part.kappa), 0.0)
                forces, tangential = element_forces(law, chip, part.b, phi, part.kappa)
                force += forces.sum(axis=1)
                torque += float((tangential * part.r).sum())
    return force, torque


def _contacts(tip: float, lag: float, start: float, end: float, z0: float, z1: float) -> Iterator[tuple[float, float]]:
    """Stretches of height (a, b) in z0..z1 where a tooth that is at angle `tip` at the tool's tip is in contact."""
    limits = [z0, z1]
    if lag != 0.0:
        low, high = sorted((tip - lag * z0, tip - lag * z1))
        for limit in (start, end):
            turns = np.arange(np.ceil((low - limit) / (2.0 * pi)), np.floor((high - limit) / (2.0 * pi)) + 1.0)
            limits += [float((tip - limit - 2.0 * pi * turn) / lag) for turn in turns]
    limits.sort()
    for a, b in pairwise(limits):
        if b > a:
            phi = (tip - lag * 0.5 * (a + b)) % (2.0 * pi)
            if start <= phi <= end:
                yield a, b


def end_mill_forces(
    cutter: Cutter, law: Law, cut: ConstantCut, *, lead_angle: float | None = None, peaks: bool = True
) -> CutForces:
    """Mean and peak forces of `cutter` in a cut of constant size.

    The mean over a revolution does not depend on the helix; kappa follows the outline of the cutter (flat bottoms do
    not cut in a horizontal feed), or is `lead_angle` [rad] at constant radius. Power is torque times `cut.spindle`.
    """
    start, end = cut.limits(cutter.diameter)
    force, torque, section = np.zeros(3), 0.0, 0.0
    share = cutter.flutes / (2.0 * pi)
    if end > start and cut.ap > 0.0:
        phi, w = _nodes(start, end, _ANGLE_NODES)
        for row, z0, z1 in _pieces(cutter, cut.ap, lead_angle):
            part = _between(row, z0, z1, lead_angle)
            angle, kappa = phi[:, None], part.kappa[None, :]
            chip = np.maximum(cut.feed_per_tooth * np.sin(angle) * np.sin(kappa), 0.0)
            width = w[:, None] * part.b[None, :]
            forces, tangential = element_forces(law, chip, width, angle, kappa)
            force += share * forces.sum(axis=(1, 2))
            torque += share * float((tangential * part.r[None, :]).sum())
            section += float((part.r * part.b * np.sin(part.kappa)).sum()) * (cos(start) - cos(end))
    feed = cut.feed_per_tooth * cutter.flutes * cut.spindle / (2.0 * pi)
    peak_force, peak, peak_torque = np.zeros(3), 0.0, 0.0
    if peaks and end > start and cut.ap > 0.0:
        for theta in _peak_angles(cutter, cut):
            now, moment = instantaneous_forces(cutter, law, cut, theta, lead_angle)
            peak_force = np.maximum(peak_force, np.abs(now))
            peak = max(peak, float(np.linalg.norm(now)))
            peak_torque = max(peak_torque, moment)
    return CutForces(
        force=force, torque=torque, power=torque * cut.spindle, mrr=section * feed,
        peak_force=peak_force, peak=peak, peak_torque=peak_torque,
    )  # fmt: skip


def _peak_angles(cutter: Cutter, cut: ConstantCut) -> list[float]:
    """Angles of tooth 0 [rad] at which peaks are looked for: over one pitch, and where contact begins or ends."""
    pitch = 2.0 * pi / cutter.flutes
    lag = 2.0 * tan(cutter.helix) / cutter.diameter * cut.ap
    start, end = cut.limits(cutter.diameter)
    corners = [angle + late for angle in (start + 1e-9, end - 1e-9) for late in (0.0, lag)]
    return [i * pitch / _PEAK_ANGLES for i in range(_PEAK_ANGLES)] + corners


def plunge_forces(cutter: Cutter, law: Law, *, feed_per_rev: float, spindle: float = 0.0) -> CutForces:
    """Forces of straight plunging or drilling in solid material, edges in to the full diameter; constant in time.

    A drill: two lips (or `flutes`), each D / (2 sin sigma) long with h = f_z sin sigma, sigma half the point angle;
    thrust from the normal force, torque from the tangential one at D/4 on average. A flat end mill: bottom edges
    with kappa = 0, db = dr and h = f_z. The chisel edge is not modelled.
    """
    c = feed_per_rev / cutter.flutes
    force, torque = np.zeros(3), 0.0
    for row in cutter.edge:
        if row[0] > 0.0:
            kappa, w = _nodes(row[3], row[4], _HEIGHT_NODES)
            r, b = row[1] + row[0] * np.sin(kappa), row[0] * w
        elif abs(cos(row[3])) > 1e-12:
            s, b = _nodes(0.0, row[5], _HEIGHT_NODES)
            r, kappa = row[1] + s * cos(row[3]), np.full_like(s, row[3])
        else:
            continue
        forces, tangential = element_forces(law, c * np.cos(kappa), b, np.zeros_like(kappa), kappa)
        force[2] += cutter.flutes * float(forces[2].sum())
        torque += cutter.flutes * float((tangential * r).sum())
    magnitude = abs(float(force[2]))
    return CutForces(
        force=force, torque=torque, power=torque * spindle,
        mrr=pi * cutter.radius**2 * feed_per_rev * spindle / (2.0 * pi),
        peak_force=np.abs(force), peak=magnitude, peak_torque=torque,
    )  # fmt: skip


def mean_chip_thickness(cutter: Cutter, cut: ConstantCut, lead_angle: float = 0.5 * pi) -> float:
    """h_m = c sin(kappa) 2 ae / (D phi_s) [m]: chip thickness averaged over the angle of contact phi_s."""
    start, end = cut.limits(cutter.diameter)
    if end <= start:
        return 0.0
    return cut.feed_per_tooth * sin(lead_angle) * (cos(start) - cos(end)) / (end - start)


def handbook_power(law: Kienzle, cutter: Cutter, cut: ConstantCut, lead_angle: float = 0.5 * pi) -> float:
    """kc(h_m) ap ae v_f [W], as handbooks give it: never below the exact mean (Jensen), equal only for mc = 0."""
    h = mean_chip_thickness(cutter, cut, lead_angle)
    if h <= 0.0:
        return 0.0
    start, end = cut.limits(cutter.diameter)
    feed = cut.feed_per_tooth * cutter.flutes * cut.spindle / (2.0 * pi)
    return law.specific_force(h) * cut.ap * cutter.radius * (cos(start) - cos(end)) * feed


def kienzle_pressure(kc11: float, mc: float, chip: float) -> float:
    """kc [Pa] at chip thickness `chip` [m]: kc11 (h / 1 mm)**-mc with `kc11` [Pa]."""
    return float(kc11 * (chip / MM) ** -mc)


def chip_force(law: Law, *, width: float, chip: float) -> tuple[float, float, float]:
    """Tangential, normal and axial force [N] on one edge `width` [m] wide at chip thickness `chip` [m].

    A chip of zero thickness leaves the edge force alone; a negative one is no contact.
    """
    if chip < 0.0 or width <= 0.0:
        return 0.0, 0.0, 0.0
    force = [float(width * ((k * chip**p if chip > 0.0 else 0.0) + e)) for k, p, e in law.packed]
    return force[0], force[1], force[2]
