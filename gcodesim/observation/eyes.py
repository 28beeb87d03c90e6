"""The sensors of a cell in a run: they read when it is their time, and what they read goes to log and files."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.observation.files import SensorFiles
from gcodesim.observation.schedule import MOST_SIGHTS, Station, regular_steps, stations_of, told_steps
from gcodesim.observation.stage import Hand, Stage, surface_of
from gcodesim.sensors.noise import Noise
from gcodesim.sensors.outputs import DepthMap, Output, Picture, Points, digest
from gcodesim.sensors.scenery import Scenery
from gcodesim.sensors.sensor import Sight

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.executor.watcher import Watcher
    from gcodesim.executor.window import StepWindow
    from gcodesim.material.surface import Surface
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop
    from gcodesim.world import WorldSteps

Outlet = Callable[[Station, str, int, Output], None]
"""Takes an output of a station, by its name, read at a time [ns]."""

_NOTHING = Scenery.of(())


@dataclass(slots=True, kw_only=True, eq=False)
class _Tally:
    """How often a sensor has read or would have, how often it saw nothing, and a hash of all that it gave."""

    readings: int = 0
    blank: int = 0
    planned: int = 0
    left_out: int = 0
    hash: Any = field(default_factory=hashlib.sha256)


@frozen(eq=False)
class _Look:
    """What was seen at the end of a window: by the log, and the surfaces of stocks if a sensor has to see."""

    inner: Any
    surfaces: Mapping[str, Surface] | None


class Eyes:
    """A watcher that reads the sensors of `shop`, and lets `inner`, another watcher, watch as well.

    `outlet` takes what they read; `files` gets what is to be saved. `seed` is that of the run.
    """

    def __init__(
        self,
        shop: Shop,
        step_ns: int,
        seed: int,
        inner: Watcher | None = None,
        outlet: Outlet | None = None,
        files: SensorFiles | None = None,
    ) -> None:
        self._shop, self._step_ns, self._seed = shop, step_ns, seed
        self._inner, self._outlet, self._files = inner, outlet, files
        self.stations = stations_of(shop.cell)
        self._stage = Stage.of(shop)
        self._due: dict[str, set[int]] = {station.name: set() for station in self.stations}
        self._told: dict[str, set[int]] = {station.name: set() for station in self.stations}
        self._tallies = {station.name: _Tally() for station in self.stations}
        self._sights: set[int] = set()
        self._planned_to = -1
        self._used: set[int] = set()

    # ---- as a watcher

    @property
    def interval_steps(self) -> int:
        return 2**31 if self._inner is None else self._inner.interval_steps

    def stops(self, plans: Sequence[Plan], first: int, last: int) -> Sequence[int]:
        """The steps at which a sensor has to see something."""
        for station in self.stations:
            tally = self._tallies[station.name]
            told = {step for step in told_steps(station, plans, self._step_ns) if step <= last}
            told -= self._told[station.name]
            self._told[station.name] |= told
            late = {max(step, self._planned_to + 1) for step in told}  # a leg may begin with a word
            steps = sorted(late | regular_steps(station, self._step_ns, self._planned_to, last))
            if station.sensor.sees:
                room = max(MOST_SIGHTS - tally.planned, 0)
                tally.left_out += len(steps[room:])
                steps = steps[:room]
                self._sights.update(steps)
            tally.planned += len(steps)
            self._due[station.name].update(steps)
        self._planned_to = max(last, self._planned_to)
        more = () if self._inner is None else self._inner.stops(plans, first, last)
        return sorted(step for step in {*self._sights, *more} if first < step < last)

    def start(self, world_steps: WorldSteps, window: StepWindow) -> None:
        if self._inner is not None:
            self._inner.start(world_steps, window)
        self._first = (world_steps, window, self._surfaces())

    def look(self, window: StepWindow) -> _Look:
        sees = window.end in self._sights
        inner = None if self._inner is None else self._inner.look(window)
        return _Look(inner=inner, surfaces=self._surfaces() if sees else None)

    def take(self, record: StepRecord, found: Sequence[Diagnostic], seen: _Look) -> Callable[[], None]:
        """The work of reading and of what the inner watcher does with the window."""
        written = None if self._inner is None else self._inner.take(record, found, seen.inner)

        def work() -> None:
            if record.window.first == 0:
                self._at_start()
            self._read_window(record, seen.surfaces)
            if written is not None:
                written()

        return work

    def follow(self, plan: Plan) -> None:
        if self._inner is not None:
            self._inner.follow(plan)

    # ---- reading

    def _surfaces(self) -> dict[str, Surface]:
        return {name: surface_of(placed) for name, placed in self._shop.stocks.items()}

    def _at_start(self) -> None:
        world, window, surfaces = self._first
        for station in self.stations:
            if 0 in self._due[station.name]:
                self._read(station, 0, world, window, 0, surfaces)

    def _read_window(self, record: StepRecord, surfaces: Mapping[str, Surface] | None) -> None:
        world, window = record.world, record.window
        last = window.end
        self._used.update(distinct(window.tool).tolist())
        for station in self.stations:
            due = self._due[station.name]
            if station.sensor.sees:
                if last in due and surfaces is not None:
                    self._read(station, last, world, window, len(window) - 1, surfaces, record)
            else:
                for step in sorted(step for step in due if window.first < step <= last):
                    self._read(station, step, world, window, step - window.first - 1, {})

    def _read(
        self,
        station: Station,
        step: int,
        world: WorldSteps,
        window: StepWindow,
        row: int,
        surfaces: Mapping[str, Surface],
        record: StepRecord | None = None,
    ) -> None:
        """One reading at the end of a step, which is `row` of the window; none of a tool that is not in use.

        `record` knows where parts and devices are; without it they are where they were first.
        """
        tool = int(window.tool[row])
        if station.tool is not None and station.tool != tool:
            return
        tally = self._tallies[station.name]
        tally.readings += 1
        q = {self._shop.name: world.q[row], **{name: joints[row] for name, joints in window.others.items()}}
        if record is not None:
            q |= {name: other.world.q[row] for name, other in record.beside.items()}
        X_WC = place_of(station, self._stage, q, tool)
        sight = Sight(
            X_WC=X_WC,
            scenery=self._scenery(q, tool, surfaces, record, row) if station.sensor.sees else _NOTHING,
            noise=Noise(self._seed, station.name, tally.readings),
            load=load_at(self._shop, X_WC, q, world.reaction[row]) if station.sensor.on_flange else np.zeros(6),
        )
        outputs = station.sensor.read(sight)
        tally.blank += any(isinstance(each, (Picture, DepthMap, Points)) and each.is_blank for each in outputs.values())
        for name, output in outputs.items():
            tally.hash.update(name.encode() + digest(output))
            t_ns = step * self._step_ns
            if self._outlet is not None:
                self._outlet(station, name, t_ns, output)
            if self._files is not None and station.sensor.save:
                self._files.write(station, tally.readings, t_ns, X_WC, name, output)

    def _scenery(
        self,
        q: Mapping[str, Array],
        tool: int,
        surfaces: Mapping[str, Surface],
        record: StepRecord | None,
        row: int,
    ) -> Scenery:
        """What stands there at the end of a step, which is `row` of the record; None: before the first one."""
        if record is None:
            hands = self._stage.hands_at_start() | {self._shop.name: Hand(tool=tool)}
            return self._stage.scenery(q, hands, surfaces)
        records = {self._shop.name: record, **record.beside}
        hands = {name: Hand.in_step(its, row, self._shop) for name, its in records.items()}
        return self._stage.scenery(q, hands, surfaces, places=record.places(row))

    # ---- afterwards

    def close(self) -> None:
        """Give the files of sensors their names."""
        if self._files is not None:
            self._files.close()

    @property
    def results(self) -> dict[str, dict[str, Any]]:
        """Of each sensor: its type, how often it has read, and a hash of all values."""
        return {
            station.name: {
                "type": station.sensor.kind,
                "readings": self._tallies[station.name].readings,
                "sha256": self._tallies[station.name].hash.hexdigest(),
            }
            for station in self.stations
        }

    def findings(self) -> Iterator[Diagnostic]:
        """GS590 for sensors that would have read more often than they may, GS591 for those that have never read.

        GS594 for those that have never seen anything.

        A tool that is a sensor may lie in the magazine for other programs, and an input may be there for them.
        """
        heard = {source.sensor for channel in self._shop.cell.channels.values() for source in channel.inputs.values()}
        for station in self.stations:
            tally = self._tallies[station.name]
            span = _span(self._shop, station)
            if tally.left_out:
                yield Diagnostic(
                    code="GS590",
                    span=span,
                    message=f"`{station.name}` reads {tally.planned + tally.left_out} times in this run; "
                    f"the first {MOST_SIGHTS} are taken",
                    hint="a longer `period` has it read through the whole run",
                    value=float(tally.planned + tally.left_out),
                    limit=float(MOST_SIGHTS),
                )
            elif tally.readings and tally.blank == tally.readings:
                yield Diagnostic(
                    code="GS594",
                    span=span,
                    message=f"`{station.name}` sees nothing in any of its {tally.readings} readings",
                    hint="look at its place and at where it looks: Z of its frame; a cell without stock, parts or "
                    "fixtures has nothing to be seen",
                    value=0.0,
                    limit=1.0,
                )
            elif not tally.readings and station.name not in heard and (station.tool or 0) in {0, *self._used}:
                target, verb = station.sensor.order
                how = f"`m_codes: {{M110: {{{target}: {verb}}}}}`"
                yield Diagnostic(
                    code="GS591",
                    span=span,
                    message=f"`{station.name}` has read nothing in this run",
                    hint=f"give it a `period`, or have a word of the program do it: {how}"
                    + ("" if station.tool is None else ", while the tool is in use"),
                )


def place_of(station: Station, stage: Stage, q: Mapping[str, Array], tool: int) -> Array:
    """X_WC (4, 4) of a station, with the joints of movers at `q[mover]` (j,) and this tool on the flange."""
    rows = {name: joints[None] for name, joints in q.items()}
    X: Array = stage.tip(rows, tool) if station.tool is not None else stage.shop.scene.track(station.frame, rows)[0]
    return X


def load_at(shop: Shop, X_WC: Array, q: Mapping[str, Array], reaction: Array) -> Array:
    """Force and torque (6,) of the tool on the flange, at a sensor and in its axes.

    `reaction` (6,) is what the flange exerts on the tool, at the flange and in axes of the base.
    """
    X_WF = multiplied(shop.X_WB.matrix, shop.kinematics.forward(q[shop.name][None])[0])
    R_WB, R_CW = shop.X_WB.R, np.ascontiguousarray(X_WC[:3, :3].T)
    force, torque = applied(R_WB, -reaction[:3]), applied(R_WB, -reaction[3:])
    torque = torque + np.cross(X_WF[:3, 3] - X_WC[:3, 3], force)
    return np.concatenate([applied(R_CW, force), applied(R_CW, torque)])


def _span(shop: Shop, station: Station) -> Span:
    if station.tool is not None:
        return shop.cell.span("tools", str(station.tool))
    return shop.cell.span("sensors", station.name)
