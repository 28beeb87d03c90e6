"""What sensors see: triangles with colours, in the world."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen

Bytes = NDArray[np.uint8]


@frozen(kw_only=False, eq=False)
class Scenery:
    """Triangles (t, 3, 3) [m] in the world by corners, their colours (t, 3) from 0 to 255; lines (l, 2, 3) [m]."""

    triangles: Array
    colors: Bytes
    lines: Array
    line_colors: Bytes

    @staticmethod
    def of(parts: Iterable[tuple[Array, Bytes]], lines: Iterable[tuple[Array, Bytes]] = ()) -> Scenery:
        """All `parts`: triangles with one colour (3,) or one each (t, 3); and lines likewise."""
        return Scenery(*_joined(parts, 3), *_joined(lines, 2))


def _joined(parts: Iterable[tuple[Array, Bytes]], corners: int) -> tuple[Array, Bytes]:
    shapes, colors = [np.zeros((0, corners, 3))], [np.zeros((0, 3), dtype=np.uint8)]
    for points, color in parts:
        shapes.append(points)
        colors.append(np.broadcast_to(color, (len(points), 3)))
    return np.concatenate(shapes), np.ascontiguousarray(np.concatenate(colors))
