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

TOGETHER = 32
"""Faces of one box of a coat, at the most."""

_FRONT = 1e-6  # m before the nozzle from which on there is spray


class Coat(NamedTuple):
    """n faces in the order of their tree: `places` of their middles [m] and `normals` (3, n), area (n,) [m²], film [m].

    Boxes hold at most `TOGETHER` faces, which are looked at together. `horizon`: sine of the elevation over the face
    that no part of the body exceeds. `dry` is the film, `wet` what it was when it was laid; `steep` is the greatest
    squared sine of the angle to the horizontal at which it was laid.
    """

    boxes: Boxes
    places: Array
    normals: Array
    area: Array
    horizon: Array
    dry: Array
    wet: Array
    steep: Array

    @property
    def middle(self) -> Array:
        """Middles (n, 3) [m]."""
        return self.places.T

    @property
    def normal(self) -> Array:
        """Normals (n, 3)."""
        return self.normals.T


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
    """Room to work in: faces (n,) that a cone meets, of each what it gets of the spray and how the gun stands to it.

    `share` (n,) is what it gets, `towards` (n,) [m] how high the gun stands over its plane and `distance` (n,) [m] how
    far away; `low` (n,) are those of them that the body itself may shade. `box` (5, TOGETHER) has, of the faces of one
    box, `towards`, how far they are ahead of the gun, where in the pattern, `distance`, and how much higher the gun
    stands over them than anything of the body. With them the bodies in the cone (b,), and a ray (2, 3).
    """

    face: Ints
    low: Ints
    share: Array
    towards: Array
    distance: Array
    box: Array
    within: Ints
    ray: Array


@kernel(lean=True)
def lay(coat: Coat, pattern: Pattern, dabs: Dabs, shades: Shades, room: CoatRoom, told: Array) -> None:
    """Lay the film of all dabs, in order; `told` (k, FIGURES) says what became of each."""
    for k in range(len(dabs.solids)):
        for figure in range(FIGURES):
            told[k, figure] = 0.0
        count, low, total = _aimed(coat, pattern, dabs, k, room)
        if count == 0:
            continue
        if _shade(coat, pattern, dabs, k, shades, (count, low), room):
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
def _aimed(coat: Coat, pattern: Pattern, dabs: Dabs, k: int, room: CoatRoom) -> tuple[int, int, float]:
    """The faces that dab k would reach if nothing stood between.

    Returns how many, of how many of them the gun does not stand higher than all of the body, and the sum of the shares.
    """
    spread = pattern.reach * max(pattern.wide, pattern.tall)
    box = coat.boxes.box
    count, low, total = 0, 0, 0.0
    node = 0
    while node < len(box):
        hx = 0.5 * (box[node, 3] - box[node, 0])
        hy = 0.5 * (box[node, 4] - box[node, 1])
        hz = 0.5 * (box[node, 5] - box[node, 2])
        radius = math.sqrt(hx * hx + hy * hy + hz * hz)
        if _outside(box[node, 0] + hx, box[node, 1] + hy, box[node, 2] + hz, radius, dabs, k, spread):
            node = coat.boxes.skip[node]
            continue
        begin, end = coat.boxes.begin[node], coat.boxes.end[node]
        if begin < end:
            _look(coat, pattern, dabs, k, begin, end, room.box)
            count, low, total = _chosen(coat, pattern, begin, end, room, (count, low, total))
        node += 1
    return count, low, total


@kernel(lean=True)
def _look(coat: Coat, pattern: Pattern, dabs: Dabs, k: int, begin: int, end: int, seen: Array) -> None:
    """How the gun of dab k stands to the faces from `begin` to `end`; see `CoatRoom.box`."""
    px, py, pz = dabs.place[k, 0], dabs.place[k, 1], dabs.place[k, 2]
    dx, dy, dz = dabs.axis[k, 0], dabs.axis[k, 1], dabs.axis[k, 2]
    sx, sy, sz = dabs.side[k, 0], dabs.side[k, 1], dabs.side[k, 2]
    ox, oy, oz = dy * sz - dz * sy, dz * sx - dx * sz, dx * sy - dy * sx
    wide, tall, steps = pattern.wide, pattern.tall, (len(pattern.density) - 1) / pattern.reach
    xs, ys, zs = coat.places[0, begin:end], coat.places[1, begin:end], coat.places[2, begin:end]
    nxs, nys, nzs = coat.normals[0, begin:end], coat.normals[1, begin:end], coat.normals[2, begin:end]
    horizons = coat.horizon[begin:end]
    towards, ahead, at, distance, over = seen[0], seen[1], seen[2], seen[3], seen[4]
    for i in range(len(xs)):
        x, y, z = xs[i] - px, ys[i] - py, zs[i] - pz
        forward = x * dx + y * dy + z * dz
        u = (x * sx + y * sy + z * sz) / (forward * wide)
        v = (x * ox + y * oy + z * oz) / (forward * tall)
        high = -(x * nxs[i] + y * nys[i] + z * nzs[i])
        far = math.sqrt(x * x + y * y + z * z)
        towards[i] = high
        ahead[i] = forward
        at[i] = math.sqrt(u * u + v * v) * steps
        distance[i] = far
        over[i] = high - horizons[i] * far


@kernel(lean=True)
def _chosen(
    coat: Coat, pattern: Pattern, begin: int, end: int, room: CoatRoom, so_far: tuple[int, int, float]
) -> tuple[int, int, float]:
    """Put those of the faces from `begin` to `end` that get spray behind those that do; returns what `_aimed` does."""
    count, doubtful, total = so_far
    last = len(pattern.density) - 1
    for i in range(end - begin):
        towards, ahead, at = room.box[0, i], room.box[1, i], room.box[2, i]
        if towards <= 0.0 or ahead < _FRONT or at >= last:
            continue
        low = int(at)
        density = pattern.density[low] + (at - low) * (pattern.density[low + 1] - pattern.density[low])
        if density <= 0.0:
            continue
        share = density * towards * coat.area[begin + i] / (pattern.wide * pattern.tall * ahead * ahead * ahead)
        total += share
        room.face[count] = begin + i
        room.share[count] = share
        room.towards[count] = towards
        room.distance[count] = room.box[3, i]
        if room.box[4, i] <= 0.0:
            room.low[doubtful] = count
            doubtful += 1
        count += 1
    return count, doubtful, total


@kernel(lean=True)
def _shade(
    coat: Coat, pattern: Pattern, dabs: Dabs, k: int, shades: Shades, counts: tuple[int, int], room: CoatRoom
) -> bool:
    """Take the share of each face that the gun does not see; whether any is taken. `counts` as `_aimed` has them."""
    spread = pattern.reach * max(pattern.wide, pattern.tall)
    bodies = len(shades.ball)
    for b in range(bodies):
        X = dabs.poses
        cx, cy, cz = shades.ball[b, 0], shades.ball[b, 1], shades.ball[b, 2]
        x = X[k, b, 0, 0] * cx + X[k, b, 0, 1] * cy + X[k, b, 0, 2] * cz + X[k, b, 0, 3]
        y = X[k, b, 1, 0] * cx + X[k, b, 1, 1] * cy + X[k, b, 1, 2] * cz + X[k, b, 1, 3]
        z = X[k, b, 2, 0] * cx + X[k, b, 2, 1] * cy + X[k, b, 2, 2] * cz + X[k, b, 2, 3]
        room.within[b] = 0 if _outside(x, y, z, shades.ball[b, 3], dabs, k, spread) else 1
    taken = False
    for b in range(bodies):
        if room.within[b] == 0:
            continue
        own = b == shades.own
        _into(room.ray, 1, dabs.poses, k, b, dabs.place[k, 0], dabs.place[k, 1], dabs.place[k, 2])
        for j in range(counts[1] if own else counts[0]):
            i = room.low[j] if own else j
            if room.share[i] == 0.0:
                continue
            face = room.face[i]
            _into(room.ray, 0, dabs.poses, k, b, coat.places[0, face], coat.places[1, face], coat.places[2, face])
            if blocked(shades.boxes, shades.triangles, shades.first[b], shades.first[b + 1], room.ray, SKIN):
                room.share[i] = 0.0
                taken = True
    return taken


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
    solids, liquid = dabs.solids[k], dabs.liquid[k]
    gx, gy, gz = dabs.down[k, 0], dabs.down[k, 1], dabs.down[k, 2]
    met, laid = 0.0, 0.0
    for i in range(count):
        if room.share[i] == 0.0:
            continue
        face, share, distance = room.face[i], scale * room.share[i], room.distance[i]
        stays = share * staying(pattern, distance)
        if pattern.rebound > 0.0:
            stays *= power(room.towards[i] / distance, pattern.rebound)
        film = solids * stays
        coat.dry[face] += film / coat.area[face]
        coat.wet[face] += liquid * stays / coat.area[face]
        flat = coat.normals[0, face] * gx + coat.normals[1, face] * gy + coat.normals[2, face] * gz
        coat.steep[face] = max(coat.steep[face], 1.0 - flat * flat)
        met += share
        laid += film
        if distance < pattern.least:
            told[k, 2] += film
            told[k, 3] += film * distance
        elif distance > pattern.most:
            told[k, 4] += film
            told[k, 5] += film * distance
    told[k, 0], told[k, 1] = met, laid


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
