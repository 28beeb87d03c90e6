"""Writes the log of one run: columns in, an MCAP file out.

Messages of a window may come in any order. Everything older than the window
before last is final and goes to the file in the order of time, then of the
topic table; so whole chunks are on disk while the run goes on. The same input
gives the same bytes: times are simulated, nothing else enters.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.backlog import Backlog
from gcodesim.log.blocks import BlockMessages
from gcodesim.log.columns import ColumnBatch
from gcodesim.log.container import Container, Sink
from gcodesim.log.description import (
    PEAK_ARRAYS,
    PROCESS_COLUMNS,
    Array,
    LogDescription,
    MotionColumns,
    ProcessColumns,
    array_of,
)
from gcodesim.log.layout import layout
from gcodesim.log.messages import (
    SEVERITIES,
    STATES,
    ProgramShown,
    event_message,
    frames_message,
    log_message,
    program_message,
)
from gcodesim.log.rows import RecordRows, RowBuilder
from gcodesim.log.scene import entities_update, force_updates, path_update, polyline_update
from gcodesim.log.schema import PROCESS, schema_data
from gcodesim.log.shapes import DrawnMesh, DrawnShape, Entity, PathPart, Polylines
from gcodesim.log.shop_units import twins_of
from gcodesim.log.topics import PERIODIC, tile_topic, topic_table, topics_of_channel
from gcodesim.version import __version__

LOG_FORMAT: Final = "1"
ROOT: Final = "world"
_MOTION: Final = tuple(field.name for field in fields(MotionColumns))
_BLOCK_FIELDS: Final = frozenset({"file", "line", "text", "block"})
_MEDIA_TYPES: Final = {
    ".json": "application/json",
    ".yaml": "application/yaml",
    ".urdf": "application/xml",
    ".stl": "model/stl",
    ".csv": "text/csv",
}


class LogWriter:
    """The log of one run at `path`; it is `path` + `.part` until `close`.

    All times are simulated nanoseconds from 0. The log starts at time 0: the
    first instant given to `window` is 0. Change messages may be given before
    or after the window in which they fall, but not after the window that follows it.
    Every method raises LogWriteError (an OSError) if the disk does not take
    the data; ValueError is a fault of the caller.
    """

    def __init__(
        self,
        path: Path,
        description: LogDescription,
        sink: Sink | None = None,
        further: Mapping[str, LogDescription] | None = None,
    ) -> None:
        """Begin a log; `sink` gets all its messages as well, such as a `LiveView`.

        `further` describes other programs that run at the same time, by the names that stand before their topics;
        `FurtherLog` writes what they do.
        """
        further = further or {}
        self._description = description
        self._frames = _checked_frames(description, further.values())
        topics = topic_table(description.stock_tiles, description.added_tiles)
        topics += tuple(topic for topic, _ in description.sensor_topics)
        own = len(topics)
        topics += tuple(topic for name in further for topic in topics_of_channel(name))
        library = f"gcodesim {__version__}"
        data = {
            schema: schema_data(schema, description.process_fields if schema == PROCESS else ())
            for schema in dict.fromkeys(topic.schema for topic in topics)
        }
        channels = [(topic, data[topic.schema]) for topic in topics]
        self._container = Container(Path(path), library, channels, sink)
        numbers = {topic.name: i for i, topic in enumerate(topics, start=1)}
        self._channels = {topic.name: numbers[topic.name] for topic in topics[:own]}
        self._periodic = tuple(self._channels[topic.name] for topic in PERIODIC)
        self._batch = ColumnBatch(description)
        self._builder = RowBuilder(description, self._periodic, self._batch.columns)
        self._rows: deque[RecordRows] = deque()
        self._next_row = 0  # of the first of them
        self._backlog = Backlog()
        self._written_ns = 0  # everything before is on its way to disk
        self._last_ns = -1  # the last instant of the last window
        self._program = ProgramShown()
        self._at_start: set[int] = set()  # channels that have their message at time 0
        self._others: list[LogWriter] = []
        self._begin()
        self._numbers = numbers

    def join(self, other: LogWriter) -> dict[str, int]:
        """Another writer of the same log; from now on what it has given decides, too, up to when all is there.

        Returns the numbers of all topics.
        """
        self._others.append(other)
        return self._numbers

    def _begin(self) -> None:
        d = self._description
        run = {"log_format": LOG_FORMAT, "gcodesim": __version__, **d.run}
        self._container.add_metadata("gcodesim.run", run)
        for name, record in d.records.items():
            self._container.add_metadata(name, record)
        inputs = dict(d.attachments)
        inputs.setdefault("layout.json", layout("robot", d.joint_names))
        for name, data in inputs.items():
            self._container.add_attachment(name, 0, _media_type(name), data)
        self._add_one("/tf_static", 0, frames_message(0, d.static_frames))
        self._add_one("/scene/cell", 0, entities_update(0, d.cell))
        self._add_one("/scene/path", 0, path_update(0, d.path_frame, d.feed_path, d.rapid_path, d.path_ahead))
        self.event(0, "start", f"{d.run.get('program', 'program')} starts")

    def path(self, t_ns: int, frame: str, feed: Polylines, rapid: Polylines, ahead: Sequence[PathPart] = ()) -> None:
        """The planned path, once more of it is known than at the start."""
        self._add_one("/scene/path", t_ns, path_update(t_ns, self._frame(frame), feed, rapid, ahead))

    # ---- every log period

    def window(
        self,
        t_ns: NDArray[np.int64],
        *,
        tf: Array,
        joint_position: Array,
        joint_velocity: Array,
        joint_effort: Array,
        joint_command: Array,
        target: Array,
        tcp: Array,
        motion: MotionColumns,
        process: ProcessColumns,
        wrench: Array,
    ) -> None:
        """The state at n log instants, later than all before. n may be 0.

        `t_ns` (n,) increasing; `tf` (n, F, 7) poses x y z qx qy qz qw [m] of
        the moving frames in their parents; joints (n, j) [rad or m, per s, N·m
        or N], `joint_command` where they were told to be; `target` and `tcp`
        (n, 7) in world; `wrench` (n, 6) [N, N·m] on the tool at the tip, in the axes of `wrench_frame`.
        """
        times = np.asarray(t_ns, dtype=np.int64)
        columns = {
            "tf": tf,
            "joint_position": joint_position,
            "joint_velocity": joint_velocity,
            "joint_effort": joint_effort,
            "joint_command": joint_command,
            "target": target,
            "tcp": tcp,
            "wrench": wrench,
            **{name: getattr(motion, name) for name in _MOTION},
            **{name: getattr(process, name) for name in PROCESS_COLUMNS},
            **{array_of(name): values for name, values in process.fields.items()},
        }
        d = self._description
        columns |= twins_of(columns, d.joint_scale or (1.0,) * len(d.joint_names), d.process_fields)
        before = self._last_ns
        self._take(times, columns)
        waiting = self._batch.first_ns
        self._drain(min([before if waiting is None else min(before, waiting), *(o.settled_ns for o in self._others)]))

    def _take(self, times: NDArray[np.int64], columns: Mapping[str, Any]) -> None:
        if not len(times):
            return
        if self._last_ns < 0 and times[0] != 0:
            raise ValueError(f"the log starts at {times[0]} ns, not at 0")
        if times[0] <= self._last_ns or (np.diff(times) <= 0).any():
            raise ValueError(f"log instants do not increase after {self._last_ns} ns")
        start = 0
        while start < len(times):
            start += self._batch.put(times, columns, start)
            if self._batch.full:
                self._build()
        self._last_ns = int(times[-1])

    def _build(self) -> None:
        if self._batch.count:
            self._rows.extend(self._builder.build(*self._batch.take()))

    # ---- when something changes

    def program(self, t_ns: int, **changes: Any) -> None:
        """The block in execution from `t_ns` on: fields of `ProgramShown` that change; the others stay.

        Writes nothing when nothing changes; a new block also gives a line for `/log`.
        """
        known = self._program
        changed = [name for name, value in changes.items() if getattr(known, name) != value]
        for name in changed:
            setattr(known, name, changes[name])
        if known.state not in STATES:
            raise ValueError(f"no such program state: '{known.state}'")
        if changed or self._channels["/program"] not in self._at_start:
            self._add_one("/program", t_ns, program_message(t_ns, known))
        if not _BLOCK_FIELDS.isdisjoint(changed):
            self._add_one("/log", t_ns, log_message(t_ns, SEVERITIES["note"], known.text, known.file, known.line))

    def blocks(self, blocks: BlockMessages, first: int = 0, last: int | None = None) -> None:
        """Blocks first ≤ i < last: what `program` and `block_polyline` write for each, many times faster."""
        columns = blocks.columns
        last = len(columns) if last is None else last
        if first >= last:
            return
        self._frame(columns.frame)
        for times, made in blocks.between(first, last):
            for topic, messages in made.items():
                self._add(topic, times, messages)
        self._program = replace(
            columns.modals[int(columns.modal[last - 1])],
            line=int(columns.line[last - 1]),
            text=columns.text[last - 1].decode(),
            block=int(columns.block[last - 1]),
        )

    def event(
        self,
        t_ns: int,
        code: str,
        message: str,
        *,
        severity: str = "note",
        file: str = "",
        line: int = 0,
        bodies: Sequence[str] = (),
        value: float = 0.0,
    ) -> None:
        """Something a test may ask for, also as a line of `/log`: a finding's code, or start, toolchange, collision,
        limit, message, print, log (what the program says), interrupted, end. `severity` is note, warning or error;
        `value` is SI, as the code says."""
        data = event_message(t_ns, code, severity, file, line, message, bodies, value)
        self._add_one("/event", t_ns, data)
        self.log(t_ns, f"{code}: {message}", severity=severity, file=file, line=line)

    def log(self, t_ns: int, message: str, *, severity: str = "note", file: str = "", line: int = 0) -> None:
        """A line for people."""
        self._add_one("/log", t_ns, log_message(t_ns, SEVERITIES[severity], message, file, line))

    def block_polyline(self, t_ns: int, points: Array, frame: str = ROOT) -> None:
        """The path (n, 3) [m] of the block that begins; arcs in pieces. No points: nothing is shown."""
        self._add_one("/scene/block", t_ns, polyline_update(t_ns, "block", self._frame(frame), points))

    def tool(
        self, t_ns: int, shapes: Sequence[DrawnShape], frame: str = "tool", waiting: Sequence[Entity] = ()
    ) -> None:
        """The tool in the spindle from now on, no shapes: the spindle is empty; and those `waiting` in their stands."""
        entity = Entity(id="tool", frame=self._frame(frame), shapes=tuple(shapes))
        self._add_one("/scene/tool", t_ns, entities_update(t_ns, [*([entity] if shapes else []), *waiting]))

    def forces(self, t_ns: NDArray[np.int64], tip: Array, force: Array, frame: str = ROOT) -> None:
        """Arrows of the process force (n, 3) [N] at `tip` (n, 3) [m], both in `frame`, at n times, which increase by
        a tenth of a second or more."""
        if len(t_ns):
            times = np.asarray(t_ns, dtype=np.int64)
            self._add("/scene/force", times, force_updates(times, self._frame(frame), tip, force))

    def stock_tile(self, t_ns: int, index: int, meshes: Sequence[DrawnMesh], frame: str = "stock") -> None:
        """All of one tile of the part: original and cut surface as meshes of one colour each."""
        shown = tuple(mesh for mesh in meshes if len(mesh.triangles))
        entity = Entity(id=f"stock/{index:02d}", frame=self._frame(frame), shapes=shown)
        self._add_one(tile_topic("stock", index), t_ns, entities_update(t_ns, [entity] if shown else []))

    def film(self, t_ns: int, index: int, name: str, meshes: Sequence[DrawnMesh], frame: str) -> None:
        """All of one film, as the entity `name`; it has the topic of an added tile."""
        entity = Entity(id=name, frame=self._frame(frame), shapes=tuple(meshes))
        self._add_one(tile_topic("added", index), t_ns, entities_update(t_ns, [entity]))

    def sensed(self, t_ns: int, topic: str, data: bytes) -> None:
        """What a sensor has read at `t_ns`, as a message of one of the `sensor_topics`."""
        self._add_one(topic, t_ns, data)

    # ---- into the file

    @property
    def settled_ns(self) -> int:
        """Everything before is on its way to disk."""
        return self._written_ns

    def flush_before(self, t_ns: int) -> None:
        """Put everything earlier than `t_ns` on disk now; nothing earlier may follow."""
        self._build()
        self._drain(t_ns)
        self._container.flush()

    def _drain(self, t_ns: int) -> None:
        """Hand everything earlier than `t_ns` over to the chunk."""
        if t_ns <= self._written_ns:
            return
        self._fill_start()
        self._container.add(self._backlog.due(t_ns), self._due_rows(t_ns), self._periodic)
        self._written_ns = t_ns

    def close(
        self,
        end_ns: int,
        state: str,
        result: Mapping[str, str] | None = None,
        attachments: Mapping[str, bytes] | None = None,
        peaks: Mapping[str, float] | None = None,
    ) -> None:
        """Finish the log at `end_ns` with `state` finished or failed, and give it its final name.

        The last state is repeated at `end_ns` when that is no log instant, with the `peaks` since the last instant by
        their fields of `/process`, and the last program line with the final state. `result` becomes the result
        record; state, duration, blocks and removed volume are added where they
        are missing. `attachments` are outputs such as results.json.
        """
        if state not in ("finished", "failed"):
            raise ValueError(f"a run ends finished or failed, not '{state}'")
        if end_ns < self._last_ns:
            raise ValueError(f"the run ends at {end_ns} ns, but {self._last_ns} ns is logged")
        newest = self._close_rows(end_ns, state, peaks or {})
        self.flush_before(end_ns + 1)
        if self._backlog:
            raise ValueError(f"the log has a message after its end at {end_ns} ns")
        for name, data in (attachments or {}).items():
            self._container.add_attachment(name, end_ns, _media_type(name), data)
        begun = self._program.block + 1 if self._program.line else 0
        record = {"blocks": str(begun), "removed_m3": repr(float(newest["removed"][0, 0]))}
        record |= {**(result or {}), "state": state, "duration_ns": str(end_ns)}
        self._container.add_metadata("gcodesim.result", record)
        self._container.finish()

    def _close_rows(self, end_ns: int, state: str, peaks: Mapping[str, float]) -> dict[str, NDArray[Any]]:
        """The last state at the end, and the end of the program; returns that state."""
        newest = self._batch.newest
        for name, value in peaks.items():
            newest[PEAK_ARRAYS.get(name) or array_of(name)][:] = value
        for t_ns in (0, end_ns):
            if t_ns > self._last_ns:
                self._take(np.array([t_ns], dtype=np.int64), newest)
        self.program(end_ns, state=state)
        self.event(end_ns, "end", state, severity="note" if state == "finished" else "error")
        return newest

    def abandon(self) -> None:
        """Stop without an end: the `.part` file keeps everything given so far, as far as it can be written.

        Where nothing is known beyond time 0, there is nothing to keep, and no file is left.
        """
        if self._container.closed:
            return
        with suppress(OSError, ValueError):
            self.flush_before(self._last_ns + 1)
        self._container.abandon()
        if all(writer._last_ns <= 0 for writer in (self, *self._others)):
            with suppress(OSError):
                self._container.part_path.unlink()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.abandon()

    def _due_rows(self, before_ns: int) -> list[RecordRows]:
        """Remove and return the rows earlier than `before_ns`."""
        due = []
        while self._rows and (rows := self._rows[0]).times[self._next_row] < before_ns:
            last = int(np.searchsorted(rows.times, before_ns))
            due.append(rows.part(self._next_row, last))
            self._next_row = last
            if last == len(rows.times):
                self._rows.popleft()
                self._next_row = 0
        return due

    def _add_one(self, topic: str, t_ns: int, data: bytes) -> None:
        self._backlog.add(self._channel(topic, int(t_ns)), int(t_ns), data)

    def _add(self, topic: str, times: NDArray[np.int64], messages: Sequence[bytes]) -> None:
        """Messages at times that do not decrease."""
        self._backlog.add_many(self._channel(topic, int(times[0])), times, messages)

    def _channel(self, topic: str, t_ns: int) -> int:
        """The channel of a topic that has a message at `t_ns`."""
        if t_ns < self._written_ns:
            raise ValueError(f"{topic} at {t_ns} ns comes late: all before {self._written_ns} ns is written")
        channel = self._channels[topic]
        if t_ns == 0:
            self._at_start.add(channel)
        return channel

    def _fill_start(self) -> None:
        """Every topic has a message at time 0, or a jump to the start would show nothing of it."""
        if self._written_ns > 0:
            return
        for other in self._others:
            other._fill_start()
        blank = {topic.name: message for topic, message in self._description.sensor_topics}
        for topic, channel in self._channels.items():
            if channel in self._periodic or channel in self._at_start:
                continue
            if topic in blank:
                self._add_one(topic, 0, blank[topic])
                continue
            if topic == "/program":
                self._add_one(topic, 0, program_message(0, ProgramShown()))
            else:  # /event and /log have their start already; what is left are scenes
                self._add_one(topic, 0, entities_update(0, ()))

    def _frame(self, frame: str) -> str:
        if frame not in self._frames:
            raise ValueError(f"frame '{frame}' is not in the tree of the log")
        return frame


def _checked_frames(d: LogDescription, further: Iterable[LogDescription] = ()) -> frozenset[str]:
    """Names of all frames; ValueError unless they make one tree with the root `world`."""
    pairs = [(frame.parent, frame.child) for frame in d.static_frames] + list(d.moving_frames)
    pairs += [pair for other in further for pair in other.moving_frames]
    parents = {child: parent for parent, child in pairs}
    if len(parents) < len(pairs):
        raise ValueError("a frame of the log has two parents")
    for child in parents:
        seen, at = {child}, parents[child]
        while at != ROOT:
            if at not in parents or at in seen:
                raise ValueError(f"frame '{child}' does not hang on '{ROOT}'")
            seen.add(at)
            at = parents[at]
    frames = frozenset((*parents, ROOT))
    for frame in (*(entity.frame for entity in d.cell), d.path_frame, d.wrench_frame):
        if frame not in frames:
            raise ValueError(f"frame '{frame}' is not in the tree of the log")
    return frames


def _media_type(name: str) -> str:
    return _MEDIA_TYPES.get(Path(name).suffix, "text/plain")
