"""A tree over passes of tools, so that a point asks only those that come near to it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.pass_kernels import PassBodies, PassPieces
from gcodesim.material.pass_tree_kernels import PassTree, Rooms, fill_rooms

Array = NDArray[np.float64]

STRETCH: Final = 0.125
"""Length of a stretch of a pass, in widths of what acts."""

MOST_STRETCHES: Final = 1024
"""Of one pass."""

ACROSS: Final = 64
ALONG: Final = 256
"""Cells of a room, across and along the axis of what acts."""

BESIDE: Final = 0.25
"""How far a room goes beyond its outline, in sizes of this."""

BITS: Final = 12
"""Halvings of the room of all stretches by which near ones come side by side."""

ROUNDING: Final = 1.0e-12
"""Radius [m] by which balls of tips are larger than their points need."""


def pass_tree(pieces: PassPieces, bodies: PassBodies) -> PassTree:
    """The tree over at least one piece."""
    length = np.sqrt(np.square(pieces.ends - pieces.starts).sum(axis=1))
    width = np.maximum(STRETCH * bodies.extent[pieces.body, 0], ROUNDING)
    stretches = np.clip(np.ceil(length / width), 1, MOST_STRETCHES).astype(np.int64)
    piece = np.repeat(np.arange(len(length)), stretches)
    place = np.arange(len(piece)) - np.repeat(np.cumsum(stretches) - stretches, stretches)
    share = np.stack([place, place + 1]) / stretches[piece]
    middle = pieces.starts[piece] + 0.5 * share.sum(axis=0)[:, None] * (pieces.ends - pieces.starts)[piece]
    order = np.lexsort((_along_the_curve(middle), pieces.body[piece]))
    leaves = 1 << int(len(piece) - 1).bit_length()
    order = order[np.minimum(np.arange(leaves), len(piece) - 1)]  # the last one once more where none is left
    piece, share = piece[order], share[:, order]
    body = pieces.body[piece]
    return PassTree(
        tips=_balls(pieces.starts, pieces.ends, piece, share),
        axes=_directions(_balls(pieces.axes_start, pieces.axes_end, piece, share)),
        body=_nodes(body, lambda one, other: np.where(one == other, one, np.int32(-1))),
        first=_nodes(piece, np.minimum),
        rooms=_rooms(bodies),
    )


def _along_the_curve(points: Array) -> NDArray[np.int64]:
    """Numbers (n,) of the cubes of points (n, 3): cubes with near numbers are near (the curve of Morton 1966)."""
    low = points.min(axis=0)
    size = float((points.max(axis=0) - low).max()) or 1.0
    place = np.minimum((points - low) / size * (1 << BITS), (1 << BITS) - 1).astype(np.int64)
    number = np.zeros(len(points), dtype=np.int64)
    for bit in range(BITS):
        for axis in range(3):
            number |= (place[:, axis] >> bit & 1) << (3 * bit + axis)
    return number


def _nodes(leaves: Any, joined: Callable[[Any, Any], Any]) -> Any:
    """What each node of a tree has, from that of its leaves (n, …) up: (2n, …). There is no node 0."""
    levels = [leaves]
    while len(levels[-1]) > 1:
        levels.append(joined(levels[-1][0::2], levels[-1][1::2]))
    return np.concatenate([levels[-1], *reversed(levels)])


def _rooms(bodies: PassBodies) -> Rooms:
    outlines = np.split(bodies.points, bodies.first[1:-1])
    low = np.array([outline.min(axis=0) for outline in outlines])
    size = np.array([outline.max(axis=0) for outline in outlines]) - low
    margin = BESIDE * size.min(axis=1)[:, None] + ROUNDING
    cell = (size + 2.0 * margin) / np.array([ACROSS, ALONG])
    diagonal = np.sqrt(np.square(cell).sum(axis=1))
    rooms = Rooms(
        least=np.zeros((len(outlines), ACROSS, ALONG)),
        room=np.ascontiguousarray(np.column_stack([low - margin, cell, diagonal])),
    )
    fill_rooms(bodies, rooms)
    return rooms


def _balls(starts: Array, ends: Array, piece: NDArray[np.int64], share: Array) -> Array:
    """Around what moves straight from `starts` to `ends` (c, 3), in the stretches of each node: (2n, 4)."""
    one, other = (starts[piece] + t[:, None] * (ends[piece] - starts[piece]) for t in share)
    least = _nodes(np.minimum(one, other), np.minimum)
    most = _nodes(np.maximum(one, other), np.maximum)
    radius = 0.5 * np.sqrt(np.square(most - least).sum(axis=1)) + ROUNDING
    return np.ascontiguousarray(np.column_stack([0.5 * (least + most), radius]))


def _directions(balls: Array) -> Array:
    """Balls (k, 4) around unit vectors for the directions in such balls: the way from u to v is at most 2 |u - v| over
    |u| + |v| as that of their directions."""
    size = np.sqrt(np.square(balls[:, :3]).sum(axis=1))
    least = np.maximum(2.0 * size - balls[:, 3], 1e-300)
    radius = np.minimum(np.where(balls[:, 3] < size, 2.0 * balls[:, 3] / least, 2.0), 2.0)
    middle = np.where(size[:, None] > 0.0, balls[:, :3] / np.maximum(size, 1e-300)[:, None], [0.0, 0.0, 1.0])
    return np.ascontiguousarray(np.column_stack([middle, radius]))
