"""A world that somebody leads on: steps are run before the run comes to them, and handed out when it does."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np

from gcodesim.frames import Array, Pose
from gcodesim.world.body import ToolBody
from gcodesim.world.protocol import Couple, World, WorldSteps
from gcodesim.world.state import wrench_rows


class LedWorld:
    """See `World`. Steps that `lead` has run are those that `run` is asked for next; in them nothing is felt."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._commands: deque[Array] = deque()
        self._led: deque[WorldSteps] = deque()
        self.step_ns, self.may_lag = world.step_ns, world.may_lag
        self.keeps_to_command, self.tells_efforts = world.keeps_to_command, world.tells_efforts

    def lead(self, q_command: Array) -> WorldSteps:
        """Move on through `q_command` (n, j), n > 0, with nothing to feel: no tool is changed until `run` was there."""
        steps = self._world.run(q_command)
        self._commands.append(q_command)
        self._led.append(steps)
        return steps

    @property
    def tool(self) -> ToolBody | None:
        return self._world.tool

    @property
    def parked(self) -> Mapping[str, tuple[ToolBody, Pose]]:
        return self._world.parked

    def reset(self, q: Array) -> None:
        """See `World.reset`."""
        self._world.reset(q)

    def attach(self, tool: ToolBody | None, pocket: Pose | None = None) -> None:
        """See `World.attach`."""
        self._check_free()
        self._world.attach(tool, pocket)

    def run(self, q_command: Array, couple: Couple | Array | None = None) -> WorldSteps:
        """See `World.run`. Steps that were led are asked for by themselves."""
        if not self._led:
            return self._world.run(q_command, couple)
        if couple is not None and wrench_rows(couple, 0, q_command).any():  # it may be near, but touches nothing
            raise RuntimeError("a tool feels something in steps that were foreseen without")
        commands, parts = [self._commands.popleft()], [self._led.popleft()]
        while (count := sum(map(len, commands))) < len(q_command) and self._led:
            commands.append(self._commands.popleft())
            parts.append(self._led.popleft())
        if count > len(q_command):  # a window ends within what was led at once
            own = len(commands[-1]) - (count - len(q_command))
            rest = np.arange(own, len(commands[-1]))
            self._commands.appendleft(commands[-1][own:])
            self._led.appendleft(parts[-1].at(rest))
            commands[-1], parts[-1] = commands[-1][:own], parts[-1].at(np.arange(own))
        if not np.array_equal(np.concatenate(commands), q_command):
            raise RuntimeError("the steps that were foreseen are not those of the run")
        return WorldSteps.joined(parts)

    def keeps_up(self, q_command: Array, wrench: Array) -> bool:
        """See `World.keeps_up`; of steps that were led, no motor has to be asked."""
        return bool(self._led) or self._world.keeps_up(q_command, wrench)

    def close(self) -> None:
        """See `World.close`."""
        self._world.close()

    def _check_free(self) -> None:
        if self._led:
            raise RuntimeError("the tool is changed before the run has come to steps that were foreseen")
