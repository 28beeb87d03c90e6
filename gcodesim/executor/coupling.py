"""The tool and what it acts on while the robot moves: joint positions in, wrench on the tool out."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.executor.stint import Stint, stint_of
from gcodesim.executor.tasks import RowColumns, Tasks
from gcodesim.executor.window import StepWindow
from gcodesim.frames import Array
from gcodesim.kinematics import shift_jacobian
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.planning import Plan


class Coupling:
    """What a world calls while it moves: joints (m, j) of steps go in, in order; wrenches (m, 6) in base axes come out.

    A world without dynamics asks for all steps at once, at the commanded joints;
    one with dynamics asks step by step. The distance of its joints from the command
    moves the tip, and with it the cut. One stretch of steps has one tool.
    """

    def __init__(self, plan: Plan, shop: Shop, rows: RowColumns) -> None:
        self._plan, self._shop, self._rows = plan, shop, rows
        self._tasks = Tasks(shop)
        self._moved = np.zeros(3)

    def follow(self, plan: Plan, rows: RowColumns) -> None:
        """Go on with a plan that has further legs, and its rows."""
        self._plan, self._rows = plan, rows

    def save(self) -> Callable[[], None]:
        """Remember which tool is in the spindle; calling the result restores it. States of processes do not count."""
        kept = copy(self._tasks)

        def restore() -> None:
            self._tasks = kept

        return restore

    def stretch(self, steps: StepWindow, begin: int, end: int, *, cuts: bool = True) -> Stretch:
        """Prepare steps `begin` to `end` of a window, all with the same tool; it `cuts`, or is kept from cutting."""
        number = int(steps.tool[begin])
        tasks = self._tasks.of(number) if cuts else self._tasks.kept(number)

        def jacobian() -> Array:
            return self._tip_jacobian(steps, begin, end)

        made = [stint_of(self._shop, self._rows, task, steps, begin, end, jacobian) for task in tasks]
        return Stretch(self, self._plan, steps, begin, end, [stint for stint in made if stint is not None])

    def _tip_jacobian(self, steps: StepWindow, begin: int, end: int) -> Array:
        """Jacobians (n, 6, j) of the tip in base axes."""
        q = steps.q[begin:end]
        tool = self._shop.tool(int(steps.tool[begin]))
        J = self._shop.kinematics.jacobian(q)
        return J if tool is None else shift_jacobian(J, self._shop.kinematics.forward(q), tool.X_FT.p)

    def moved_from(self, now: Array) -> Array:
        """The offset (3,) [m] of the tip from the command one step ago; from here on it is `now`."""
        before, self._moved = self._moved, now
        return before


class Stretch:
    """Consecutive steps with one tool; itself the function that a world calls."""

    def __init__(
        self, coupling: Coupling, plan: Plan, steps: StepWindow, begin: int, end: int, stints: list[Stint]
    ) -> None:
        self._coupling, self._plan, self._steps = coupling, plan, steps
        self.begin, self.end, self.stints = begin, end, stints

    @property
    def pushes(self) -> bool:
        """Whether a world would feel what the tool does."""
        return any(stint.task.process.pushes for stint in self.stints)

    def __call__(self, first: int, q: Array) -> Array:
        """What the tool feels (m, 6) from step `first` of the stretch on, with joints at `q` (m, j) after each step."""
        commanded = self._steps.q[self.begin + first : self.begin + first + len(q)]
        wrench = np.zeros((len(q), 6))
        if not self.stints:
            return wrench
        if len(q) == self.end - self.begin and np.array_equal(q, commanded):
            for stint in self.stints:
                stint.run()
                if stint.wrench is not None:
                    wrench += stint.wrench
            return wrench
        for i in range(len(q)):
            k = self.begin + first + i
            moved = self._plan.tip(q[i : i + 1], self._steps.row[k : k + 1])[0, :3, 3] - self._steps.tip[k, :3, 3]
            before = self._coupling.moved_from(moved)
            for stint in self.stints:
                if stint.task.process.pushes:
                    wrench[i] += stint.step(first + i, before, moved)
        return wrench

    def whole(self) -> Array:
        """What the tool feels (n, 6) if the machine follows its command."""
        return self(0, self._steps.q[self.begin : self.end])

    def save(self) -> Callable[[], None]:
        """Remember targets and processes; calling the result restores them."""
        kept = [(stint, stint.task.state.values.copy(), stint.task.target.memento()) for stint in self.stints]

        def restore() -> None:
            for stint, values, back in kept:
                stint.task.state.values[:] = values
                stint.forget()
                back()

        return restore

    def finish(self) -> None:
        """To be called after the world has moved step by step, when all answers are in."""
        for stint in self.stints:
            stint.finish()
