"""Removal from the columns of one field along pieces whose axis has any direction and may turn.

Where the axis keeps its direction the removal from each column is exact. Where it turns, the body is looked at in
poses of which no point moves by more than half a cell, and what it sweeps between two of them is taken as the hull of
both: too little by less than the square of that way over eight times the radius of the body, an 800th of a cell for a
radius of ten cells.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH_SHIFT, Columns, Field
from gcodesim.material.removal_kernels import subtract
from gcodesim.material.slab_kernels import Slab, at_pose, line_of, swept
from gcodesim.material.sweep_kernels import columns_across_x, columns_across_y, x_of, y_of
from gcodesim.material.wall_kernels import shorten_walls

Array = NDArray[np.float64]

POSE_STEP = 0.5
"""Cells that a point of a turning body moves by at most from one pose to the next."""

TOGETHER = 8
"""Poses for which the columns nearby are looked for at once."""

FAR = 4.0
"""Radii after which a straight way is looked at in a further part: columns near a slanting one are then fewer."""

SAME_AXIS = 1.0e-9


class ToolWay(NamedTuple):
    """Pieces of a tip's way, each (c, 3), in axes of the field: tips [m], and unit vectors to the holder at the ends.

    Between them the axis is that of the weighted mean of both vectors.
    """

    starts: Array
    ends: Array
    axes_start: Array
    axes_end: Array


class ToolPose(NamedTuple):
    """Tip (u, v, w) and unit axis (au, av, aw)."""

    u: float
    v: float
    w: float
    au: float
    av: float
    aw: float


class SlabReach(NamedTuple):
    """Room around a slab: least and most u, v, w [m]."""

    u0: float
    u1: float
    v0: float
    v1: float
    w0: float
    w1: float


@kernel(lean=True)
def slab_at(slabs: Array, number: int) -> Slab:
    """A row of `slabs` (m, 6)."""
    return Slab(
        slabs[number, 0], slabs[number, 1], slabs[number, 2], slabs[number, 3], slabs[number, 4], slabs[number, 5]
    )


@kernel(lean=True)
def pose_at(way: ToolWay, p: int, t: float) -> ToolPose:
    """The pose at the share t of piece p."""
    starts, ends, axes_start, axes_end = way
    au = axes_start[p, 0] + t * (axes_end[p, 0] - axes_start[p, 0])
    av = axes_start[p, 1] + t * (axes_end[p, 1] - axes_start[p, 1])
    aw = axes_start[p, 2] + t * (axes_end[p, 2] - axes_start[p, 2])
    norm = np.sqrt(au * au + av * av + aw * aw)
    return ToolPose(
        starts[p, 0] + t * (ends[p, 0] - starts[p, 0]),
        starts[p, 1] + t * (ends[p, 1] - starts[p, 1]),
        starts[p, 2] + t * (ends[p, 2] - starts[p, 2]),
        au / norm,
        av / norm,
        aw / norm,
    )


@kernel(lean=True)
def reach_of(slab: Slab, pose: ToolPose) -> SlabReach:
    """Room around the cylinder that holds a slab."""
    r = slab.widest
    ru = r * np.sqrt(max(0.0, 1.0 - pose.au * pose.au))
    rv = r * np.sqrt(max(0.0, 1.0 - pose.av * pose.av))
    rw = r * np.sqrt(max(0.0, 1.0 - pose.aw * pose.aw))
    ua, ub = slab.h0 * pose.au, slab.h1 * pose.au
    va, vb = slab.h0 * pose.av, slab.h1 * pose.av
    wa, wb = slab.h0 * pose.aw, slab.h1 * pose.aw
    return SlabReach(
        pose.u + min(ua, ub) - ru, pose.u + max(ua, ub) + ru, pose.v + min(va, vb) - rv, pose.v + max(va, vb) + rv,
        pose.w + min(wa, wb) - rw, pose.w + max(wa, wb) + rw,
    )  # fmt: skip


@kernel(lean=True)
def joined(one: SlabReach, other: SlabReach) -> SlabReach:
    """Room around both."""
    return SlabReach(
        min(one.u0, other.u0), max(one.u1, other.u1), min(one.v0, other.v0), max(one.v1, other.v1),
        min(one.w0, other.w0), max(one.w1, other.w1),
    )  # fmt: skip


@kernel(lean=True)
def cut_straight(field: Field, slab: Slab, begin: ToolPose, end: ToolPose) -> tuple[float, bool]:
    """Remove what a slab sweeps from pose to pose with the axis of the first; (length [m], whether there was room)."""
    columns, grid, walls, dirty, _ = field
    lo, hi, count = columns
    nx, ny = count.shape
    reach = joined(reach_of(slab, begin), reach_of(slab, end))
    first_i, last_i = columns_across_x(grid, nx, reach.u0, reach.u1)
    first_j, last_j = columns_across_y(grid, ny, reach.v0, reach.v1)
    mu, mv, mw = end.u - begin.u, end.v - begin.v, end.w - begin.w
    total = 0.0
    for i in range(first_i, last_i):
        u = x_of(grid, i) - begin.u
        for j in range(first_j, last_j):
            n = count[i, j]
            if n == 0 or hi[i, j, n - 1] <= reach.w0 or lo[i, j, 0] >= reach.w1:
                continue
            line = line_of(u, y_of(grid, j) - begin.v, begin.au, begin.av, begin.aw, mu, mv, mw, slab)
            low, high = swept(line, slab)
            if low >= high:
                continue
            gone = subtract(columns, i, j, begin.w + low, begin.w + high)
            if gone < 0.0:
                return total, False
            if gone > 0.0:
                total += gone
                if walls.shape[0] > 0:
                    shorten_walls(walls, i, j, gone)
                dirty[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = 1
    return total, True


@kernel(lean=True)
def cut_turning(
    field: Field, slab: Slab, way: ToolWay, p: int, first: int, last: int, poses: int
) -> tuple[float, bool]:
    """Remove what a slab sweeps from pose `first` to `last` of piece p, which has `poses`; see `cut_straight`."""
    columns, grid, walls, dirty, _ = field
    lo, hi, count = columns
    nx, ny = count.shape
    reach = reach_of(slab, pose_at(way, p, first / poses))
    for k in range(first + 1, last + 1):
        reach = joined(reach, reach_of(slab, pose_at(way, p, k / poses)))
    first_i, last_i = columns_across_x(grid, nx, reach.u0, reach.u1)
    first_j, last_j = columns_across_y(grid, ny, reach.v0, reach.v1)
    total = 0.0
    for i in range(first_i, last_i):
        x = x_of(grid, i)
        for j in range(first_j, last_j):
            n = count[i, j]
            if n == 0 or hi[i, j, n - 1] <= reach.w0 or lo[i, j, 0] >= reach.w1:
                continue
            y = y_of(grid, j)
            held_low, held_high = 1.0, 0.0
            for k in range(first, last + 1):
                pose = pose_at(way, p, k / poses)
                line = line_of(x - pose.u, y - pose.v, pose.au, pose.av, pose.aw, 0.0, 0.0, 0.0, slab)
                low, high = at_pose(line, slab, 0.0)
                if low < high:
                    low, high = low + pose.w, high + pose.w
                    if held_low < held_high:  # bodies of neighbouring poses overlap, so what lies between is swept
                        held_low, held_high = min(held_low, low), max(held_high, high)
                    else:
                        held_low, held_high = low, high
                if held_low < held_high and (low >= high or k == last):
                    gone = subtract(columns, i, j, held_low, held_high)
                    if gone < 0.0:
                        return total, False
                    if gone > 0.0:
                        total += gone
                        if walls.shape[0] > 0:
                            shorten_walls(walls, i, j, gone)
                        dirty[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = 1
                    held_low, held_high = 1.0, 0.0
    return total, True


@kernel(lean=True)
def cut_along(field: Field, way: ToolWay, slabs: Array, first: int, taken: Array) -> int:
    """Remove pieces `first`... in order; returns the index of the piece that found no room, or their number.

    slabs (m, 6); taken (c,): what each piece takes of the columns [m³] is added.
    """
    starts, ends, axes_start, axes_end = way
    grid = field.grid
    cell, area = min(grid.dx, grid.dy), grid.dx * grid.dy
    tall, widest = 0.0, 0.0
    for number in range(len(slabs)):
        tall = max(tall, abs(slabs[number, 1]), abs(slabs[number, 2]))
        widest = max(widest, slabs[number, 5])
    for p in range(first, len(starts)):
        move, across, turn = 0.0, 0.0, 0.0
        for d in range(3):
            way_d, turn_d = ends[p, d] - starts[p, d], axes_end[p, d] - axes_start[p, d]
            move += way_d * way_d
            turn += turn_d * turn_d
            if d < 2:
                across += way_d * way_d
        if turn <= SAME_AXIS * SAME_AXIS:
            parts = max(1, int(np.ceil(np.sqrt(across) / (FAR * widest))))
            for part in range(parts):
                begin, end = pose_at(way, p, part / parts), pose_at(way, p, (part + 1) / parts)
                for number in range(len(slabs)):
                    gone, ok = cut_straight(field, slab_at(slabs, number), begin, end)
                    taken[p] += gone * area
                    if not ok:
                        return p
            continue
        poses = max(1, int(np.ceil((np.sqrt(move) + np.sqrt(turn) * tall) / (POSE_STEP * cell))))
        for pose in range(0, poses, TOGETHER):
            for number in range(len(slabs)):
                gone, ok = cut_turning(field, slab_at(slabs, number), way, p, pose, min(pose + TOGETHER, poses), poses)
                taken[p] += gone * area
                if not ok:
                    return p
    return len(starts)


@kernel(lean=True)
def common_columns(one: Columns, other: Columns, both: Columns) -> None:
    """Fill `both` with what is in material in one set of columns and in the other, on the same grid."""
    nx, ny = one.number.shape
    for i in range(nx):
        for j in range(ny):
            a, b, n = 0, 0, 0
            while a < one.number[i, j] and b < other.number[i, j]:
                low = max(one.lo[i, j, a], other.lo[i, j, b])
                high = min(one.hi[i, j, a], other.hi[i, j, b])
                if low < high:
                    both.lo[i, j, n], both.hi[i, j, n] = low, high
                    n += 1
                if one.hi[i, j, a] < other.hi[i, j, b]:
                    a += 1
                else:
                    b += 1
            both.number[i, j] = n


@kernel(lean=True)
def depths_in(field: Field, way: ToolWay, slabs: Array, depths: Array) -> None:
    """How deep [m] a body is in material at the start of each piece (c,): how far a point on a column lies inside it,

    or the length of column inside, whichever is less. Nothing is removed.
    """
    columns, grid = field.columns, field.grid
    lo, hi, count = columns
    nx, ny = count.shape
    for p in range(len(depths)):
        depths[p] = 0.0
        pose = pose_at(way, p, 0.0)
        for number in range(len(slabs)):
            slab = slab_at(slabs, number)
            reach = reach_of(slab, pose)
            first_i, last_i = columns_across_x(grid, nx, reach.u0, reach.u1)
            first_j, last_j = columns_across_y(grid, ny, reach.v0, reach.v1)
            for i in range(first_i, last_i):
                x = x_of(grid, i) - pose.u
                for j in range(first_j, last_j):
                    n = count[i, j]
                    if n == 0 or hi[i, j, n - 1] <= reach.w0 or lo[i, j, 0] >= reach.w1:
                        continue
                    y = y_of(grid, j) - pose.v
                    line = line_of(x, y, pose.au, pose.av, pose.aw, 0.0, 0.0, 0.0, slab)
                    low, high = at_pose(line, slab, 0.0)
                    for k in range(n):
                        a, b = max(low, lo[i, j, k] - pose.w), min(high, hi[i, j, k] - pose.w)
                        if a < b:
                            s = 0.5 * (a + b)
                            h = line.height + s * pose.aw
                            r = np.sqrt(max(0.0, x * x + y * y + s * s - h * h))
                            depths[p] = max(depths[p], min(b - a, slab.widest - r))
