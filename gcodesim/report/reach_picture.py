"""The region that an arm reaches: a drawing from above and from the side (SVG), and a mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.material.surface import Surface
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.planning.place import Region

_SCALE: Final = 0.25  # pixels for each mm
_MARGIN: Final = 30.0  # pixels around each view
_REACHED, _NOW, _BEST, _INK = "#cfe3f5", "#999999", "#c0392b", "#333333"
# the six sides of a cell: axis, upper side?, corners counter-clockwise from outside
_SIDES: Final = (
    (0, 1, ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))),
    (0, 0, ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0))),
    (1, 1, ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0))),
    (1, 0, ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1))),
    (2, 1, ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))),
    (2, 0, ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0))),
)


def mesh_of(region: Region) -> Surface:
    """The closed surface of all cells inside, in the world [m]."""
    shape = region.inside.shape
    padded = np.pad(region.inside, 1)
    corners: list[NDArray[np.int64]] = []
    for axis, upper, square in _SIDES:
        beyond = np.roll(padded, -1 if upper else 1, axis=axis)[1:-1, 1:-1, 1:-1]
        cells = np.argwhere(region.inside & ~beyond)
        corners.append(cells[:, None, :] + np.array(square))
    squares = np.concatenate(corners).reshape(-1, 4, 3)
    numbers = np.ravel_multi_index(tuple(np.moveaxis(squares, -1, 0)), tuple(n + 1 for n in shape))
    used, index = np.unique(numbers, return_inverse=True)
    index = index.reshape(-1, 4)
    faces = np.concatenate([index[:, [0, 1, 2]], index[:, [0, 2, 3]]]).astype(np.int32)
    at = np.stack(np.unravel_index(used, tuple(n + 1 for n in shape)), axis=-1)
    cut = np.zeros(len(faces), dtype=np.uint8)
    return Surface(vertices=region.corner + region.cell * at, faces=faces, cut=cut)


def picture_of(region: Region, path: Array, shift: Array | None, base: Array) -> str:
    """SVG of two sections through the middle of the path (k, 3) [m] in the world, from above and from the side.

    The path is drawn where it is and, with a `shift` (3,) [m], where it is proposed; `base` (3,) is the arm's.
    """
    proposed = path if shift is None else path + shift
    middle = 0.5 * (proposed.min(axis=0) + proposed.max(axis=0))
    size = np.array(region.inside.shape) * region.cell / MM * _SCALE
    width, height = 2.0 * size[0] + 3.0 * _MARGIN, max(size[1], size[2]) + 2.0 * _MARGIN
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}"'
        f' viewBox="0 0 {width:.0f} {height:.0f}" font-family="sans-serif" font-size="12">',
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="white"/>',
    ]
    for number, (across, up, cut) in enumerate(((0, 1, 2), (0, 2, 1))):
        left = _MARGIN + number * (size[0] + _MARGIN)
        top = _MARGIN
        layer = int(np.clip((middle[cut] - region.corner[cut]) // region.cell, 0, region.inside.shape[cut] - 1))
        inside = np.take(region.inside, layer, axis=cut)
        parts += _cells(inside, region.cell, left, top)

        def at(points: Array, left: float = left, top: float = top, across: int = across, up: int = up) -> str:
            x = left + (points[:, across] - region.corner[across]) / MM * _SCALE
            y = top + size[up] - (points[:, up] - region.corner[up]) / MM * _SCALE
            return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))

        parts.append(f'<polyline points="{at(path)}" fill="none" stroke="{_NOW}" stroke-width="1"/>')
        if shift is not None:
            parts.append(f'<polyline points="{at(proposed)}" fill="none" stroke="{_BEST}" stroke-width="1.5"/>')
        x, y = at(base[None]).split(",")
        parts.append(f'<circle cx="{x}" cy="{y}" r="5" fill="{_INK}"/>')
        name, third = ("from above", "Z") if number == 0 else ("from the side", "Y")
        title = f"{name}, section at {third} {middle[cut] / MM:.0f} mm"
        parts.append(f'<text x="{left:.0f}" y="{top - 10:.0f}" fill="{_INK}">{title}</text>')
    parts.append("</svg>\n")
    return "\n".join(parts)


def _cells(inside: NDArray[np.bool_], cell: float, left: float, top: float) -> list[str]:
    """Rows of cells, each run of them one rectangle."""
    side = cell / MM * _SCALE
    rows = []
    for j in range(inside.shape[1]):
        row = np.concatenate([[False], inside[:, j], [False]]).astype(np.int8)
        begins, ends = np.flatnonzero(np.diff(row) == 1), np.flatnonzero(np.diff(row) == -1)
        y = top + (inside.shape[1] - 1 - j) * side
        rows += [
            f'<rect x="{left + a * side:.1f}" y="{y:.1f}" width="{(b - a) * side:.1f}" height="{side:.1f}"'
            f' fill="{_REACHED}"/>'
            for a, b in zip(begins.tolist(), ends.tolist(), strict=True)
        ]
    return rows
