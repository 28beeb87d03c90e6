"""The program of a job, read and planned leg by leg.

A leg goes from rest to rest and needs no answer from the run. It ends where the program asks for one: where a probe
touches, or what an input reads. Most programs are one leg, read and planned before anything moves. A probing move is a
leg of its own, planned when the stock is in the state that earlier legs have left. Legs begin with a whole step.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gcodesim import canon
from gcodesim.arithmetic.matrices import norm
from gcodesim.canon import Axes
from gcodesim.canon.batch import MoveBatch
from gcodesim.cell.inputs import InputSource
from gcodesim.cell.standing import standing_of
from gcodesim.checks.deaf_tools import deaf_tool_findings
from gcodesim.checks.empty_spindle import empty_spindle_findings
from gcodesim.checks.ends import left_on
from gcodesim.checks.told_once import told_once
from gcodesim.checks.unused_filament import unused_filament_findings
from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.frames import Array
from gcodesim.jobs.leg_checks import LegChecks
from gcodesim.jobs.marks import is_stop, lone_marks
from gcodesim.jobs.results import ProbeResult
from gcodesim.jobs.sensor_waits import not_heard, standing_still, waited_in_vain
from gcodesim.jobs.switching import switching_findings, untriggered
from gcodesim.motion.build import PathBuilder
from gcodesim.motion.joining import standing_until, with_instant
from gcodesim.motion.tool_path import PathEvent, ToolPath
from gcodesim.motion.trajectory import TimedEvent
from gcodesim.planning import Plan, plan_path, posing_of
from gcodesim.planning.handing_over import tool_after, with_handing_over
from gcodesim.planning.legs import followed_by
from gcodesim.planning.switched import history_of
from gcodesim.processes.signal import ACTIVE, BEAM, BEAM_POWER, FLOW, SPRAY
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.shop import Shop, with_stock
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.cell.signals import SignalSource
    from gcodesim.checks.contact import Contact
    from gcodesim.checks.postures import Postures
    from gcodesim.checks.stock_watch import StockWatch
    from gcodesim.executor.halt import RunHalt
    from gcodesim.jobs.job import Job

_QUESTIONS: Final = (canon.ProbeMove, canon.Input)
_OF_TIPS: Final = ("GS301", "GS304")
_LEAVING: Final = 0.02  # [s] after a trip within which the tool begins to leave what it has touched
_GRAZE: Final = 1e-5  # [m] by which it may go deeper for a moment, as along a slope
_HALVINGS: Final = 50


class Legs:
    """Reads and plans `job` leg by leg: the first one by `prepare`, further ones while it is run or checked."""

    def __init__(self, job: Job, start: Axes, *, marks: int | None = None) -> None:
        """Read all of the program, or up to its stop number `marks`, from 0, at which it waits for ever.

        Stops are marks and tool changes.
        """
        assert job.shop is not None and job.reading is not None and job.cell is not None
        self._job, self._reading = job, job.reading
        self._stream = job.reading.stream()
        settings = job.reading.settings
        dialect = DIALECTS[settings.dialect]
        self._builder = PathBuilder(
            start,
            fastest=job.shop.fastest,
            centre=float(job.shop.X_BM.inverse().p[0]),
            length_leans=settings.length_leans,
            rapids_stand=dialect.rapids_stand,
            only_changes_stop=dialect.only_changes_stop,
            power_goes_along=job.cell.channels[job.channel].laser_mode is not None,
        )
        self._marks = marks
        self._question: canon.ProbeMove | canon.Input | None = None
        self._reply: canon.Answer | None = None
        self._read = self._ended = False
        self._checks = LegChecks(job.shop)
        self._posing = posing_of(job.shop, self._obstacles(), job.borne)
        self._at: Array = job.shop.home
        self._mounted = job.cell.channels[job.channel].loaded_tool or 0
        self._step_ns = job.cell.simulation.step_ns
        self._steps = 0  # of all legs so far
        self._stocked: bool | None = None
        self._duration_of = standing_of(job.cell, job.shop.channel)
        self._outputs: dict[str, float] = {}  # digital P0 …, analog E0 …
        self._unheard: dict[str, tuple[int, Span]] = {}
        self._halted = False  # whether the machine stands where a sensor is asked
        self._touched: tuple[str, float] | None = None  # what the last leg touched, and how far it went in after that

    @property
    def shop(self) -> Shop:
        assert self._job.shop is not None
        return self._job.shop

    # ---- for callers

    def onward(self, halt: RunHalt | None = None) -> Plan | None:
        """The plan of all legs so far and the next; None when the program has no further leg.

        Findings are added to the job. All earlier legs have been run, so that the stock is in the state they left
        it, and everything stands as `halt` says; or nothing is run at all.
        """
        while not self._ended:
            if self._question is None and not self._read:
                self._read_on()
            question = self._question
            if not self._halted and isinstance(question, canon.Input) and self._source(question).sensor is not None:
                # what has been said before takes effect first: a step in which the sensor is asked
                self._builder.add(canon.Waited(span=question.span, seconds=self._step_ns * 1e-9))
                self._halted = True
                return self._plain_leg()
            if question is None or len(self._builder.rows):
                plan = self._plain_leg()
                if plan is not None or self._ended:
                    return plan
            elif isinstance(question, canon.ProbeMove):
                return self._probe(question)
            else:
                self._hear(question, halt)
        return None

    @property
    def ended(self) -> bool:
        """Whether all of the program has been planned."""
        return self._ended

    def stock_up(self) -> bool:
        """Load the stocks; False if a fault in one of them, which is reported, keeps the job from running."""
        if self._stocked is None:
            self._job.shop, problems = with_stock(self.shop, self._job.options.left)
            self._job.findings.extend(problems)
            self._stocked = not any(problem.level >= Severity.ERROR for problem in problems)
        return self._stocked

    def stop(self) -> None:
        """Somebody stopped the run: report what has been found while reading up to then."""
        if not self._read:
            self._end_of_reading()
            self._ended = True

    def tell_of_untouched_stock(self) -> None:
        """GS919 where probes have met a stock in which nothing is cut."""
        job = self._job
        if job.probings and self.shop.stocks:
            job.findings.add(
                Diagnostic(
                    code="GS919",
                    span=job.probings[0].span,
                    message="probes meet the stock as it comes into the cell: a check cuts nothing",
                    hint="`gcodesim run` probes what the program has cut by then",
                    count=len(job.probings),
                )
            )

    # ---- reading

    def _read_on(self) -> None:
        """Read up to the next question, or to the end."""
        reply, self._reply = self._reply, None
        if reply is not None:
            try:
                self._take(self._stream.send(reply))
            except StopIteration:
                self._end_of_reading()
                return
        if self._question is None:
            add = self._builder.add
            for item in self._stream:
                if isinstance(item, _QUESTIONS):
                    self._question = item
                    break
                if self._marks is not None and isinstance(item, canon.Event) and self._holds(item):
                    self._stand_at(item)
                    self._end_of_reading()
                    break
                add(item)
            else:
                self._end_of_reading()
        self._job.sources |= self._reading.sources

    def _holds(self, item: canon.Event) -> bool:
        """Whether the program waits for ever here."""
        assert self._marks is not None
        if not is_stop(item):
            return False
        self._marks -= 1
        if self._marks >= 0:
            return False
        self._job.held = item.span
        return True

    def _stand_at(self, item: canon.Event) -> None:
        """Come to the mark, or ask for the tool; what an arm puts into a stand for that, it does put there."""
        if not isinstance(item, canon.ToolChange):
            self._builder.add(item)
            return
        if self.shop.cell.magazine.stands:
            self._builder.add(canon.ToolChange(span=item.span, tool=0))
        self._builder.add(canon.ToolAwaited(span=item.span, tool=item.tool))

    def _take(self, item: canon.Event | MoveBatch) -> None:
        if isinstance(item, _QUESTIONS):
            self._question = item
        else:
            self._builder.add(item)

    def _end_of_reading(self) -> None:
        self._read = True
        self._stream.close()
        self._job.sources |= self._reading.sources
        self._job.findings.extend(self._reading.findings)
        self._tell_of_unheard()

    @property
    def _switch(self) -> SignalSource | None:
        """What switches a process tool in this cell, if no action does."""
        sources = self.shop.signal_sources
        return next((sources[s.name] for s in (ACTIVE, BEAM, BEAM_POWER, SPRAY, FLOW) if s.name in sources), None)

    # ---- plain legs

    def _plain_leg(self) -> Plan | None:
        """Plan all moves that have been read; None when nothing is left to do."""
        path = self._builder.leg()
        if not self._job.alone:
            path = with_handing_over(path, self._mounted)
            self._mounted = tool_after(path, self._mounted)
        before = self._job.plan
        self._job.events = [*self._job.events, *(noted.event for noted in path.events)]
        if self._read:
            self._ended = True
            self._job.findings.extend(left_on(self._job.events, self._switch))
            if self._job.alone:
                self._job.findings.extend(lone_marks(self._job.channel, self._job.events))
            whole = path if before is None else before.path.then(path)
            self._job.findings.extend(empty_spindle_findings(whole, self.shop.cell))
            self._job.findings.extend(unused_filament_findings(whole, self.shop.cell))
            self._job.findings.extend(switching_findings(whole, self.shop))
            loaded = self.shop.cell.channels[self.shop.channel].loaded_tool or 0
            self._job.findings.extend(
                deaf_tool_findings(
                    whole,
                    self.shop.cell.tools,
                    loaded,
                    untriggered(self.shop.cell),
                    self.shop.signal_sources,
                    self.shop.signals,
                )
            )
            lasting = any(self._duration_of(noted) > 0.0 for noted in path.events)
            if before is not None and not len(path) and not lasting:
                return None
        plan = self._planned(path)
        return self._followed(plan, path, self._found(plan))

    def _planned(self, path: ToolPath) -> Plan:
        shop = self.shop
        return plan_path(
            path,
            shop.kinematics,
            self._posing,
            home=self._at,
            duration_of=self._duration_of,
            tool_frames={number: tool.X_FT for number, tool in shop.cell.tools.items()},
            look_ahead=shop.look_ahead,
        )

    def _found(self, plan: Plan) -> Iterator[Diagnostic]:
        """Findings about the plan of one leg."""
        return told_once(plan.findings, (hit for hit in self._checks.hits(plan) if not self._backs_off(hit)))

    def watch_stocks(self) -> StockWatch | None:
        """Who looks in a run at what the machine does to stocks as they then are; findings of the plan go."""
        return self._checks.watch(self._job, self.shop)

    def _obstacles(self) -> Postures | None:
        """What an arm may hit; a machine whose joints are its axes has nothing to choose."""
        if self.shop.mover.joints_are_axes:
            return None
        from gcodesim.checks.postures import Postures

        return Postures.of(self._checks.of_machine, self.shop.home)

    def _backs_off(self, hit: Diagnostic) -> bool:
        """Whether a tool is only on its way out of what it has probed."""
        if self._touched is None or hit.code not in _OF_TIPS or self._touched[0] not in hit.bodies:
            return False
        return (hit.time or 0.0) <= _LEAVING and (hit.value or 0.0) * MM <= self._touched[1] + _GRAZE

    def _followed(self, leg: Plan, path: ToolPath, found: Iterator[Diagnostic]) -> Plan:
        """The plan of all legs when `leg`, planned of `path`, is the next one; `found` has its own times."""
        job, before = self._job, self._job.plan
        begin = self._steps * self._step_ns * 1e-9
        for finding in found:
            if before is None:
                job.findings.add(finding)
            else:
                later = replace(finding, time=None if finding.time is None else finding.time + begin)
                job.findings.add(later, key=(later.code, later.span, "of a later leg"))
        if not self._ended:
            leg = self._padded(leg)
            self._posing = self._posing.after(leg.joint_path, leg.path, self.shop.home)
            self._at = leg.joints(leg.trajectory.sample(np.array([leg.trajectory.duration])))[0]
        _set_outputs(self._outputs, (noted.event for noted in leg.path.events), moved=True)
        job.plan = leg if before is None else followed_by(before, leg)
        return job.plan

    def _padded(self, leg: Plan) -> Plan:
        """`leg` and the rest of the step in which it comes to rest."""
        assert self._question is not None
        steps = -(-leg.trajectory.duration_ns // self._step_ns)
        self._steps += int(steps)
        end = int(steps) * self._step_ns * 1e-9
        rest = end - leg.trajectory.duration
        if rest <= 1e-12:
            return leg
        pause = canon.Pause(span=self._question.span, seconds=rest)
        return replace(leg, trajectory=standing_until(leg.trajectory, end, pause))

    # ---- probing

    def _probe(self, question: canon.ProbeMove) -> Plan | None:
        """The move of a probe as far as it goes."""
        self._builder.add(question)
        path = self._builder.leg()
        self._job.events = [*self._job.events, *(noted.event for noted in path.events)]
        if not self.stock_up():
            self._ended = True
            return None
        whole = self._planned(path)
        begin = float(whole.trajectory.row_start[-1])
        contact = self._contact(whole, begin, towards=question.towards)
        refused = contact is not None and contact.time <= begin
        tripped = contact is not None and (not refused or question.word == "G31")
        trip, stop = _shares(whole, begin if contact is None else contact.time) if tripped else (1.0, 1.0)
        if refused:
            trip = stop = 0.0
        point, rest = _along(path, trip), _along(path, stop)
        path = replace(path, end=np.concatenate([path.end[:-1], [rest]]))
        self._builder.stand_at(rest)
        self._reply = canon.Touched(point=point, stop=rest, tripped=tripped, refused=refused and not tripped)
        leg = self._planned(path)
        time = _time_at(leg, trip / stop if stop > 0.0 else 1.0)
        body = "" if contact is None or not tripped else contact.body
        over = norm(np.subtract(rest, point)[:3])
        event = self._trip_event(question, leg, time, point=point, body=body, tripped=tripped, over=over)
        leg = replace(leg, trajectory=with_instant(leg.trajectory, time, event))
        at = self._steps * self._step_ns * 1e-9 + time
        self._job.probings.append(
            ProbeResult(span=question.span, word=question.word, time=at, tripped=tripped, body=body, tip=event.tip)
        )
        found = [finding for finding in self._found(leg) if finding.code not in _OF_TIPS]
        plan = self._followed(leg, path, iter(found))
        self._touched = (body, over) if body and question.towards else None
        self._question = None
        return plan

    def _contact(self, plan: Plan, begin: float, *, towards: bool) -> Contact | None:
        """What the tool in the spindle touches first, or leaves, on the last move of `plan`."""
        from gcodesim.checks.clearance import standing_bodies
        from gcodesim.checks.contact import TargetStock, Touching

        shop = self.shop
        tool = shop.tool(plan.path.state_of(len(plan.path) - 1).tool)
        if tool is None:
            return None
        stocks = [
            TargetStock(
                name=name,
                stock=placed.stock,
                pose=lambda q, frame=placed.frame: shop.scene.seen_from(shop.name, frame, {shop.name: q}),  # type: ignore[misc]
            )
            for name, placed in shop.stocks.items()
        ]
        return Touching(plan, tool, stocks, standing_bodies(shop.scene, shop.name)).first(begin=begin, towards=towards)

    def _trip_event(self, question: canon.ProbeMove, leg: Plan, time: float, **known: Any) -> canon.Trip:
        """The event in the log for a probe that trips at `time` [s] of its leg."""
        samples = leg.trajectory.sample(np.array([time]))
        tip = leg.tip(leg.joints(samples), np.array([len(leg.path) - 1]))[0, :3, 3]
        x, y, z = (float(value) for value in self.shop.X_WB.apply(tip))
        return canon.Trip(span=question.span, word=question.word, tip=(x, y, z), **known)

    # ---- inputs

    def _source(self, question: canon.Input) -> InputSource:
        """What the cell says that an input reads; 0 where it says nothing."""
        inputs = self.shop.cell.channels[self.shop.channel].inputs
        return inputs.get(_pin(question), InputSource())

    def _hear_sensor(self, question: canon.Input, name: str, begin: float, halt: RunHalt | None) -> None:
        """What a switch of the cell says, and for how long M66 waits for it."""
        from gcodesim.observation.hearing import Hearing
        from gcodesim.observation.schedule import station_of

        assert self._job.plan is not None
        if not self._job.alone:
            self._job.findings.add(not_heard(question, name))
        station = station_of(self.shop.cell, name)
        halt = halt or standing_still(self.shop, self._job.plan, self._at, self._steps, self._step_ns)
        hearing = Hearing(self.shop, station, halt, self._step_ns * 1e-9)
        heard = hearing.wait(question.wait, begin, question.timeout)
        if heard.value is None:
            self._job.findings.add(waited_in_vain(question, name, hearing.where, heard.what))
        self._answer(question, heard.value, heard.seconds)
        self._builder.add(canon.Noticed(span=question.span, sensor=name, value=heard.value, what=heard.what))
        self._halted = False

    def _answer(self, question: canon.Input, value: float | None, waited: float) -> None:
        """Tell the program what it hears after it has waited [s]."""
        if value is not None and question.type == "digital":
            value = float(value != 0.0)
        if waited > 0.0:
            self._builder.add(canon.Waited(span=question.span, seconds=waited))
        self._question = None
        self._reply = canon.Heard(value=value)

    def _hear(self, question: canon.Input, halt: RunHalt | None) -> None:
        """What an input reads, as the cell has it; the machine has come to rest, and stands while it waits."""
        pending = self._builder.events
        begin = self._steps * self._step_ns * 1e-9 + sum(self._duration_of(noted) for noted in pending)
        outputs = dict(self._outputs)
        _set_outputs(outputs, (noted.event for noted in pending), moved=False)
        pin, source = _pin(question), self._source(question)
        if pin not in self.shop.cell.channels[self.shop.channel].inputs:
            count, first = self._unheard.get(pin, (0, question.span))
            self._unheard[pin] = (count + 1, first)
        if source.sensor is not None:
            self._hear_sensor(question, source.sensor, begin, halt)
            return
        if source.device is not None:
            source = self._state_of(source.device, begin, pending)
        self._answer(question, *source.read(question.wait, begin, question.timeout, outputs))

    def _state_of(self, name: str, begin: float, pending: Sequence[PathEvent]) -> InputSource:
        """What an input reads that shows whether a device has arrived; from `begin` [s] on it is not switched again."""
        device = self.shop.cell.devices[name]
        events = [] if self._job.plan is None else list(self._job.plan.trajectory.events)
        now = [TimedEvent(time=begin, duration=0.0, row=noted.row, event=noted.event) for noted in pending]
        state, arrival = history_of(device, [*events, *now]).state(begin)
        if arrival is None:
            return InputSource(values=(state,))
        return InputSource(values=(state, 1.0), times=(arrival,))

    def _tell_of_unheard(self) -> None:
        """GS905 for inputs that the cell does not name."""
        for pin, (count, first) in self._unheard.items():
            self._reading.not_simulated[f"M66 {pin}"] = (count, first)
            self._job.findings.add(
                Diagnostic(
                    code="GS905",
                    message=f"M66 {pin} is read, but nothing sets that input: it is 0 and stays so",
                    span=first,
                    hint=f"say in the cell what it reads: `inputs: {{{pin}: 1}}`",
                    count=count,
                )
            )


def _pin(question: canon.Input) -> str:
    """`P1` or `E0`."""
    return f"{'P' if question.type == 'digital' else 'E'}{question.index}"


def _set_outputs(outputs: dict[str, float], events: Iterable[canon.Event], *, moved: bool) -> None:
    """Take over the outputs that the program has set; those of M62, M63 and M67 wait for the next move."""
    for event in events:
        if isinstance(event, canon.Output) and (moved or not event.with_motion):
            outputs[f"{'P' if event.type == 'digital' else 'E'}{event.index}"] = event.value


def _shares(plan: Plan, time: float) -> tuple[float, float]:
    """How much of the last move is done at `time` [s], and how much when the machine has braked from there to rest."""
    trajectory = plan.trajectory
    samples = trajectory.sample(np.array([time]))
    s, v = float(samples.s[0]), float(samples.speed[0])
    length = float(trajectory.pieces.length[samples.piece[0]])
    phases = trajectory.phases
    brakes = -phases.acceleration[(phases.piece == samples.piece[0]) & (phases.acceleration < 0.0)]
    stop = length if not len(brakes) else min(s + v * v / (2.0 * float(brakes.min())), length)
    return s / length, stop / length


def _along(path: ToolPath, share: float) -> Axes:
    """The controlled point at a share of the last move."""
    x, y, z, a, b, c = (path.start[-1] + share * (path.end[-1] - path.start[-1])).tolist()
    return (x, y, z, a, b, c)


def _time_at(plan: Plan, share: float) -> float:
    """When `share` of the last move is done [s]."""
    low, high = float(plan.trajectory.row_start[-1]), float(plan.trajectory.row_end[-1])
    if share >= 1.0:
        return high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if float(plan.trajectory.sample(np.array([middle])).fraction[0]) < share:
            low = middle
        else:
            high = middle
    return high
