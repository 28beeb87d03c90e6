"""How far a body is above whatever lies below it: both are looked at along a grid of vertical lines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.solids.mesh_file import Faces, Triangles
from gcodesim.solids.resting_kernels import extreme_heights

LINES: Final = 24
"""Vertical lines along each side of the body's outline seen from above; its corners have a line each besides."""

LEVEL: Final = 1e-9
"""[m] by which a floor may be higher than a body that counts as what is stood on."""

SUNK: Final = 2e-3
"""[m] by which a support may reach into a body and still be below it."""

_NOWHERE: Final = -1e9
"""[m], lower than anything is."""


@frozen(eq=False)
class Ground:
    """What a body may come to lie on: the skins of `others` in the world, and a level floor at height `floor` [m]."""

    others: Mapping[str, Triangles]
    floor: float


def is_bare_below(body: Triangles, others: Iterable[Triangles]) -> bool:
    """Whether none of `others` is below a body, however far."""
    numbered = {str(number): other for number, other in enumerate(others)}
    return not gap_below(body, Ground(others=numbered, floor=_NOWHERE))[1]


def gap_below(body: Triangles, ground: Ground) -> tuple[float, str]:
    """How far [m] a body can go down, and the name of what it then lies on; "" is the floor.

    Exact for level faces; elsewhere as good as the grid of lines. Never below 0.
    """
    points, faces = body.points, body.faces
    low, high = points.min(axis=0), points.max(axis=0)
    share = (np.arange(LINES) + 0.5) / LINES
    x, y = np.meshgrid(low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1]), indexing="ij")
    inner = points[:, :2] + 1e-6 * (0.5 * (low + high)[:2] - points[:, :2])
    lines = np.concatenate([np.column_stack([x.ravel(), y.ravel()]), inner])
    bottom = _extreme(points, faces, lines, highest=False)
    best, name = float(low[2]) - ground.floor, ""
    for other, skin in ground.others.items():
        corners, triangles = skin.points, skin.faces
        at = corners[triangles]
        near = (at[:, :, :2].min(axis=1) <= high[:2]).all(axis=1) & (at[:, :, :2].max(axis=1) >= low[:2]).all(axis=1)
        if not near.any() or float(at[near][:, :, 2].min()) > high[2]:
            continue
        top = _extreme(corners, triangles[near], lines, highest=True, below=bottom + SUNK)
        with np.errstate(invalid="ignore"):
            gap = bottom - top
        here = np.isfinite(gap)
        if here.any() and float(gap[here].min()) < best + LEVEL:
            best, name = float(gap[here].min()), other
    return max(best, 0.0), name


def _extreme(points: Array, faces: Faces, lines: Array, *, highest: bool, below: Array | None = None) -> Array:
    """Height (n,) at which each vertical line (n, 2) meets triangles: the highest up to `below`, or the lowest.

    Lines that meet none have -inf or inf.
    """
    up_to = np.full(len(lines), np.inf) if below is None else below
    found = np.empty(len(lines))
    extreme_heights(
        np.ascontiguousarray(points), np.ascontiguousarray(faces, dtype=np.int64), lines, up_to, highest, found
    )
    return found
