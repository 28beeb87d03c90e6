"""Forces of an upright cutter by fine sums over the exact shape that earlier cuts have left: slow, and free of a grid.

Material is a half space below z = 0 less what tools have swept, each at places so dense that scallops between them do
not count. An element of the edge cuts where it advances and where there is material just outside it. Kienzle and
rotation as in `gcodesim.processes.force_kernels`, elements as `tests.unit.processes.test_peaks` has them.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

OUTSIDE = 0.05e-6  # [m] outside the edge, where material is asked for; a thin cut of a flat edge is not much thicker
LEAST_ADVANCE = 1.0e-4
DENSE = 20e-6  # [m] between places of a sweep


@dataclass(frozen=True)
class Pass:
    """What a cutter has swept: its tip was at places (m, 3) [m] in order, on straight lines between them."""

    cutter: object
    places: np.ndarray


@dataclass(frozen=True)
class Loads:
    """Mean force on the tool (3,) [N] along the feed, to its left and up; mean torque [N·m]; peaks of both."""

    mean: np.ndarray
    torque: float
    peak_force: float
    peak_torque: float

    @property
    def size(self) -> float:
        """Size of the mean force [N]."""
        return float(np.linalg.norm(self.mean))


def dense(places):
    """Places (m, 3) not more than DENSE apart on the way through `places`."""
    found = [places[:1]]
    for a, b in itertools.pairwise(places):
        number = max(1, math.ceil(float(np.linalg.norm(b - a)) / DENSE))
        found.append(a + (np.arange(1, number + 1) / number)[:, None] * (b - a))
    return np.concatenate(found)


def radius_at(cutter, height):
    """Radius [m] of the cutter at heights (n,) [m] above its tip; -1 below it."""
    radius = np.full(height.shape, -1.0)
    for arc, at_r, at_z, kappa0, _, _, foot, head, _ in cutter.edge:
        here = (height >= foot) & (height <= head) & (height >= 0.0)
        if arc > 0.0:
            own = at_r + np.sqrt(np.maximum(arc * arc - np.square(height - at_z), 0.0))
        elif head > foot:
            own = at_r + (height - foot) / math.tan(kappa0)
        else:
            continue
        radius = np.where(here, np.maximum(radius, own), radius)
    return np.where(height > cutter.edge[-1][7], cutter.radius, radius)


def is_swept(points, passed):
    """Which points (n, 3) a pass has swept."""
    found = np.zeros(len(points), dtype=bool)
    low, high = points.min(axis=0), points.max(axis=0)
    reach = passed.cutter.radius
    # a pass is divided, so that only its parts near the points are made dense
    for a, b in zip(passed.places[:-1], passed.places[1:], strict=True):
        if (np.maximum(a, b)[:2] + reach < low[:2]).any() or (np.minimum(a, b)[:2] - reach > high[:2]).any():
            continue
        if min(a[2], b[2]) > high[2]:
            continue
        length = float(np.linalg.norm(b - a))
        begin, end = 0.0, 1.0
        if length > 0.0:  # the part of it that is near
            middle, widest = 0.5 * (low + high), float(np.linalg.norm(high - low)) * 0.5 + 1.5 * reach + 2e-3
            at = float(np.dot(middle - a, b - a)) / length
            begin, end = max(0.0, (at - widest) / length), min(1.0, (at + widest) / length)
            if end <= begin:
                continue
        for x, y, z in dense(np.array([a + begin * (b - a), a + end * (b - a)])):
            left = np.flatnonzero(~found)
            if not len(left):
                return found
            rest = points[left]
            near = np.square(rest[:, 0] - x) + np.square(rest[:, 1] - y)
            own = radius_at(passed.cutter, rest[:, 2] - z)
            found[left] = (own >= 0.0) & (near <= own * own)
    return found


def loads(cutter, law, chip, tip, way, passes, top=0.0, angles=1440, count=40):
    """Loads of a cutter at `tip` (3,) [m] that goes along the unit vector `way` (3,), chip [m] a tooth.

    `angles` of a revolution and `count` elements of each part of the edge are looked at.
    """
    r, z, kappa, width = elements(cutter, top - tip[2], count)
    sine, cosine = np.sin(kappa), np.where(np.abs(np.cos(kappa)) < 1e-12, 0.0, np.cos(kappa))
    level, climb = math.hypot(way[0], way[1]), way[2]
    ux, uy = (way[0] / level, way[1] / level) if level > 1e-9 else (1.0, 0.0)
    phi = (np.arange(angles) + 0.5) / angles * 2.0 * math.pi
    s, c = np.sin(phi)[:, None], np.cos(phi)[:, None]
    advance = level * s * sine - climb * cosine
    cuts = advance > LEAST_ADVANCE
    out_r, out_z = r + OUTSIDE * sine, z - OUTSIDE * cosine
    ahead, left = out_r * s, out_r * c
    points = np.stack(
        [tip[0] + ux * ahead - uy * left, tip[1] + uy * ahead + ux * left, np.broadcast_to(tip[2] + out_z, left.shape)],
        -1,
    )
    asked = points[cuts]
    full = asked[:, 2] <= top
    for passed in passes:
        left = np.flatnonzero(full)
        if len(left):
            full[left] = ~is_swept(asked[left], passed)
    here = np.zeros(cuts.shape, dtype=bool)
    here[cuts] = full
    grown = [np.where(here, width * (f * np.where(here, chip * advance, 1.0) ** p + e), 0.0) for f, p, e in law.packed]
    inward = grown[1] * sine + grown[2] * cosine
    parts = np.stack([-grown[0] * c - inward * s, grown[0] * s - inward * c, grown[1] * cosine - grown[2] * sine,
                      grown[0] * r])  # fmt: skip
    mean = parts.sum(axis=(1, 2)) * cutter.flutes / angles
    late = 2.0 * z * math.tan(cutter.helix) / cutter.diameter * angles / (2.0 * math.pi)
    tooth = np.zeros((4, angles))
    for k in range(len(z)):
        whole = math.floor(late[k])
        part = late[k] - whole
        tooth += (1.0 - part) * np.roll(parts[:, :, k], whole, axis=1) + part * np.roll(
            parts[:, :, k], whole + 1, axis=1
        )
    turn = np.zeros((4, angles))
    for n in range(cutter.flutes):
        turn += np.roll(tooth, round(n * angles / cutter.flutes), axis=1)
    peak = float(np.sqrt(np.square(turn[:3]).sum(axis=0)).max())
    return Loads(mean[:3], float(mean[3]), peak, float(turn[3].max()))


def elements(cutter, depth, count):
    """Radius, height, kappa and width (n,) of fine elements of the edge below `depth` [m]."""
    found = []
    for arc, at_r, at_z, kappa0, kappa1, length, foot, head, _ in cutter.edge:
        share = (np.arange(count) + 0.5) / count
        if arc > 0.0:
            if foot >= depth:
                continue
            end = kappa1 if head <= depth else math.acos(max((at_z - depth) / arc, -1.0))
            kappa = kappa0 + share * (end - kappa0)
            found.append((at_r + arc * np.sin(kappa), at_z - arc * np.cos(kappa), kappa,
                          np.full(count, arc * (end - kappa0) / count)))  # fmt: skip
        elif foot < depth and length > 0.0:
            whole = min(length, (depth - foot) / math.sin(kappa0) if kappa0 > 0.0 else length)
            s = share * whole
            found.append((at_r + s * math.cos(kappa0), foot + s * math.sin(kappa0), np.full(count, kappa0),
                          np.full(count, whole / count)))  # fmt: skip
    return [np.concatenate([row[i] for row in found]) for i in range(4)]
