"""What sensors read, as messages of the log."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.topics import Topic
from gcodesim.log.wire import FIXED32, chunk, double, stamp, tag, text, unsigned
from gcodesim.observation.files import millimetres
from gcodesim.observation.schedule import Station, stations_of
from gcodesim.sensors.optics import BACKGROUND
from gcodesim.sensors.outputs import Calibration, DepthMap, Numbers, Output, Picture, Points, Wrench
from gcodesim.sensors.png import png_of

if TYPE_CHECKING:
    from gcodesim.shop import Shop

_SCHEMAS: Final[dict[type, str]] = {
    Picture: "foxglove.CompressedImage",
    DepthMap: "foxglove.RawImage",
    Calibration: "foxglove.CameraCalibration",
    Points: "foxglove.PointCloud",
    Wrench: "gcodesim.Wrench",
    Numbers: "gcodesim.Reading",
}
_FLOAT32: Final = 7  # foxglove.PackedElementField.NumericType
_POINT_BYTES: Final = 12


_BLANK: Final[dict[type, Output]] = {
    Picture: Picture(pixels=np.full((1, 1, 3), BACKGROUND, dtype=np.uint8)),
    DepthMap: DepthMap(depth=np.full((1, 1), np.nan, dtype=np.float32)),
    Calibration: Calibration(width=1, height=1, intrinsics=(1.0, 1.0, 0.0, 0.0)),
    Points: Points(points=np.zeros((0, 3), dtype=np.float32)),
    Wrench: Wrench(values=np.zeros(6)),
    Numbers: Numbers(values={}),
}
"""What a sensor shows before it has read: one pixel of nothing, no points, no figures."""


def sensor_topics(shop: Shop) -> tuple[tuple[Topic, bytes], ...]:
    """The topics of all sensors of a shop, each with what it shows before the first reading."""
    return tuple(
        (Topic(station.topic(name), _SCHEMAS[form], "change"), sensor_message(station, 0, _BLANK[form]))
        for station in stations_of(shop.cell)
        for name, form in station.sensor.outputs.items()
    )


def image_topics(shop: Shop) -> list[tuple[str, str]]:
    """The topics of pictures, each with that of its calibration, if there is one."""
    found = []
    for station in stations_of(shop.cell):
        forms = {form: name for name, form in station.sensor.outputs.items()}
        if Picture in forms:
            calibration = station.topic(forms[Calibration]) if Calibration in forms else ""
            found.append((station.topic(forms[Picture]), calibration))
    return found


def sensor_message(station: Station, t_ns: int, output: Output) -> bytes:
    """The message of one output."""
    frame = station.log_frame
    match output:
        case Picture(pixels=pixels):
            return stamp(1, t_ns) + chunk(2, png_of(pixels)) + text(3, "png") + text(4, frame)
        case DepthMap():
            return _depth(t_ns, frame, output)
        case Calibration():
            return _calibration(t_ns, frame, output)
        case Points(points=points):
            return _cloud(t_ns, frame, points)
        case Wrench(values=values):
            parts = [b"".join(double(k + 1, v) for k, v in enumerate(part)) for part in values.reshape(2, 3).tolist()]
            return stamp(1, t_ns) + text(2, frame) + chunk(3, parts[0]) + chunk(4, parts[1])
        case Numbers(values=figures):
            shown = ((name, double(2, value) if value else b"") for name, value in figures.items())
            return stamp(1, t_ns) + b"".join(chunk(2, text(1, name) + number) for name, number in shown)


def _depth(t_ns: int, frame: str, output: DepthMap) -> bytes:
    if output.millimetres:
        return _raw_image(t_ns, frame, "16UC1", millimetres(output).astype("<u2"))
    return _raw_image(t_ns, frame, "32FC1", output.depth.astype("<f4"))


def _raw_image(t_ns: int, frame: str, encoding: str, rows: NDArray[Any]) -> bytes:
    """A `foxglove.RawImage` of values (h, w), little-endian."""
    height, width = rows.shape
    size = _fixed32(2, width) + _fixed32(3, height)
    step = _fixed32(5, width * rows.itemsize)
    return stamp(1, t_ns) + size + text(4, encoding) + step + chunk(6, rows.tobytes()) + text(7, frame)


def _calibration(t_ns: int, frame: str, output: Calibration) -> bytes:
    fx, fy, cx, cy = output.intrinsics
    K = (fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0)
    R = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    P = (fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0)
    size = _fixed32(2, output.width) + _fixed32(3, output.height)
    matrices = b"".join(_packed_doubles(number, values) for number, values in ((6, K), (7, R), (8, P)))
    return stamp(1, t_ns) + size + matrices + text(9, frame)


def _cloud(t_ns: int, frame: str, points: NDArray[np.float32]) -> bytes:
    """A `foxglove.PointCloud` of the points that were seen."""
    seen = points[~np.isnan(points[:, 2])].astype("<f4")
    turn = chunk(2, double(4, 1.0))
    fields = b"".join(
        chunk(5, text(1, axis) + (_fixed32(2, 4 * k) if k else b"") + unsigned(3, _FLOAT32))
        for k, axis in enumerate("xyz")
    )
    head = stamp(1, t_ns) + text(2, frame) + chunk(3, chunk(1, b"") + turn)
    return head + _fixed32(4, _POINT_BYTES) + fields + chunk(6, seen.tobytes())


def _fixed32(number: int, value: int) -> bytes:
    return tag(number, FIXED32) + value.to_bytes(4, "little")


def _packed_doubles(number: int, values: tuple[float, ...]) -> bytes:
    return chunk(number, np.array(values, dtype="<f8").tobytes())
