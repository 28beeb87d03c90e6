"""What sensors give: pictures, maps of depth, points, loads, figures. Log and files know these and no sensor."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen

Array = NDArray[np.float64]


@frozen(eq=False)
class Picture:
    """Red, green and blue from 0 to 255 (height, width, 3), the upper row first."""

    pixels: NDArray[np.uint8]

    @property
    def is_blank(self) -> bool:
        """Whether all pixels are alike: there is nothing in the picture, or nothing that could be told apart."""
        return bool((self.pixels == self.pixels[:1, :1]).all())


@frozen(eq=False)
class DepthMap:
    """Depth along the optical axis (height, width) [m]; not a number where nothing is seen.

    `millimetres`: told as whole millimetres, 0 where nothing is seen, as many cameras do it.
    """

    depth: NDArray[np.float32]
    millimetres: bool = False

    @property
    def is_blank(self) -> bool:
        """Whether no pixel has a depth."""
        return bool(np.isnan(self.depth).all())


@frozen(eq=False)
class Calibration:
    """How a camera sees: size [pixels], focal lengths and centre (fx, fy, cx, cy) [pixels]; no distortion."""

    width: int
    height: int
    intrinsics: tuple[float, float, float, float]


@frozen(eq=False)
class Points:
    """Points (n, 3) [m] in the frame of the sensor; rows that are not numbers are points that were not seen."""

    points: NDArray[np.float32]

    @property
    def is_blank(self) -> bool:
        """Whether nothing was seen."""
        return bool(np.isnan(self.points).all())


@frozen(eq=False)
class Wrench:
    """Force [N] and torque [N·m] (6,) that act on the sensor, in its own axes."""

    values: Array


@frozen(eq=False)
class Numbers:
    """Numbers by name; a name ends in the unit, such as `distance_m`."""

    values: Mapping[str, float]


Output = Picture | DepthMap | Calibration | Points | Wrench | Numbers


def digest(output: Output) -> bytes:
    """A hash of the values themselves, whatever file or message they stand in."""
    return hashlib.sha256(b"".join(_parts(output))).digest()


def _parts(output: Output) -> list[bytes]:
    match output:
        case Picture(pixels=values) | DepthMap(depth=values) | Points(points=values) | Wrench(values=values):
            return [repr(values.shape).encode(), _little(values)]
        case Calibration():
            return [repr((output.width, output.height, output.intrinsics)).encode()]
    return [repr(sorted(output.values.items())).encode()]


def _little(values: NDArray[Any]) -> bytes:
    return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).tobytes()
