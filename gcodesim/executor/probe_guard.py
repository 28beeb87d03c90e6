"""A tool that probes removes nothing, neither while it probes nor while it leaves what it has touched."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import inverse_pose, multiplied, norms
from gcodesim.canon import Trip
from gcodesim.executor.tasks import RowColumns
from gcodesim.executor.window import StepWindow
from gcodesim.frames import Array
from gcodesim.motion.tool_path import ToolPath
from gcodesim.shop import Shop


class ProbeGuard:
    """Says in which steps a tool is kept from cutting: those of a probing move, which stops where it touches, and the

    first ones behind it, until the tool has gone back by as much as it overran, and a cell. Asked for all windows in
    order.
    """

    def __init__(self, shop: Shop) -> None:
        self._shop = shop
        self._stopped: dict[str, Array] | None = None  # where the tip stood over each stock when a probe had stopped
        self._over = 0.0

    def kept(self, path: ToolPath, rows: RowColumns, steps: StepWindow) -> NDArray[np.bool_]:
        """Steps (n,) of a window. A leg probes in all its steps or in none."""
        kept: NDArray[np.bool_] = rows.probing[steps.row]
        if kept.any():
            self._stopped = {name: tips[-1] for name, tips in self._tips(steps).items()}
            self._over = next((e.event.over for e in reversed(path.events) if isinstance(e.event, Trip)), 0.0)
            return kept
        if self._stopped is None:
            return kept
        near = np.zeros(len(steps), dtype=bool)
        for name, tips in self._tips(steps).items():
            room = self._over + self._shop.stocks[name].stock.cell
            near |= norms(tips - self._stopped[name]) <= room
        kept[: len(near) if near.all() else int(np.argmin(near))] = True
        if not near.all():
            self._stopped = None
        return kept

    def _tips(self, steps: StepWindow) -> dict[str, Array]:
        """The tip (n, 3) [m] as each stock sees it."""
        shop = self._shop
        now = steps.joints(shop.name, 0, len(steps))
        poses = {name: shop.scene.seen_from(shop.name, placed.frame, now) for name, placed in shop.stocks.items()}
        return {name: multiplied(inverse_pose(X), steps.tip)[:, :3, 3] for name, X in poses.items()}
