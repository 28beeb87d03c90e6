"""Records a run: the log while it goes on, results and stocks at its end."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, multiplied, norms
from gcodesim.diagnostics import Diagnostic
from gcodesim.executor.record import StepRecord
from gcodesim.files.output_folder import LOG_NAME, RESULTS_NAME
from gcodesim.frames import Array
from gcodesim.installed import version_of
from gcodesim.jobs.job import BULLET
from gcodesim.jobs.pace import log_period_ns, pacing_of
from gcodesim.jobs.results import Results
from gcodesim.log import (
    Entity,
    LogDescription,
    LogWriter,
    MotionColumns,
    ProcessColumns,
    ProcessField,
    StaticFrame,
    layout,
)
from gcodesim.log.further import FurtherLog
from gcodesim.log.scene import entities_update, lines_update
from gcodesim.log.topics import DRAWN, LOOSE, MOST_TILES, Topic
from gcodesim.motion.tool_path import HOME, RAPID
from gcodesim.processes.column import FORCE, LOG, POWER, RESULTS, TORQUE, Column
from gcodesim.recorder.blocks import Blocks
from gcodesim.recorder.bodies import cell_entities, tile_meshes
from gcodesim.recorder.films import MOST_FILM_LOOKS, FilmGlimpse, Films
from gcodesim.recorder.frames import Frames, seven, stock_frame, work_systems
from gcodesim.recorder.instants import Instants
from gcodesim.recorder.limits import JointLimits
from gcodesim.recorder.look import layout_kind, view_of
from gcodesim.recorder.loose import LoosePieces
from gcodesim.recorder.pose_kernels import bend, compare
from gcodesim.recorder.reporter import Reporter
from gcodesim.recorder.result_files import write_files
from gcodesim.recorder.sensed import image_topics, sensor_message, sensor_topics
from gcodesim.recorder.texts import Texts
from gcodesim.recorder.tool_shown import ToolShown
from gcodesim.recorder.ways import Ways
from gcodesim.units import DEG, MM

if TYPE_CHECKING:
    from gcodesim.diagnostics import SourceText
    from gcodesim.executor import Execution
    from gcodesim.executor.window import StepWindow
    from gcodesim.jobs.job import Job
    from gcodesim.log.live import LiveView
    from gcodesim.material.stock import Stock
    from gcodesim.material.surface import Glimpse, Tile, Tiles
    from gcodesim.observation.schedule import Station
    from gcodesim.planning import Plan
    from gcodesim.sensors.outputs import Output
    from gcodesim.world import WorldSteps

Seen = tuple[Sequence["Glimpse"], Sequence[FilmGlimpse]]
"""What a look has shown of the stocks and of the films."""

TILE_PERIOD_NS: Final = 500_000_000
"""Stock is drawn at most this often."""

DRAWN_COLUMNS: Final = 25_000
"""Columns of a stock that the log draws: finer than a screen shows, at a cost of milliseconds per look."""

MOST_TILE_LOOKS: Final = 120
"""Looks at the stock in a whole run: a long program is not watched more closely than a short one."""

ALWAYS_DRAWN: Final = 1000
WORTH_DRAWING: Final = 1.05
"""The path is redrawn with each leg while it has few rows, later when it has grown by this factor."""

FORCE_PERIOD_NS: Final = 100_000_000

LIBRARIES: Final = ("mcap", "numpy", "pybullet", "zstandard")
"""Packages whose version may change a number or a byte."""


class Recorder:
    """The log of one job in folder `out`, for `live` viewers, too; OSError when the folder cannot be written.

    Of several programs at once it is that of the first, and `others` are those of further channels, by which the same
    log is written.
    """

    def __init__(self, job: Job, out: Path, live: LiveView | None = None) -> None:
        out.mkdir(parents=True, exist_ok=True)
        self._out = out
        self._set_up(job, "")
        self._tiles += [self._tiles_of(placed.stock) for placed in self._shop.stocks.values()]
        self.others = [FurtherRecorder(other) for other in job.others]
        further = {other.channel: other.description for other in self.others}
        self._begin_with(LogWriter(out / LOG_NAME, self._description(self._ways), live, further))
        for other in self.others:
            other.begin_in(self._writer)
            other.share(self._loose)

    def _set_up(self, job: Job, prefix: str) -> None:
        assert job.shop is not None and job.plan is not None and job.cell is not None
        self._job, self._shop, self._plan = job, job.shop, job.plan
        self._step_ns = job.cell.simulation.step_ns
        self._period_ns = log_period_ns(job)
        self._frames = Frames.of(self._shop, prefix)
        self._bearers = job.bearers
        self._systems = work_systems(self._shop, self._plan.path)
        self._speeds = np.array([state.spindle for state in self._plan.path.states])
        self._ways = Ways.of(self._plan, self._shop)
        self._blocks = Blocks.of(self._plan, self._shop, job.sources, self._ways, self._frames.path_frame)
        self._begun = 0  # how many of the blocks have been written
        self._drawn = len(self._plan.path)  # rows
        self._drawings = job.drawings
        self._expected: deque[Sequence[Diagnostic]] = deque()
        self._tiles: list[Tiles] = []
        self._films = Films((), (), ()) if prefix else self._films_of(job)
        self._tile_ns = self._tile_period(
            max(each.plan.trajectory.duration_ns for each in job.all if each.plan is not None)
        )
        engine = job.world == BULLET and any(not placed.revolved for placed in self._shop.stocks.values())
        own_tile = len(self._films) < MOST_TILES
        self._loose = LoosePieces(self._frames, self._step_ns) if engine and own_tile and not prefix else None
        self._limits = JointLimits.of(self._shop)
        self._sheet = self._shop.sheet
        self._instants = Instants(self._plan, self._sheet)
        self._cut_at: Array = np.zeros(3)  # where the tip is over the work
        self._force_shown = False
        self._now_ns = 0
        self._tool_shown = ToolShown(job, self._frames.tool, is_first=not prefix)
        self._is_first = not prefix

    def _begin_with(self, writer: LogWriter) -> None:
        self._writer = writer
        self._tool_shown.writer = writer
        self._reporter = Reporter(writer, self._job.shown(self._job.findings))
        self._texts = Texts(writer, self._plan.trajectory.events)

    # ---- before the run

    def _tiles_of(self, stock: Stock) -> Tiles:
        return stock.tiles(across=self._across, spacing=stock.spacing_for(DRAWN_COLUMNS))

    def _films_of(self, job: Job) -> Films:
        assert job.cell is not None
        coated = list(self._shop.coated.values())
        specs = [job.cell.coats[each.frame] for each in coated]
        return Films(coated, [spec.most for spec in specs], [spec.bare for spec in specs])

    @property
    def _film_ns(self) -> int:
        """Time between two looks at films."""
        return max(1, MOST_TILE_LOOKS // MOST_FILM_LOOKS) * self._tile_ns

    @property
    def _across(self) -> int:
        """Tiles along one side of a stock; the log has room for 16 tiles in all."""
        count = len(self._shop.stocks)
        return 4 if count == 1 else 2 if count <= 4 else 1

    def _tile_period(self, duration_ns: int) -> int:
        """Time between two looks at the stock: whole beats, with which windows may end."""
        wanted = max(TILE_PERIOD_NS, duration_ns // MOST_TILE_LOOKS)
        beat_ns = pacing_of(self._job).beat * self._step_ns
        return -(-wanted // beat_ns) * beat_ns

    @property
    def interval_steps(self) -> int:
        """Steps between two looks at the stock."""
        return max(1, self._tile_ns // self._step_ns)

    def stops(self, plans: Sequence[Plan], first: int, last: int) -> Sequence[int]:
        """None: the log looks at the stock now and then, whenever a window ends."""
        del plans, first, last
        return ()

    def _description(self, ways: Ways) -> LogDescription:
        job = self._job
        own = job.loaded.files[0]
        rapid = _is_rapid(self._plan)
        attachments = {"program.nc": job.program.raw, "cell.yaml": job.loaded.sources[own.name].raw}
        for name, source in sorted(job.sources.items()):
            if job.reading is not None and name in job.reading.sources and name != job.program.name:
                attachments[name] = source.raw
        urdf = self._urdf()
        if urdf is not None:
            attachments[f"{self._shop.name}.urdf"] = urdf
        view = view_of(self._shop, ways, rapid)
        fields = self._fields()
        kind = layout_kind(self._shop)
        channels = [other.channel for other in self.others]
        images = image_topics(self._shop)
        joints, outputs = self._shop.joint_names, self._blocks.outputs
        attachments["layout.json"] = layout(
            kind, joints, outputs, view, fields, channels, images, [topic.name for topic, _ in self._drawn_topics]
        )
        run = {
            "program": job.program.name,
            "program_sha256": job.program.sha256,
            "cell": own.name,
            "cell_sha256": own.sha256,
            "seed": str(job.cell.simulation.seed if job.cell else 0),
            "step_ns": str(self._step_ns),
            "log_period_ns": str(self._period_ns),
            "world": job.world,
            **{name: version_of(name) for name in LIBRARIES if job.world == BULLET or name != "pybullet"},
        }
        others = self.others
        for other in others:
            known = {*attachments, job.program.name} if other.runs(job.program) else {*attachments}
            attachments |= {name: data for name, data in other.attachments.items() if name not in known}
        records = {f"gcodesim.joints.{other.channel}": other.joint_limits for other in others}
        if others:
            records["gcodesim.channels"] = {each.channel: each.program.name for each in job.all}
        return LogDescription(
            run=run,
            static_frames=(*self._frames.static, *(frame for other in others for frame in other.static_frames)),
            moving_frames=self._frames.moving,
            joint_names=self._shop.joint_names,
            joint_scale=tuple(MM if kind == "prismatic" else DEG for kind in self._shop.kinematics.joints.kinds),
            cell=(*cell_entities(self._frames), *(entity for other in others for entity in other.entities)),
            feed_path=ways.polylines(~rapid),
            rapid_path=ways.polylines(rapid),
            path_ahead=ways.ahead(self._plan, ~rapid),
            path_frame=self._frames.path_frame,
            process_kinds=self._sheet.kinds,
            process_fields=fields,
            sensor_topics=(*sensor_topics(self._shop), *self._drawn_topics),
            stock_tiles=max(1, sum(len(tiles) for tiles in self._tiles)),
            added_tiles=len(self._films),
            records={"gcodesim.joints": self._limits.record, **records},
            attachments=attachments,
        )

    @property
    def _drawn_topics(self) -> tuple[tuple[Topic, bytes], ...]:
        """The topics of what a script draws, and of pieces that come loose, with what they show at the start."""
        drawings = self._job.drawings
        shown = () if drawings is None else ((DRAWN, lines_update(0, drawings)),)
        return shown if self._loose is None else (*shown, (LOOSE, entities_update(0, [])))

    def _fields(self) -> tuple[ProcessField, ...]:
        fields = tuple(field for column in self._sheet.own(LOG) for field in _fields_of(column))
        self._own = [field.name for field in fields if not field.twin_of]
        return fields

    def _urdf(self) -> bytes | None:
        """The robot description that was read, if there was one."""
        file = self._shop.mover.description
        return None if file is None else file.read_bytes()

    # ---- during the run

    def start(self, world: WorldSteps, window: StepWindow) -> None:
        """The state at time 0."""
        from gcodesim.executor.record import record_of

        X_WT = self._bent(self._plan.tip(world.q, window.row), np.zeros((1, 6)))
        self._cut_at = self._frames.seen_from_table(world.q, X_WT)[0, :3, 3]
        self._reporter.until(0)
        self._texts.until(0)
        self._tool_shown.start(window)
        for index, tiles in enumerate(self._tiles):
            self._draw(0, index, tiles.all())
        record = record_of(window, world, [], self._sheet)
        if self._frames.parts and self._shop.moves_parts:
            lying = [self._shop.scene.track(name, {self._shop.name: world.q}) for name in self._frames.parts]
            record = replace(record, parts=np.stack(lying, axis=1))
        self._write(record, np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64))
        self._begin_blocks(0)

    def look(self, window: StepWindow) -> Seen:
        """What `window` has changed of each stock and film, when it is time to look; drawn when it is written."""
        begin_ns, end_ns = window.first * self._step_ns, window.end * self._step_ns

        def is_due(period_ns: int) -> bool:
            return end_ns // period_ns != begin_ns // period_ns

        tiles = [tiles.changed() for tiles in self._tiles] if is_due(self._tile_ns) else []
        return tiles, self._films.look() if len(self._films) and is_due(self._film_ns) else []

    def take(self, record: StepRecord, found: Sequence[Diagnostic], seen: Seen | tuple[()]) -> Callable[[], None]:
        """Take the next window, the findings that came up in it, and the tiles that were seen to change.

        Returns the work of writing it down, which can be done while the next window runs.
        """
        return lambda: self._write_down(record, found, seen)

    def _write_down(self, record: StepRecord, found: Sequence[Diagnostic], seen: Seen | tuple[()]) -> None:
        window = record.window
        end_ns = window.end * self._step_ns
        if window.looks is not None:
            t_ns, at = window.looks.ticks * self._step_ns, window.looks.step
        else:
            ends = window.ticks[1:] * self._step_ns
            at = np.flatnonzero(ends % self._period_ns == 0)
            t_ns = ends[at]
        self._begin_blocks(end_ns)
        self._reporter.until(end_ns, found, begin_ns=self._now_ns + 1)
        self._texts.until(end_ns)
        self._tool_shown.take(record, t_ns, at, self._now_ns)
        self._moves_of_pieces(record, end_ns)
        self._write(record, t_ns, at)
        self._now_ns = end_ns
        tiles, films = seen or ((), ())
        for index, glimpse in enumerate(tiles):
            self._draw(self._now_ns, index, glimpse.draw())
        self._draw_films(films)

    def _begin_blocks(self, t_ns: int) -> None:
        """Write the blocks that begin up to then."""
        first, self._begun = self._begun, self._blocks.before(t_ns + 1)
        self._writer.blocks(self._blocks.messages, first, self._begun)

    def sensed(self, station: Station, name: str, t_ns: int, output: Output) -> None:
        """Write an output of a sensor, read at `t_ns`."""
        self._writer.sensed(t_ns, station.topic(name), sensor_message(station, t_ns, output))

    # ---- between legs

    def expect(self, found: Sequence[Diagnostic]) -> None:
        """Take what was found while the next leg was read and planned."""
        self._expected.append(found)

    def follow(self, plan: Plan) -> None:
        """The run goes on with a further leg; `plan` is that of all legs so far."""
        rows, events = len(self._plan.path), len(self._plan.trajectory.events)
        self._plan = plan
        self._systems = work_systems(self._shop, plan.path)
        self._speeds = np.array([state.spindle for state in plan.path.states])
        self._tool_shown.follow(plan)
        self._ways = self._ways.followed_by(Ways.of(plan, self._shop, rows))
        frame = self._frames.path_frame
        self._blocks = Blocks.of(plan, self._shop, self._job.sources, self._ways, frame)
        self._texts.expect(plan.trajectory.events[events:])
        self._instants.follow(plan)
        drawings = self._job.drawings
        if drawings is not None and drawings is not self._drawings:
            self._drawings = drawings
            self._writer.sensed(self._now_ns, DRAWN.name, lines_update(self._now_ns, drawings))
        while self._expected:
            self._reporter.expect(self._expected.popleft(), self._now_ns)
        if len(plan.path) > WORTH_DRAWING * self._drawn or len(plan.path) < ALWAYS_DRAWN:
            self._drawn = len(plan.path)
            rapid = _is_rapid(plan)
            feed, rapids = self._ways.polylines(~rapid), self._ways.polylines(rapid)
            self._writer.path(self._now_ns, frame, feed, rapids, self._ways.ahead(plan, ~rapid))

    def _draw(self, t_ns: int, index: int, tiles: Sequence[Tile]) -> None:
        first = sum(len(before) for before in self._tiles[:index])
        frame = stock_frame(index, list(self._shop.stocks)[index])
        for tile in tiles:
            self._writer.stock_tile(t_ns, first + tile.number, tile_meshes(tile), frame)

    def _draw_films(self, films: Sequence[FilmGlimpse]) -> None:
        for film in films:
            name, frame, X = self._films.frame(film.number, self._frames)
            self._writer.film(self._now_ns, film.number, f"film/{name}", self._films.draw(film, X), frame)

    def _moves_of_pieces(self, record: StepRecord, t_ns: int) -> None:
        """Draw pieces of stocks on their way down; those that further channels free are taken as they come, too."""
        if self._loose is None:
            return
        for body in record.loose:
            self._loose.add(body)
        for at_ns, entities in self._loose.until(t_ns) if self._is_first else ():
            self._writer.sensed(at_ns, LOOSE.name, entities_update(at_ns, entities))

    def _write(self, record: StepRecord, t_ns: Any, at: Any) -> None:
        """The log instants `t_ns` (m,), which are in steps `at` (m,) of the record."""
        self._instants.add(record, t_ns, at)
        if self._instants.worth_writing:
            self._write_instants()

    def _write_instants(self) -> None:
        """Write the columns of the log instants collected so far."""
        if not self._instants.count:
            return
        came = self._instants.take()
        X_WT = self._bent(came["X_BT"], came["deflection"])
        speed = self._speed(came, X_WT)
        here = came["now"] - 1
        q, X_WT = came["q"][here], X_WT[here]
        qd, effort, row = came["qd"], came["effort"], came["row"]
        X_WB = self._shop.X_WB
        target = multiplied(X_WB.matrix, came["target"])
        path = self._plan.path
        state = path.state[row] if len(path) else np.zeros(len(row), int)
        systems = np.array([own.system for own in path.states], dtype=np.int64)[state]
        part = self._frames.carried(q, self._systems[state], systems)
        if self._bearers is not None:
            part = self._bearers.carried(part, systems, came["t_ns"] * 1e-9)
        errors, local = np.empty((len(row), 2)), np.empty((len(row), 3))
        compare(target, X_WT, part, errors, local)
        wrench = _in_world(X_WB.R, came["wrench"])
        force = norms(wrench[:, :3])
        travel, pace, load = self._limits.used(q, qd, effort)
        self._writer.window(
            came["t_ns"],
            tf=self._frames.at(q, X_WT, self._tools(came["tool"]), part, came.get("parts")),
            joint_position=q,
            joint_velocity=qd,
            joint_effort=effort,
            joint_command=came["command"],
            target=seven(target),
            tcp=seven(X_WT),
            motion=MotionColumns(
                feed=speed,
                feed_command=norms(came["velocity"]),
                position_error=errors[:, 0],
                orientation_error=errors[:, 1],
                block_fraction=np.clip(self._fractions(row, came["time"]), 0.0, 1.0),
                position=local,
                limit=came["saturated"],
                travel_used=travel,
                speed_used=pace,
                effort_used=load,
            ),
            process=ProcessColumns(
                kind=came["kind"],
                engaged=came["engaged"],
                spindle=self._spindle(row),
                force=force,
                torque=came["torque"],
                power=came["power"],
                removal=came["removal"],
                removed=came["removed"],
                max_force=came[FORCE.peak_field],
                max_torque=came[TORQUE.peak_field],
                max_power=came[POWER.peak_field],
                fields={name: came[name] for name in self._own},
            ),
            wrench=wrench,
        )
        self._arrows(came["t_ns"], X_WT[:, :3, 3], wrench[:, :3], force)

    def _bent(self, X_BT: Array, deflection: Array) -> Array:
        """X_WT (n, 4, 4) of the tip on the link side: where motors bring it, with gears bent by (n, 6) in B."""
        X = np.require(X_BT, np.float64, ["C", "W"])
        bend(self._shop.X_WB.matrix, deflection, X)
        return X

    def _speed(self, came: Mapping[str, Any], X_WT: Array) -> Array:
        """Speed (m,) of the tip over the work in the steps of the instants, from where it is at the `ends` of steps.

        A step's way begins where the step before ended.
        """
        cut = self._frames.seen_from_table(came["q"], X_WT)[:, :3, 3]  # feed is the tool's way over the work
        way = np.concatenate([self._cut_at[None], cut])
        self._cut_at = cut[-1]
        speed: Array = norms(way[came["now"]] - way[came["before"]]) / came["dt"]
        return speed

    def _fractions(self, row: Any, time: Array) -> Array:
        """How much of the time of its row has passed (m,)."""
        trajectory = self._plan.trajectory
        if not len(trajectory.row_start):
            return np.zeros(len(row))
        start, end = trajectory.row_start[row], trajectory.row_end[row]
        done: Array = (time - start) / np.maximum(end - start, 1e-12)
        return done

    def _spindle(self, row: Any) -> Array:
        path = self._plan.path
        return self._speeds[path.state[row]] if len(path) else np.full(len(row), self._speeds[0])

    def _tools(self, numbers: Any) -> Array:
        """X_FT (n, 4, 4) of the tools in the spindle."""
        X = np.tile(np.eye(4), (len(numbers), 1, 1))
        for number in set(numbers.tolist()):
            tool = self._shop.tool(number)
            if tool is not None:
                X[numbers == number] = tool.X_FT.matrix
        return X

    def _arrows(self, t_ns: Any, tip: Array, force: Array, size: Array) -> None:
        at = np.flatnonzero(t_ns % FORCE_PERIOD_NS == 0)
        if not len(at):
            return
        shown = size[at] > 0.0
        before = np.concatenate([[self._force_shown], shown[:-1]])
        told = at[shown | before | (t_ns[at] == 0)]
        self._writer.forces(t_ns[told], tip[told], force[told])
        self._force_shown = bool(shown[-1])

    # ---- after the run

    def finish(self, results: Results, execution: Execution) -> None:
        """Close the log and write results and stocks beside it."""
        self._write_instants()
        for each in () if execution.interrupted else (self, *self.others):
            each._tool_shown.end(self._now_ns)
        for index, tiles in enumerate(self._tiles):
            self._draw(self._now_ns, index, tiles.changed().draw())
        self._draw_films(self._films.look(last=True))
        self._reporter.rest(self._now_ns, self._job.shown(self._job.findings) if self.others else results.findings)
        if execution.interrupted:
            stopped = results.stopped_at
            place = {"file": stopped.file, "line": stopped.line} if stopped is not None else {}
            self._writer.event(self._now_ns, "interrupted", "stopped by the user", severity="error", **place)  # type: ignore[arg-type]
        state = "failed" if results.status == "failed" else "finished"
        for other in self.others:
            other.end(state)
        text = results.text().encode()
        removed = sum(stock.removed - stock.deposited for stock in results.stocks.values())
        record = {"removed_m3": repr(removed)} | {
            column.peak_field: repr(float(execution.rows[column.name].max(initial=0.0)))
            for column in self._sheet.shown_in(RESULTS)
            if column.of == "greatest"
        }
        self._writer.close(self._now_ns, state, record, {RESULTS_NAME: text}, self._instants.peaks)
        write_files(self._out, self._shop, results, self._job.skins, text=text)

    def abandon(self) -> None:
        """After a fault: keep what is there, under the name of an incomplete log."""
        for each in (self, *self.others):
            with suppress(Exception):  # the fault itself may come from work that waits to be written
                each._write_instants()
        self._writer.abandon()


class FurtherRecorder(Recorder):
    """The part of a log that a further program has; its messages go into the log of the first."""

    def __init__(self, job: Job) -> None:
        self._set_up(job, f"{job.channel}/")
        self.others = []
        rapid = _is_rapid(self._plan)
        self.description = LogDescription(
            run={"program": job.program.name},
            static_frames=(),
            moving_frames=self._frames.moving,
            joint_names=self._shop.joint_names,
            joint_scale=tuple(MM if kind == "prismatic" else DEG for kind in self._shop.kinematics.joints.kinds),
            feed_path=self._ways.polylines(~rapid),
            rapid_path=self._ways.polylines(rapid),
            path_ahead=self._ways.ahead(self._plan, ~rapid),
            path_frame=self._frames.path_frame,
            process_kinds=self._sheet.kinds,
            process_fields=self._fields(),
        )

    @property
    def channel(self) -> str:
        return self._job.channel

    @property
    def static_frames(self) -> tuple[StaticFrame, ...]:
        return self._frames.static

    @property
    def entities(self) -> tuple[Entity, ...]:
        """The links of its machine, and what that carries."""
        return cell_entities(self._frames)

    @property
    def joint_limits(self) -> Mapping[str, str]:
        return self._limits.record

    def runs(self, program: SourceText) -> bool:
        """Whether its program is this one, as that of a session with several machines is."""
        own = self._job.program
        return (own.name, own.raw) == (program.name, program.raw)

    @property
    def attachments(self) -> dict[str, bytes]:
        """Its program, subprograms and robot description."""
        job, urdf = self._job, self._urdf()
        read = () if job.reading is None else sorted(job.reading.sources.items())
        found = {job.program.name: job.program.raw} | {name: source.raw for name, source in read}
        return found | ({} if urdf is None else {f"{self._shop.name}.urdf": urdf})

    def share(self, loose: LoosePieces | None) -> None:
        """Pieces that this program frees are drawn by the first, with its own."""
        self._loose = loose

    def begin_in(self, first: LogWriter) -> None:
        """Begin to write, into the log that `first` writes."""
        self._begin_with(FurtherLog(first, self.channel, self.description))

    def look(self, window: StepWindow) -> Seen:
        """Nothing: the first channel looks at the stocks."""
        return (), ()

    def end(self, state: str) -> None:
        """Write the rest; the log is closed by the first recorder."""
        self._write_instants()
        self._reporter.rest(self._now_ns, self._job.shown(self._job.findings))
        writer = self._writer
        assert isinstance(writer, FurtherLog)
        own = "failed" if self._job.stopped_at is not None else state
        writer.end(self._now_ns, own, self._instants.peaks)


def _fields_of(column: Column) -> Iterator[ProcessField]:
    """What the log says of a column of a process: the value, its peak since the last instant, and what people read."""
    yield ProcessField(name=column.field, flag=column.of == "any")
    if column.of == "greatest":
        yield ProcessField(name=column.peak_field)
    if column.shop_field:
        yield ProcessField(name=column.shop_field, twin_of=column.drawn_field, divisor=column.divisor)


def _is_rapid(plan: Plan) -> NDArray[np.bool_]:
    """Rows (n,) of G0 and G28."""
    rapid: NDArray[np.bool_] = np.isin(plan.path.kind, (RAPID, HOME))
    return rapid


def _in_world(R_WB: Array, wrench: Array) -> Array:
    return np.concatenate([applied(R_WB, wrench[:, :3]), applied(R_WB, wrench[:, 3:])], axis=1)
