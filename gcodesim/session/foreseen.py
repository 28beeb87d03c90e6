"""What steps that wait come to, where nothing but the command and the machine decides about it.

A script that closes a loop asks after each step. A leg of a run for each of them costs milliseconds; so the world of
the run is led on through the same joints at once, and the run comes to these steps later, many in one leg.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.executor.stint import is_near
from gcodesim.executor.tasks import Task, Tasks
from gcodesim.frames import Array
from gcodesim.processes import PROCESSES

if TYPE_CHECKING:
    from gcodesim.session.table_plan import Stretched
    from gcodesim.shop import Shop
    from gcodesim.world import WorldSteps
    from gcodesim.world.led import LedWorld


class ForeseenSteps:
    """Leads the world of one machine through steps that wait. `shop` is that of the run, with its stocks.

    `count` are those of the stretches that wait through which it was led.
    """

    def __init__(self, world: LedWorld, shop: Shop) -> None:
        self._world, self._shop = world, shop
        self._tasks = Tasks(shop)
        self.count = 0
        self._last: WorldSteps | None = None

    def last(self, waiting: Sequence[Stretched], *, holds: bool) -> WorldSteps | None:
        """The last of the steps that wait; None where a tool may feel what it acts on, or is told something.

        `holds`: its gripper has a part. Each call goes on from the one before.
        """
        for stretch in waiting[self.count :]:
            if stretch.events or self._may_feel(stretch, holds=holds):
                return None
            self._last = self._world.lead(np.ascontiguousarray(stretch.q[1:]))
            self.count += 1
        return self._last if self.count else None

    def forget(self, count: int) -> None:
        """The run has come to the first `count` stretches, or they will not be run."""
        self.count = max(self.count - count, 0)

    def _may_feel(self, stretch: Stretched, *, holds: bool) -> bool:
        """Whether something may push at the tool, or it has a part that it may lose."""
        number = stretch.state.tool
        tool = self._shop.tool(number)
        if tool is None:
            return False
        pulled = tool.load is not None and any((*tool.load.force, *tool.load.torque))
        if holds or pulled or stretch.state.push:
            return True
        kinds = [PROCESSES[kind] for kind in tool.processes if not PROCESSES[kind].leads]
        if not any(kind.pushes for kind in kinds):
            return False
        if any(kind.acts_on == "parts" for kind in kinds):
            return True
        pushing = [task for task in self._tasks.of(number) if task.process.pushes and not task.process.leads]
        if len(pushing) > 1 and not self._world.keeps_to_command:
            return True  # several at one tool are asked step by step where gears swing, wherever they are
        return any(self._is_near(task, stretch) for task in pushing)

    def _is_near(self, task: Task, stretch: Stretched) -> bool:
        """Whether a process may act on its target in these steps."""
        shop, frame = self._shop, task.target.frame
        if shop.scene.moves(frame):
            return True
        tool = task.tool
        X_BS = shop.scene.seen_from(shop.name, frame, {shop.name: stretch.q[:1]})
        tips: Array = multiplied(inverse_pose(X_BS), shop.kinematics.forward(stretch.q), tool.X_FT.matrix)
        return is_near(task, tips[:-1, :3, 3], tips[1:, :3, 3], -tips[:, :3, 2], task.target.room)
