"""Where the time of a run goes: by line, by tool and by layer, from its log. The parts of each add up to the total."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.playback.columns import peak_of
from gcodesim.playback.recording import Recording

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

LAYER_STEP: Final = 1e-5  # [m] heights closer than this are one layer
MOST_LAYERS: Final = 2000
_LEVEL_SHARE: Final = 0.6  # share of the working time at constant height from which on there are layers
_NEAR_NS: Final = 100_000_000


@frozen
class LineTime:
    """A program line: how often it ran, its time [s], its removed volume [m³] and its greatest force [N]."""

    file: str
    line: int
    text: str
    count: int
    seconds: float
    removed: float
    force: float


@frozen
class ToolTime:
    """A tool in the spindle (0: none): all time since its change began, and how much of it was in material [s]."""

    number: int
    name: str
    seconds: float
    engaged: float
    removed: float
    force: float
    power: float


@frozen
class LayerTime:
    """Work at one height `z` [m] of the work coordinates, with the moves that lead to it; None: before the first."""

    z: float | None
    seconds: float
    engaged: float
    removed: float


@frozen
class TimeReport:
    """`total` [s], and its parts in three ways. `layers` is empty for work that has none, such as a curved surface."""

    total: float
    lines: tuple[LineTime, ...]
    tools: tuple[ToolTime, ...]
    layers: tuple[LayerTime, ...]
    operations: tuple[Mapping[str, Any], ...] = ()
    """Those of `results.json`, as they stand there."""

    def as_json(self) -> dict[str, Any]:
        """Units in the names; in the order of the run."""
        from gcodesim.numbers import clean, rounded
        from gcodesim.units import MM, MM3

        value: dict[str, Any] = {
            "total_s": rounded(self.total),
            "tools": [
                {
                    "number": t.number,
                    "name": t.name,
                    "time_s": rounded(t.seconds),
                    "engaged_s": rounded(t.engaged),
                    "removed_mm3": rounded(t.removed / MM3),
                    "max_force_N": rounded(t.force),
                    "max_power_W": rounded(t.power),
                }
                for t in self.tools
            ],
            "operations": [dict(operation) for operation in self.operations],
            "layers": [
                {
                    "z_mm": None if layer.z is None else rounded(layer.z / MM, 6),
                    "time_s": rounded(layer.seconds),
                    "engaged_s": rounded(layer.engaged),
                    "removed_mm3": rounded(layer.removed / MM3),
                }
                for layer in self.layers
            ],
            "lines": [
                {
                    "file": line.file,
                    "line": line.line,
                    "count": line.count,
                    "time_s": rounded(line.seconds),
                    "removed_mm3": rounded(line.removed / MM3),
                    "max_force_N": rounded(line.force),
                }
                for line in self.lines
            ],
        }
        cleaned: dict[str, Any] = clean(value)
        return cleaned


def end_of(recording: Recording) -> int:
    """The end of the run [ns]: that of the time law if the results have it, else the last moment of the log."""
    total = recording.results.get("time", {}).get("total_s")
    exact = recording.end_ns if total is None else round(float(total) * 1e9)
    return exact if abs(exact - recording.end_ns) < _NEAR_NS else recording.end_ns


def time_report(recording: Recording) -> TimeReport:
    """The parts of the time of a run. A line has the time from its start to the start of the next one."""
    end_ns = end_of(recording)
    timeline = recording.timeline
    starts = np.minimum(timeline.t_ns, end_ns)
    durations = np.diff(starts, append=end_ns) * 1e-9
    process = _Process(recording)
    block = timeline.at(process.t_ns - 1)  # a sample is the end of the steps that led to it
    return TimeReport(
        total=end_ns * 1e-9,
        lines=_lines(recording, starts, durations, process, block),
        tools=_tools(recording, starts, durations, process, block),
        layers=_layers(recording, end_ns, process),
        operations=tuple(recording.results.get("operations", ())),
    )


class _Process:
    """The columns of `/process`, zeros where a log has none; each sample covers the time since the sample before.

    `force` and `power` are the greatest in that time, `last_force` is that of its last step.
    """

    def __init__(self, recording: Recording) -> None:
        series = recording.series("/process")
        self.t_ns = series.t_ns
        force, power = peak_of(series, "force_n"), peak_of(series, "power_w")
        columns = series.columns("engaged", force, power, "force_n", "removed_m3")
        self.engaged, self.force, self.power, self.last_force, removed = columns.T if len(columns) else np.zeros((5, 0))
        self.removed = np.diff(removed, prepend=0.0)
        self.seconds = np.diff(self.t_ns, prepend=0) * 1e-9


def _sums(index: Ints, count: int, process: _Process) -> tuple[Array, Array, Array, Array]:
    """Engaged time, removed volume, greatest force and power by group (count,); index −1 belongs to none."""
    valid = index >= 0
    index = index[valid]
    seconds = process.seconds * (process.engaged > 0.0)
    engaged: Array = np.zeros(count)
    removed: Array = np.zeros(count)
    engaged += np.bincount(index, weights=seconds[valid], minlength=count)
    removed += np.bincount(index, weights=process.removed[valid], minlength=count)
    force, power = np.zeros(count), np.zeros(count)
    np.maximum.at(force, index, process.force[valid])
    np.maximum.at(power, index, process.power[valid])
    return engaged, removed, force, power


def _lines(
    recording: Recording, starts: Ints, durations: Array, process: _Process, block: Ints
) -> tuple[LineTime, ...]:
    timeline = recording.timeline
    known: dict[tuple[str, int], int] = {}
    files = [modal.file for modal in timeline.modals]
    group = np.array(
        [
            known.setdefault((files[modal], line), len(known))
            for modal, line in zip(timeline.modal.tolist(), timeline.line.tolist(), strict=True)
        ],
        dtype=np.int64,
    )
    if not known:
        return ()
    seconds = np.bincount(group, weights=durations, minlength=len(known))
    seconds[group[0]] += starts[0] * 1e-9  # nothing runs before the first line
    counts = np.bincount(group[np.diff(timeline.block, prepend=-1) != 0], minlength=len(known))
    index = np.where(block >= 0, group[block], -1)
    _, removed, _, _ = _sums(index, len(known), process)
    force = _force_of_lines(recording, known, process, block, index)
    texts = dict(zip(group.tolist(), timeline.text, strict=True))
    return tuple(
        LineTime(
            file=file,
            line=line,
            text=texts[i],
            count=int(counts[i]),
            seconds=float(seconds[i]),
            removed=float(removed[i]),
            force=float(force[i]),
        )
        for i, (file, line) in enumerate(known)
    )


def _force_of_lines(
    recording: Recording, known: Mapping[tuple[str, int], int], process: _Process, block: Ints, index: Ints
) -> Array:
    """The greatest force on each of the `known` lines: that of `lines.csv`, which has seen every step.

    A log alone knows only the last step of the time between two samples in which a block began; if the run
    ends between two samples, not even that, because the state of the last sample is repeated.
    """
    force = np.zeros(len(known))
    begun = recording.timeline.at(np.append(0, process.t_ns[:-1]))
    last = np.where(process.t_ns % max(recording.period_ns, 1) == 0, process.last_force, 0.0)
    told = np.where(begun == block, process.force, last)
    np.maximum.at(force, index[index >= 0], told[index >= 0])
    rows = recording.line_rows or []
    with suppress(KeyError, TypeError, ValueError):  # the table of another run; the values of the log stay
        seen = {(row["file"], int(row["line"])): float(row["max_force_N"]) for row in rows}
        if seen:
            force[:] = [seen.get(place, 0.0) for place in known]
    return force


def _tools(
    recording: Recording, starts: Ints, durations: Array, process: _Process, block: Ints
) -> tuple[ToolTime, ...]:
    timeline = recording.timeline
    if not len(timeline):
        return ()
    tool = np.array([modal.tool for modal in timeline.modals], dtype=np.int64)[timeline.modal]
    numbers = list(dict.fromkeys(tool.tolist()))
    place = {number: i for i, number in enumerate(numbers)}
    group = np.array([place[number] for number in tool.tolist()], dtype=np.int64)
    seconds = np.bincount(group, weights=durations, minlength=len(numbers))
    seconds[group[0]] += starts[0] * 1e-9
    engaged, removed, force, power = _sums(np.where(block >= 0, group[block], -1), len(numbers), process)
    names = {modal.tool: modal.tool_name for modal in timeline.modals}
    # a sample at a change belongs to both tools; the results have seen every step
    seen = {tool["number"]: tool for tool in recording.results.get("tools", ())}
    return tuple(
        ToolTime(
            number=number,
            name=(names[number] or f"T{number}") if number else "no tool",
            seconds=float(seconds[i]),
            engaged=float(engaged[i]),
            removed=float(removed[i]),
            force=float(seen.get(number, {}).get("max_force_N", force[i])),
            power=float(seen.get(number, {}).get("max_power_W", power[i])),
        )
        for i, number in enumerate(numbers)
    )


def _layers(recording: Recording, end_ns: int, process: _Process) -> tuple[LayerTime, ...]:
    """Heights at which material was cut or laid for a while, in the order of the run.

    A layer begins with the move that leads to it, when the work before it ended.
    """
    motion = recording.series("/motion")
    working = process.engaged > 0.0
    if "z_m" not in motion.names or len(motion.t_ns) != len(process.t_ns) or not working.any():
        return ()
    z = np.rint(motion.column("z_m") / LAYER_STEP).astype(np.int64)
    level = working & np.concatenate([[False], np.abs(np.diff(z)) == 0])
    if process.seconds[level].sum() < _LEVEL_SHARE * process.seconds[working].sum():
        return ()
    at = np.flatnonzero(level)
    changes = np.flatnonzero(np.diff(z[at], prepend=z[at[0]] - 1))
    heights = z[at][changes]
    if len(heights) > MOST_LAYERS:
        return ()
    # samples after the last work of one layer belong to the next
    borders = np.concatenate([[0], at[changes[1:] - 1] + 1, [len(z)]])
    group = np.repeat(np.arange(len(heights)), np.diff(borders))
    known = list(dict.fromkeys(heights.tolist()))
    index = np.array([known.index(h) for h in heights.tolist()], dtype=np.int64)[group]
    engaged, removed, _, _ = _sums(index, len(known), process)
    ends = np.minimum(process.t_ns, end_ns)
    seconds = np.bincount(index, weights=np.diff(ends, prepend=0) * 1e-9, minlength=len(known))
    seconds[index[-1]] += (end_ns - int(ends[-1])) * 1e-9
    return tuple(
        LayerTime(z=h * LAYER_STEP, seconds=float(seconds[i]), engaged=float(engaged[i]), removed=float(removed[i]))
        for i, h in enumerate(known)
    )


def slowest(lines: Sequence[LineTime], most: int) -> list[LineTime]:
    """The lines that take the most time, longest first."""
    return sorted(lines, key=lambda line: -line.seconds)[:most]
