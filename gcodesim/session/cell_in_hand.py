"""A cell that a Python program moves: robots to joints and poses, tools coupled and switched, paths run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gcodesim import simulation
from gcodesim.api import InputError
from gcodesim.arithmetic.matrices import multiplied
from gcodesim.canon import Pause
from gcodesim.cell.loader import load_cell
from gcodesim.cell.standing import standing_of
from gcodesim.controllers import Controller
from gcodesim.diagnostics import Diagnostic, Findings, Severity
from gcodesim.frames import Array, Pose, quaternion_from_rotation, rotation_from_quaternion
from gcodesim.frozen import frozen
from gcodesim.jobs.job import Job, Options
from gcodesim.kinematics.protocol import Status
from gcodesim.log.shapes import DrawnLine
from gcodesim.motion.joining import standing_until
from gcodesim.motion.tool_path import PathEvent, ToolPath, ToolState
from gcodesim.observation.schedule import Station, stations_of
from gcodesim.planning import Plan, plan_path, posing_of
from gcodesim.planning.joint_moves import JointMove
from gcodesim.planning.joint_spline import JointSpline
from gcodesim.planning.shop_posing import loads_of
from gcodesim.sensors.camera import MOST_PIXELS
from gcodesim.sensors.optics import Optics
from gcodesim.sensors.outputs import Output, Picture
from gcodesim.session import caller
from gcodesim.session.misuse import MisuseError
from gcodesim.session.pose_path import between
from gcodesim.session.run_thread import RunThread
from gcodesim.session.sensor_in_hand import Present, depths_of, looking, pixels_of
from gcodesim.session.servo_kernels import JointBounds, approach
from gcodesim.session.switches import Switches
from gcodesim.session.table_plan import Stretched, merged, plan_of
from gcodesim.session.tool_in_hand import HandTool
from gcodesim.shop import Shop, controller_of, open_shop
from gcodesim.tools.tcp_load import TcpLoad
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.jobs.results import Results

_MOST_WAITING: Final = 10_000  # steps: then they are run, though nobody asks what they did
_UNLIMITED: Final = 1e6  # [rad/s, m/s, and per s] where a description names no limit


@frozen(eq=False)
class JointState:
    """A robot after the last step, in the order of its joints: positions, velocities and efforts of motors (j,), SI.

    `reaction` (6,): force [N] and torque [N·m] of the flange on the tool, at the flange, in axes of the base.
    """

    names: tuple[str, ...]
    position: Array
    velocity: Array
    effort: Array
    reaction: Array


def open_cell(
    cell: Path | str,
    out: Path | str | None = None,
    *,
    world: str | None = None,
    force: bool = False,
    allow_code: bool = False,
) -> OpenCell:
    """Open the cell that the file `cell` describes, to be used in a `with` statement.

    Ctrl-C in the `with` statement ends it as it ends a run: at once, and log and results say so.
    With `out`, a folder, what a run writes is written there; in place of lines of a program stand those of the calling
    script. `world`, `force` and `allow_code` as of `gcodesim run`. Raises `InputError` when the cell has errors,
    OSError when it cannot be read, `WorldUnavailable` when the world cannot be opened here.
    """
    from gcodesim.world import require_world

    loaded = load_cell(Path(cell), allow_code=allow_code)
    if loaded.cell is None:
        raise InputError(list(loaded.findings), loaded.sources)
    tools = {number: replace(tool, load=tool.load or TcpLoad()) for number, tool in loaded.cell.tools.items()}
    channels = {name: replace(channel, signals={}) for name, channel in loaded.cell.channels.items()}  # no words come
    loaded = replace(loaded, cell=replace(loaded.cell, tools=tools, channels=channels))  # a script may pull at any tool
    script = caller.script()
    job = Job(
        program=script,
        loaded=loaded,
        options=Options(world=world, force=force),
        findings=Findings(),
        sources={**loaded.sources, script.name: script},
    )
    job.findings.extend(loaded.findings)
    assert loaded.cell is not None
    job.shop = open_shop(loaded.cell)
    job.drawings = ()
    standing = simulation.standing_findings(job.shop)
    job.findings.extend(standing)
    if any(finding.level >= Severity.ERROR for finding in standing):
        raise InputError(list(job.findings), job.sources)
    require_world(job.world)
    return OpenCell(job, None if out is None else Path(out))


class OpenCell:
    """An open cell; time stands until `step` or a path is run. Made by `open_cell`."""

    def __init__(self, job: Job, out: Path | None) -> None:
        assert job.cell is not None and job.shop is not None
        self._job = job
        self._run = RunThread(job, out)
        job.legs, job.seen = self._run, self._see
        self._step_ns = job.cell.simulation.step_ns
        self._wanted_ns = self._done_steps = 0
        self._waiting: list[Stretched] = []
        self._waiting_steps = 0
        self._switches = Switches()
        self._q = job.shop.home.copy()
        self._qd = np.zeros_like(self._q)
        self._target = self._q.copy()
        self._bounds = _bounds(job.shop)
        self._state = ToolState()
        self._active = False
        self._record: StepRecord | None = None
        self._closed = False
        self._arm = Arm(self)
        self._tools: dict[int, HandTool] = {}
        self._sensors: dict[str, HandSensor] = {}

    def __enter__(self) -> OpenCell:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end(interrupted=kind is not None and issubclass(kind, KeyboardInterrupt))

    # ---- what is in the cell

    def robot(self, name: str | None = None) -> Arm:
        """The robot, or machine tool, that the cell's first channel moves. MisuseError for another name."""
        if name is not None and name != self._shop.name:
            raise MisuseError(f"`{name}` cannot be moved: the first channel of this cell moves `{self._shop.name}`")
        return self._arm

    def tool(self, number: int) -> HandTool:
        """The tool with this number. MisuseError when the cell has none."""
        if number not in self._shop.cell.tools:
            known = ", ".join(str(each) for each in sorted(self._shop.cell.tools)) or "none"
            raise MisuseError(f"the cell has no tool {number}; it has {known}")
        return self._tools.setdefault(number, HandTool(self, number))

    def sensor(self, name: str) -> HandSensor:
        """The sensor with this name, of a tool such as `T9`. MisuseError when the cell has none."""
        known = {station.name: station for station in stations_of(self._shop.cell)}
        if name not in known:
            raise MisuseError(f"the cell has no sensor `{name}`; it has {', '.join(known) or 'none'}")
        return self._sensors.setdefault(name, HandSensor(self, known[name]))

    def camera(self, name: str) -> HandSensor:
        """The camera with this name. MisuseError when the cell has none, or it takes no pictures."""
        found = self.sensor(name)
        if Picture not in found.station.sensor.outputs.values():
            raise MisuseError(f"`{name}` is a {found.station.sensor.kind}, which takes no pictures")
        return found

    def picture(
        self,
        position: ArrayLike,
        target: ArrayLike,
        *,
        up: ArrayLike = (0.0, 0.0, 1.0),
        width: int = 640,
        height: int = 480,
        field_of_view: float = 1.0,
    ) -> NDArray[np.uint8]:
        """Red, green and blue (height, width, 3) of the cell as it stands, from a place to a target in the world [m].

        `field_of_view` [rad] is from the left border to the right one. MisuseError for a picture that cannot be.
        """
        if not (width >= 1 and height >= 1 and width * height <= MOST_PIXELS and 0.0 < field_of_view < 3.0):
            raise MisuseError(f"a picture has 1 to {MOST_PIXELS} pixels and an angle between 0 and 3 rad")
        try:
            X_WC = looking(position, target, up)
        except ValueError as fault:
            raise MisuseError(f"there is no such picture: {fault}") from fault
        return self._present().picture(Optics.of_view(width, height, field_of_view), X_WC)

    # ---- drawings, in the log and its viewer

    def draw(
        self, path: ToolPath | ArrayLike, *, color: Sequence[float] = (0.85, 0.1, 0.6), frame: str | None = None
    ) -> None:
        """Draw a path in the log, from now on: a `ToolPath` in a work system (G54), or points (n, 3) [m] in the world.

        `color` is red, green and blue from 0 to 1. MisuseError for what is no line, and for an unknown work system.
        """
        if isinstance(path, ToolPath):
            points = path.positions if len(path) else np.zeros((0, 3))
            X_WM = self._shop.X_WB @ self._shop.X_BM
            points = X_WM.apply(self._shop.placement.work_offsets[self._system(frame or "G54")].apply(points))
        elif frame is not None:
            raise MisuseError("points are those of the world; only a `ToolPath` is drawn in a work system")
        else:
            points = np.asarray(path, dtype=float)
        if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2 or not np.isfinite(points).all():
            raise MisuseError("a drawing needs two points or more, each of three finite numbers")
        self._draw(points, color)

    def draw_frame(self, position: ArrayLike, orientation: ArrayLike | None = None, length: float = 0.05) -> None:
        """Draw the axes of a pose in the world: X red, Y green, Z blue, `length` [m]; quaternion x y z w."""
        R = np.eye(3) if orientation is None else rotation_from_quaternion(np.asarray(orientation, dtype=float))
        p = np.asarray(position, dtype=float)
        for axis in range(3):
            self._draw(np.array([p, p + length * R[:, axis]]), [float(k == axis) for k in range(3)])

    def clear_drawings(self) -> None:
        """Take all drawings away, from now on."""
        self._flush()
        self._job.drawings = ()

    def _draw(self, points: Array, color: Sequence[float]) -> None:
        self._check_open()
        self._flush()  # what waits has been before
        red, green, blue = (float(share) for share in color)
        drawn = self._job.drawings or ()
        line = DrawnLine(id=f"drawing {len(drawn)}", points=points.copy(), color=(red, green, blue, 1.0))
        self._job.drawings = (*drawn, line)

    def _system(self, frame: str) -> int:
        """The number of a work system by name; MisuseError for one that the cell does not have."""
        names = {f"G{54 + k}" if k < 6 else f"G59.{k - 5}": k + 1 for k in range(9)}
        if names.get(frame) not in self._shop.placement.work_offsets:
            raise MisuseError(f"there is no work system `{frame}`; use G54 to G59.3")
        return names[frame]

    @property
    def time(self) -> float:
        """Seconds since the cell was opened, tool changes included."""
        self._flush()
        return self._done_steps * self._step_ns * 1e-9

    @property
    def findings(self) -> list[Diagnostic]:
        """What has been found so far, with the severities of the cell."""
        self._flush()
        return self._job.shown(self._job.findings)

    @property
    def results(self) -> Results:
        """The results, as of a run; MisuseError while the cell is open."""
        if self._run.results is None:
            raise MisuseError("results are there when the cell has been closed, after the `with` statement")
        return self._run.results

    # ---- time

    def step(self, seconds: float) -> None:
        """Let time pass: joints go on to their targets. Parts of a step of the simulation count with the next call."""
        self._check_open()
        if not (np.isfinite(seconds) and seconds > 0.0):
            raise MisuseError(f"time cannot pass by {seconds} s; give a number above 0")
        self._wanted_ns += round(seconds * 1e9)
        count = self._wanted_ns // self._step_ns
        self._wanted_ns -= count * self._step_ns
        while count:
            some = min(count, _MOST_WAITING)
            self._pass(some)
            count -= some

    def close(self) -> None:
        """End the run, write what is to be written; further calls do nothing."""
        self._end(interrupted=False)

    def _end(self, *, interrupted: bool) -> None:
        if self._closed:
            return
        try:
            if not interrupted:
                if self._record is None and not self._waiting:
                    self._pass(1)  # so that there is a log of a cell in which nothing was done
                self._flush()
        finally:
            self._closed = True
            self._run.end(interrupted=interrupted)

    # ---- inside

    @property
    def _shop(self) -> Shop:
        assert self._job.shop is not None
        return self._job.shop

    def _present(self) -> Present:
        """What stands where, after the last step; if there was none, after one in which nothing moves."""
        self._check_open()
        if self._record is None and not self._waiting:
            self._pass(1)
        self._flush()
        assert self._record is not None
        return Present(shop=self._shop, record=self._record)

    def _see(self, record: StepRecord) -> None:
        self._record = record

    def _check_open(self) -> None:
        if self._closed:
            raise MisuseError("this cell is closed; open it again")

    def _pass(self, count: int) -> None:
        """`count` steps towards the target; they are run when somebody asks what they did."""
        table = np.empty((count + 1, len(self._q)))
        table[0] = self._q
        approach(self._q, self._qd, self._target, self._bounds, self._step_ns * 1e-9, table[1:])
        self._wait_for(table)

    def _wait_for(self, table: Array) -> None:
        """Steps through joint vectors (n + 1, j) that are to be run."""
        self._switches.turn(self._active)
        events = self._switches.taken()
        self._waiting.append(
            Stretched(q=table, state=self._state, span=caller.line(), active=self._active, events=events)
        )
        self._waiting_steps += len(table) - 1
        if self._waiting_steps >= _MOST_WAITING:
            self._flush()

    def _flush(self) -> None:
        """Run all steps that wait."""
        stretches, self._waiting, self._waiting_steps = merged(self._waiting), [], 0
        if stretches:
            changes = standing_of(self._shop.cell, self._shop.channel)
            self._advance(plan_of(stretches, self._shop, self._step_ns * 1e-9, changes))

    def _advance(self, leg: Plan) -> None:
        """Run a leg, filled up to a whole step."""
        begin = self._done_steps * self._step_ns * 1e-9
        steps = -(-leg.trajectory.duration_ns // self._step_ns)
        end = steps * self._step_ns * 1e-9
        if end - leg.trajectory.duration > 1e-12:
            pause = Pause(span=caller.line(), seconds=end - leg.trajectory.duration)
            leg = replace(leg, trajectory=standing_until(leg.trajectory, end, pause))
        for finding in self._found(leg):
            later = replace(finding, time=None if finding.time is None else finding.time + begin)
            self._job.findings.add(later, key=(later.code, later.span, "of a session"))
        self._done_steps += steps
        self._run.advance(leg)

    def _found(self, leg: Plan) -> list[Diagnostic]:
        """What is wrong with the motion of a leg."""
        found = list(leg.findings)
        if self._shop.cell.fixtures:
            from gcodesim.checks.clearance import clearance_findings, standing_bodies

            bodies = standing_bodies(self._shop.scene, self._shop.name)
            found += clearance_findings(leg, self._shop.cell.tools, bodies, X_BM=self._shop.X_BM)
        return found

    def _change_tool(self, number: int) -> None:
        self._check_open()
        self._active = False
        self._state = replace(self._state, tool=number, spindle=0.0, push=())
        self._switches.change(number, self._shop.tool(number))

    def _measured(self) -> Array:
        """Where the joints are (j,); before the first step, where they stand."""
        self._flush()
        return self._q if self._record is None else self._record.world.q[-1]

    def _aim(self, q: Array) -> None:
        self._check_open()
        self._target = q

    def _move_joints(self, target: Array) -> None:
        """Go to `target` (j,) from rest to rest, all joints together, and wait until that is done."""
        self._check_open()
        self._check_rest()
        move, dt = JointMove.between(self._q, target, self._shop.kinematics.joints), self._step_ns * 1e-9
        if not self._shop.mover.joints_are_axes:
            move, _ = move.within(loads_of(self._shop), self._state.tool)
        count = max(int(np.ceil(move.duration / dt - 1e-9)), 1)
        times: Array = np.arange(count + 1, dtype=float) * dt
        table = move.at(times)
        table[0], table[-1] = self._q, target
        self._wait_for(table)
        self._q, self._target = target.copy(), target.copy()

    def _follow_joints(self, vectors: Array, active: bool | None) -> None:
        """Go through joint vectors (n, j) without a stop, from where the robot stands, and wait until that is done."""
        self._check_open()
        self._check_rest()
        spline = JointSpline.through(np.vstack([self._q, vectors]), self._shop.kinematics.joints)
        dt = self._step_ns * 1e-9
        count = max(int(np.ceil(spline.duration / dt - 1e-9)), 1)
        table = spline.at(np.arange(count + 1, dtype=float) * dt)
        table[0], table[-1] = self._q, vectors[-1]
        joints = self._shop.kinematics.joints
        for k in np.flatnonzero(((table < joints.lower) | (table > joints.upper)).any(axis=0)):
            raise MisuseError(f"the smooth way through these vectors takes {joints.names[k]} beyond its limit")
        before, self._active = self._active, self._active if active is None else active
        self._wait_for(table)
        self._active = before
        self._q, self._target = table[-1].copy(), table[-1].copy()

    def _check_rest(self) -> None:
        if np.any(np.abs(self._qd) > 0.0):
            raise MisuseError("the robot is moving; let it come to rest with `cell.step` first")

    def _run_path(self, path: ToolPath, frame: str, active: bool | None) -> None:
        """Run moves as a program would, from where the robot stands, with the tool that it holds."""
        self._check_open()
        if not len(path):
            raise MisuseError("the path has no moves")
        self._check_rest()
        self._flush()
        shop, tool = self._shop, self._shop.tool(self._state.tool)
        placed, system = shop.placement.work_offsets, self._system(frame)
        length = 0.0 if tool is None else tool.true_length
        state = replace(self._state, system=system, offset=(0.0, 0.0, length, 0.0, 0.0, 0.0), word="G1")
        n = len(path)
        zeros = np.zeros(n, dtype=np.int32)
        on = path.active | self._active if active is None else np.full(n, active)
        if on.any() and tool is None:
            raise MisuseError("the path is to be run with the process on, but the robot holds no tool")
        own = replace(
            path.transform(placed[system]),
            active=on,
            state=zeros,
            states=(state,),
            source=zeros,
            spans=(caller.line(),),
        )
        events = [PathEvent(0, event) for event in self._switches.taken()]
        for row in np.flatnonzero(np.diff(on, prepend=~on[:1])).tolist():
            events += [PathEvent(row, event) for event in self._switches.turning(bool(on[row]))]
        own = replace(own, events=tuple(events))
        leg = plan_path(
            own,
            shop.kinematics,
            posing_of(shop),
            home=self._q,
            duration_of=standing_of(shop.cell, shop.channel),
            tool_frames={number: each.X_FT for number, each in shop.cell.tools.items()},
        )
        self._advance(leg)
        end = leg.trajectory.sample(np.array([leg.trajectory.duration]))
        self._q = leg.joints(end)[0].copy()
        self._target = self._q.copy()


Joints = str | Mapping[str, float] | ArrayLike
"""What a script gives for joints: all of them (j,), some by name, or the name of a pose of the cell."""


class Arm:
    """A robot, or a machine tool, of an open cell. Joint values in rad and m, in the order of `joint_names`."""

    def __init__(self, cell: OpenCell) -> None:
        self._cell = cell

    @property
    def name(self) -> str:
        return self._cell._shop.name

    @property
    def joint_names(self) -> tuple[str, ...]:
        return self._cell._shop.kinematics.joints.names

    @property
    def joint_state(self) -> JointState:
        """The state after the last step; zeros, at home, before the first."""
        q = self._cell._measured()
        record, zero = self._cell._record, np.zeros(len(q))
        if record is None:
            return JointState(
                names=self.joint_names, position=q.copy(), velocity=zero, effort=zero, reaction=np.zeros(6)
            )
        world = record.world
        return JointState(
            names=self.joint_names,
            position=world.q[-1].copy(),
            velocity=world.qd[-1].copy(),
            effort=world.effort[-1].copy(),
            reaction=world.reaction[-1].copy(),
        )

    @property
    def controller(self) -> Controller:
        """How its motors follow what they are told; may be set until the first step (see `gcodesim.controllers`)."""
        from gcodesim.world import usual_controller

        job, mover = self._cell._job, self._cell._shop.mover
        return mover.controller or usual_controller(job.world, mover.stiffness)

    @controller.setter
    def controller(self, controller: Controller) -> None:
        """MisuseError once a step has run, and for machine tools, which have no model of their motors."""
        cell, shop = self._cell, self._cell._shop
        cell._check_open()
        if cell._record is not None or cell._waiting:
            raise MisuseError("a controller is set before the first step")
        if shop.mover.joints_are_axes:
            raise MisuseError(f"`{self.name}` is a machine tool; controllers are for robots")
        count = len(self.joint_names)
        for name, values in controller.lists().items():
            if len(values) not in (0, 1, count):
                raise MisuseError(f"`{name}` has {len(values)} entries; `{self.name}` has {count} joints")
        mover = replace(shop.mover, controller=controller_of(controller, shop.kinematics))
        scene = replace(shop.scene, movers={**shop.scene.movers, mover.name: mover})
        cell._job.shop = replace(shop, mover=mover, scene=scene)

    @property
    def tool(self) -> HandTool | None:
        """The tool that it holds."""
        number = self._cell._state.tool
        return self._cell.tool(number) if number else None

    @property
    def endeffector_pose(self) -> tuple[Array, Array]:
        """Position (3,) [m] and orientation x y z w in the world of the tip of the tool, or of the flange."""
        shop = self._cell._shop
        X_BF = Pose.from_matrix(shop.kinematics.forward(self._cell._measured()[None])[0])
        X_WT = shop.X_WB @ X_BF @ self._X_FT()
        return X_WT.p, quaternion_from_rotation(X_WT.R)

    def set_joint_position(self, q: Joints) -> None:
        """Where the joints are to go with the next steps: all (j,), some by name, or the name of a pose.

        MisuseError beyond a limit.
        """
        self._cell._aim(self._joints_of(q))

    def move_joints(self, *vectors: Joints) -> None:
        """Go through joint vectors from rest to rest, all joints together (PTP); returns when the last is reached.

        A text is the name of one of the robot's `poses` in the cell; external axes stay where they are.
        MisuseError beyond a limit, before anything moves, and while the robot moves already.
        """
        self._cell._check_rest()
        for target in [self._joints_of(q) for q in vectors]:
            self._cell._move_joints(target)

    def follow_joints(self, vectors: Sequence[Joints], active: bool | None = None) -> None:
        """Go through joint vectors without a stop, and wait; `active` switches the process of the tool meanwhile.

        A cubic spline from rest to rest, as fast as the limits of the joints allow (`planning.joint_spline`).
        MisuseError beyond a limit, before anything moves, and while the robot moves already.
        """
        self._cell._check_rest()
        table = [self._joints_of(q) for q in vectors]
        if not table:
            raise MisuseError("the path has no joint vectors")
        self._cell._follow_joints(np.array(table), active)

    def follow(
        self,
        positions: ArrayLike,
        orientations: ArrayLike | None = None,
        *,
        spacing: float = 5e-3,
        active: bool | None = None,
    ) -> None:
        """Bring the tip through poses in the world without a stop, and wait; it begins where the tip stands.

        `positions` (n, 3) [m], `orientations` (n, 4) x y z w, or one for all, or None: the tool keeps its own. Between
        two poses the tip goes straight, and turns evenly, through further poses that are at most `spacing` [m] (or as
        many radians times 0.1 m) apart; joints go through all of them as in `follow_joints`. MisuseError, with the
        number of the pose, where one cannot be reached, before anything moves.
        """
        cell = self._cell
        cell._check_rest()
        p0, q0 = self.endeffector_pose
        ends = np.vstack([p0, np.atleast_2d(np.asarray(positions, dtype=float))])
        wanted = q0 if orientations is None else np.asarray(orientations, dtype=float)
        turns = np.broadcast_to(wanted, (len(ends) - 1, 4))
        if not (np.isfinite(ends).all() and np.isfinite(turns).all() and spacing > 0.0):
            raise MisuseError("poses are finite numbers, and their spacing is above 0 m")
        poses, number = between(ends, np.vstack([q0, turns]), spacing)
        shop = cell._shop
        X_FT, X_BW = self._X_FT().inverse().matrix, shop.X_WB.inverse().matrix
        q, status = shop.kinematics.inverse(multiplied(X_BW, poses, X_FT), cell._q)
        bad = np.flatnonzero((status == Status.REACH) | (status == Status.LIMIT))
        if len(bad):
            why = "is out of reach" if status[bad[0]] == Status.REACH else "needs a joint beyond its limit"
            raise MisuseError(f"`{self.name}` cannot go there: the way to pose {number[bad[0]]} {why}")
        cell._follow_joints(q, active)

    def move_to(self, position: ArrayLike, orientation: ArrayLike | None = None) -> None:
        """Bring the tip to a pose in the world by a joint move (PTP), and wait; as `set_endeffector_pose` otherwise."""
        self._cell._check_rest()
        self.set_endeffector_pose(position, orientation)
        self._cell._move_joints(self._cell._target.copy())

    @property
    def poses(self) -> Mapping[str, Mapping[str, float]]:
        """The named poses that the cell gives this robot: joint values [rad, m] by the names of joints."""
        shop = self._cell._shop
        if shop.mover.joints_are_axes:
            return {}
        robot = shop.cell.robots[shop.name]
        names = robot.chain.driven_joints.names
        return {pose: dict(zip(names, values, strict=True)) for pose, values in robot.poses.items()}

    def _joints_of(self, q: Joints) -> Array:
        """All joint values (j,) that a script means; MisuseError when they are none of this robot's."""
        if isinstance(q, str):
            poses = self.poses
            if q not in poses:
                raise MisuseError(f"`{self.name}` has no pose `{q}`; it has {', '.join(poses) or 'none'}")
            q = poses[q]
        joints = self._cell._shop.kinematics.joints
        target = self._cell._target.copy()
        if isinstance(q, Mapping):
            for name, value in q.items():
                if name not in joints.names:
                    raise MisuseError(f"`{self.name}` has no joint `{name}`; it has {', '.join(joints.names)}")
                target[joints.names.index(name)] = value
        else:
            given = np.asarray(q, dtype=float)
            if given.shape != target.shape:
                raise MisuseError(f"`{self.name}` has {len(target)} joints; {given.size} values are given")
            target = given.copy()
        for k in np.flatnonzero(~((target >= joints.lower) & (target <= joints.upper))):
            raise MisuseError(
                f"{joints.names[k]} cannot go to {target[k]:.6g}: its limits are {joints.lower[k]:.6g} and "
                f"{joints.upper[k]:.6g} {'m' if joints.kinds[k] == 'prismatic' else 'rad'}"
            )
        return target

    def set_endeffector_pose(self, position: ArrayLike, orientation: ArrayLike | None = None) -> None:
        """Where the tip of the tool, or the flange, is to be with the next steps, in the world; joints go evenly there.

        `orientation` x y z w; without it the tool keeps its own. MisuseError, with the reason, when no joints do it.
        """
        cell, shop = self._cell, self._cell._shop
        held = self._cell._target
        goal = np.asarray(position, dtype=float)
        turned = np.array([0.0, 0.0, 0.0, 1.0]) if orientation is None else np.asarray(orientation, dtype=float)
        if goal.shape != (3,) or turned.shape != (4,) or not np.isfinite([*goal, *turned]).all() or not turned.any():
            raise MisuseError("a pose has a place of three finite numbers [m], and an orientation x y z w, not all 0")
        if orientation is None:
            R = (shop.X_WB @ Pose.from_matrix(shop.kinematics.forward(held[None])[0]) @ self._X_FT()).R
        else:
            R = rotation_from_quaternion(turned)
        X_WT = Pose(goal, R)
        X_BF = shop.X_WB.inverse() @ X_WT @ self._X_FT().inverse()
        q, status = shop.kinematics.inverse(X_BF.matrix[None], held)
        if status[0] in (Status.REACH, Status.LIMIT):
            why = "is out of reach" if status[0] == Status.REACH else "needs a joint beyond its limit"
            place = ", ".join(f"{value / MM:.1f}" for value in X_WT.p)
            raise MisuseError(f"`{self.name}` cannot go there: the tip at ({place}) mm in the world {why}")
        cell._aim(q[0].copy())

    def run(self, path: ToolPath, frame: str = "G54") -> None:
        """Run the moves of a path with the tip of the tool, from where the robot stands to the end, as a program does.

        Points are those of the work system `frame`. The tool is held as the cell says (`orientation:`). MisuseError
        while the robot moves, for a path without moves, or where it is switched on and no tool is held.
        """
        self._cell._run_path(path, frame, None)

    def _X_FT(self) -> Pose:
        tool = self._cell._shop.tool(self._cell._state.tool)
        return Pose.identity() if tool is None else tool.X_FT


class HandSensor:
    """A sensor of an open cell. It reads whenever it is asked, besides its own times, which are those of a run."""

    def __init__(self, cell: OpenCell, station: Station) -> None:
        self._cell, self.station = cell, station
        self._count = 0

    def read(self) -> Mapping[str, Output]:
        """What it reads after the last step, by name. MisuseError for a tool that no robot holds."""
        present = self._cell._present()
        if self.station.tool is not None and self.station.tool != present.tool:
            raise MisuseError(f"no robot holds tool {self.station.tool}; call `couple` and `step` first")
        self._count += 1
        job = self._cell._job
        assert job.cell is not None
        return present.reading(self.station, job.cell.simulation.seed, self._count)

    def picture(self) -> NDArray[np.uint8]:
        """Red, green and blue (height, width, 3), the upper row first. MisuseError if it takes no pictures."""
        found = pixels_of(self.read())
        if found is None:
            raise MisuseError(f"`{self.station.name}` is a {self.station.sensor.kind}, which takes no pictures")
        return found

    def depth(self) -> NDArray[np.float32]:
        """Depth (height, width) [m], not a number where nothing is seen. MisuseError if it measures none."""
        found = depths_of(self.read())
        if found is None:
            raise MisuseError(f"`{self.station.name}` is a {self.station.sensor.kind}, which measures no depth")
        return found


def _bounds(shop: Shop) -> JointBounds:
    joints = shop.kinematics.joints
    return JointBounds(
        np.minimum(np.asarray(joints.speed, dtype=float), _UNLIMITED),
        np.minimum(np.asarray(joints.acceleration, dtype=float), _UNLIMITED),
    )
