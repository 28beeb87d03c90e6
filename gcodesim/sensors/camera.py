"""Cameras: a picture of what the scene holds, and how far away it is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Final

import numpy as np

from gcodesim.arithmetic.scalars import atan
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, Range
from gcodesim.declarations.plain_kinds import Choice, Whole
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.frozen import frozen
from gcodesim.sensors.optics import Exposure, Optics
from gcodesim.sensors.outputs import Calibration, DepthMap, Output, Picture
from gcodesim.sensors.sensor import Sensor, Sight
from gcodesim.units import DEG, MM

MOST_PIXELS: Final = 4_000_000
MOST_DEPTHS: Final = 1_000_000
"""Pixels of one picture, and of one map of depth: what a viewer takes in one message, 4 MB."""

USUAL_ANGLE: Final = 60.0 * DEG

_SIDE: Final = Whole(Range(least=1, most=8192))
_SHARE: Final = Range(least=0.0, most=1.0)
_PIXELS: Final = Quantity("ratio", Range(least=-1e6, most=1e6))
_FOCAL: Final = Quantity("ratio", Range(above=0.0, most=1e6))


@frozen
class Camera(Sensor):
    """A camera without distortion, with a lamp beside its lens."""

    kind: ClassVar[str] = "camera"
    outputs: ClassVar[Mapping[str, type]] = {"image": Picture, "calibration": Calibration}
    order: ClassVar[tuple[str, str]] = ("camera", "shoot")
    most: ClassVar[int] = MOST_PIXELS

    width: int = key(_SIDE, "pixels from left to right", default=640)
    height: int = key(_SIDE, "pixels from top to bottom", default=480)
    field_of_view: float | None = key(
        Quantity("angle", Range(above=0.0, most=170.0 * DEG), example="60 deg"),
        "angle from the left border of the picture to the right one",
        derive=lambda camera: camera._angle,
        rule="that of `focal_length`, else 60 deg",
    )
    focal_length: tuple[float, float] | None = key(
        Vector(_FOCAL, 2, "[800, 800]"), "fx and fy in pixels, in place of `field_of_view`", default=None
    )
    center: tuple[float, float] | None = key(
        Vector(_PIXELS, 2, "[319.5, 239.5]"),
        "cx and cy: where the optical axis meets the picture, in pixels from the middle of the upper left one",
        default=None,
        rule="the middle",
    )
    near: float = key(
        Quantity("length", Range(least=1e-6, most=1e3)), "what is nearer than this is not seen", default=1.0 * MM
    )
    noise: float = key(
        Quantity("ratio", _SHARE), "standard deviation of the brightness, as a share of white", default=0.0, quiet=True
    )

    @property
    def optics(self) -> Optics:
        """Its intrinsics."""
        plain = Optics.of_view(self.width, self.height, self.field_of_view or self._angle)
        fx, fy = self.focal_length or (plain.fx, plain.fy)
        cx, cy = self.center or (plain.cx, plain.cy)
        return Optics(width=self.width, height=self.height, fx=fx, fy=fy, cx=cx, cy=cy, near=self.near)

    @property
    def _angle(self) -> float:
        """The angle of view [rad] where none is given."""
        return USUAL_ANGLE if self.focal_length is None else 2.0 * atan(0.5 * self.width / self.focal_length[0])

    def read(self, sight: Sight) -> Mapping[str, Output]:
        return self._developed(self.optics.exposure(sight.X_WC, sight.scenery), sight)

    def _developed(self, seen: Exposure, sight: Sight) -> dict[str, Output]:
        pixels = seen.picture()
        if self.noise > 0.0:
            grain = sight.noise.normal(pixels.size).reshape(pixels.shape)
            pixels = np.clip(np.floor(pixels + 255.0 * self.noise * grain + 0.5), 0.0, 255.0).astype(np.uint8)
        shape = Calibration(width=self.width, height=self.height, intrinsics=self.optics.intrinsics)
        return {"image": Picture(pixels=pixels), "calibration": shape}

    def problems(self) -> list[tuple[str, str]]:
        found = []
        if self.width * self.height > self.most:
            found.append(
                (
                    "width",
                    f"a picture of {self.width} x {self.height} has {self.width * self.height} pixels; "
                    f"{self.most} are possible",
                )
            )
        if self.focal_length is not None and abs((self.field_of_view or self._angle) - self._angle) > 1e-9:
            found.append(("focal_length", "`focal_length` and `field_of_view` say the same; give one of them"))
        return found


@frozen
class DepthCamera(Camera):
    """A camera that measures how far away each pixel is, along its axis."""

    kind: ClassVar[str] = "depth_camera"
    outputs: ClassVar[Mapping[str, type]] = {**Camera.outputs, "depth": DepthMap}
    most: ClassVar[int] = MOST_DEPTHS

    range: tuple[float, float] = key(
        Vector(Quantity("length", NOT_NEGATIVE), 2, "[100, 5000 mm]"),
        "least and greatest depth that it measures",
        default=(0.1, 10.0),
    )
    depth_noise: float = key(
        Quantity("length", NOT_NEGATIVE), "standard deviation of a depth", default=0.0, quiet=True, example="1 mm"
    )
    encoding: str = key(
        Choice(("32FC1", "16UC1")), "of depths in the log: metres as numbers, or whole millimetres", default="32FC1"
    )

    def read(self, sight: Sight) -> Mapping[str, Output]:
        seen = self.optics.exposure(sight.X_WC, sight.scenery)
        found = self._developed(seen, sight)
        depth = seen.depth.copy()
        if self.depth_noise > 0.0:
            count = depth.size * (4 if self.noise > 0.0 else 1)  # the grain of the picture has the first three parts
            depth += self.depth_noise * sight.noise.normal(count)[-depth.size :].reshape(depth.shape)
        least, most = self.range
        depth[~((depth >= least) & (depth <= most))] = np.nan
        return {**found, "depth": DepthMap(depth=depth.astype(np.float32), millimetres=self.encoding == "16UC1")}

    def problems(self) -> list[tuple[str, str]]:
        found = Camera.problems(self)
        if not self.range[0] < self.range[1]:
            found.append(("range", "`range` must begin below its end"))
        return found
