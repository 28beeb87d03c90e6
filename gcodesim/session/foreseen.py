"""What steps that wait come to, where that follows from the command alone: nothing has to be run to know it.

A script that closes a loop asks after each step. A leg of a run for each of them costs milliseconds; here a world of
the machine's own goes through the same joints, and the steps are run later, many at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.executor.track import robot_body
from gcodesim.processes import PROCESSES
from gcodesim.world import WorldSteps, tool_body
from gcodesim.world.kinematic import KinematicWorld

if TYPE_CHECKING:
    from gcodesim.session.table_plan import Stretched
    from gcodesim.shop import Shop


class ForeseenSteps:
    """A world of one machine beside that of the run, which keeps to its command and feels nothing but the tool."""

    def __init__(self, shop: Shop, step_ns: int) -> None:
        self._shop = shop
        self._world = KinematicWorld(robot_body(shop, "kinematic"), step_ns)
        self._felt: dict[int, bool] = {}
        self._told = 0
        self._last: WorldSteps | None = None

    @staticmethod
    def of(shop: Shop, world_name: str, step_ns: int) -> ForeseenSteps | None:
        """None where motors may not keep to their command."""
        exact = world_name == "kinematic" and robot_body(shop, world_name).controller.law == "ideal"
        return ForeseenSteps(shop, step_ns) if exact else None

    def forget(self) -> None:
        """The steps that waited are run: others will begin where they ended."""
        self._told, self._last = 0, None

    def last(self, waiting: Sequence[Stretched], ran: WorldSteps | None) -> WorldSteps | None:
        """The last of the steps that wait, behind those that `ran`; None where a tool may feel what it acts on.

        Each call goes on from the one before.
        """
        fresh = waiting[self._told :]
        if any(stretch.events or self._may_feel(stretch) for stretch in fresh):
            return None
        if fresh:
            if not self._told:
                self._begin(waiting[0], ran)
            self._last = self._world.run(np.concatenate([stretch.q[1:] for stretch in fresh]))
            self._told = len(waiting)
        return self._last

    def _begin(self, first: Stretched, ran: WorldSteps | None) -> None:
        tool = self._shop.tool(first.state.tool)
        self._world.attach(None if tool is None else tool_body(tool), None)
        if ran is None:
            self._world.reset(first.q[0])
        else:
            self._world.go_on(ran.q[-1], ran.qd[-1])

    def _may_feel(self, stretch: Stretched) -> bool:
        """Whether something may push at the tool, or it may hold what weighs."""
        number = stretch.state.tool
        if number not in self._felt:
            self._felt[number] = self._may_act(number)
        return bool(stretch.state.push) or self._felt[number]

    def _may_act(self, number: int) -> bool:
        shop = self._shop
        tool = shop.tool(number)
        if tool is None:
            return False
        kinds = [PROCESSES[kind] for kind in tool.processes]
        pulled = tool.load is not None and any((*tool.load.force, *tool.load.torque))
        pushed = bool(shop.cell.stocks) and any(kind.pushes for kind in kinds)
        return pulled or pushed or (shop.moves_parts and any(kind.acts_on == "parts" for kind in kinds))
