"""Sensors of an open cell, and pictures from anywhere: what stands there after the last step."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gcodesim.arithmetic.matrices import norm
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.given import numbers
from gcodesim.observation.eyes import load_at, place_of
from gcodesim.observation.schedule import Station
from gcodesim.observation.stage import Hand, Stage, surface_of
from gcodesim.sensors.noise import Noise
from gcodesim.sensors.optics import Optics
from gcodesim.sensors.outputs import DepthMap, Output, Picture
from gcodesim.sensors.scenery import Scenery
from gcodesim.sensors.sensor import Sight
from gcodesim.session.misuse import MisuseError

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.session.cell_in_hand import OpenCell
    from gcodesim.shop import Shop


@frozen(eq=False)
class Present:
    """A shop as the last step has left it; `records` are of that step, by machines, the first channel's first."""

    shop: Shop
    records: Mapping[str, StepRecord]

    @property
    def record(self) -> StepRecord:
        return self.records[self.shop.name]

    @property
    def q(self) -> dict[str, Array]:
        return {name: record.world.q[-1] for name, record in self.records.items()}

    @property
    def tool(self) -> int:
        return int(self.record.window.tool[-1])

    def scenery(self, stage: Stage) -> Scenery:
        surfaces = {name: surface_of(placed) for name, placed in self.shop.stocks.items()}
        hands = {name: Hand.in_step(its, len(its) - 1, self.shop) for name, its in self.records.items()}
        first = next(iter(self.records.values()))
        return stage.scenery(self.q, hands, surfaces, places=first.places(len(first) - 1))

    def reading(self, station: Station, seed: int, number: int) -> Mapping[str, Output]:
        """What a sensor reads now, as reading `number`."""
        stage = Stage.of(self.shop)
        X_WC = place_of(station, stage, self.q, self.tool)
        load = np.zeros(6)
        if station.sensor.on_flange:
            load = load_at(self.shop, X_WC, self.q, self.record.world.reaction[-1])
        scenery = self.scenery(stage) if station.sensor.sees else Scenery.of(())
        noise = Noise(seed, station.name, number)
        return station.sensor.read(Sight(X_WC=X_WC, scenery=scenery, noise=noise, load=load))

    def picture(self, optics: Optics, X_WC: Array) -> NDArray[np.uint8]:
        """Red, green and blue (h, w, 3) from `X_WC` (4, 4)."""
        return optics.exposure(X_WC, self.scenery(Stage.of(self.shop))).picture()


def looking(position: ArrayLike, target: ArrayLike, up: ArrayLike) -> Array:
    """X_WC (4, 4) at a position, with Z to the target and Y away from `up`; ValueError where that says nothing."""
    p = numbers(position, (3,), "the place of the camera")
    z = numbers(target, (3,), "its target") - p
    x = np.cross(z, numbers(up, (3,), "the direction `up`"))
    if not (norm(x) > 1e-12 and np.isfinite(x).all()):
        raise ValueError("the camera looks along `up`, or at itself")
    z, x = z / norm(z), x / norm(x)
    X = np.eye(4)
    X[:3, 0], X[:3, 1], X[:3, 2], X[:3, 3] = x, np.cross(z, x), z, p
    return X


def pixels_of(outputs: Mapping[str, Output]) -> NDArray[np.uint8] | None:
    """The picture among what a sensor has read."""
    return next((output.pixels for output in outputs.values() if isinstance(output, Picture)), None)


def depths_of(outputs: Mapping[str, Output]) -> NDArray[np.float32] | None:
    """The map of depth among what a sensor has read."""
    return next((output.depth for output in outputs.values() if isinstance(output, DepthMap)), None)


class HandSensor:
    """A sensor of an open cell. It reads whenever it is asked, besides its own times, which are those of a run."""

    def __init__(self, cell: OpenCell, station: Station) -> None:
        self._cell, self.station = cell, station
        self._count = 0

    def read(self) -> Mapping[str, Output]:
        """What it reads after the last step, by name. MisuseError for a tool that no robot holds."""
        present = self._cell._present(self.station.tool)
        if self.station.tool is not None and self.station.tool != present.tool:
            raise MisuseError(f"no robot holds tool {self.station.tool}; call `couple` and `step` first")
        self._count += 1
        return present.reading(self.station, present.shop.cell.simulation.seed, self._count)

    def picture(self) -> NDArray[np.uint8]:
        """Red, green and blue (height, width, 3), the upper row first. MisuseError if it takes no pictures."""
        found = pixels_of(self.read())
        if found is None:
            raise MisuseError(f"`{self.station.name}` is a {self.station.sensor.kind}, which takes no pictures")
        return found

    def depth(self) -> NDArray[np.float32]:
        """Depth (height, width) [m], not a number where nothing is seen. MisuseError if it measures none."""
        found = depths_of(self.read())
        if found is None:
            raise MisuseError(f"`{self.station.name}` is a {self.station.sensor.kind}, which measures no depth")
        return found
