"""Sensors that a machine takes up like a tool: a housing with a lens at its tip, which looks along the tool's Z."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import inline, key
from gcodesim.frozen import frozen
from gcodesim.sensors import camera, line_scanner
from gcodesim.sensors.sensor import Sensor
from gcodesim.tools.body import Primitive, cylinder
from gcodesim.tools.tool import Tool
from gcodesim.units import MM

LENS_HEIGHT = 0.2
"""Of the length: how much of the housing is the lens, for drawing."""


@frozen
class SensorHead(Tool):
    """A housing of which the lens is the tip. It takes nothing and gives nothing; what it hits, it hits."""

    diameter: float = key("length", "diameter of the housing", default=50.0 * MM)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """The lens, the housing, the holder."""
        mouth = LENS_HEIGHT * self.length
        lens = cylinder("objective", 0.3 * self.diameter, 0.0, mouth)
        return (lens, cylinder("housing", 0.5 * self.diameter, mouth, self.length), *self._holder_bodies())

    def problems(self) -> list[tuple[str, str]]:
        own = [] if self.sensor is None else self.sensor.problems()
        return [*Tool.problems(self), *own]

    def _positive(self) -> dict[str, float]:
        return {"diameter": self.diameter, **Tool._positive(self)}


@frozen
class CameraHead(SensorHead):
    """A camera in the magazine."""

    kind: ClassVar[str] = "camera"

    keys: camera.Camera = inline(camera.Camera)

    @property
    def sensor(self) -> Sensor | None:
        return self.keys


@frozen
class DepthCameraHead(SensorHead):
    """A depth camera in the magazine."""

    kind: ClassVar[str] = "depth_camera"

    keys: camera.DepthCamera = inline(camera.DepthCamera)

    @property
    def sensor(self) -> Sensor | None:
        return self.keys


@frozen
class LineScannerHead(SensorHead):
    """A laser line scanner in the magazine; its fan lies in the plane of X and Z of the tool."""

    kind: ClassVar[str] = "line_scanner"

    keys: line_scanner.LineScanner = inline(line_scanner.LineScanner)

    @property
    def sensor(self) -> Sensor | None:
        return self.keys
