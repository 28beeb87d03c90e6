"""Sensors of an open cell, and pictures from anywhere: what stands there after the last step."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gcodesim.arithmetic.matrices import norm
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.observation.eyes import load_at, place_of, seen_in
from gcodesim.observation.schedule import Station
from gcodesim.observation.stage import Stage, surface_of
from gcodesim.sensors.noise import Noise
from gcodesim.sensors.optics import Optics
from gcodesim.sensors.outputs import DepthMap, Output, Picture
from gcodesim.sensors.scenery import Scenery
from gcodesim.sensors.sensor import Sight

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.shop import Shop


@frozen(eq=False)
class Present:
    """A shop as the last step has left it."""

    shop: Shop
    record: StepRecord

    @property
    def q(self) -> dict[str, Array]:
        return {self.shop.name: self.record.world.q[-1]}

    @property
    def tool(self) -> int:
        return int(self.record.window.tool[-1])

    def scenery(self, stage: Stage) -> Scenery:
        surfaces = {name: surface_of(placed) for name, placed in self.shop.stocks.items()}
        return seen_in(stage, self.q, self.tool, surfaces, self.record, len(self.record) - 1)

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
    p, z = np.asarray(position, dtype=float), np.asarray(target, dtype=float) - np.asarray(position, dtype=float)
    x = np.cross(z, np.asarray(up, dtype=float))
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
