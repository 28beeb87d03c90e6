"""The tool and what it acts on while the robot moves: joint positions in, wrench on the tool out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.executor.part_run import PartRun
from gcodesim.executor.stint import Stint, deflection_of
from gcodesim.executor.stint_maker import StepSpan, StintMaker
from gcodesim.executor.switching import Switching
from gcodesim.executor.tasks import Only, RowColumns, Task, Tasks
from gcodesim.executor.window import StepWindow
from gcodesim.frames import Array
from gcodesim.kinematics import shift_jacobian
from gcodesim.processes import PROCESSES
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.checks.stock_watch import Sighting, StockWatch
    from gcodesim.planning import Plan
    from gcodesim.processes.protocol import Process
    from gcodesim.processes.swing_kernels import Swings


class Coupling:
    """What a world calls while it moves: joints (m, j) of steps go in, in order; wrenches (m, 6) in base axes come out.

    A world that follows its command asks for all steps at once; one that does not asks step by step, and says where
    the tip begins and would end, and how it gives way (`react`). One stretch of steps has one tool. `gears_move`: the
    world moves the gears of the machine, and the process does not. `only`: what the run is about, if not all.
    """

    def __init__(
        self,
        plan: Plan,
        shop: Shop,
        rows: RowColumns,
        parts: PartRun | None = None,
        *,
        gears_move: bool = False,
        only: Only | None = None,
    ) -> None:
        self._shop, self._parts = shop, parts
        self._tasks = Tasks(shop, parts, only)
        self.follow(plan, rows)
        self._gears_move = gears_move
        self._leads: dict[int, list[Process]] = {}  # by tool
        self._bent: Array | None = None  # how far (1, 3) [m] in B loads have put the tip at the end of the last steps

    def follow(self, plan: Plan, rows: RowColumns) -> None:
        """Go on with a plan that has further legs, and its rows."""
        self._plan = plan
        self._maker = StintMaker(self._shop, rows, Switching(plan, self._shop), self._parts)

    def save(self) -> Callable[[], None]:
        """Remember which tool is in the spindle; calling the result restores it. States of processes do not count."""
        kept, bent = copy(self._tasks), self._bent

        def restore() -> None:
            self._tasks, self._bent = kept, bent

        return restore

    def pulled(self, steps: StepWindow) -> NDArray[np.bool_]:
        """In which steps (n,) of a window a process that leads pulls at the tool."""
        pulled = np.zeros(len(steps), dtype=bool)
        for number in distinct(steps.tool).tolist():
            for process in self._leading(number):
                pulled |= (steps.tool == number) & ~process.idles(
                    self._maker.signals(process.reads, steps, slice(None)), len(steps)
                )
        return pulled

    def _leading(self, number: int) -> list[Process]:
        """The processes of a tool that lead."""
        tool = self._shop.tool(number)
        if number not in self._leads:
            kinds = () if tool is None else tool.acts_by
            self._leads[number] = [PROCESSES[kind].of(tool, None) for kind in kinds if PROCESSES[kind].leads]
        return self._leads[number]

    def stretch(self, steps: StepWindow, begin: int, end: int, *, cuts: bool = True, pulled: bool = True) -> Stretch:
        """Prepare steps `begin` to `end` of a window, all with the same tool; it `cuts`, or is kept from cutting.

        `pulled`: see `Coupling.pulled`, which says the same of all of them.
        """
        number = int(steps.tool[begin])
        tasks = self._tasks.of(number) if cuts else self._tasks.kept(number)
        if not pulled:
            tasks = [task for task in tasks if not task.process.leads]
        stints = self._stints(tasks, steps, begin, end)
        if self._leading(number):
            self._bend(end - begin, stints)
        else:
            self._bent = None
        return self._made(tasks, steps, begin, end, stints)

    def _made(self, tasks: Sequence[Task], steps: StepWindow, begin: int, end: int, stints: list[Stint]) -> Stretch:
        alone = sum(task.process.pushes for task in tasks) < 2
        return Stretch(self._plan, steps, begin, end, stints, partial(self._part, tasks, steps), pushes_alone=alone)

    def _stints(self, tasks: Sequence[Task], steps: StepWindow, begin: int, end: int) -> list[Stint]:
        def jacobian() -> Array:
            return self.tip_jacobian(steps, begin, end)

        span = StepSpan(steps, begin, end, None if self._gears_move else jacobian)
        made = [self._maker.stint(task, span) for task in tasks]
        return [stint for stint in made if stint is not None]

    def _part(self, tasks: Sequence[Task], steps: StepWindow, begin: int, end: int) -> Stretch:
        """Steps of a stretch that has not been run, in which no process leads and no part is carried."""
        return self._made(tasks, steps, begin, end, self._stints(tasks, steps, begin, end))

    def _bend(self, count: int, stints: list[Stint]) -> None:
        """Let the other processes act, in `count` steps, where those that lead put the tip."""
        bent: Array = np.zeros((count, 3))
        for stint in stints:
            if stint.task.process.leads:
                stint.run()
                bent += deflection_of(stint)[:, :3]
        before = bent[:1] if self._bent is None else self._bent
        self._bent = bent[-1:]
        both = np.concatenate([before, bent])
        if both.any():
            for stint in stints:
                if not stint.task.process.leads:
                    stint.shift(both)

    def tip_jacobian(self, steps: StepWindow, begin: int, end: int) -> Array:
        """Jacobians (n, 6, j) of the tip in base axes."""
        q = steps.q[begin:end]
        tool = self._shop.tool(int(steps.tool[begin]))
        J = self._shop.kinematics.jacobian(q)
        return J if tool is None else shift_jacobian(J, self._shop.kinematics.forward(q), tool.X_FT.p)


class Stretch:
    """Consecutive steps with one tool; itself the function that a world calls.

    `watch` looks at what else of the machine comes to stocks, and `seen` is what it saw in these steps. `again` makes
    a stretch of some of the steps. `pushes_alone`: no two processes push, wherever the tool is.
    """

    def __init__(
        self,
        plan: Plan,
        steps: StepWindow,
        begin: int,
        end: int,
        stints: list[Stint],
        again: Callable[[int, int], Stretch],
        *,
        pushes_alone: bool,
    ) -> None:
        self._plan, self._steps, self._again = plan, steps, again
        self.begin, self.end, self.stints, self.pushes_alone = begin, end, stints, pushes_alone
        self.watch: StockWatch | None = None
        self.seen: Sighting | None = None

    @property
    def tool(self) -> int:
        """The number of the tool in the spindle."""
        return int(self._steps.tool[self.begin])

    def look(self) -> Sighting | None:
        """How far the machine comes without a body of it in a stock as that is now; None: there is nothing to hit."""
        self._see(whether=True)
        return self.seen

    def settle(self) -> None:
        """The steps are done: a body that was seen in material is so only if that is still there."""
        if self.watch is None:
            return
        if self.seen is not None and self.seen.meets:
            self._see(whether=False)
        self.watch.keep(self.seen, self.tool)

    def _see(self, *, whether: bool) -> None:
        if self.watch is not None:
            steps, begin = self._steps, self.begin
            before = steps.q[begin - 1] if begin else steps.q_begin
            way = np.concatenate([before[None], steps.q[begin : self.end]])
            self.seen = self.watch.look(way, self.tool, whether=whether)

    def __len__(self) -> int:
        return self.end - self.begin

    def divided(self, after: int) -> list[Stretch]:
        """The same steps as two stretches, the first of `after` steps; none where they cannot be divided."""
        if not self.divisible or not 0 < after < len(self):
            return []
        middle = self.begin + after
        parts = [self._again(self.begin, middle), self._again(middle, self.end)]
        for part in parts:
            part.watch = self.watch
        return parts

    @property
    def divisible(self) -> bool:
        """Whether its steps may be run in parts."""
        whole = (stint.task.process.leads or stint.parts is not None or stint.anew for stint in self.stints)
        return not any(whole)

    @property
    def pushes(self) -> bool:
        """Whether a world would feel what the tool does."""
        return any(not stint.task.process.rests(stint.window) for stint in self.stints)

    def __call__(self, first: int, q: Array) -> Array:
        """What the tool feels (n, 6) in all steps, with joints (n, j) as commanded."""
        for stint in self.stints:
            stint.run()
        return self.felt

    @property
    def felt(self) -> Array:
        """What the tool has felt (n, 6) in all steps."""
        wrench = np.zeros((len(self), 6))
        for stint in self.stints:
            if stint.wrench is not None:
                wrench += stint.wrench
        return wrench

    def advance(self, at: int, until: int) -> None:
        """Steps `at` to `until` of this stretch, in order, with joints as commanded."""
        for stint in self.stints:
            stint.advance(at, until)

    def react(self, k: int, q_before: Array, q_free: Array, response: Array) -> Array:
        """What the tool feels (6,) in step `k` of the stretch, base axes; see `world.protocol.Reacting`."""
        wrench, at = np.zeros(6), self.begin + k
        if not self.stints:
            return wrench
        steps, row = self._steps, np.repeat(self._steps.row[at], 2)
        tips = self._plan.tip(np.array([q_before, q_free]), row)[:, :3, 3]
        before, moved = tips[0] - steps.tip_before[at, :3, 3], tips[1] - steps.tip[at, :3, 3]
        for stint in self.stints:
            if stint.task.process.pushes:
                wrench += stint.step(k, before, moved, response)
        return wrench

    @property
    def swung(self) -> NDArray[np.bool_]:
        """In which steps (n,) `swing` can tell."""
        pushing = [stint for stint in self.stints if stint.task.process.pushes]
        return pushing[0].swung if self.pushes_alone and pushing else np.full(len(self), self.pushes_alone)

    def swing(self, swings: Swings) -> Array | None:
        """What the tool feels (n, 6) in all steps of a machine whose gears swing as `swings`, base axes, tell.

        None where no single process can tell at once; see `world.protocol.SwungAtOnce`. Nothing has happened then.
        """
        pushing = [stint for stint in self.stints if stint.task.process.pushes]
        if len(pushing) != 1 or not pushing[0].swing(swings):
            return None
        assert pushing[0].wrench is not None
        return pushing[0].wrench

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

    @property
    def goes_along(self) -> bool:
        """Whether something acts where the machine puts the tip; see `Stint.goes_along`."""
        return any(stint.goes_along for stint in self.stints)

    def take_parts(self) -> None:
        """Let grippers take and let go what they do, before the world moves with it."""
        for stint in self.stints:
            if stint.parts is not None:
                stint.finish()

    def finish(self, off: Array | None = None) -> None:
        """To be called after the world has moved step by step, when all answers are in.

        `off` (n + 1, 3) [m] in B is how far the tip was off its command at the beginning and at the end of each step.
        """
        for stint in self.stints:
            if off is not None and stint.goes_along:
                stint.shift(off)
            stint.finish()
