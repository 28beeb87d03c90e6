"""One machine of an open cell: where its joints are to go, the steps of it that wait to be run, and what it holds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.cell.standing import standing_of
from gcodesim.checks.told_once import told_once
from gcodesim.frames import Array
from gcodesim.motion.tool_path import PathEvent, ToolPath, ToolState
from gcodesim.planning import plan_path, posing_of
from gcodesim.planning.joint_moves import JointMove
from gcodesim.planning.joint_spline import JointSpline, TipPace
from gcodesim.planning.legs import followed_by
from gcodesim.planning.shop_posing import bearers_of, loads_of
from gcodesim.session import caller
from gcodesim.session.foreseen import ForeseenSteps
from gcodesim.session.misuse import MisuseError
from gcodesim.session.run_thread import SessionLegs
from gcodesim.session.servo_kernels import JointBounds, approach
from gcodesim.session.switches import Switches
from gcodesim.session.table_plan import LegForm, Stretched, merged, plan_of
from gcodesim.world.led import LedWorld

if TYPE_CHECKING:
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.executor.record import StepRecord
    from gcodesim.jobs.job import Job
    from gcodesim.planning import Plan
    from gcodesim.planning.borne_work import BorneWork
    from gcodesim.session.path_frame import PathFrame
    from gcodesim.shop import Shop
    from gcodesim.world import World, WorldSteps

_AT_ONCE: Final = 1e-9  # [s] within which what is there at the beginning of a way is met
_ROUNDED_OFF: Final = 1e-4  # [rad, m] that a smooth way between vectors at a limit may swing beyond it
_UNLIMITED: Final = 1e6  # [rad/s, m/s, and per s] where a description names no limit


class MovedMachine:
    """The machine that one channel of the cell moves, from step to step.

    `q` and `qd` (j,) are the commanded joints at the end of all steps so far, run or waiting, `target` (j,) is where
    they go with the next ones. `record` is of the last steps that were run.
    """

    def __init__(self, job: Job, step_ns: int) -> None:
        self.job = job
        self._step_ns, self._dt = step_ns, step_ns * 1e-9
        self.q = self.shop.home.copy()
        self.qd = np.zeros_like(self.q)
        self.target = self.q.copy()
        assert job.cell is not None
        loaded = job.cell.channels[job.channel].loaded_tool or 0  # in hand from the start, as of a program
        self.state = ToolState(tool=loaded)
        self.active = False
        self.switches = Switches.holding(self.shop.tool(loaded))
        self.record: StepRecord | None = None
        self._waiting: list[Stretched] = []
        self._known = 0  # how many of those that wait somebody was told of
        self.is_told = False  # whether words wait with its steps: some take time of their own
        self._unchecked: list[Plan] = []
        self._unchecked_from = 0.0  # [s]
        self._hit: set[tuple[str, tuple[str, ...]]] = set()  # codes and bodies that were told
        self._bounds = _bounds(self.shop)
        self._posing = posing_of(self.shop)
        self._form: LegForm | None = None
        self._world: LedWorld | None = None  # of the run, which begins with the first steps
        self._foreseen: ForeseenSteps | None = None
        self._held: set[str] = set()  # parts that its gripper has
        assert isinstance(job.legs, SessionLegs)
        self._checks = job.legs.checks
        job.seen, job.led = self._see, self._lead

    def _see(self, record: StepRecord) -> None:
        self.record = record
        for _, event in record.grips:
            if event.kind == "taken":
                self._held.add(event.part)
            elif event.kind in ("lost", "released"):
                self._held.discard(event.part)

    def _lead(self, world: World) -> World:
        self._world = LedWorld(world)
        return self._world

    @property
    def shop(self) -> Shop:
        assert self.job.shop is not None
        return self.job.shop

    @property
    def has_begun(self) -> bool:
        """Whether a step of it was run or waits."""
        return self.record is not None or self.waits

    @property
    def waits(self) -> bool:
        """Whether steps of it wait to be run."""
        return bool(self._waiting)

    @property
    def stands_first(self) -> bool:
        """Whether its next step begins with a change of tools, for which it stands."""
        return self.switches.changes_tool

    @property
    def last(self) -> WorldSteps | None:
        """The last steps of all, run or foreseen; None before any, and where those that wait have to be run first."""
        ran = None if self.record is None else self.record.world
        if not self._waiting:
            return ran
        if self._world is None:
            return None
        self._foreseen = self._foreseen or ForeseenSteps(self._world, self.shop)
        return self._foreseen.last(self._waiting, holds=bool(self._held))

    @property
    def foreseen(self) -> int:
        """How many of the stretches that wait are foreseen."""
        return 0 if self._foreseen is None else self._foreseen.count

    @property
    def rests(self) -> bool:
        return not np.any(np.abs(self.qd) > 0.0)

    def check_rest(self) -> None:
        """MisuseError while it moves."""
        if not self.rests:
            raise MisuseError("the robot is moving; let it come to rest with `cell.step` first")

    def change_tool(self, number: int) -> None:
        """Hold the tool of this number from the next step on, 0 for none, switched off."""
        self.active = False
        self.state = replace(self.state, tool=number, spindle=0.0, push=())
        self.switches.change(number, self.shop.tool(number))

    # ---- tables of joints, a row for each step and one before (n + 1, j)

    def towards_target(self, steps: int) -> Array:
        """The next steps on the way to the target, at which they arrive no faster than the limits allow."""
        table = np.empty((steps + 1, len(self.q)))
        table[0] = self.q
        approach(self.q, self.qd, self.target, self._bounds, self._dt, table[1:])
        return table

    def move(self, target: Array) -> Array:
        """Steps to `target` (j,) from rest to rest, all joints together. MisuseError while it moves."""
        self.check_rest()
        move = JointMove.between(self.q, target, self.shop.kinematics.joints)
        if not self.shop.mover.joints_are_axes:
            move, _ = move.within(loads_of(self.shop), self.state.tool)
        return self._sampled(move.at, move.duration, target)

    def follow(self, vectors: Array, along: TipPace | None = None) -> Array:
        """Steps through joint vectors (n, j) without a stop, from rest to rest.

        With `along` (n rows) the tip is no faster than that. MisuseError while it moves, and where the smooth way goes
        beyond a limit.
        """
        self.check_rest()
        joints = self.shop.kinematics.joints
        if along is not None:
            along = along._replace(gone=np.concatenate([[0.0], along.gone]))
        spline = JointSpline.through(np.vstack([self.q, vectors]), joints, along)
        table = self._sampled(lambda t: spline.at(t)[:, : len(self.q)], spline.duration, vectors[-1])
        kept = np.clip(table, joints.lower, joints.upper)
        for k in np.flatnonzero((np.abs(kept - table) > _ROUNDED_OFF).any(axis=0)):
            raise MisuseError(f"the smooth way through these vectors takes {joints.names[k]} beyond its limit")
        return kept

    def _sampled(self, at: Callable[[Array], Array], duration: float, end: Array) -> Array:
        steps = max(int(np.ceil(duration / self._dt - 1e-9)), 1)
        table = at(np.arange(steps + 1, dtype=float) * self._dt)
        table[0], table[-1] = self.q, end
        return table

    def stand_at(self, q: Array) -> None:
        """It has come to rest at `q` (j,), which is its target, too."""
        self.q, self.target = q.copy(), q.copy()

    # ---- steps that wait

    def wait_for(self, table: Array, active: bool | None = None) -> None:
        """Keep steps that are to be run; `active` is whether the process of the tool is on, if not as before."""
        on = self.active if active is None else active
        self.switches.turn(on)
        events = self.switches.taken()
        self.is_told = self.is_told or bool(events)
        self._waiting.append(Stretched(q=table, state=self.state, span=caller.line(), active=on, events=events))

    def leg(self, count: int | None = None) -> Plan | None:
        """The plan of the first `count` stretches that wait, or of all; None if there are none."""
        stretches = merged(self._waiting[:count])
        if not stretches:
            return None
        return self._plan_of(stretches)

    def _plan_of(self, stretches: Sequence[Stretched]) -> Plan:
        standing = standing_of(self.shop.cell, self.shop.channel)
        plan = plan_of(stretches, self.shop, self._posing, self._dt, standing, self._form)
        self._form = self._form or LegForm.of(stretches, plan)
        return plan

    def leg_along(self, path: ToolPath, given_in: PathFrame, active: bool | None, borne: BorneWork | None) -> Plan:
        """The plan of moves in a frame, as of a program, from where the machine stands, with the tool in hand.

        `active`: whether the process is on all along; None: as the path says, or as it is. `borne` is where work
        systems are that other machines bear. MisuseError where it would be on without a tool.
        """
        shop, tool = self.shop, self.shop.tool(self.state.tool)
        length = 0.0 if tool is None else tool.true_length
        state = replace(self.state, system=given_in.system, offset=(0.0, 0.0, length, 0.0, 0.0, 0.0), word="G1")
        n = len(path)
        zeros = np.zeros(n, dtype=np.int32)
        on = path.active | self.active if active is None else np.full(n, active)
        if on.any() and tool is None:
            raise MisuseError("the path is to be run with the process on, but the robot holds no tool")
        own = replace(
            path.transform(given_in.X_MP),
            active=on,
            state=zeros,
            states=(state,),
            source=zeros,
            spans=(caller.line(),),
        )
        events = [PathEvent(0, event) for event in self.switches.taken()]
        for row in np.flatnonzero(np.diff(on, prepend=~on[:1])).tolist():
            events += [PathEvent(row, event) for event in self.switches.turning(bool(on[row]))]
        return plan_path(
            replace(own, events=tuple(events)),
            shop.kinematics,
            posing_of(shop, borne=borne),
            home=self.q,
            duration_of=standing_of(shop.cell, shop.channel),
            tool_frames={number: each.X_FT for number, each in shop.cell.tools.items()},
            look_ahead=shop.look_ahead,
        )

    def standing_plan(self) -> Plan:
        """A plan of one step in which it stands where it is."""
        still = Stretched(q=np.vstack([self.q, self.q]), state=self.state, span=caller.line(), active=False)
        return self._plan_of([still])

    def borne_work(self, plans: Mapping[str, Plan]) -> BorneWork | None:
        """Where the work systems are that other machines bear, at the beginning of their `plans`."""
        bearers = bearers_of(self.shop, plans)
        return None if bearers is None else bearers.after_waits((), self.shop.X_WB)

    # ---- what is wrong with legs, and what they hit

    def check_later(self, leg: Plan, begin: float) -> int:
        """Keep a leg that begins at `begin` [s] to be checked; says how many are kept."""
        if not self._unchecked:
            self._unchecked_from = begin
        self._unchecked.append(leg)
        return len(self._unchecked)

    def found(self) -> Iterator[Diagnostic]:
        """Check the legs that are kept, all at once: each check has much to prepare, and legs may be short.

        What was in something else already when they began has been told with the legs before.
        """
        legs, self._unchecked = self._unchecked, []
        if not legs:
            return
        plan, begin = reduce(followed_by, legs), self._unchecked_from
        for finding in told_once(plan.findings, self._checks.hits(plan)):
            what, goes_on = (finding.code, finding.bodies), (finding.time or 0.0) <= _AT_ONCE
            if what in self._hit and goes_on:
                continue
            if finding.bodies:
                self._hit.add(what)
            yield replace(finding, time=None if finding.time is None else finding.time + begin)

    def tell_of_waiting(self) -> None:
        """Somebody is told what comes of the steps that wait."""
        self._known = len(self._waiting)

    def leave_undone(self) -> None:
        """Forget the steps that wait and of which nobody was told."""
        del self._waiting[self._known :]

    def forget_waiting(self, count: int | None = None) -> None:
        """The steps of the first `count` stretches that waited, or of all, are about to be run."""
        gone = len(self._waiting) if count is None else count
        self._waiting, self._known = self._waiting[gone:], max(self._known - gone, 0)
        self.is_told = self.is_told and bool(self._waiting)
        if self._foreseen is not None:
            self._foreseen.forget(gone)


def _bounds(shop: Shop) -> JointBounds:
    joints = shop.kinematics.joints
    return JointBounds(
        np.minimum(np.asarray(joints.speed, dtype=float), _UNLIMITED),
        np.minimum(np.asarray(joints.acceleration, dtype=float), _UNLIMITED),
    )
