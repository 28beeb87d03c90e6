"""Devices in a run: where they are when the program has switched them, and what lies on them goes along."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.cell.device import Device, DeviceHistory
from gcodesim.cell.placement import DEVICE
from gcodesim.frames import Array
from gcodesim.planning.switched import history_of
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.planning import Plan


class DeviceRun:
    """All devices of a cell; `follow` says what the program of a channel sets, and when."""

    def __init__(self, shop: Shop, dt: float) -> None:
        self._shop, self._dt = shop, dt
        self.devices: Mapping[str, Device] = {f"{DEVICE}/{name}": own for name, own in shop.cell.devices.items()}
        self._first = next(iter(shop.cell.channels))
        self._history = {name: DeviceHistory(device, [], []) for name, device in self.devices.items()}
        self._at = {name: shop.scene.at_rest(name).matrix for name in self.devices}
        self.frames: dict[str, Callable[[int, int], Array]] = {
            name: partial(self._moved, name) for name in self.devices
        }

    def follow(self, channel: str, plan: Plan) -> None:
        """Take over what the program of a channel sets up to the end of its plan."""
        for name, device in self.devices.items():
            if (device.channel or self._first) == channel:
                self._history[name] = history_of(device, plan.trajectory.events)

    def _moved(self, name: str, step: int, count: int) -> Array:
        """X_WF (count, 4, 4) of what lies on a device, at the ends of steps from `step` on."""
        time = np.maximum(step + 1 + np.arange(count), 0) * self._dt
        X = np.tile(np.eye(4), (count, 1, 1))
        X[:, :3, 3] = self._history[name].shifts(time)
        moved: Array = multiplied(self._at[name], X)
        return moved

    def drawn(self, name: str, step: int, count: int) -> Array:
        """X_WF (count, 4, 4) of the device itself; the frame of a conveyor stands still."""
        if self.devices[name].speed > 0.0:
            return np.tile(self._at[name], (count, 1, 1))
        return self._moved(name, step, count)
