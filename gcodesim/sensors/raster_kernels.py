"""Triangles and lines onto the pixels of a pinhole camera, nearest first (a z-buffer, Catmull 1974).

Camera axes: X right, Y down, Z ahead. A pixel (u, v), counted from the upper left, is the ray through
((u - cx) / fx, (v - cy) / fy, 1), as in `foxglove.CameraCalibration`. Depth is that along Z. What is nearer than `near`
is cut off.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.power_kernels import log
from gcodesim.compiled import kernel
from gcodesim.frames import Array

Bytes = NDArray[np.uint8]
Ints = NDArray[np.int32]

NOBODY = -1
EDGE = 1e-9  # [pixels] a pixel this little beside an edge is on it, so that neighbours leave no gap
IN_FRONT = 1e-4  # share of its depth by which a line is drawn in front of a face that it lies in


class Lens(NamedTuple):
    """Focal lengths and centre [pixels], and the least depth [m] that is seen."""

    fx: float
    fy: float
    cx: float
    cy: float
    near: float


class Exposed(NamedTuple):
    """Depth (h, w) [m], infinite at first, and who is seen (h, w): the number of a triangle, or `NOBODY`."""

    depth: Array
    owner: Ints


@kernel
def expose(triangles: Array, lens: Lens, film: Exposed) -> None:
    """Draw triangles (t, 3, 3) [m] in camera axes."""
    corners = np.empty((4, 3))
    flat = np.empty((4, 2))
    for i in range(len(triangles)):
        count = _cut_at_near(triangles[i], lens.near, corners)
        if count < 3:
            continue
        for k in range(count):
            flat[k, 0] = lens.fx * corners[k, 0] / corners[k, 2] + lens.cx
            flat[k, 1] = lens.fy * corners[k, 1] / corners[k, 2] + lens.cy
        _fill(i, triangles[i], flat, count, lens, film)


@kernel
def _cut_at_near(triangle: Array, near: float, corners: Array) -> int:
    """The part of a triangle with z >= near, as 0, 3 or 4 `corners`; returns how many."""
    count = 0
    for k in range(3):
        a, b = triangle[k], triangle[(k + 1) % 3]
        if a[2] >= near:
            corners[count] = a
            count += 1
        if (a[2] >= near) != (b[2] >= near):
            share = (near - a[2]) / (b[2] - a[2])
            for c in range(2):
                corners[count, c] = a[c] + share * (b[c] - a[c])
            corners[count, 2] = near
            count += 1
    return count


@kernel
def _fill(number: int, triangle: Array, flat: Array, count: int, lens: Lens, film: Exposed) -> None:
    """Draw a convex polygon of `count` corners `flat` (4, 2) [pixels] that lies in the plane of a triangle."""
    nx, ny, nz, d = _plane(triangle)
    if nx == 0.0 and ny == 0.0 and nz == 0.0:
        return
    area = 0.0
    for k in range(count):
        j = (k + 1) % count
        area += flat[k, 0] * flat[j, 1] - flat[j, 0] * flat[k, 1]
    sign = 1.0 if area >= 0.0 else -1.0
    height, width = film.depth.shape
    left, right, top, bottom = flat[0, 0], flat[0, 0], flat[0, 1], flat[0, 1]
    for k in range(1, count):
        left, right = min(left, flat[k, 0]), max(right, flat[k, 0])
        top, bottom = min(top, flat[k, 1]), max(bottom, flat[k, 1])
    if right < 0.0 or left > width - 1 or bottom < 0.0 or top > height - 1:
        return
    u0, u1 = int(max(np.ceil(left - EDGE), 0.0)), int(min(np.floor(right + EDGE), width - 1.0))
    v0, v1 = int(max(np.ceil(top - EDGE), 0.0)), int(min(np.floor(bottom + EDGE), height - 1.0))
    for v in range(v0, v1 + 1):
        for u in range(u0, u1 + 1):
            inside = True
            for k in range(count):
                j = (k + 1) % count
                du, dv = flat[j, 0] - flat[k, 0], flat[j, 1] - flat[k, 1]
                beside = sign * (du * (v - flat[k, 1]) - dv * (u - flat[k, 0]))
                if beside < -EDGE * (abs(du) + abs(dv)):
                    inside = False
                    break
            if not inside:
                continue
            steep = nx * ((u - lens.cx) / lens.fx) + ny * ((v - lens.cy) / lens.fy) + nz
            if steep == 0.0:
                continue  # seen edge on
            depth = d / steep
            if lens.near <= depth < film.depth[v, u]:
                film.depth[v, u] = depth
                film.owner[v, u] = number


@kernel
def _plane(triangle: Array) -> tuple[float, float, float, float]:
    """Normal, not of unit length, and its product with any point of the plane."""
    ax, ay, az = triangle[0, 0], triangle[0, 1], triangle[0, 2]
    bx, by, bz = triangle[1, 0] - ax, triangle[1, 1] - ay, triangle[1, 2] - az
    cx, cy, cz = triangle[2, 0] - ax, triangle[2, 1] - ay, triangle[2, 2] - az
    nx, ny, nz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    return nx, ny, nz, nx * ax + ny * ay + nz * az


@kernel
def shade(triangles: Array, colors: Bytes, lens: Lens, film: Exposed, ambient: float, pixels: Bytes) -> None:
    """Colours (h, w, 3) of what is seen, as a lamp beside the lens lights it (Lambert); the rest stays as it is.

    A face shines with the share `ambient` of its colour, and with the rest times the cosine to the ray.
    """
    height, width = film.depth.shape
    for v in range(height):
        for u in range(width):
            number = film.owner[v, u]
            if number < 0:
                continue
            nx, ny, nz, _ = _plane(triangles[number])
            x, y = (u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy
            length = np.sqrt((nx * nx + ny * ny + nz * nz) * (x * x + y * y + 1.0))
            light = ambient + (1.0 - ambient) * abs(nx * x + ny * y + nz) / length
            for c in range(3):
                pixels[v, u, c] = np.uint8(min(colors[number, c] * light + 0.5, 255.0))


@kernel
def trace(lines: Array, colors: Bytes, lens: Lens, film: Exposed, pixels: Bytes) -> None:
    """Draw lines (l, 2, 3) [m] in camera axes, one pixel thick, where no face is in front of them."""
    height, width = film.depth.shape
    for i in range(len(lines)):
        a, b = lines[i, 0].copy(), lines[i, 1].copy()
        if a[2] < lens.near and b[2] < lens.near:
            continue
        if a[2] < lens.near:
            a += (lens.near - a[2]) / (b[2] - a[2]) * (b - a)
        if b[2] < lens.near:
            b += (lens.near - b[2]) / (a[2] - b[2]) * (a - b)
        au, av = lens.fx * a[0] / a[2] + lens.cx, lens.fy * a[1] / a[2] + lens.cy
        bu, bv = lens.fx * b[0] / b[2] + lens.cx, lens.fy * b[1] / b[2] + lens.cy
        low, high = _share_inside(au, bu, width, 0.0, 1.0)
        low, high = _share_inside(av, bv, height, low, high)
        if low > high:
            continue
        count = int((high - low) * max(abs(bu - au), abs(bv - av))) + 1
        for k in range(count + 1):
            share = low + (high - low) * k / count
            u, v = int(np.floor(au + share * (bu - au) + 0.5)), int(np.floor(av + share * (bv - av) + 0.5))
            if not (0 <= u < width and 0 <= v < height):
                continue
            depth = 1.0 / (1.0 / a[2] + share * (1.0 / b[2] - 1.0 / a[2]))
            if depth * (1.0 - IN_FRONT) <= film.depth[v, u]:
                for c in range(3):
                    pixels[v, u, c] = colors[i, c]


@kernel
def _share_inside(a: float, b: float, size: int, low: float, high: float) -> tuple[float, float]:
    """The shares of the way from `a` to `b` that lie in -0.5 … size - 0.5, within `low` to `high`."""
    first, last = -0.5 - a, size - 0.5 - a
    way = b - a
    if way == 0.0:
        return (low, high) if first <= 0.0 <= last else (1.0, 0.0)
    if way < 0.0:
        first, last = last, first
    return max(low, first / way), min(high, last / way)


@kernel
def logarithms(values: Array, out: Array) -> None:
    """Natural logarithms (n,)."""
    for i in range(len(values)):
        out[i] = log(values[i])
