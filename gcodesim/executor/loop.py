"""The run: windows of steps, one after another, each planned, moved, processed and recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import partial
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np

from gcodesim.diagnostics import Diagnostic
from gcodesim.executor.ahead import CutThread, WindowCut
from gcodesim.executor.behind import Behind
from gcodesim.executor.coupling import Coupling
from gcodesim.executor.probe_guard import ProbeGuard
from gcodesim.executor.record import StepRecord, record_of
from gcodesim.executor.stint import Stint
from gcodesim.executor.tasks import RowColumns
from gcodesim.executor.totals import JointTotals, RowTotals
from gcodesim.executor.window import StepWindow, first_carry, window_of
from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.processes.column import ADDED, REMOVED
from gcodesim.shop import Shop
from gcodesim.world import RobotBody, WorldSteps, open_world, tool_body

if TYPE_CHECKING:
    from gcodesim.planning import Plan
    from gcodesim.world import World

MOST_STEPS: Final = 2000
"""Steps of one window: enough to spread the cost of a window, few enough to stay small in memory."""


@frozen
class Progress:
    """How far a run has come: steps done and in all, simulated time [s], path row."""

    step: int
    steps: int
    time: float
    row: int


Inspect = Callable[[StepRecord, RowTotals, JointTotals], Sequence[Diagnostic]]
"""Looks at each window and the totals so far; answers findings that are new."""


class Watcher(Protocol):
    """Who wants to see every window: the log."""

    def start(self, world_steps: WorldSteps, window: StepWindow) -> None:
        """The state before the first step, as a window of one step that does not move."""

    def look(self, window: StepWindow) -> Any:
        """Look at the stocks as `window` leaves them; in the thread that cuts, before the next window is cut.

        The result is handed to `take`, unless the cut is undone; then `look` is called again.
        """

    def take(self, record: StepRecord, found: Sequence[Diagnostic], seen: Any) -> Callable[[], None]:
        """The next window, the findings that came up in it, and what `look` saw at its end.

        Returns work that needs nothing else; it is done in order, in another thread, while the next window runs.
        """

    def follow(self, plan: Plan) -> None:
        """The run goes on with a leg; `plan` is that of all legs so far. Done in order with the work from `take`."""

    @property
    def interval_steps(self) -> int:
        """The number of steps after which the watcher wants to look at the stock."""


@frozen(eq=False)
class Execution:
    """The outcome of a run. `interrupted`: somebody stopped it after `steps` of `planned` steps.

    `volumes` [m³]: what was removed from each stock and what was added to it. `others`: the same of further channels.
    """

    rows: RowTotals
    joints: JointTotals
    steps: int
    planned: int
    last_row: int
    interrupted: bool
    volumes: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    others: Sequence[Execution] = ()


def execute(
    plan: Plan,
    shop: Shop,
    *,
    world_name: str,
    dt_ns: int,
    inspect: Inspect | None = None,
    watcher: Watcher | None = None,
    progress: Callable[[Progress], None] | None = None,
    onward: Callable[[], Plan | None] | None = None,
) -> Execution:
    """Run the whole plan in a world; stock changes in place.

    At the end of a plan, `onward` may say how the program goes on: with the plan of all
    legs so far and the next one, which begins with a whole step.

    KeyboardInterrupt ends the run after the windows in progress; what was done until
    then is in the result. It is passed on to the caller when nothing was done. Raises
    `WorldUnavailable` when the world cannot be opened here.
    """
    rows = RowColumns.of(plan.path, shop)
    sheet = shop.sheet
    totals = RowTotals.zeros(len(rows.tool), sheet)
    standing: dict[str, float] = {}
    q0 = plan.joints(plan.trajectory.sample(np.zeros(1)))[0]
    joints = JointTotals.start(q0)
    world = open_world(world_name, RobotBody(chain=shop.kinematics.chain, X_WB=shop.X_WB), dt_ns)
    most = MOST_STEPS if watcher is None else max(1, min(MOST_STEPS, watcher.interval_steps))
    coupling, guard = Coupling(plan, shop, rows), ProbeGuard(shop)
    planned = 0
    done, interrupted, last_row = 0, False, 0
    cutter = CutThread(None if watcher is None else watcher.look, undoable=world.may_lag)
    behind = Behind()
    volumes: dict[str, tuple[float, float]] = {}
    in_hand: list[WindowCut] = []
    try:
        _attach(world, shop, int(rows.tool[0]))
        world.reset(q0)
        if watcher is not None:
            still = window_of(plan, rows, -1, 1, dt_ns, first_carry(plan, rows))
            watcher.start(world.run(q0[None]), still)
            world.reset(q0)
        follows = True
        leg: Plan | None = plan
        while leg is not None:
            first, planned = planned, int(-(-leg.trajectory.duration_ns // dt_ns))
            if first:
                rows = RowColumns.of(leg.path, shop)
                totals.grow(len(rows.tool))
                coupling.follow(leg, rows)
            cuts = _cuts(leg, coupling, guard, rows, range(first, planned, most), planned, dt_ns)
            cut = next(cuts, None)
            while cut is not None:
                cutter.begin(cut)
                following = next(cuts, None)
                in_hand = [cut] if following is None else [cut, following]
                cutter.wait(cut)
                if following is not None and follows:
                    cutter.begin(following)
                steps, follows = _move(world, shop, cutter, cut, following)
                record = record_of(cut.window, steps, cut.stints, sheet, standing)
                standing = record.standing
                _add_volumes(volumes, cut.stints)
                del in_hand[0]
                totals.add(record)
                joints.add(steps.q, steps.qd, steps.qdd, steps.effort, steps.saturated, record.window.row)
                found = inspect(record, totals, joints) if inspect is not None else []
                if watcher is not None:
                    behind.do(watcher.take(record, found, cut.seen))
                done += len(record)
                last_row = int(record.window.row[-1])
                cut = following
                if progress is not None:
                    progress(Progress(step=done, steps=planned, time=done * dt_ns * 1e-9, row=last_row))
            leg = onward() if onward is not None else None
            if leg is not None and watcher is not None:
                behind.do(partial(watcher.follow, leg))
    except KeyboardInterrupt:
        if not done:  # there is nothing yet that could be told
            raise
        interrupted = True
    finally:
        world.close()
        cutter.close()
        behind.close()
    for cut in in_hand:  # what an interrupted run has cut ahead of its motion
        _add_volumes(volumes, cut.stints)
    return Execution(
        rows=totals,
        joints=joints,
        steps=done,
        planned=planned,
        last_row=last_row,
        interrupted=interrupted,
        volumes=volumes,
    )


def _cuts(
    plan: Plan, coupling: Coupling, guard: ProbeGuard, rows: RowColumns, firsts: range, end: int, dt_ns: int
) -> Iterator[WindowCut]:
    """The windows that begin with steps `firsts`, the last before step `end`, sampled and divided where the tool

    changes or begins or ceases to be kept from cutting; nothing is cut yet.
    """
    carry = first_carry(plan, rows, firsts.start * dt_ns)
    for first in firsts:
        window = window_of(plan, rows, first, min(firsts.step, end - first), dt_ns, carry)
        kept = guard.kept(plan.path, rows, window)
        changes = (np.diff(window.tool) != 0) | np.diff(kept)
        bounds = (np.flatnonzero(changes) + 1).tolist()
        borders = zip([0, *bounds], [*bounds, len(window)], strict=True)
        stretches = [coupling.stretch(window, begin, end, cuts=not kept[begin]) for begin, end in borders]
        yield WindowCut(window=window, stretches=stretches)


def _move(
    world: World, shop: Shop, cutter: CutThread, cut: WindowCut, following: WindowCut | None
) -> tuple[WorldSteps, bool]:
    """Move through a window, tool by tool; also returns whether the motors kept up.

    Where they do, the cut is known already; otherwise it is undone, and world and process go step by step.
    """
    moved: list[WorldSteps] = []
    follows = True
    for index, stretch in enumerate(cut.stretches):
        _attach(world, shop, int(cut.window.tool[stretch.begin]))
        q = cut.window.q[stretch.begin : stretch.end]
        if not stretch.pushes:
            moved.append(world.run(q))
        elif world.keeps_up(q, cut.wrenches[index]):
            moved.append(world.run(q, cut.wrenches[index]))
        else:
            follows = False
            if following is not None:
                cutter.take_back(following)
            cutter.take_back(cut, first=index)
            moved.append(world.run(q, stretch))
            stretch.finish()
            cut.wrenches.append(np.zeros(0))
            cutter.cut(cut)
    return moved[0] if len(moved) == 1 else _joined(moved), follows


def _add_volumes(volumes: dict[str, tuple[float, float]], stints: Sequence[Stint]) -> None:
    for stint in stints:
        answer = stint.answer
        if answer is None or not (REMOVED.name in answer.columns or ADDED.name in answer.columns):
            continue
        gone, come = volumes.get(stint.task.target.name, (0.0, 0.0))
        volumes[stint.task.target.name] = (
            gone + float(answer[REMOVED.name].sum()),
            come + float(answer[ADDED.name].sum()),
        )


def _joined(parts: list[WorldSteps]) -> WorldSteps:
    names = ("q", "qd", "qdd", "effort", "saturated", "reaction")
    return WorldSteps(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def _attach(world: World, shop: Shop, number: int) -> None:
    """Put the tool with this number on the flange; the old one goes into its pocket."""
    tool = shop.tool(number)
    body = None if tool is None else tool_body(tool)
    now = world.tool
    if (now.name if now else None) == (body.name if body else None):
        return
    world.attach(body, None if now is None else pocket_of(shop, now.name))


def pocket_of(shop: Shop, name: str) -> Pose:
    """Where the tool of this name waits: the pose of its flange side in the world; pockets follow X of the magazine."""
    names = [tool.name for _, tool in sorted(shop.cell.tools.items())]
    index = names.index(name) if name in names else len(names)
    return shop.magazine_pose @ Pose.from_xyz_rpy((index * shop.cell.magazine.pitch, 0.0, 0.0))
