"""One channel in a run: its plan, its machine in a world, what its tools do, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from operator import is_
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.matrices import applied
from gcodesim.diagnostics import Diagnostic
from gcodesim.executor.accuracy import PathAccuracy
from gcodesim.executor.ahead import WindowCut
from gcodesim.executor.coupling import Coupling, Stretch
from gcodesim.executor.execution import Execution
from gcodesim.executor.freeing import Freed
from gcodesim.executor.made_by import add_passes
from gcodesim.executor.part_run import PartRun, laden
from gcodesim.executor.probe_guard import ProbeGuard
from gcodesim.executor.record import StepRecord, record_of
from gcodesim.executor.stock_change import StockChange, add_changes
from gcodesim.executor.switching import Switching
from gcodesim.executor.tasks import Only, RowColumns
from gcodesim.executor.tip_swings import TipSwings
from gcodesim.executor.totals import JointTotals, RowTotals
from gcodesim.executor.window import Carry, Ints, StepWindow, first_carry, window_of
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.processes.gripping import GRIP, GripEvent
from gcodesim.scene import PartChange
from gcodesim.shop import Shop
from gcodesim.solids.mass import MassOfSkin
from gcodesim.world import RobotBody, World, WorldSteps, open_world, tool_body, usual_controller

if TYPE_CHECKING:
    from gcodesim.checks.stock_watch import StockWatch
    from gcodesim.executor.loose_bodies import LooseBodies
    from gcodesim.executor.pacing import Pacing
    from gcodesim.executor.watcher import Watcher
    from gcodesim.material.passes import Passes
    from gcodesim.planning import Plan


ON_COMMAND: Final = 1e-9
"""[m] within which a tip counts as where it is commanded to be."""

Inspect = Callable[[StepRecord, RowTotals, JointTotals], Sequence[Diagnostic]]
"""Looks at each window and the totals so far; answers findings that are new."""


@frozen(eq=False)
class TrackPlan:
    """What a channel brings to a run: its plan, its shop, who looks at its steps, and what it is about, if not all.

    `bodies` looks at how near its machine comes to stocks. `efforts`: whether anybody wants to know speeds and efforts
    of joints. `led` puts around the world of the run what leads that on.
    """

    plan: Plan
    shop: Shop
    inspect: Inspect | None = None
    watcher: Watcher | None = None
    only: Only | None = None
    bodies: StockWatch | None = None
    efforts: bool = True
    led: Callable[[World], World] | None = None


class Track:
    """A channel while it runs. `steps` is the number that its plan needs, `done` that of those that are run."""

    def __init__(
        self,
        brought: TrackPlan,
        world_name: str,
        pacing: Pacing,
        passes: dict[str, Passes] | None = None,
        number: int = 0,
        parts: PartRun | None = None,
        loose: LooseBodies | None = None,
    ) -> None:
        """`passes` are those at each stock, kept for all channels; `number` is that of this one."""
        dt_ns = pacing.dt_ns
        plan, shop = brought.plan, brought.shop
        self.parts, self._loose = parts, loose
        self.load: dict[str, tuple[Pose, MassOfSkin]] = {}
        self._on_flange: tuple[int | None, list[tuple[Pose, MassOfSkin]]] = (None, [])  # tool and load
        if parts is not None:
            parts.devices.follow(shop.channel, plan)
        self.plan, self.shop, self.watcher = plan, shop, brought.watcher
        self.rows = RowColumns.of(plan.path, shop)
        self._inspect, self._pacing, self._dt_ns, self._bodies = brought.inspect, pacing, dt_ns, brought.bodies
        self._sheet = shop.sheet
        self._totals = RowTotals.zeros(len(self.rows.tool), self._sheet)
        self._standing: dict[str, float] = {}
        self._home = plan.joints(plan.trajectory.sample(np.zeros(1)))[0]
        world = open_world(world_name, robot_body(shop, world_name), dt_ns, efforts=brought.efforts)
        self.world = world if brought.led is None else brought.led(world)
        self._joints = JointTotals.start(self._home, told=self.world.tells_efforts)
        gears_move = not self.world.keeps_to_command
        self._coupling = Coupling(plan, shop, self.rows, parts, gears_move=gears_move, only=brought.only)
        self._guard = ProbeGuard(shop)
        yields = shop.stiffness is not None or gears_move
        self._accuracy = PathAccuracy() if yields else None
        self._swings = TipSwings(dt_ns * 1e-9) if gears_move else None
        self.changes: dict[str, StockChange] = {}
        self._passes, self._number = passes or {}, number
        self.done = self.last_row = 0
        self.stands_at = self._home
        # how far the tip was off its command at the end of the last steps, and with which tool
        self._off: tuple[Array, int] | None = None
        self.late_grips: list[GripEvent] = []
        self.freed: list[Freed] = []

    def begin(self) -> None:
        """Put the first tool on the flange, and show the watcher the state at the start."""
        plan, rows = self.plan, self.rows
        self.attach(int(rows.tool[0]))
        self.world.reset(self._home)
        if self.watcher is not None:
            still = window_of(plan, rows, np.array([-1, 0]), self._pacing, first_carry(plan, rows))
            self.watcher.start(self.world.run(self._home[None]), still)
            self.world.reset(self._home)

    @property
    def steps(self) -> int:
        return int(-(-self.plan.trajectory.duration_ns // self._dt_ns))

    def follow(self, plan: Plan) -> None:
        """Go on with the plan of all legs so far and the next."""
        self.plan, self.rows = plan, RowColumns.of(plan.path, self.shop)
        self._totals.grow(len(self.rows.tool))
        self._coupling.follow(plan, self.rows)
        if self._bodies is not None:
            self._bodies.follow(plan)
        if self.parts is not None:
            self.parts.devices.follow(self.shop.channel, plan)

    def carry(self, first: int) -> Carry:
        """What the window that begins with step `first` of a leg takes over."""
        return first_carry(self.plan, self.rows, first * self._dt_ns)

    def window(self, ticks: Ints, carry: Carry) -> StepWindow:
        asked, logged = self.world.tells_efforts, self.watcher is not None
        return window_of(self.plan, self.rows, ticks, self._pacing, carry, asked=asked, logged=logged)

    def run_world(self, window: StepWindow, begin: int, end: int, wrench: Array | None = None) -> WorldSteps:
        """Move through steps `begin` to `end`, in which the tool feels `wrench` (n, 6), base axes.

        Returns what happens at their ends, and when the log looks at them: at the moments of `AskedTicks`.
        """
        command = window.command
        if command is None:
            return self.world.run(window.q[begin:end], wrench)
        rows, moments = command.rows(begin, end), command.moments(begin, end)
        ends = command.at[command.ends[begin:end]]
        felt = None if wrench is None else wrench[np.searchsorted(ends, np.arange(rows.start, rows.stop))]
        return self.world.run(command.q[rows], felt).at(command.at[moments] - rows.start)

    def cut(self, window: StepWindow, *, looks: bool) -> WindowCut:
        """A window, divided where the tool changes, begins or ceases to be kept from cutting, or to be pulled at.

        Nothing is cut yet.
        A program that has ended cuts nothing more while others go on.
        """
        kept = self._guard.kept(self.plan.path, self.rows, window)
        if window.end > self.steps:
            kept = kept | (window.ticks[:-1] >= self.steps)
        pulled = self._coupling.pulled(window)
        changes = (np.diff(window.tool) != 0) | np.diff(kept) | np.diff(pulled)
        bounds = (np.flatnonzero(changes) + 1).tolist()
        borders = zip([0, *bounds], [*bounds, len(window)], strict=True)
        stretches = [
            self._coupling.stretch(window, begin, end, cuts=not kept[begin], pulled=bool(pulled[begin]))
            for begin, end in borders
        ]
        for stretch in stretches:
            stretch.watch = self._bodies
        return WindowCut(window=window, stretches=stretches, looks=looks)

    def save(self) -> Callable[[], None]:
        """Remember what `cut` changes; calling the result restores it."""
        guard, tasks = copy(self._guard), self._coupling.save()

        def restore() -> None:
            self._guard = guard
            tasks()

        return restore

    def attach(self, number: int) -> None:
        """Put the tool with this number on the flange, with the parts that it holds; the old one goes to its pocket."""
        load = list(self.load.values())
        held, by = self._on_flange
        if number == held and len(load) == len(by) and all(map(is_, load, by)):
            return  # the usual case, which is asked in every window
        self._on_flange = (number, load)
        world, tool, now = self.world, self.shop.tool(number), self.world.tool
        body = None if tool is None else laden(tool_body(tool), load)
        if now is not None and body is not None and now.name == body.name and now.mass != body.mass:
            world.attach(body, None)
            return
        if (now.name if now else None) == (body.name if body else None):
            return
        world.attach(body, None if now is None else pocket_of(self.shop, now.name))

    def move(self, stretch: Stretch, window: StepWindow) -> Iterator[WorldSteps]:
        """Move through steps that need no force; whoever takes a part or lets it go has another load from then on."""
        parts, begin = self.parts, stretch.begin
        changes = [change for stint in stretch.stints if stint.parts is not None for change in stint.parts.changes]
        number = int(window.tool[stretch.begin])
        if parts is None or not changes:
            self.attach(number)
            yield self.run_world(window, begin, stretch.end)
            return
        for change in changes:
            until = change.hold.step - window.first
            if until > begin:
                self.attach(number)
                yield self.run_world(window, begin, until)
                begin = until
            parts.happens(change)
            self._reload(change, parts)
        self.attach(number)
        yield self.run_world(window, begin, stretch.end)

    def off_command(self, window: StepWindow, stretch: Stretch, steps: WorldSteps) -> Array | None:
        """How far (n + 1, 3) [m] in B the tip is off its command, before and at the end of each step of a stretch.

        None where nothing asks, and where it is not off by more than rounding.
        """
        begin, self._off = self._off, None
        if not stretch.goes_along:
            return None
        here = slice(stretch.begin, stretch.end)
        off: Array = (self.plan.tip(steps.q, window.row[here]) - window.tip[here])[:, :3, 3]
        if steps.gear is not None:
            off = off + applied(self._coupling.tip_jacobian(window, stretch.begin, stretch.end), steps.gear)[:, :3]
        before = off[:1] if begin is None or begin[1] != stretch.tool else begin[0]
        self._off = (off[-1:], stretch.tool)
        both = np.concatenate([before, off])
        return both if np.abs(both).max() > ON_COMMAND else None

    def carry_on(self, stretch: Stretch) -> None:
        """After steps with force: what was taken or let go in them counts from the next stretch on."""
        for stint in stretch.stints:
            if stint.parts is not None and self.parts is not None:
                for change in stint.parts.changes:
                    self.parts.happens(change)
                    self._reload(change, self.parts)

    def _reload(self, change: PartChange, parts: PartRun) -> None:
        hold = change.hold
        self.load.pop(hold.body, None)
        if change.holder:
            self.load[hold.body] = (hold.X, parts.masses[hold.body])

    def take(self, cut: WindowCut, steps: WorldSteps) -> StepRecord:
        """Take over what was done in a window: `steps` at the ends of its steps, or at the moments of `AskedTicks`."""
        window, at_looks = cut.window, None
        if window.command is not None:
            at_looks, steps = steps.at(window.command.looks), steps.at(window.command.ends)
        feeds = ~self.rows.rapid[window.row] & (window.samples.event < 0)
        record = record_of(window, steps, cut.stints, self._sheet, self._standing, feeds)
        if steps.gear is not None:
            for stretch in cut.stretches:
                here = slice(stretch.begin, stretch.end)
                J = self._coupling.tip_jacobian(cut.window, stretch.begin, stretch.end)
                record.deflection[here] += applied(J, steps.gear[here])
        if self._accuracy is not None:
            tips = window.tip if np.array_equal(steps.q, window.q) else self.plan.tip(steps.q, window.row)
            ends = tips[:, :3, 3] + record.deflection[:, :3]
            self._accuracy.add(record, ends)
            if self._swings is not None:
                self._swings.add(record, ends)
        if window.looks is not None:
            record = replace(record, at_looks=at_looks)
        self._standing = record.standing
        if self._bodies is not None:
            for stretch in cut.stretches:
                here = slice(stretch.begin, stretch.end)
                times = window.ticks[stretch.begin : stretch.end + 1].astype(float) * (self._dt_ns * 1e-9)
                self._bodies.take(stretch.seen, stretch.tool, window.row[here], times)
        add_changes(self.changes, cut.stints)
        self.freed.extend(piece for _, piece in record.freed)
        if self._loose is not None and record.freed:
            q = {self.shop.name: steps.q, **window.others}
            record = replace(record, loose=tuple(self._loose.fall(self.shop, record.freed, window.ticks[1:], q)))
        if self._passes:
            add_passes(self._passes, cut.stints, self._number)
        if self.parts is not None:
            for stint in cut.stints:
                if stint.parts is not None:
                    for name, X_W in stint.parts.let_go_at:
                        self.parts.was_let_go(name, X_W)
            self.parts.count([event for _, event in record.grips])
        self._totals.add(record)
        ticks = np.diff(window.ticks)
        self._joints.add(steps.q, steps.qd, steps.qdd, steps.effort, steps.saturated, window.row, ticks)
        self.done = window.end
        self.stands_at = steps.q[-1]
        self.last_row = int(record.window.row[-1])
        return record

    def found(self, record: StepRecord) -> Sequence[Diagnostic]:
        """Findings that came up in a window."""
        return self._inspect(record, self._totals, self._joints) if self._inspect is not None else []

    def let_go_at_end(self) -> None:
        """Open the gripper if the program does so after its last move, when no step is left to do it in."""
        parts, shop = self.parts, self.shop
        if parts is None or not self.load:
            return
        if float(Switching(self.plan, shop).changes(GRIP)[1][-1]) > 0.5:
            return
        step = self.done - 1
        joints = {shop.name: self.stands_at[None]}
        frames = parts.frames_at(step, joints)
        for name in list(self.load):
            X_WP = parts.ran.poses(name, step, joints)[0]
            change, height, support = parts.come_to_rest(step, name, X_WP, np.zeros(3), frames)
            parts.happens(replace(change, fall=None))
            parts.was_let_go(name, X_WP)
            event = GripEvent(step=step, kind="released", part=name, height=height, support=support.rpartition("/")[2])
            parts.count([event])
            self.late_grips.append(event)
        self.load.clear()

    def execution(self, planned: int, *, interrupted: bool) -> Execution:
        return Execution(
            rows=self._totals,
            joints=self._joints,
            late_grips=tuple(self.late_grips),
            steps=self.done,
            planned=planned,
            last_row=self.last_row,
            interrupted=interrupted,
            changes=self.changes,
            passes=self._passes,
            accuracy=self._accuracy,
            swings=self._swings,
            freed=tuple(self.freed),
        )


def robot_body(shop: Shop, world_name: str) -> RobotBody:
    """The machine of a shop as a world of this name moves it."""
    return RobotBody(
        chain=shop.kinematics.chain,
        X_WB=shop.X_WB,
        stiffness=None if shop.stiffness is None else tuple(shop.stiffness.tolist()),
        controller=shop.mover.controller or usual_controller(world_name, shop.stiffness),
    )


def pocket_of(shop: Shop, name: str) -> Pose:
    """Where the tool of this name waits: the pose of its flange side in the world; pockets follow X of the magazine."""
    own = next((number for number in shop.cell.magazine.stands if shop.cell.tools[number].name == name), None)
    if own is not None:
        return shop.stand(own)
    names = [tool.name for _, tool in sorted(shop.cell.tools.items())]
    index = names.index(name) if name in names else len(names)
    return shop.magazine_pose @ Pose.from_xyz_rpy((index * shop.cell.magazine.pitch, 0.0, 0.0))
