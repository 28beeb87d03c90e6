"""What a log describes, and the input for each log instant: plain values and columns, no objects of the simulation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field, fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.log.shapes import Entity, PathPart, Polylines
from gcodesim.log.topics import Topic

Array = NDArray[np.float64]


@frozen
class StaticFrame:
    """A frame that never moves: pose of `child` seen from `parent`; `p` (3,) [m], `q` (4,) x y z w."""

    parent: str
    child: str
    p: Array
    q: Array


@frozen
class ProcessField:
    """A field of `/process` that only this log has, a number or a `flag`; its name ends in the unit.

    One that begins with `max_` holds the greatest of the field with the rest of its name since the instant before.
    `twin_of` names a field in SI of which this one is the same in units of the shop floor: divided by `divisor`.
    """

    name: str
    flag: bool = False
    twin_of: str = ""
    divisor: float = 1.0


@frozen
class LogDescription:
    """Everything that is fixed for a whole log.

    `run` is the metadata record: program, program_sha256, cell, cell_sha256,
    seed, step_ns, log_period_ns, versions; `log_format` and `gcodesim` are
    added; `records` are further ones by name. `moving_frames` are (parent, child) in the order of the columns given
    to `LogWriter.window`; `joint_scale` is 1 mm or 1 degree in SI for each of the
    joints, as people read them. `wrench_frame` names the frame whose axes the wrench
    follows. `process_kinds` is the list into which the column `kind` points,
    `process_fields` come in `/process` after the fields that it always has.
    `sensor_topics` are those of sensors, in the order in which one reading is written, each with the message that is
    shown at time 0 of one that has not read yet.
    `cell` has the robot links and fixtures, `feed_path` and `rapid_path` the
    planned path in `path_frame`, and `path_ahead` the feeds in parts, with
    the times at which they are done. `attachments` are the inputs by name:
    program.nc, subprograms, cell.yaml, URDFs; layout.json is added when missing.
    """

    run: Mapping[str, str]
    static_frames: tuple[StaticFrame, ...]
    moving_frames: tuple[tuple[str, str], ...]
    joint_names: tuple[str, ...]
    joint_scale: tuple[float, ...] = ()
    cell: tuple[Entity, ...] = ()
    feed_path: Polylines = field(default_factory=Polylines.none)
    rapid_path: Polylines = field(default_factory=Polylines.none)
    path_ahead: tuple[PathPart, ...] = ()
    path_frame: str = "world"
    wrench_frame: str = "world"
    process_kinds: tuple[str, ...] = ("",)
    process_fields: tuple[ProcessField, ...] = ()
    sensor_topics: tuple[tuple[Topic, bytes], ...] = ()
    stock_tiles: int = 1
    added_tiles: int = 0
    records: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    attachments: Mapping[str, bytes] = field(default_factory=dict)


@frozen
class MotionColumns:
    """How the machine follows, at n log instants. Shapes (n,), `position` (n, 3).

    Tip speeds [m/s], errors against the target [m], [rad], part of the block
    that is done, tip in the active work coordinates [m], held by a limit. The
    three `…_used` say how close the nearest joint is to its limit of travel,
    speed and effort: 1 is at the limit.
    """

    feed: Array
    feed_command: Array
    position_error: Array
    orientation_error: Array
    block_fraction: Array
    position: Array
    limit: NDArray[np.bool_]
    travel_used: Array
    speed_used: Array
    effort_used: Array


@frozen
class ProcessColumns:
    """What the tool does to the part, at n log instants. Shapes (n,).

    `kind` points into `LogDescription.process_kinds`; spindle [rad/s, + = M3],
    force [N], torque about the tool axis [N·m], power [W], removal rate [m³/s]
    and net removed volume since the start [m³], negative for added material. The three `max_…` are the greatest of
    any step since the instant before, where the others are those of the last step.
    `fields` (n,) by name are those of `LogDescription.process_fields`.
    """

    kind: NDArray[np.integer]
    engaged: NDArray[np.bool_]
    spindle: Array
    force: Array
    torque: Array
    power: Array
    removal: Array
    removed: Array
    max_force: Array
    max_torque: Array
    max_power: Array
    fields: Mapping[str, NDArray[Any]] = field(default_factory=dict)


PROCESS_COLUMNS: Final = tuple(item.name for item in fields(ProcessColumns) if item.name != "fields")
"""Those that every log has."""


PEAK: Final = "max_"
"""What the names of peaks begin with."""


PEAK_ARRAYS: Final = {"max_force_n": "max_force", "max_torque_nm": "max_torque", "max_power_w": "max_power"}
"""The columns of those that every log has, by their fields."""


def with_peaks(names: Iterable[str]) -> dict[str, str]:
    """The most telling field of each figure: its peak between samples if there is one, else the figure itself."""
    known = list(names)
    peaks = {name.removeprefix(PEAK) for name in known if name.startswith(PEAK)}.intersection(known)
    shown = (name for name in known if not (name.startswith(PEAK) and name.removeprefix(PEAK) in peaks))
    return {name: PEAK + name if name in peaks else name for name in shown}


def array_of(name: str) -> str:
    """The name of the values of a process field among the columns of a log."""
    return f"process.{name}"
