"""Compiled walks over a kinematic tree: joint frames, link poses, Jacobians."""

from __future__ import annotations

from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices, Tree


@kernel(lean=True)
def copy_row(source: Array, target: Array) -> None:
    """``target[:] = source`` for vectors (n,); a loop, because slice assignment takes seconds to compile."""
    for i in range(source.shape[0]):
        target[i] = source[i]


@kernel(lean=True)
def joint_frames(q: Array, parent: Indices, before: Array, axis: Array, prismatic: Indices, out: Array) -> None:
    """Poses of the moved joint frames, `out` (j, 4, 4), of one joint vector q (j,)."""
    for i in range(q.shape[0]):
        ax, ay, az = axis[i, 0], axis[i, 1], axis[i, 2]
        p = parent[i]
        for r in range(3):
            if p < 0:
                b0, b1, b2, b3 = before[i, r, 0], before[i, r, 1], before[i, r, 2], before[i, r, 3]
            else:
                o0, o1, o2 = out[p, r, 0], out[p, r, 1], out[p, r, 2]
                b0 = o0 * before[i, 0, 0] + o1 * before[i, 1, 0] + o2 * before[i, 2, 0]
                b1 = o0 * before[i, 0, 1] + o1 * before[i, 1, 1] + o2 * before[i, 2, 1]
                b2 = o0 * before[i, 0, 2] + o1 * before[i, 1, 2] + o2 * before[i, 2, 2]
                b3 = o0 * before[i, 0, 3] + o1 * before[i, 1, 3] + o2 * before[i, 2, 3] + out[p, r, 3]
            out[i, r, 0], out[i, r, 1], out[i, r, 2], out[i, r, 3] = b0, b1, b2, b3
        if prismatic[i] == 1:
            for r in range(3):
                out[i, r, 3] += (out[i, r, 0] * ax + out[i, r, 1] * ay + out[i, r, 2] * az) * q[i]
        else:
            c, s = cos_sin(q[i])
            v = 1.0 - c
            for r in range(3):
                b0, b1, b2 = out[i, r, 0], out[i, r, 1], out[i, r, 2]
                along = (b0 * ax + b1 * ay + b2 * az) * v
                # a row of R Rot(axis, q): Rodrigues' formula with the row on the left
                out[i, r, 0] = c * b0 + along * ax + s * (b1 * az - b2 * ay)
                out[i, r, 1] = c * b1 + along * ay + s * (b2 * ax - b0 * az)
                out[i, r, 2] = c * b2 + along * az + s * (b0 * ay - b1 * ax)
        out[i, 3, 0] = 0.0
        out[i, 3, 1] = 0.0
        out[i, 3, 2] = 0.0
        out[i, 3, 3] = 1.0


@kernel(lean=True)
def place(frames: Array, carrier: int, offset: Array, out: Array) -> None:
    """Pose `out` (4, 4) of something that rides on joint `carrier` (−1: base) at `offset` (4, 4)."""
    if carrier < 0:
        for r in range(4):
            for k in range(4):
                out[r, k] = offset[r, k]
        return
    for r in range(3):
        f0, f1, f2 = frames[carrier, r, 0], frames[carrier, r, 1], frames[carrier, r, 2]
        for k in range(4):
            out[r, k] = f0 * offset[0, k] + f1 * offset[1, k] + f2 * offset[2, k]
        out[r, 3] += frames[carrier, r, 3]
        out[3, r] = 0.0
    out[3, 3] = 1.0


@kernel(lean=True)
def fill_jacobian(
    frames: Array, axis: Array, prismatic: Indices, path: Indices, px: float, py: float, pz: float, out: Array
) -> None:
    """Geometric Jacobian `out` (6, j) of the point p, base axes; columns of joints off the path are zero."""
    for i in range(axis.shape[0]):
        for r in range(6):
            out[r, i] = 0.0
        if path[i] == 0:
            continue
        ax, ay, az = axis[i, 0], axis[i, 1], axis[i, 2]
        zx = frames[i, 0, 0] * ax + frames[i, 0, 1] * ay + frames[i, 0, 2] * az
        zy = frames[i, 1, 0] * ax + frames[i, 1, 1] * ay + frames[i, 1, 2] * az
        zz = frames[i, 2, 0] * ax + frames[i, 2, 1] * ay + frames[i, 2, 2] * az
        if prismatic[i] == 1:
            out[0, i], out[1, i], out[2, i] = zx, zy, zz
        else:
            dx, dy, dz = px - frames[i, 0, 3], py - frames[i, 1, 3], pz - frames[i, 2, 3]
            out[0, i], out[1, i], out[2, i] = zy * dz - zz * dy, zz * dx - zx * dz, zx * dy - zy * dx
            out[3, i], out[4, i], out[5, i] = zx, zy, zz


@kernel(lean=True)
def poses_along(q: Array, tree: Tree, carrier: Indices, offset: Array, frames: Array, out: Array) -> None:
    """Poses `out` (n, m, 4, 4) of m riders along a joint path q (n, j); `frames` (j, 4, 4) is room to work in."""
    parent, before, axis, prismatic = tree.parent, tree.before, tree.axis, tree.prismatic
    for k in range(q.shape[0]):
        joint_frames(q[k], parent, before, axis, prismatic, frames)
        for m in range(carrier.shape[0]):
            place(frames, carrier[m], offset[m], out[k, m])


@kernel(lean=True)
def jacobians_along(q: Array, tree: Tree, frames: Array, flange: Array, out: Array) -> None:
    """Jacobians `out` (n, 6, j) at the flange along a joint path; `frames` (j, 4, 4), `flange` (4, 4) are room."""
    parent, before, axis, prismatic, path = tree.parent, tree.before, tree.axis, tree.prismatic, tree.path
    carrier, offset = tree.flange_carrier, tree.flange_offset
    for k in range(q.shape[0]):
        joint_frames(q[k], parent, before, axis, prismatic, frames)
        place(frames, carrier, offset, flange)
        fill_jacobian(frames, axis, prismatic, path, flange[0, 3], flange[1, 3], flange[2, 3], out[k])
