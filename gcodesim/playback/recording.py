"""A run on disk: its log and the files beside it."""

from __future__ import annotations

import csv
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np

from gcodesim.diagnostics import Diagnostic, Severity, SourceText, Span
from gcodesim.diagnostics.plain import table_text, text_of_table
from gcodesim.files.output_folder import LOG_NAME, RESULTS_NAME, SETUPS_NAME
from gcodesim.log.event import LogEvent
from gcodesim.log.logfile import LogFile, LogReadError, RawMessage
from gcodesim.log.reader import decoder_of
from gcodesim.log.series import Series, read_series
from gcodesim.log.topics import LOOSE, PERIODIC
from gcodesim.playback.frames import RecordedFrames
from gcodesim.playback.scenes import Drawing, drawing_of
from gcodesim.playback.stored_results import NoResultsError, results_from
from gcodesim.playback.timeline import Timeline

PERIODIC_TOPICS: Final = tuple(topic.name for topic in PERIODIC)
_TILES: Final = ("/scene/stock/", "/scene/added/")
_OTHER_FILES: Final = ("layout.json", "results.json", "cell.yaml", "program.nc")


class RecordingError(Exception):
    """There is no log, or it cannot be read; the text says why."""


@dataclass(eq=False)
class Recording:
    """One run. `folder` is the output folder if that was named, else None: a log alone has no files beside it.

    Damaged parts of the log are left out; `findings` says which, once they have been asked for.
    """

    log: LogFile
    folder: Path | None
    _series: dict[tuple[str, int], Series] = field(default_factory=dict)
    _unfit: str = ""
    _tile_times: dict[str, list[tuple[int, int]]] = field(default_factory=lambda: defaultdict(list))

    @staticmethod
    def open(path: Path) -> Recording:
        """The run in an output folder, or the log at `path`. RecordingError when there is none."""
        folder = path if path.is_dir() else None
        file = path / LOG_NAME if folder is not None else path
        try:
            log = LogFile.open(file, lenient=True)
        except FileNotFoundError:
            where = f"folder {path} holds no {LOG_NAME}" if folder is not None else f"log {path} is not there"
            if folder is not None and (folder / SETUPS_NAME).is_file():
                inside = ", ".join(str(one.parent) for one in sorted(folder.glob(f"*/{LOG_NAME}")))
                where += f", but those of set-ups: {inside}"
            raise RecordingError(where) from None
        except (LogReadError, OSError) as error:
            raise RecordingError(f"log {file} cannot be read: {error}") from None
        if not log.chunks and not log.complete:
            raise RecordingError(f"log {file} holds nothing that can be read: {log.problem}")
        if "gcodesim.run" not in log.metadata and not log.library.startswith("gcodesim"):
            raise RecordingError(f"{file} is an MCAP file, but no log of gcodesim")
        if log.chunks and next(log.messages(), None) is None:
            reason = log.damage[0] if log.damage else "its chunks hold no message"
            raise RecordingError(f"log {file} holds nothing that can be read: {reason}")
        return Recording(log, folder)

    @property
    def end_ns(self) -> int:
        return self.log.end_ns

    @property
    def run(self) -> dict[str, str]:
        """The record of the inputs: program, cell, seed, versions."""
        return dict(self.log.metadata.get("gcodesim.run", {}))

    @property
    def period_ns(self) -> int:
        """Time between two samples from the record; 0 if it does not say."""
        try:
            return max(int(self.run.get("log_period_ns", "0")), 0)
        except ValueError:
            return 0

    @property
    def name(self) -> str:
        """Name of the program."""
        return self.run.get("program", self.log.path.name)

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """Parts of the log that cannot be read, as far as they have been asked for."""
        span, end_s = Span(self.log.path.name), self.end_ns * 1e-9
        found = [
            Diagnostic(
                code="GS614",
                span=span,
                message=f"{damage}; what was in it is left out",
                time=None if damage.first_ns is None else damage.first_ns * 1e-9,
                hint="`gcodesim info` tells all that is damaged; run the program again for a whole log",
            )
            for damage in self.log.damage
        ]
        if self._unfit:
            hint = "run the program again; what the log itself has was used"
            found.append(Diagnostic(code="GS614", span=span, message=f"{self._unfit}; it is left out", hint=hint))
        if self.log.problem:
            ended = "gcodesim.result" in self.log.metadata
            lost = "" if ended else f"; what came after {end_s:.3f} s is not there"
            found.append(
                Diagnostic(
                    code="GS614",
                    severity=Severity.WARNING,
                    span=span,
                    message=f"{self.log.problem}{lost}",
                    time=end_s,
                    hint="the run was killed, or the file was not copied whole; `gcodesim info` tells what is missing",
                )
            )
        return tuple(found)

    @property
    def gaps(self) -> tuple[tuple[int, int], ...]:
        """Spans of time [ns] of which nothing is known, because their chunks are damaged."""
        return tuple(
            (damage.first_ns, damage.last_ns)
            for damage in self.log.damage
            if damage.first_ns is not None and damage.last_ns is not None
        )

    @cached_property
    def results(self) -> dict[str, Any]:
        """The results that the log carries, else those beside it; {} if there are no consistent ones."""
        data = self.log.attached(RESULTS_NAME)
        if data is None and self.folder is not None:
            with suppress(OSError):
                data = (self.folder / RESULTS_NAME).read_bytes()
        if data is None:  # the run did not come to its end
            return {}
        try:
            return results_from(data)
        except NoResultsError as reason:
            self._unfit = f"{RESULTS_NAME} holds no results of gcodesim: {reason}"
            return {}

    @cached_property
    def line_rows(self) -> list[dict[str, str]] | None:
        """Rows of `lines.csv` of the output folder; None without one."""
        file = None if self.folder is None else self.folder / "lines.csv"
        if file is None or not file.is_file():
            return None
        with file.open(encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream))
        names = {table_text(name): name for name in self.timeline.files()}
        for row in rows:
            if shown := row.get("file"):
                row["file"] = names.get(shown) or text_of_table(shown)
        return rows

    @cached_property
    def sources(self) -> dict[str, SourceText]:
        """The program and its subprograms by the names that the log uses."""
        found, ran = {}, self.timeline.files()
        for name in self.log.attachments:
            shown = self.name if name == "program.nc" else name
            if name == "program.nc" or (name in ran and name not in _OTHER_FILES):
                raw = self.log.attached(name)
                if raw is not None:
                    found[shown] = SourceText(shown, raw)
        return found

    @cached_property
    def _changes(self) -> dict[str, list[tuple[int, Any]]]:
        """Time and message of all topics that are neither periodic nor tiles, from one pass through the log.

        The pass also notes where the tiles are.
        """
        wanted: dict[int, tuple[str, Callable[[RawMessage], Any]]] = {}
        others = [f"/{name}{topic}" for name in self.channels for topic in ("/event", "/scene/tool")]
        scenes = ("/scene/cell", "/scene/path", "/scene/tool", "/scene/drawn", LOOSE.name)
        for topic in ("/tf_static", "/program", "/event", *scenes, *others):
            channel = self.log.channel_id(topic)
            if channel is not None:
                wanted[channel] = (topic, decoder_of(self.log, channel))
        found: dict[str, list[tuple[int, Any]]] = {topic: [] for topic, _ in wanted.values()}
        tiles = self._channels_of(self.tile_topics)
        for message in self.log.messages({*wanted, *tiles}):
            if message.channel in tiles:
                self._tile_times[tiles[message.channel]].append((message.t_ns, len(message.data)))
                continue
            topic, decode = wanted[message.channel]
            found[topic].append((message.t_ns, decode(message)))
        return found

    @cached_property
    def timeline(self) -> Timeline:
        return Timeline.of(self._changes.get("/program", []))

    @cached_property
    def events(self) -> tuple[LogEvent, ...]:
        told = [
            LogEvent.of(t_ns, message)
            for topic in ("/event", *(f"/{name}/event" for name in self.channels))
            for t_ns, message in self._changes.get(topic, [])
        ]
        return tuple(sorted(told, key=lambda event: event.t_ns))

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of further programs that ran at the same time; their topics have them in front."""
        topics = (channel.topic for channel in self.log.channels.values())
        programs = (topic.removesuffix("/program") for topic in topics if topic.endswith("/program"))
        return tuple(name[1:] for name in programs if name)

    def series(self, topic: str, every_ns: int = 0) -> Series:
        """A periodic topic as columns, empty when the log has none; all seven are read at once."""
        if (topic, every_ns) not in self._series:
            topics = PERIODIC_TOPICS if topic in PERIODIC_TOPICS else (topic,)
            read = read_series(self.log, topics, every_ns=every_ns)
            nothing = Series(np.zeros(0, dtype=np.int64), (), np.zeros((0, 0)), {})
            for name in topics:
                self._series[name, every_ns] = read.get(name, nothing)
        return self._series[topic, every_ns]

    def frames(self, every_ns: int = 0) -> RecordedFrames:
        """The frames of all channels."""
        static = self._changes.get("/tf_static", [])
        frames = RecordedFrames.of(static[-1][1] if static else None, self.series("/tf", every_ns))
        for name in self.channels:
            frames = frames.joined(RecordedFrames.of(None, self.series(f"/{name}/tf", every_ns)))
        return frames

    def joints(self, every_ns: int = 0) -> list[Series]:
        """The joint states of all channels, the first one first."""
        topics = ("/joint_states", *(f"/{name}/joint_states" for name in self.channels))
        return [self.series(topic, every_ns) for topic in topics]

    def tools(self) -> list[tuple[int, tuple[Drawing, ...]]]:
        """The tools in all spindles and the pieces that came loose, whenever one of them changes."""
        topics = ("/scene/tool", *(f"/{name}/scene/tool" for name in self.channels), LOOSE.name)
        own = [self.drawings(topic) for topic in topics]
        shown: list[tuple[Drawing, ...]] = [() for _ in own]
        found: dict[int, tuple[Drawing, ...]] = {}
        changes = [(t_ns, i, content) for i, drawn in enumerate(own) for t_ns, content in drawn]
        changes.sort(key=lambda change: change[:2])
        for t_ns, i, content in changes:
            shown[i] = content
            found[t_ns] = tuple(drawing for each in shown for drawing in each)
        return list(found.items())

    def drawings(self, topic: str) -> list[tuple[int, tuple[Drawing, ...]]]:
        """Time and content of a scene topic that is not a tile, in order."""
        return [(t_ns, drawing_of(update)) for t_ns, update in self._changes.get(topic, [])]

    # ---- stock, which is most of a log

    @property
    def tile_topics(self) -> tuple[str, ...]:
        """All topics that draw a tile of stock or of added material, sorted."""
        names = (channel.topic for channel in self.log.channels.values())
        return tuple(sorted(name for name in names if name.startswith(_TILES) and name != LOOSE.name))

    def _channels_of(self, topics: Iterable[str]) -> dict[int, str]:
        """The `topics` that the log has, by the numbers of their channels."""
        found = {self.log.channel_id(topic): topic for topic in topics}
        return {channel: topic for channel, topic in found.items() if channel is not None}

    def tile_times(self) -> dict[str, list[tuple[int, int]]]:
        """When each tile changes [ns], and how many bytes the message of it has."""
        _ = self._changes
        return {topic: self._tile_times[topic] for topic in self.tile_topics}

    def tiles(self, wanted: Mapping[str, Sequence[int]]) -> Iterator[tuple[int, str, tuple[Drawing, ...]]]:
        """Time, topic and content of the tiles that were sent at the `wanted` times [ns] of each topic."""
        channels = self._channels_of([topic for topic, times in wanted.items() if times])
        at = {topic: frozenset(times) for topic, times in wanted.items()}
        decoders: dict[int, Callable[[RawMessage], Any]] = {}
        for message in self.log.messages(channels):
            topic = channels[message.channel]
            if message.t_ns in at[topic]:
                if message.channel not in decoders:
                    decoders[message.channel] = decoder_of(self.log, message.channel)
                yield message.t_ns, topic, drawing_of(decoders[message.channel](message))

    def stock_at(self, t_ns: int) -> list[Drawing]:
        """Every tile as it was last drawn up to `t_ns`."""
        drawn = {topic: [t for t, _ in times if t <= t_ns] for topic, times in self.tile_times().items()}
        last = {topic: [max(times)] for topic, times in drawn.items() if times}  # none where a chunk is damaged
        found = {topic: drawing for _, topic, drawing in self.tiles(last)}
        return [drawing for topic in sorted(found) for drawing in found[topic]]
