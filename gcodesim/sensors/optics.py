"""A pinhole camera: from its intrinsics and a scenery to a picture and a map of depth."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied
from gcodesim.arithmetic.scalars import tan
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.sensors.raster_kernels import NOBODY, Exposed, Lens, expose, shade, trace
from gcodesim.sensors.scenery import Scenery

BACKGROUND: Final = (232, 236, 240)
"""Where nothing is seen."""

AMBIENT: Final = 0.35
"""The share of a colour that a face shows however it is turned."""


@frozen
class Optics:
    """Size [pixels], focal lengths and centre [pixels], and the least depth [m] that is seen."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    near: float = 1e-3

    @staticmethod
    def of_view(width: int, height: int, angle: float, near: float = 1e-3) -> Optics:
        """Square pixels and the centre in the middle; `angle` [rad] from the left border to the right one."""
        f = 0.5 * width / tan(0.5 * angle)
        return Optics(width=width, height=height, fx=f, fy=f, cx=0.5 * (width - 1), cy=0.5 * (height - 1), near=near)

    @property
    def intrinsics(self) -> tuple[float, float, float, float]:
        return (self.fx, self.fy, self.cx, self.cy)

    @property
    def _lens(self) -> Lens:
        return Lens(self.fx, self.fy, self.cx, self.cy, self.near)

    def exposure(self, X_WC: Array, scenery: Scenery) -> Exposure:
        """What is seen from `X_WC` (4, 4)."""
        seen = _in_camera(X_WC, scenery.triangles)
        size = (self.height, self.width)
        film = Exposed(np.full(size, np.inf), np.full(size, NOBODY, dtype=np.int32))
        expose(seen, self._lens, film)
        return Exposure(optics=self, X_WC=X_WC, scenery=scenery, triangles=seen, film=film)


@frozen(eq=False)
class Exposure:
    """What a camera sees, before it is made into a picture; `triangles` (t, 3, 3) [m] are in camera axes."""

    optics: Optics
    X_WC: Array
    scenery: Scenery
    triangles: Array
    film: Exposed

    @property
    def depth(self) -> Array:
        """Depth along the optical axis (h, w) [m]; infinite where nothing is seen."""
        return self.film.depth

    def picture(self) -> NDArray[np.uint8]:
        """Red, green and blue (h, w, 3)."""
        pixels = np.empty((*self.film.depth.shape, 3), dtype=np.uint8)
        pixels[:] = BACKGROUND
        lens = self.optics._lens
        shade(self.triangles, self.scenery.colors, lens, self.film, AMBIENT, pixels)
        if len(self.scenery.lines):
            lines = _in_camera(self.X_WC, self.scenery.lines)
            trace(lines, self.scenery.line_colors, lens, self.film, pixels)
        return pixels


def _in_camera(X_WC: Array, shapes: Array) -> Array:
    """Points (n, k, 3) of the world in camera axes."""
    R_CW = np.ascontiguousarray(X_WC[:3, :3].T)
    points = applied(R_CW, (shapes - X_WC[:3, 3]).reshape(-1, 3))
    return np.ascontiguousarray(points.reshape(shapes.shape))
