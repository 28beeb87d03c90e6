"""A cell that a Python program moves: robots to joints and poses, tools coupled and switched, paths run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gcodesim import given, simulation
from gcodesim.api import InputError
from gcodesim.canon import Pause
from gcodesim.cell import LoadedCell
from gcodesim.cell.cell import MAIN
from gcodesim.cell.loader import load_cell
from gcodesim.diagnostics import Diagnostic, Findings, Severity
from gcodesim.frames import Array, rotation_from_quaternion
from gcodesim.jobs.job import Job, Options
from gcodesim.jobs.switching import switching_findings
from gcodesim.log.shapes import DrawnLine
from gcodesim.motion.joining import standing_until
from gcodesim.motion.tool_path import ToolPath
from gcodesim.observation.schedule import stations_of
from gcodesim.planning import Plan
from gcodesim.sensors.camera import MOST_PIXELS
from gcodesim.sensors.optics import Optics
from gcodesim.sensors.outputs import Picture
from gcodesim.session import caller
from gcodesim.session.arm import Arm
from gcodesim.session.machine import MovedMachine
from gcodesim.session.misuse import MisuseError, as_misuse
from gcodesim.session.path_frame import path_frame_of
from gcodesim.session.run_thread import RunThread
from gcodesim.session.sensor_in_hand import HandSensor, Present, looking
from gcodesim.session.tool_in_hand import HandTool
from gcodesim.shop import Shop, open_shop
from gcodesim.tools.tcp_load import TcpLoad

if TYPE_CHECKING:
    from gcodesim.jobs.results import Results
    from gcodesim.planning.borne_work import BorneWork
    from gcodesim.world import WorldSteps

_MOST_WAITING: Final = 10_000  # steps: then they are run, though nobody asks what they did
_MOST_FORESEEN = 250  # steps that somebody knows of: then they are run, so that the log is not far behind
_MOST_UNCHECKED: Final = 100  # legs: then they are checked, though nobody asks for findings


def open_cell(
    cell: Path | str,
    out: Path | str | None = None,
    *,
    world: str | None = None,
    force: bool = False,
    allow_paths: Sequence[Path | str] = (),
    allow_code: bool = False,
) -> OpenCell:
    """Open the cell that the file `cell` describes, to be used in a `with` statement.

    All machines that channels of the cell move are there, whatever programs the channels have. Ctrl-C in the `with`
    statement ends it as it ends a run: at once, and log and results say so.
    With `out`, a folder, what a run writes is written there; in place of lines of a program stand those of the calling
    script. `world`, `force`, `allow_paths`, folders besides that of the cell that may be read, and `allow_code` as of
    `gcodesim run`. Raises `InputError` when the cell has errors,
    OSError when it cannot be read, `WorldUnavailable` when the world cannot be opened here.
    """
    from gcodesim.world import WORLDS, require_world

    if world is not None and world not in WORLDS:
        raise MisuseError(f"there is no world `{world}`; there are {', '.join(sorted(WORLDS))}")
    loaded = load_cell(Path(cell), tuple(map(Path, allow_paths)), allow_code=allow_code)
    if loaded.cell is None:
        raise InputError(list(loaded.findings), loaded.sources)
    tools = {number: replace(tool, load=tool.load or TcpLoad()) for number, tool in loaded.cell.tools.items()}
    channels = {name: replace(channel, signals={}) for name, channel in loaded.cell.channels.items()}  # no words come
    loaded = replace(loaded, cell=replace(loaded.cell, tools=tools, channels=channels))  # a script may pull at any tool
    job = _job_of(loaded, Options(world=world, force=force))
    if any(finding.level >= Severity.ERROR for finding in job.findings):
        raise InputError(list(job.findings), job.sources)
    require_world(job.world)
    return OpenCell(job, None if out is None else Path(out))


def _job_of(loaded: LoadedCell, options: Options) -> Job:
    """A job without a plan for each channel of a cell, `main` first; what is wrong with the cell is with the first."""
    assert loaded.cell is not None
    script = caller.script()
    jobs = [
        Job(
            program=script,
            loaded=loaded,
            options=options,
            findings=Findings(),
            channel=channel,
            sources={**loaded.sources, script.name: script},
            shop=open_shop(loaded.cell, channel),
        )
        for channel in sorted(loaded.cell.channels, key=lambda name: (name != MAIN, name))
    ]
    job, *job.others = jobs
    job.drawings = ()
    job.findings.extend(loaded.findings)
    for each in jobs:
        assert each.shop is not None
        job.findings.extend(simulation.standing_findings(each.shop))
    return job


class OpenCell:
    """An open cell; time stands until `step` or a path is run. Made by `open_cell`."""

    def __init__(self, job: Job, out: Path | None) -> None:
        assert job.cell is not None and job.shop is not None
        self._job = job
        self._run = RunThread(job, out)
        self._step_ns = job.cell.simulation.step_ns
        self._wanted_ns = self._done_steps = self._waiting_steps = 0
        self._told_steps = 0  # of those that wait, somebody knows of so many
        self._machines = [MovedMachine(each, self._step_ns) for each in job.all]
        self._closed = False
        self._arms = {machine.shop.name: Arm(self, machine) for machine in self._machines}
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
        """The robot, or machine tool, of this name that a channel moves; without one, that of the first channel.

        MisuseError for another name.
        """
        if name is None:
            return next(iter(self._arms.values()))
        if not isinstance(name, str) or name not in self._arms:
            listed = ", ".join(f"`{each}`" for each in self._arms)
            raise MisuseError(f"no channel of this cell moves `{name}`; they move {listed}")
        return self._arms[name]

    @property
    def robots(self) -> tuple[Arm, ...]:
        """All robots and machine tools that channels of the cell move, that of the first channel first."""
        return tuple(self._arms.values())

    def tool(self, number: int) -> HandTool:
        """The tool with this number. MisuseError when the cell has none."""
        if not isinstance(number, (int, np.integer)) or number not in self._shop.cell.tools:
            known = ", ".join(str(each) for each in sorted(self._shop.cell.tools)) or "none"
            raise MisuseError(f"the cell has no tool {number!r}; it has {known}")
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
        whole = isinstance(width, (int, np.integer)) and isinstance(height, (int, np.integer))
        with as_misuse():
            field_of_view = given.number(field_of_view, "the angle of a picture [rad]")
        if not (whole and width >= 1 and height >= 1 and width * height <= MOST_PIXELS and 0.0 < field_of_view < 3.0):
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
        """Draw a path in the log, from now on: a `ToolPath` in `frame` (G54), or points (n, 3) [m] in the world.

        `color` is red, green and blue from 0 to 1. MisuseError for what is no line, and for an unknown `frame`.
        """
        if isinstance(path, ToolPath):
            points = path.positions if len(path) else np.zeros((0, 3))
            X_WM = self._shop.X_WB @ self._shop.X_BM
            points = X_WM.apply(path_frame_of(self._shop, frame or "G54").X_MP.apply(points))
        elif frame is not None:
            raise MisuseError("points are those of the world; only a `ToolPath` is drawn in a frame")
        else:
            with as_misuse():
                points = given.numbers(path, (None, 3), "a drawing")
        if len(points) < 2:
            raise MisuseError("a drawing needs two points or more, each of three finite numbers")
        self._draw(points, color)

    def draw_frame(self, position: ArrayLike, orientation: ArrayLike | None = None, length: float = 0.05) -> None:
        """Draw the axes of a pose in the world: X red, Y green, Z blue, `length` [m]; quaternion x y z w.

        MisuseError for what is no pose, and for no length.
        """
        with as_misuse():
            turned = (0.0, 0.0, 0.0, 1.0) if orientation is None else orientation
            R = rotation_from_quaternion(given.quaternions(turned, (4,), "the orientation of a frame"))
            p = given.numbers(position, (3,), "the place of a frame")
            length = given.number(length, "the length of axes [m]", above=0.0)
        for axis in range(3):
            self._draw(np.array([p, p + length * R[:, axis]]), [float(k == axis) for k in range(3)])

    def clear_drawings(self) -> None:
        """Take all drawings away, from now on."""
        self._flush()
        self._job.drawings = ()

    def _draw(self, points: Array, color: Sequence[float]) -> None:
        self._check_open()
        self._flush()  # what waits has been before
        with as_misuse():
            red, green, blue = given.numbers(color, (3,), "a colour, of red, green and blue from 0 to 1,").tolist()
        drawn = self._job.drawings or ()
        line = DrawnLine(id=f"drawing {len(drawn)}", points=points.copy(), color=(red, green, blue, 1.0))
        self._job.drawings = (*drawn, line)

    @property
    def time(self) -> float:
        """Seconds since the cell was opened, tool changes included."""
        if any(machine.is_told for machine in self._machines):
            self._flush()
        self._tell_of_waiting()
        return (self._done_steps + self._waiting_steps) * self._step_ns * 1e-9

    @property
    def findings(self) -> list[Diagnostic]:
        """What has been found so far, with the severities of the cell."""
        self._flush()
        self._tell_of_motion()
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
        with as_misuse():
            seconds = given.number(seconds, "the time that passes [s]", above=0.0)
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
        if self._run.has_failed:  # which was told
            self._closed = True
            return
        try:
            if interrupted:
                self._leave_undone()
            elif not self._first.has_begun:
                self._pass(1)  # so that there is a log of a cell in which nothing was done
            self._flush()
            self._tell_of_motion()
            self._tell_of_switching()
        finally:
            self._closed = True
            self._run.end(interrupted=interrupted)

    # ---- inside

    @property
    def _shop(self) -> Shop:
        assert self._job.shop is not None
        return self._job.shop

    @property
    def _first(self) -> MovedMachine:
        return self._machines[0]

    def _holder(self, number: int) -> MovedMachine | None:
        """The machine that holds this tool."""
        return next((machine for machine in self._machines if machine.state.tool == number), None)

    def _last_of(self, machine: MovedMachine) -> WorldSteps | None:
        """The last steps of a machine, which are run if that is not known otherwise; None before any."""
        if machine.waits and machine.last is None:
            self._flush()
        self._tell_of_waiting()
        return machine.last

    def _tell_of_waiting(self) -> None:
        """Somebody is told what comes of the steps that wait: an interruption does not leave them undone."""
        if self._waiting_steps >= _MOST_FORESEEN:
            self._flush()
        self._told_steps = self._waiting_steps
        for machine in self._machines:
            machine.tell_of_waiting()

    def _leave_undone(self) -> None:
        """Forget the steps that wait and of which nobody knows; all others are to be run."""
        for machine in self._machines:
            machine.leave_undone()
        self._waiting_steps = self._told_steps if all(machine.waits for machine in self._machines) else 0

    def _present(self, tool: int | None = None) -> Present:
        """What stands where, after the last step; if there was none, after one in which nothing moves.

        Seen from the machine that holds `tool`, if one does, else from the first.
        """
        self._check_open()
        if not self._first.has_begun:
            self._pass(1)
        self._flush()
        own = self._first if tool is None else self._holder(tool) or self._first
        records = {machine.shop.name: machine.record for machine in self._machines if machine.record is not None}
        return Present(shop=own.shop, records=records)

    def _check_open(self) -> None:
        if self._closed or self._run.has_failed:
            raise MisuseError("this cell is closed; open it again")

    def _pass(self, count: int) -> None:
        """`count` steps of all machines towards their targets; they are run when somebody asks what they did."""
        at_once = self._flushed_for_change()
        for machine in self._machines:
            machine.wait_for(machine.towards_target(count))
        self._count_waiting(count, at_once=at_once)

    def _wait_for(self, own: MovedMachine, table: Array, active: bool | None = None) -> None:
        """Steps of one machine through joints (n + 1, j); meanwhile the others go on towards their targets."""
        self._check_open()
        at_once = self._flushed_for_change()
        for machine in self._machines:
            if machine is own:
                machine.wait_for(table, active)
            else:
                machine.wait_for(machine.towards_target(len(table) - 1))
        self._count_waiting(len(table) - 1, at_once=at_once)

    def _flushed_for_change(self) -> bool:
        """Whether a machine changes its tool before its next step, while others go on.

        Then all steps so far are run, and the next ones have to be run at once: the others get as many more as the
        change takes, and that must not depend on when somebody asks what they did.
        """
        if len(self._machines) == 1 or not any(machine.stands_first for machine in self._machines):
            return False
        self._flush()
        return True

    def _count_waiting(self, count: int, *, at_once: bool) -> None:
        self._waiting_steps += count
        if at_once or self._waiting_steps >= _MOST_WAITING:
            self._flush()

    def _flush(self) -> None:
        """Run all steps that wait; those that are foreseen are legs by themselves."""
        while self._waiting_steps:
            count = min((machine.foreseen for machine in self._machines if machine.foreseen), default=None)
            self._advance(self._waiting_legs(count), count)

    def _waiting_legs(self, count: int | None = None) -> dict[MovedMachine, Plan]:
        """The plans of those who have steps that wait, in the first `count` stretches or all."""
        return {machine: leg for machine in self._machines if (leg := machine.leg(count)) is not None}

    def _advance(self, legs: Mapping[MovedMachine, Plan], count: int | None = None) -> None:
        """Run a leg of each machine: those that wait, or one made otherwise. All last as long as the longest.

        Those that wait are of the first `count` stretches, or of all.

        Who has steps that wait goes on towards its target, others stand at the end of theirs.
        """
        steps = max(self._steps_of(leg) for leg in legs.values())
        whole = []
        for machine in self._machines:
            leg = legs[machine]
            if machine.waits and (more := steps - self._steps_of(leg)):
                machine.wait_for(machine.towards_target(more))
                longer = machine.leg()
                assert longer is not None
                leg = longer
            machine.forget_waiting(count)
            whole.append(self._filled(leg, steps))
        gone = self._waiting_steps if count is None else steps
        self._waiting_steps, self._told_steps = self._waiting_steps - gone, max(self._told_steps - gone, 0)
        begin = self._done_steps * self._step_ns * 1e-9
        kept = [machine.check_later(leg, begin) for machine, leg in zip(self._machines, whole, strict=True)]
        if max(kept) >= _MOST_UNCHECKED:
            self._tell_of_motion()
        self._done_steps += steps
        self._run.advance(whole)

    def _steps_of(self, leg: Plan) -> int:
        return int(-(-leg.trajectory.duration_ns // self._step_ns))

    def _filled(self, leg: Plan, steps: int) -> Plan:
        """A leg that stands at its end until so many steps are over."""
        end = steps * self._step_ns * 1e-9
        if end - leg.trajectory.duration <= 1e-12:
            return leg
        pause = Pause(span=caller.line(), seconds=end - leg.trajectory.duration)
        return replace(leg, trajectory=standing_until(leg.trajectory, end, pause))

    def _tell_of_motion(self) -> None:
        """Report what is wrong with the motion of all legs so far, and what they hit."""
        for machine in self._machines:
            for finding in machine.found():
                self._job.findings.add(finding, key=(finding.code, finding.span, finding.bodies))

    def _tell_of_switching(self) -> None:
        """Report tools that were switched on for nothing, or never, along all that was done."""
        for machine in self._machines:
            if (plan := machine.job.plan) is not None:
                self._job.findings.extend(switching_findings(plan.path, machine.shop))

    def _run_path(self, own: MovedMachine, path: ToolPath, frame: str, active: bool | None) -> None:
        """Run moves as a program would, from where the machine stands, with the tool that it holds."""
        self._check_open()
        if not isinstance(path, ToolPath):
            raise MisuseError(f"what is run is a `gcodesim.ToolPath`; {type(path).__name__} is given")
        if not len(path):
            raise MisuseError("the path has no moves")
        own.check_rest()
        self._flush()
        given_in = path_frame_of(own.shop, frame)
        leg = own.leg_along(path, given_in, active, self._borne(own, given_in.system))
        for machine in self._machines:
            if machine is not own:
                machine.wait_for(machine.towards_target(self._steps_of(leg)))
        self._advance({**self._waiting_legs(), own: leg})
        own.stand_at(leg.joints(leg.trajectory.sample(np.array([leg.trajectory.duration])))[0])

    def _borne(self, own: MovedMachine, system: int) -> BorneWork | None:
        """Where work systems are that other machines bear; None where they bear none.

        MisuseError where the machine that bears `system` moves.
        """
        links = own.shop.placement.borne
        if not links:
            return None
        by_name = {machine.shop.name: machine for machine in self._machines}
        bearer = by_name.get(links[system].partition("/")[0]) if system in links else None
        if bearer is not None and not bearer.rests:
            raise MisuseError(f"`{bearer.shop.name}`, on which the work stands, is moving; let it come to rest first")
        return own.borne_work({name: machine.standing_plan() for name, machine in by_name.items()})
