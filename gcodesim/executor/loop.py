"""The run: windows of steps one after the other, each planned, moved, processed, recorded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from gcodesim.diagnostics import Diagnostic
from gcodesim.executor.behind import Behind
from gcodesim.executor.coupling import Coupling, Stretch
from gcodesim.executor.part import Part
from gcodesim.executor.record import StepRecord, record_of
from gcodesim.executor.tasks import RowColumns
from gcodesim.executor.totals import JointTotals, RowTotals
from gcodesim.executor.window import StepWindow, first_carry, window_of
from gcodesim.frames import Array, Pose
from gcodesim.shop import Shop
from gcodesim.world import RobotBody, WorldSteps, open_world, tool_body

if TYPE_CHECKING:
    from gcodesim.planning import Plan
    from gcodesim.world import World

MOST_STEPS: Final = 2000
"""Steps of one window: enough to spread the cost of a window, few enough to stay small in memory."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How far a run is: steps done of all, simulated time [s], path row."""

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

    def take(self, record: StepRecord, found: Sequence[Diagnostic]) -> Callable[[], None]:
        """The next window, and the findings that came up in it; stock has to be looked at now.

        The answer is work that needs the record alone; it is done in order, in another thread, while the next
        window runs.
        """

    @property
    def interval_steps(self) -> int:
        """After so many steps the watcher wants to look at the stock."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Execution:
    """What a run came to. `interrupted` when somebody stopped it after `steps` of `planned` steps.

    `volumes` [m³]: of each stock what was removed and what was added.
    """

    rows: RowTotals
    joints: JointTotals
    steps: int
    planned: int
    last_row: int
    interrupted: bool
    volumes: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def execute(
    plan: Plan,
    shop: Shop,
    *,
    world_name: str,
    dt_ns: int,
    inspect: Inspect | None = None,
    watcher: Watcher | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Execution:
    """Run the whole plan in a world; stock changes in place.

    KeyboardInterrupt ends the run after the window in hand; what was done until
    then is in the result. Raises `WorldUnavailable` when the world cannot be
    opened here.
    """
    rows = RowColumns.of(plan.path)
    totals = RowTotals.zeros(len(rows.tool))
    carry = first_carry(plan, rows)
    q0 = plan.joints(plan.trajectory.sample(np.zeros(1)))[0]
    joints = JointTotals.start(q0)
    planned = int(-(-plan.trajectory.duration_ns // dt_ns))
    world = open_world(world_name, RobotBody(chain=shop.kinematics.chain, X_WB=shop.X_WB), dt_ns)
    coupling = Coupling(plan, shop, rows)
    most = MOST_STEPS if watcher is None else max(1, min(MOST_STEPS, watcher.interval_steps))
    done, interrupted, last_row = 0, False, 0
    behind = Behind()
    volumes: dict[str, tuple[float, float]] = {}
    try:
        _attach(world, shop, int(rows.tool[0]))
        world.reset(q0)
        if watcher is not None:
            still = window_of(plan, rows, -1, 1, dt_ns, first_carry(plan, rows))
            watcher.start(world.run(q0[None]), still)
            world.reset(q0)
        while done < planned:
            count = min(most, planned - done)
            window = window_of(plan, rows, done, count, dt_ns, carry)
            record, parts = _run(world, shop, coupling, window)
            _add_volumes(volumes, parts)
            _sum_up(record, totals, joints)
            found = inspect(record, totals, joints) if inspect is not None else []
            if watcher is not None:
                behind.do(watcher.take(record, found))
            done += count
            last_row = int(window.row[-1])
            if progress is not None:
                progress(Progress(step=done, steps=planned, time=done * dt_ns * 1e-9, row=last_row))
    except KeyboardInterrupt:
        interrupted = True
    finally:
        world.close()
        behind.close()
    return Execution(
        rows=totals,
        joints=joints,
        steps=done,
        planned=planned,
        last_row=last_row,
        interrupted=interrupted,
        volumes=volumes,
    )


def _run(world: World, shop: Shop, coupling: Coupling, window: StepWindow) -> tuple[StepRecord, list[Part]]:
    """Move through a window, tool by tool."""
    bounds = (np.flatnonzero(np.diff(window.tool)) + 1).tolist()
    stretches: list[Stretch] = []
    moved: list[WorldSteps] = []
    for begin, end in zip([0, *bounds], [*bounds, len(window)], strict=True):
        _attach(world, shop, int(window.tool[begin]))
        stretch = coupling.stretch(window, begin, end)
        moved.append(_move(world, stretch, window.q[begin:end]))
        stretch.finish()
        stretches.append(stretch)
    steps = moved[0] if len(moved) == 1 else _joined(moved)
    parts = [part for stretch in stretches for part in stretch.parts]
    return record_of(window, steps, parts), parts


def _add_volumes(volumes: dict[str, tuple[float, float]], parts: Sequence[Part]) -> None:
    for part in parts:
        assert part.answer is not None
        change = float(part.answer.removed.sum())
        before = volumes.get(part.task.target.name, (0.0, 0.0))
        gone, come = (change, 0.0) if part.task.process.takes else (0.0, -change)
        volumes[part.task.target.name] = (before[0] + gone, before[1] + come)


def _move(world: World, stretch: Stretch, q: Array) -> WorldSteps:
    """Move through a stretch. Where the motors keep up, the cut is known before the motion and done in one go;
    else the world and the process go step by step."""
    if not any(part.task.process.pushes for part in stretch.parts):
        return world.run(q)
    restore = stretch.save() if world.may_lag else None
    wrench = stretch.whole()
    if restore is None or world.keeps_up(q, wrench):
        return world.run(q, wrench)
    restore()
    return world.run(q, stretch)


def _joined(parts: list[WorldSteps]) -> WorldSteps:
    names = ("q", "qd", "qdd", "effort", "saturated", "reaction")
    return WorldSteps(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def _attach(world: World, shop: Shop, number: int) -> None:
    """Put the tool of that number on the flange; the old one goes into its pocket."""
    tool = shop.tool(number)
    body = None if tool is None else tool_body(tool)
    now = world.tool
    if (now.name if now else None) == (body.name if body else None):
        return
    world.attach(body, None if now is None else pocket_of(shop, now.name))


def pocket_of(shop: Shop, name: str) -> Pose:
    """Where the tool of that name waits: pose of its flange side in the world, along X of the magazine."""
    names = [tool.name for _, tool in sorted(shop.cell.tools.items())]
    index = names.index(name) if name in names else len(names)
    return shop.magazine_pose @ Pose.from_xyz_rpy((index * shop.cell.magazine.pitch, 0.0, 0.0))


def _sum_up(record: StepRecord, totals: RowTotals, joints: JointTotals) -> None:
    row = record.window.row
    world = record.world
    joints.add(world.q, world.qd, world.qdd, world.effort, world.saturated, row)
    cutting = record.removed > 0.0
    # what cutting takes away is known better with every pass along a wall, so single steps may be negative
    totals.add("removed", row, np.where(record.adding, 0.0, record.removed))
    totals.add("added", row, np.where(record.adding, -record.removed, 0.0))
    totals.add("engaged", row, record.engaged * record.window.dt)
    totals.add("stopped_cut", row, np.where(record.stopped, record.removed, 0.0))
    totals.add("reversed_cut", row, np.where(record.reversed, record.removed, 0.0))
    totals.add("rapid_cut", row, np.where(record.rapid & cutting, record.removed, 0.0))
    totals.add("rapid_bound", row, np.where(record.rapid & cutting, record.rapid_bound, 0.0))
    totals.add("inside", row, record.inside * record.window.dt)
    totals.add("tilted", row, record.tilted * record.window.dt)
    totals.raise_to("force", row, np.linalg.norm(record.wrench[:, :3], axis=1))
    for name in ("torque", "power"):
        totals.raise_to(name, row, np.abs(getattr(record, name)))
    totals.raise_to("shank", row, record.shank_depth)
    totals.raise_to("holder", row, record.holder_depth)
