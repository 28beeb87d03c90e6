"""Profiles of revolution: for each thin disc of a bar the rings of material in it, and what a convex blade takes.

The half plane of a lathe has z along the spindle and r away from it. A disc has a short sorted list of rings
[lo, hi] in r; radii are exact, z is sampled at the middle of the discs. The volume of a ring is pi (hi² - lo²) dz.
"""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Array, Ints

LEAST_RING = 1.0e-10
"""Rings thinner than this [m] are rounding."""


@kernel(lean=True)
def swept_outline(blade: Array, dz: float, dr: float, out: Array) -> int:
    """The outline of what a convex `blade` (m, 2) (z, r; counter-clockwise) sweeps along (dz, dr), its start first.

    The sum of a convex polygon and a line is the polygon with two edges more. Into `out` (m + 2, 2); returns how many
    points it has.
    """
    m = len(blade)
    count = 0
    for i in range(m):
        before, after = blade[i - 1], blade[i]
        last = (after[1] - before[1]) * dz - (after[0] - before[0]) * dr  # outward normal times the way
        following = blade[(i + 1) % m]
        following_turn = (following[1] - after[1]) * dz - (following[0] - after[0]) * dr
        was, is_ = last > 0.0, following_turn > 0.0
        if was or not is_:
            out[count, 0], out[count, 1] = after[0], after[1]
            if was:
                out[count, 0] += dz
                out[count, 1] += dr
            count += 1
            if was and not is_:
                out[count, 0], out[count, 1] = after[0], after[1]
                count += 1
        else:
            out[count, 0], out[count, 1] = after[0], after[1]
            out[count + 1, 0], out[count + 1, 1] = after[0] + dz, after[1] + dr
            count += 2
    return count


@kernel(lean=True)
def discs_across(outline: Array, count: int, z: float, dz: float, low: Array, high: Array) -> tuple[int, int]:
    """Where each disc's middle crosses a convex outline of `count` points: r from `low` to `high`.

    Returns the discs from first to (not including) last; between them both arrays are filled.
    """
    n = len(low)
    least, most = outline[0, 0], outline[0, 0]
    for i in range(count):
        least, most = min(least, outline[i, 0]), max(most, outline[i, 0])
    first = max(0, int(np.ceil((least - z) / dz - 0.5)))
    last = min(n, int(np.floor((most - z) / dz - 0.5)) + 1)
    if last <= first:
        return 0, 0
    for j in range(first, last):
        low[j], high[j] = np.inf, -np.inf
    for i in range(count):
        az, ar = outline[i - 1, 0], outline[i - 1, 1]
        bz, br = outline[i, 0], outline[i, 1]
        if i == 0:
            az, ar = outline[count - 1, 0], outline[count - 1, 1]
        if bz < az:
            az, ar, bz, br = bz, br, az, ar
        if bz <= az:
            continue
        begin = max(first, int(np.ceil((az - z) / dz - 0.5)))
        end = min(last, int(np.floor((bz - z) / dz - 0.5)) + 1)
        slope = (br - ar) / (bz - az)
        for j in range(begin, end):
            r = ar + (z + (j + 0.5) * dz - az) * slope
            low[j], high[j] = min(low[j], r), max(high[j], r)
    return first, last


@kernel(lean=True)
def take_ring(lo: Array, hi: Array, number: Ints, j: int, a: float, b: float) -> float:
    """Take radii a to b out of disc `j`; the volume over pi dz, or -1 where the disc has no room for one ring more."""
    n, k = number[j], lo.shape[1]
    if n == k and n > 0:  # only a cut inside one ring makes one more
        for i in range(n):
            if lo[j, i] + LEAST_RING < a and b < hi[j, i] - LEAST_RING:
                return -1.0
    taken = 0.0
    i = 0
    while i < number[j]:
        low, high = lo[j, i], hi[j, i]
        if high <= a or low >= b:
            i += 1
            continue
        inner, outer = max(low, a), min(high, b)
        taken += outer * outer - inner * inner
        keeps_inner, keeps_outer = inner - low > LEAST_RING, high - outer > LEAST_RING
        if keeps_inner and keeps_outer:
            for s in range(number[j], i + 1, -1):
                lo[j, s], hi[j, s] = lo[j, s - 1], hi[j, s - 1]
            hi[j, i], lo[j, i + 1], hi[j, i + 1] = inner, outer, high
            number[j] += 1
            i += 2
        elif keeps_inner:
            hi[j, i] = inner
            i += 1
        elif keeps_outer:
            lo[j, i] = outer
            i += 1
        else:
            taken += inner * inner - low * low + high * high - outer * outer
            for s in range(i, number[j] - 1):
                lo[j, s], hi[j, s] = lo[j, s + 1], hi[j, s + 1]
            number[j] -= 1
    return taken


@kernel(lean=True)
def ring_at(lo: Array, hi: Array, number: Ints, z: float, dz: float, at_z: float, at_r: float) -> bool:
    """Whether a point of the half plane is in material."""
    j = int(np.floor((at_z - z) / dz))
    if j < 0 or j >= len(number):
        return False
    r = abs(at_r)
    inside = False
    for i in range(number[j]):
        inside = inside or lo[j, i] <= r < hi[j, i]
    return inside


@kernel(lean=True)
def profile_volume(lo: Array, hi: Array, number: Ints, dz: float) -> float:
    """Volume [m³] of all rings."""
    total = 0.0
    for j in range(len(number)):
        for i in range(number[j]):
            total += hi[j, i] * hi[j, i] - lo[j, i] * lo[j, i]
    return np.pi * dz * total


@kernel(lean=True)
def label_rings(lo: Array, hi: Array, number: Ints, mark: Ints) -> None:
    """Mark (n, k) with 1 what hangs together with what the jaws hold, with 0 what is loose.

    Jaws hold the outer ring of the first disc that has material.

    Rings of neighbouring discs hang together where they overlap. Goes there and back until nothing changes.
    """
    n = len(number)
    mark[:] = 0
    start = 0
    while start < n and number[start] == 0:
        start += 1
    if start == n:
        return
    mark[start, number[start] - 1] = 1
    changed = True
    while changed:
        changed = False
        for way in range(2):
            for step in range(1, n):
                j = step if way == 0 else n - 1 - step
                before = j - 1 if way == 0 else j + 1
                for i in range(number[j]):
                    if mark[j, i]:
                        continue
                    for s in range(number[before]):
                        if mark[before, s] and min(hi[j, i], hi[before, s]) > max(lo[j, i], lo[before, s]):
                            mark[j, i] = 1
                            changed = True
                            break


@kernel
def columns_along(radii: Array, lo: Array, hi: Array, number: Ints, z: Array) -> tuple[Array, Array, Ints]:
    """Intervals along Z at some distances (m,) from the axis: lo, hi (m, k) [m] and how many of them (m,) are used.

    `lo`, `hi`, `number` are the rings of n runs of equal discs, run j from z[j] to z[j + 1].
    """
    m, n = len(radii), len(number)
    count = np.zeros(m, dtype=np.int32)
    most = 1
    for p in range(m):
        inside = False
        for j in range(n):
            here = _in_rings(lo, hi, number, j, radii[p])
            count[p] += here and not inside
            inside = here
        most = max(most, count[p])
    first, last = np.zeros((m, most)), np.zeros((m, most))
    for p in range(m):
        inside, i = False, -1
        for j in range(n):
            here = _in_rings(lo, hi, number, j, radii[p])
            if here and not inside:
                i += 1
                first[p, i] = z[j]
            if here:
                last[p, i] = z[j + 1]
            inside = here
    return first, last, count


@kernel(lean=True, inlined=True)
def _in_rings(lo: Array, hi: Array, number: Ints, j: int, r: float) -> bool:
    inside = False
    for i in range(number[j]):
        inside = inside or lo[j, i] <= r < hi[j, i]
    return inside


@kernel
def columns_across(
    lo: Array, hi: Array, number: Ints, z: float, dz: float, beside: Array, heights: Array
) -> tuple[Array, Array, Ints]:
    """Intervals across the axis, at distances (a,) beside it and at heights (b,): lo, hi (a, b, k) [m], number (a, b).

    Discs are those of a profile, `dz` thick from `z` on.
    """
    a, b, k = len(beside), len(heights), max(1, 2 * lo.shape[1])
    first, last = np.zeros((a, b, k)), np.zeros((a, b, k))
    count = np.zeros((a, b), dtype=np.int32)
    for q in range(b):
        j = min(max(int(np.floor((heights[q] - z) / dz)), 0), len(number) - 1)
        rings = number[j]
        for p in range(a):
            n, aside = 0, beside[p] * beside[p]
            for side in range(2):
                for s in range(rings):
                    i = rings - 1 - s if side == 0 else s
                    outer, inner = hi[j, i] * hi[j, i] - aside, lo[j, i] * lo[j, i] - aside
                    if outer <= 0.0:
                        continue
                    far, near = np.sqrt(outer), np.sqrt(max(inner, 0.0))
                    if inner > 0.0:
                        first[p, q, n], last[p, q, n] = (-far, -near) if side == 0 else (near, far)
                        n += 1
                    elif side == 0:  # across the middle
                        first[p, q, n], last[p, q, n] = -far, far
                        n += 1
            count[p, q] = n
    return first, last, count
