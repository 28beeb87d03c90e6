"""Fewer triangles for the same surface, by collapsing edges, with a bound that is never passed.

A point is taken out of its ring of neighbours and the hole is closed by a fan from one of them (half-edge collapse;
Kobbelt, Campagna and Seidel 1998). So points stay where they were, and corners keep their places.

How far the fan is from what it replaces is found by overlaying both along the mean normal of the ring, over which both
have to be height fields. Each is flat within a cell of the overlay, so they are farthest apart where an edge of one
crosses an edge of the other, or at the point that goes (Cohen, Manocha and Olano 1997, successive mappings). A face
adds this to what the faces under it have added before, so the sum bounds how far it is from the surface of the
beginning, and how far that is from it.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]

MOST_NEIGHBOURS = 32
"""A point with more stays."""

SLIVER = 0.01
"""How flat a new triangle may be: its height is at least this share of the distance that is allowed."""

THIN = 1e-9
"""Share of an edge by which a face may lie over another one and not count as being over it."""

TURNED = 1e-6
"""Angle [rad] up to which a face counts as still in its plane."""

EVEN = 1e-6
"""What an edge counts beside a distance, by its length: of equally good neighbours the nearest is taken."""


class ThinnedSkin(NamedTuple):
    """Points (v, 3) [m] and faces (f, 3), of which those that are gone begin with -1.

    Each face has how far it is `off` (f,) [m], and whether it has `turned` (f,) out of its plane.
    """

    points: Array
    faces: Ints
    off: Array
    turned: Bytes


class CornerLists(NamedTuple):
    """The corners 3 f + k of the faces at each point as a list: the `first` (v,), and the `next` (3 f,); -1 ends it."""

    first: Ints
    next: Ints


class Neighbours(NamedTuple):
    """Room for one point's neighbours in order: `face`, `point` (n,), where they are seen from it along the mean normal
    `place` (n, 3), how far a face of a fan is from what is under it, `height` (n,), how far faces of a fan and of the
    best one are off, `off` (2, n), and `mark` (v,), the last point in whose ring each has been."""

    face: Ints
    point: Ints
    place: Array
    height: Array
    off: Array
    mark: Ints


@kernel(lean=True)
def list_corners(skin: ThinnedSkin, corners: CornerLists) -> None:
    """Fill the lists; `first` begins with -1."""
    for f in range(len(skin.faces)):
        for k in range(3):
            p = skin.faces[f, k]
            corners.next[3 * f + k] = corners.first[p]
            corners.first[p] = 3 * f + k


@kernel(lean=True)
def _ring_of(skin: ThinnedSkin, corners: CornerLists, ring: Neighbours, p: int) -> int:
    """The neighbours of p in order against the clock; how many, 0 where its faces are not one closed fan."""
    count = 0
    corner = corners.first[p]
    while corner >= 0:
        f = corner // 3
        if skin.faces[f, 0] >= 0:
            if count == MOST_NEIGHBOURS:
                return 0
            ring.face[count] = f
            count += 1
        corner = corners.next[corner]
    if count < 3:
        return 0
    for n in range(count):  # face n is the one that goes on where face n - 1 ends
        found = False
        for m in range(n, count):
            f = ring.face[m]
            k = 0 if skin.faces[f, 0] == p else (1 if skin.faces[f, 1] == p else 2)
            begins, ends = skin.faces[f, (k + 1) % 3], skin.faces[f, (k + 2) % 3]
            if n == 0 or begins == ring.point[n]:
                ring.face[m] = ring.face[n]
                ring.face[n] = f
                ring.point[n] = begins
                ring.point[n + 1] = ends
                found = True
                break
        if not found:
            return 0
    if ring.point[count] != ring.point[0]:
        return 0
    for n in range(count):
        if ring.mark[ring.point[n]] == p:
            return 0  # the fan passes a point twice
        ring.mark[ring.point[n]] = p
    return count


@kernel(lean=True)
def _seen_along_normal(skin: ThinnedSkin, ring: Neighbours, p: int, count: int) -> bool:
    """Fill `place`: two coordinates across the mean normal of the ring and a height; False where a face looks away."""
    px, py, pz = skin.points[p, 0], skin.points[p, 1], skin.points[p, 2]
    nx = ny = nz = 0.0
    for n in range(count):
        a, b = ring.point[n], ring.point[n + 1]
        ax, ay, az = skin.points[a, 0] - px, skin.points[a, 1] - py, skin.points[a, 2] - pz
        bx, by, bz = skin.points[b, 0] - px, skin.points[b, 1] - py, skin.points[b, 2] - pz
        nx += ay * bz - az * by
        ny += az * bx - ax * bz
        nz += ax * by - ay * bx
    size = sqrt(nx * nx + ny * ny + nz * nz)
    if size == 0.0:
        return False
    nx, ny, nz = nx / size, ny / size, nz / size
    if abs(nz) > 0.6:  # a direction across the normal
        ux, uy, uz = 0.0, nz, -ny
    else:
        ux, uy, uz = ny, -nx, 0.0
    size = sqrt(ux * ux + uy * uy + uz * uz)
    ux, uy, uz = ux / size, uy / size, uz / size
    vx, vy, vz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
    for n in range(count + 1):
        a = ring.point[n]
        ax, ay, az = skin.points[a, 0] - px, skin.points[a, 1] - py, skin.points[a, 2] - pz
        ring.place[n, 0] = ax * ux + ay * uy + az * uz
        ring.place[n, 1] = ax * vx + ay * vy + az * vz
        ring.place[n, 2] = ax * nx + ay * ny + az * nz
    for n in range(count):
        if ring.place[n, 0] * ring.place[n + 1, 1] - ring.place[n, 1] * ring.place[n + 1, 0] <= 0.0:
            return False
    return True


@kernel(lean=True)
def _fan_off(skin: ThinnedSkin, ring: Neighbours, count: int, k: int, sliver: float, off: Array) -> float:
    """How far (n,) each face of the fan from neighbour k may be off [m], and the most; infinite where it is refused.

    A face is as far off as the worst of those that it lies over, and as far as it is from them.
    """
    place = ring.place
    x, y, z = place[k, 0], place[k, 1], place[k, 2]
    for n in range(count):
        off[n] = skin.off[ring.face[n]]
    for n in range(count):
        ring.height[n] = 0.0
    worst = 0.0
    for n in range(count):
        worst = max(worst, off[n])
    inside = False
    for n in range(count):
        m = (n + 1) % count
        if n == k or m == k:
            continue
        ax, ay, bx, by = place[n, 0] - x, place[n, 1] - y, place[m, 0] - x, place[m, 1] - y
        area = ax * by - ay * bx
        cx, cy = bx - ax, by - ay
        longest = max(ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy)
        if area <= sliver * sqrt(longest):
            return np.inf
        s, t = (-x * by + y * bx) / area, (-ax * y + ay * x) / area  # where the point that goes is in this face
        depth = min(s, t, 1.0 - s - t)
        if depth >= -THIN:
            inside = True
            ring.height[n] = abs(z + s * (place[n, 2] - z) + t * (place[m, 2] - z))
            if depth > THIN:
                off[n] = worst
    if not inside:
        return np.inf
    _cross(skin, ring, count, k, off)
    most = 0.0
    for n in range(count):
        if n != k and (n + 1) % count != k:
            off[n] += ring.height[n]
            most = max(most, off[n])
    return most


@kernel(lean=True)
def _cross(skin: ThinnedSkin, ring: Neighbours, count: int, k: int, off: Array) -> None:
    """Take into `off` and `height` what is where an edge of the fan, from k to m, crosses one of the ring, to n."""
    place = ring.place
    x, y, z = place[k, 0], place[k, 1], place[k, 2]
    for m in range(count):
        before = (m + count - 1) % count  # the face of the fan on the other side of its edge
        if m == k or (m + 1) % count == k or before == k:
            continue
        wx, wy = place[m, 0] - x, place[m, 1] - y
        for n in range(count):
            turn = place[n, 0] * wy - place[n, 1] * wx
            if n in (k, m) or turn == 0.0:
                continue
            s = (x * wy - y * wx) / turn  # along the ring's edge
            t = (x * place[n, 1] - y * place[n, 0]) / turn  # along the fan's
            if s < 0.0 or s > 1.0 or t < 0.0 or t > 1.0:
                continue
            height = abs(s * place[n, 2] - z - t * (place[m, 2] - z))
            ring.height[m] = max(ring.height[m], height)
            ring.height[before] = max(ring.height[before], height)
            if s > THIN:
                under = max(skin.off[ring.face[n]], skin.off[ring.face[(n + count - 1) % count]])
                off[m] = max(off[m], under)
                off[before] = max(off[before], under)


@kernel(lean=True)
def _is_linked(skin: ThinnedSkin, corners: CornerLists, ring: Neighbours, p: int, count: int, k: int) -> bool:
    """Whether p and neighbour k have just the two neighbours in common that are beside k in the ring."""
    q, before, after = ring.point[k], ring.point[(k + count - 1) % count], ring.point[(k + 1) % count]
    corner = corners.first[q]
    while corner >= 0:
        f = corner // 3
        if skin.faces[f, 0] >= 0:
            for j in range(3):
                r = skin.faces[f, j]
                if r != p and r != q and r != before and r != after and ring.mark[r] == p:
                    return False
        corner = corners.next[corner]
    return True


@kernel(lean=True)
def _best_of(skin: ThinnedSkin, corners: CornerLists, ring: Neighbours, p: int, count: int, allowed: float) -> int:
    """The neighbour whose fan is least off, at most `allowed` [m], and in `off[1]` how far; -1 if there is none."""
    best, least = -1, np.inf
    for k in range(count):
        far = _fan_off(skin, ring, count, k, SLIVER * allowed, ring.off[0])
        x, y, z = ring.place[k, 0], ring.place[k, 1], ring.place[k, 2]
        cost = far + EVEN * sqrt(x * x + y * y + z * z)
        if far <= allowed and cost < least and _is_linked(skin, corners, ring, p, count, k):
            best, least = k, cost
            for n in range(count):
                ring.off[1, n] = ring.off[0, n]
    return best


@kernel(lean=True)
def _collapse(skin: ThinnedSkin, corners: CornerLists, ring: Neighbours, p: int, count: int, k: int) -> None:
    """Take p out; the faces beside neighbour k go, the others end there."""
    q = ring.point[k]
    for n in range(count):
        f = ring.face[n]
        if n == k or (n + 1) % count == k:
            skin.faces[f, 0] = -1
            continue
        skin.off[f] = ring.off[1, n]
        ax, ay, az = _area(skin, f)
        for j in range(3):
            if skin.faces[f, j] == p:
                skin.faces[f, j] = q
                corners.next[3 * f + j], corners.first[q] = corners.first[q], 3 * f + j
        bx, by, bz = _area(skin, f)
        cx, cy, cz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        along = ax * bx + ay * by + az * bz
        if cx * cx + cy * cy + cz * cz > TURNED * TURNED * along * along:
            skin.turned[f] = 1
    corners.first[p] = -1


@kernel(lean=True)
def collapse_some(skin: ThinnedSkin, corners: CornerLists, ring: Neighbours, rest: Bytes, allowed: float) -> int:
    """Take out points none of which is a neighbour of another, no face ending up more than `allowed` [m] off; how many.

    A point that goes lays its corners into the list of its neighbour. `rest` (v,) and `mark` begin with zeros and -1.
    """
    gone = 0
    for p in range(len(corners.first)):
        if corners.first[p] < 0 or rest[p] != 0:
            continue
        count = _ring_of(skin, corners, ring, p)
        if count == 0 or not _seen_along_normal(skin, ring, p, count):
            continue
        k = _best_of(skin, corners, ring, p, count, allowed)
        if k >= 0:
            _collapse(skin, corners, ring, p, count, k)
            for n in range(count):
                rest[ring.point[n]] = 1
            gone += 1
    return gone


@kernel(lean=True)
def ways_out(skin: ThinnedSkin, way: Array, held: Array) -> None:
    """The way (v, 3) on which each point moves so that only faces leave their planes that have left them before.

    Its length is the area [m²] by which a move along the unit way changes the volume. `held` (v, 6) is room for two
    directions in which a flat face holds a point; both arrays begin with zeros. What is held in three does not move.
    """
    for f in range(len(skin.faces)):
        if skin.faces[f, 0] < 0 or skin.turned[f] == 0:
            continue
        nx, ny, nz = _area(skin, f)
        for k in range(3):
            p = skin.faces[f, k]
            way[p, 0] += nx / 6.0
            way[p, 1] += ny / 6.0
            way[p, 2] += nz / 6.0
    for f in range(len(skin.faces)):
        if skin.faces[f, 0] < 0 or skin.turned[f] != 0:
            continue
        nx, ny, nz = _area(skin, f)
        size = sqrt(nx * nx + ny * ny + nz * nz)
        if size == 0.0:
            continue
        for k in range(3):
            _hold(way, held, skin.faces[f, k], nx / size, ny / size, nz / size)


@kernel(lean=True)
def _area(skin: ThinnedSkin, f: int) -> tuple[float, float, float]:
    """Twice the area vector [m²] of a face."""
    i, j, k = skin.faces[f, 0], skin.faces[f, 1], skin.faces[f, 2]
    ax, ay, az = (
        skin.points[j, 0] - skin.points[i, 0],
        skin.points[j, 1] - skin.points[i, 1],
        skin.points[j, 2] - skin.points[i, 2],
    )
    bx, by, bz = (
        skin.points[k, 0] - skin.points[i, 0],
        skin.points[k, 1] - skin.points[i, 1],
        skin.points[k, 2] - skin.points[i, 2],
    )
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@kernel(lean=True)
def _hold(way: Array, held: Array, p: int, x: float, y: float, z: float) -> None:
    """Take out of the way of a point what leads out of a plane with this normal."""
    for n in range(2):
        hx, hy, hz = held[p, 3 * n], held[p, 3 * n + 1], held[p, 3 * n + 2]
        along = x * hx + y * hy + z * hz
        x, y, z = x - along * hx, y - along * hy, z - along * hz
    size = sqrt(x * x + y * y + z * z)
    if size < 1e-6:
        return  # held in this direction already
    x, y, z = x / size, y / size, z / size
    for n in range(2):
        if held[p, 3 * n] == 0.0 and held[p, 3 * n + 1] == 0.0 and held[p, 3 * n + 2] == 0.0:
            held[p, 3 * n], held[p, 3 * n + 1], held[p, 3 * n + 2] = x, y, z
            break
    out = x * way[p, 0] + y * way[p, 1] + z * way[p, 2]
    way[p, 0] -= out * x
    way[p, 1] -= out * y
    way[p, 2] -= out * z
