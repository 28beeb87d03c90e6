"""Spray on the faces of a body: what of a cone reaches which face, and what of that stays there.

A gun is a point p that sprays along an axis d. Where spray crosses the plane at distance 1, it has the coordinates
(u, v); the share of it through du dv is the pattern. A face of area A and normal n, seen from p at r, gets

    share = pattern(u, v) (-r.n) A / z^3        u = r.x / z, v = r.y / z, z = r.d

because du dv = (-r.n) dA / z^3. So distance and angle need no law of their own, and nothing is lost or doubled at any
tilt: shares of all that the cone meets add up to 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from numpy import float64, int64
from numpy.typing import NDArray

from gcodesim.arithmetic.power_kernels import power
from gcodesim.compiled import kernel
from gcodesim.solids.ray_kernels import Boxes, TriangleEdges, blocked

Array = NDArray[float64]
Ints = NDArray[int64]

FIGURES = 6
"""What is told of each dab: share of the spray that meets faces, film [m³], then film [m³] and film times distance [m⁴]

from too near, and the same from too far."""

SKIN = 1e-5
"""[m] What is nearer to a face than this does not shade it: the face itself, and what lies on it."""

_FRONT = 1e-6  # m before the nozzle from which on there is spray


class Coat(NamedTuple):
    """n faces in the order of their tree: middle, normal (n, 3), area (n,) [m²], film [m] and its greatest steepness.

    `horizon`: sine of the elevation over the face that no part of the body exceeds. `dry` is the film, `wet` what
    it was when it was laid; `steep` is the greatest squared sine of the angle to the horizontal at which it was laid.
    """

    boxes: Boxes
    middle: Array
    normal: Array
    area: Array
    horizon: Array
    dry: Array
    wet: Array
    steep: Array


class Pattern(NamedTuple):
    """How a gun sprays, in the plane at distance 1 and in units of the cone: `wide` along X and `tall` along Y.

    `density` (k,) is the share of the spray for each unit of area at even steps of the radius, from 0 to `reach`.
    `efficiency` (m,) of what meets a face, the share that stays, at `distance` (m,) [m]; times the cosine of the angle
    of incidence to the power of `rebound`. Distances from `least` to `most` are those that the gun is made for.
    """

    density: Array
    reach: float
    wide: float
    tall: float
    distance: Array
    efficiency: Array
    rebound: float
    least: float
    most: float


class Dabs(NamedTuple):
    """k short moments of spraying in S: place (k, 3) [m], axis and X of the gun (k, 3), solids and liquid (k,) [m³].

    `down` (k, 3) is the direction of gravity; `poses` (k, b, 3, 4) are those of the b bodies that may shade.
    """

    place: Array
    axis: Array
    side: Array
    solids: Array
    liquid: Array
    down: Array
    poses: Array


class Shades(NamedTuple):
    """The b bodies that may shade: body j has the nodes first[j] to first[j + 1], and lies in a ball (b, 4) [m].

    Body `own` is the one that is coated, -1 if it is not among them.
    """

    boxes: Boxes
    triangles: TriangleEdges
    first: Ints
    ball: Array
    own: int


class CoatRoom(NamedTuple):
    """Room to work in: faces (n,) that a cone meets with their shares (n,), bodies in it (b,), a ray (2, 3)."""

    face: Ints
    share: Array
    within: Ints
    ray: Array


@kernel(lean=True)
def lay(coat: Coat, pattern: Pattern, dabs: Dabs, shades: Shades, room: CoatRoom, told: Array) -> None:
    """Lay the film of all dabs, in order; `told` (k, FIGURES) says what became of each."""
    for k in range(len(dabs.solids)):
        for figure in range(FIGURES):
            told[k, figure] = 0.0
        count = _aimed(coat, pattern, dabs, k, room)
        if count == 0:
            continue
        _shade(coat, pattern, dabs, k, shades, count, room)
        total = 0.0
        for i in range(count):
            total += room.share[i]
        # a gun so near that single faces fill its cone: they get no more than there is
        _add(coat, pattern, dabs, k, count, room, 1.0 if total <= 1.0 else 1.0 / total, told)


@kernel(lean=True)
def _outside(x: float, y: float, z: float, radius: float, dabs: Dabs, k: int, spread: float) -> bool:
    """Whether a ball at x, y, z is certainly outside the cone of dab k, `spread` wide at distance 1."""
    x, y, z = x - dabs.place[k, 0], y - dabs.place[k, 1], z - dabs.place[k, 2]
    ahead = x * dabs.axis[k, 0] + y * dabs.axis[k, 1] + z * dabs.axis[k, 2]
    if ahead + radius <= 0.0:
        return True
    aside = math.sqrt(max(x * x + y * y + z * z - ahead * ahead, 0.0))
    return bool(aside > spread * (ahead + radius) + radius)


@kernel(lean=True)
def _aimed(coat: Coat, pattern: Pattern, dabs: Dabs, k: int, room: CoatRoom) -> int:
    """The faces that dab k would reach if nothing stood between; returns how many."""
    spread = pattern.reach * max(pattern.wide, pattern.tall)
    px, py, pz = dabs.place[k, 0], dabs.place[k, 1], dabs.place[k, 2]
    dx, dy, dz = dabs.axis[k, 0], dabs.axis[k, 1], dabs.axis[k, 2]
    sx, sy, sz = dabs.side[k, 0], dabs.side[k, 1], dabs.side[k, 2]
    ox, oy, oz = dy * sz - dz * sy, dz * sx - dx * sz, dx * sy - dy * sx
    steps = (len(pattern.density) - 1) / pattern.reach
    box = coat.boxes.box
    count = 0
    node = 0
    while node < len(box):
        hx = 0.5 * (box[node, 3] - box[node, 0])
        hy = 0.5 * (box[node, 4] - box[node, 1])
        hz = 0.5 * (box[node, 5] - box[node, 2])
        radius = math.sqrt(hx * hx + hy * hy + hz * hz)
        if _outside(box[node, 0] + hx, box[node, 1] + hy, box[node, 2] + hz, radius, dabs, k, spread):
            node = coat.boxes.skip[node]
            continue
        for i in range(coat.boxes.begin[node], coat.boxes.end[node]):
            x, y, z = coat.middle[i, 0] - px, coat.middle[i, 1] - py, coat.middle[i, 2] - pz
            towards = -(x * coat.normal[i, 0] + y * coat.normal[i, 1] + z * coat.normal[i, 2])
            ahead = x * dx + y * dy + z * dz
            if towards <= 0.0 or ahead < _FRONT:
                continue
            u = (x * sx + y * sy + z * sz) / (ahead * pattern.wide)
            v = (x * ox + y * oy + z * oz) / (ahead * pattern.tall)
            at = math.sqrt(u * u + v * v) * steps
            low = int(at)
            if low >= len(pattern.density) - 1:
                continue
            density = pattern.density[low] + (at - low) * (pattern.density[low + 1] - pattern.density[low])
            if density <= 0.0:
                continue
            room.face[count] = i
            room.share[count] = density * towards * coat.area[i] / (pattern.wide * pattern.tall * ahead * ahead * ahead)
            count += 1
        node += 1
    return count


@kernel(lean=True)
def _shade(coat: Coat, pattern: Pattern, dabs: Dabs, k: int, shades: Shades, count: int, room: CoatRoom) -> None:
    """Take the share of each face that the gun does not see."""
    spread = pattern.reach * max(pattern.wide, pattern.tall)
    bodies = len(shades.ball)
    for b in range(bodies):
        X = dabs.poses
        cx, cy, cz = shades.ball[b, 0], shades.ball[b, 1], shades.ball[b, 2]
        x = X[k, b, 0, 0] * cx + X[k, b, 0, 1] * cy + X[k, b, 0, 2] * cz + X[k, b, 0, 3]
        y = X[k, b, 1, 0] * cx + X[k, b, 1, 1] * cy + X[k, b, 1, 2] * cz + X[k, b, 1, 3]
        z = X[k, b, 2, 0] * cx + X[k, b, 2, 1] * cy + X[k, b, 2, 2] * cz + X[k, b, 2, 3]
        room.within[b] = 0 if _outside(x, y, z, shades.ball[b, 3], dabs, k, spread) else 1
    for b in range(bodies):
        if room.within[b] == 0:
            continue
        _into(room.ray, 1, dabs.poses, k, b, dabs.place[k, 0], dabs.place[k, 1], dabs.place[k, 2])
        for i in range(count):
            face = room.face[i]
            if room.share[i] == 0.0 or (b == shades.own and _above(coat, face, dabs, k)):
                continue
            _into(room.ray, 0, dabs.poses, k, b, coat.middle[face, 0], coat.middle[face, 1], coat.middle[face, 2])
            if blocked(shades.boxes, shades.triangles, shades.first[b], shades.first[b + 1], room.ray, SKIN):
                room.share[i] = 0.0


@kernel(lean=True)
def _above(coat: Coat, face: int, dabs: Dabs, k: int) -> bool:
    """Whether the gun stands higher over a face than anything of its body."""
    x = dabs.place[k, 0] - coat.middle[face, 0]
    y = dabs.place[k, 1] - coat.middle[face, 1]
    z = dabs.place[k, 2] - coat.middle[face, 2]
    up = x * coat.normal[face, 0] + y * coat.normal[face, 1] + z * coat.normal[face, 2]
    return bool(up > coat.horizon[face] * math.sqrt(x * x + y * y + z * z))


@kernel(lean=True)
def _into(ray: Array, end: int, X: Array, k: int, b: int, x: float, y: float, z: float) -> None:
    """Put the point x, y, z of S, in the frame of body b, at that end of the ray."""
    x, y, z = x - X[k, b, 0, 3], y - X[k, b, 1, 3], z - X[k, b, 2, 3]
    for axis in range(3):
        ray[end, axis] = X[k, b, 0, axis] * x + X[k, b, 1, axis] * y + X[k, b, 2, axis] * z


@kernel(lean=True)
def _add(
    coat: Coat, pattern: Pattern, dabs: Dabs, k: int, count: int, room: CoatRoom, scale: float, told: Array
) -> None:
    """Lay what stays of dab k on the faces that it reaches."""
    for i in range(count):
        if room.share[i] == 0.0:
            continue
        face, share = room.face[i], scale * room.share[i]
        x = dabs.place[k, 0] - coat.middle[face, 0]
        y = dabs.place[k, 1] - coat.middle[face, 1]
        z = dabs.place[k, 2] - coat.middle[face, 2]
        distance = math.sqrt(x * x + y * y + z * z)
        stays = share * staying(pattern, distance)
        nx, ny, nz = coat.normal[face, 0], coat.normal[face, 1], coat.normal[face, 2]
        if pattern.rebound > 0.0:
            stays *= power((x * nx + y * ny + z * nz) / distance, pattern.rebound)
        film = dabs.solids[k] * stays
        coat.dry[face] += film / coat.area[face]
        coat.wet[face] += dabs.liquid[k] * stays / coat.area[face]
        flat = nx * dabs.down[k, 0] + ny * dabs.down[k, 1] + nz * dabs.down[k, 2]
        coat.steep[face] = max(coat.steep[face], 1.0 - flat * flat)
        told[k, 0] += share
        told[k, 1] += film
        if distance < pattern.least:
            told[k, 2] += film
            told[k, 3] += film * distance
        elif distance > pattern.most:
            told[k, 4] += film
            told[k, 5] += film * distance


@kernel(lean=True)
def staying(pattern: Pattern, distance: float) -> float:
    """The share of the spray that stays on a face at this distance, straight between known ones, even beyond them."""
    known = pattern.distance
    last = len(known) - 1
    if distance <= known[0]:
        return float(pattern.efficiency[0])
    if distance >= known[last]:
        return float(pattern.efficiency[last])
    at = 0
    while known[at + 1] < distance:
        at += 1
    part = (distance - known[at]) / (known[at + 1] - known[at])
    return float(pattern.efficiency[at] + part * (pattern.efficiency[at + 1] - pattern.efficiency[at]))
