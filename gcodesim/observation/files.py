"""What sensors read, as files in the folder of a run: pictures as PNG, everything else as rows of a table."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

import numpy as np

from gcodesim.files.output_folder import TABLE_OF_READINGS
from gcodesim.files.whole_file import whole_file, write_whole
from gcodesim.frames import Array
from gcodesim.sensors.outputs import DepthMap, Numbers, Output, Picture, Points, Wrench
from gcodesim.sensors.png import png_of
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.observation.schedule import Station

HEAD: Final = "reading,time_s,"
"""How every table of a sensor begins."""


def names_left(out: Path, stations: Iterable[Station]) -> list[str]:
    """The files in a folder that have names of what these sensors write."""
    found = []
    for station in stations:
        if station.sensor.save:
            found += [path.name for path in out.glob(f"{station.name}_[0-9]*.png")]
            found += [path.name for path in out.glob(f"{station.name}{TABLE_OF_READINGS}")]
    return sorted(found)


def picture_of(output: Output) -> bytes | None:
    """A picture, or a map of depth in whole millimetres (0: nothing seen), as PNG; None of what is neither."""
    if isinstance(output, Picture):
        return png_of(output.pixels)
    if isinstance(output, DepthMap):
        return png_of(millimetres(output))
    return None


def millimetres(output: DepthMap) -> np.ndarray[tuple[int, ...], np.dtype[np.uint16]]:
    """Depths (h, w) [mm]; 0 where nothing is seen, and the greatest number for all that is farther."""
    depth = np.where(np.isnan(output.depth), 0.0, output.depth.astype(float) / MM)
    return np.minimum(np.floor(depth + 0.5), 65535.0).astype(np.uint16)


class SensorFiles:
    """Writes the files of those sensors that are to be saved; closed at the end of the run."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._tables: dict[str, BinaryIO] = {}
        self._stack = ExitStack()

    def write(self, station: Station, number: int, t_ns: int, X_WC: Array, name: str, output: Output) -> None:
        """One output of reading `number` (from 1), taken at `X_WC` (4, 4)."""
        picture = picture_of(output)
        if picture is not None:
            suffix = "" if name == "image" else f"_{name}"
            write_whole(self._out / f"{station.name}_{number:04d}{suffix}.png", picture)
            return
        rows = list(_rows(output, X_WC))
        if not rows:
            return
        if station.name not in self._tables:
            path = self._out / f"{station.name}{TABLE_OF_READINGS}"
            self._tables[station.name] = self._stack.enter_context(whole_file(path))
            self._tables[station.name].write(f"{HEAD}{_head(output)}\n".encode())
        start = f"{number},{t_ns * 1e-9:.9g},"
        self._tables[station.name].write("".join(f"{start}{row}\n" for row in rows).encode())

    def close(self) -> None:
        """All tables get their names."""
        self._stack.close()


def _head(output: Output) -> str:
    if isinstance(output, Points):
        return "point,x_mm,y_mm,z_mm,world_x_mm,world_y_mm,world_z_mm"
    if isinstance(output, Wrench):
        return "force_x_N,force_y_N,force_z_N,torque_x_Nm,torque_y_Nm,torque_z_Nm"
    assert isinstance(output, Numbers)
    return ",".join(output.values)


def _rows(output: Output, X_WC: Array) -> Iterator[str]:
    match output:
        case Points(points=points):
            own = points.astype(float)
            x, y, z = (own[:, k, None] for k in range(3))
            world = x * X_WC[:3, 0] + y * X_WC[:3, 1] + z * X_WC[:3, 2] + X_WC[:3, 3]
            seen = np.flatnonzero(~np.isnan(own[:, 2]))
            for i, values in zip(seen.tolist(), np.hstack([own, world])[seen].tolist(), strict=True):
                yield f"{i}," + ",".join(f"{value / MM:.6f}" for value in values)
        case Wrench(values=values):
            yield ",".join(f"{value:.6g}" for value in (values + 0.0).tolist())
        case Numbers(values=figures):
            yield ",".join(f"{value + 0.0:.9g}" for value in figures.values())
