"""Metrics of a run: times, distances, volumes, forces and margins, in the form of `results.json`."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.diagnostics.plain import table_text
from gcodesim.diagnostics.show import as_json
from gcodesim.diagnostics.span_table import SpanTable
from gcodesim.executor.totals import JointTotals, RowTotals
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.jobs.paces import RowPaces
from gcodesim.jobs.target_result import TargetResult
from gcodesim.kinematics.chain import Joints
from gcodesim.motion.tool_path import HOME, RAPID, ToolPath
from gcodesim.numbers import clean, rounded
from gcodesim.processes.column import FORCE, POWER, REMOVED, TORQUE, Column
from gcodesim.units import DEG, MM, MM3, MM_PER_MINUTE

SCHEMA: Final = "gcodesim-results/1"
PACES: Final = ("least_feed_mm_min", "share_at_feed")
"""Columns of `lines.csv` that tell how fast a line ran."""
RunStatus = Literal["ok", "findings", "failed"]


@frozen
class TurnedResult:
    """What else is told of the stock of a lathe: volumes [m³], and outlines of the finished part (k, 2) (z, r) [m].

    `parted`: the part was parted off; then `in_chuck` is the rest of the bar, and `scrap` other pieces that fell.
    """

    parted: bool
    in_chuck: float
    scrap: float
    threads: float
    profiles: Sequence[Array]

    def as_json(self) -> dict[str, Any]:
        return {
            "parted_off": self.parted,
            "in_chuck_mm3": rounded(self.in_chuck / MM3),
            "scrap_mm3": rounded(self.scrap / MM3),
            "thread_mm3": rounded(self.threads / MM3),
            "profiles_z_r_mm": [
                [[rounded(z / MM), rounded(r / MM)] for z, r in loop.tolist()] for loop in self.profiles
            ],
        }


@frozen
class PieceRest:
    """Where a piece came to rest that an engine let fall: `way` [m] lower, on `support`; `name` is its frame."""

    name: str
    way: float
    support: str


@frozen(eq=False)
class FallenPiece:
    """A piece that fell out of a stock: its volume [m³], its box in S [m], and the move that freed it.

    `rest` is where it lies, where the world is an engine.
    """

    volume: float
    low: Array
    high: Array
    span: Span
    rest: PieceRest | None = None

    def as_json(self) -> dict[str, Any]:
        return {
            "volume_mm3": rounded(self.volume / MM3),
            "file": self.span.file,
            "line": self.span.line,
            "low_mm": [rounded(value / MM) for value in self.low.tolist()],
            "high_mm": [rounded(value / MM) for value in self.high.tolist()],
            **({} if self.rest is None else self._rest(self.rest)),
        }

    @staticmethod
    def _rest(rest: PieceRest) -> dict[str, Any]:
        return {"body": rest.name, "fell_mm": rounded(rest.way / MM), "lies_on": rest.support}


@frozen
class DoseResult:
    """What beams gave a stock, seen from above: the greatest for each area, the sum over it, and the map's grid.

    `corner` (x, y) [m] is where the map begins in the stock's columns, `cell` (dx, dy) [m] the size of its cells.
    """

    unit: str
    greatest: float
    total_unit: str
    total: float
    corner: tuple[float, float]
    cell: tuple[float, float]

    def as_json(self) -> dict[str, Any]:
        return {
            "unit": self.unit,
            "greatest": rounded(self.greatest),
            "total_unit": self.total_unit,
            "total": rounded(self.total),
            "corner_mm": [rounded(value / MM) for value in self.corner],
            "cell_mm": [rounded(value / MM) for value in self.cell],
        }


@frozen(eq=False)
class BodyResult:
    """A stock at the end as a body of even density, in its own frame S; SI. Without a `density` nothing is weighed.

    `center` (3,) of mass; `inertia` (3, 3) about it, divided by the mass; `pure`: the metal whose density was taken.
    """

    volume: float
    center: Array
    inertia: Array
    density: float | None
    pure: str = ""

    @property
    def mass(self) -> float | None:
        return None if self.density is None else self.density * self.volume

    def as_json(self) -> dict[str, Any]:
        mass = self.mass
        rows = self.inertia.tolist()
        inertia = None if mass is None else [[rounded(v * mass / (MM * MM)) for v in row] for row in rows]
        return {
            "density_kg_m3": None if self.density is None else rounded(self.density),
            "density_of": self.pure,
            "mass_kg": None if mass is None else rounded(mass),
            "center_mm": [rounded(value / MM) for value in self.center.tolist()],
            "inertia_kg_mm2": inertia,
        }


@frozen
class StockResult:
    """One stock at the end; volumes [m³], resolution [m]. What fell out of it in pieces remains: it is not in chips.

    `force` [N] is the greatest that it felt, where there are parts to tell apart.
    """

    material: str
    initial: float
    removed: float
    deposited: float
    remaining: float
    resolution: float
    error_bound: float
    force: float | None = None
    turned: TurnedResult | None = None
    doses: Mapping[str, DoseResult] = field(default_factory=dict)
    fallen: Sequence[FallenPiece] = ()
    body: BodyResult | None = None

    def as_json(self) -> dict[str, Any]:
        return {
            "material": self.material,
            "initial_mm3": rounded(self.initial / MM3),
            "removed_mm3": rounded(self.removed / MM3),
            "deposited_mm3": rounded(self.deposited / MM3),
            "remaining_mm3": rounded(self.remaining / MM3),
            "resolution_mm": rounded(self.resolution / MM),
            "error_bound_mm3": rounded(self.error_bound / MM3),
            **({} if self.body is None else {"body": self.body.as_json()}),
            **({} if self.force is None else {"max_force_N": rounded(self.force)}),
            **({} if self.turned is None else self.turned.as_json()),
            **({"doses": {name: dose.as_json() for name, dose in self.doses.items()}} if self.doses else {}),
            **({"fallen": [piece.as_json() for piece in self.fallen]} if self.fallen else {}),
        }


@frozen
class ProbeResult:
    """One probing move: at `time` [s] it tripped on `body`, or came to its end, with the tip there in the world [m]."""

    span: Span
    word: str
    time: float
    tripped: bool
    body: str
    tip: tuple[float, float, float]

    def as_json(self) -> dict[str, Any]:
        return {
            "file": self.span.file,
            "line": self.span.line,
            "move": self.word,
            "time_s": rounded(self.time),
            "tripped": self.tripped,
            "touched": self.body or None,
            **{f"{axis}_mm": rounded(value / MM) for axis, value in zip("xyz", self.tip, strict=True)},
        }


@frozen
class Times:
    """Where the time goes [s]; total = feed + rapid + dwell + tool_change + spindle + devices, engaged is within feed.

    `spindle` is what the cell's spindle takes to its speeds, `devices` the waiting for clamps and doors.
    """

    feed: float = 0.0
    engaged: float = 0.0
    rapid: float = 0.0
    dwell: float = 0.0
    tool_change: float = 0.0
    spindle: float = 0.0
    devices: float = 0.0

    @property
    def total(self) -> float:
        return self.feed + self.rapid + self.dwell + self.tool_change + self.spindle + self.devices

    def as_json(self) -> dict[str, Any]:
        return {
            "total_s": rounded(self.total),
            "feed_s": rounded(self.feed),
            "engaged_s": rounded(self.engaged),
            "rapid_s": rounded(self.rapid),
            "dwell_s": rounded(self.dwell),
            "tool_change_s": rounded(self.tool_change),
            **({"spindle_s": rounded(self.spindle)} if self.spindle else {}),
            **({"devices_s": rounded(self.devices)} if self.devices else {}),
        }


@frozen(eq=False)
class Results:
    """The results of a run or a check. `as_json` is the content of `results.json`."""

    status: RunStatus
    stopped_at: Span | None
    inputs: Mapping[str, Any]
    findings: Sequence[Diagnostic]
    times: Times
    feed_distance: float
    rapid_distance: float
    stocks: Mapping[str, StockResult] = field(default_factory=dict)
    tools: Sequence[Mapping[str, Any]] = ()
    operations: Sequence[Mapping[str, Any]] = ()
    """Where the time goes from one tool change, or comment that stands alone, to the next (`jobs/operations.py`)."""
    joints: Sequence[Mapping[str, Any]] = ()
    not_simulated: Sequence[Mapping[str, Any]] = ()
    probings: Sequence[ProbeResult] = ()
    lines: LineRows = field(default_factory=lambda: LineRows())
    printing: Mapping[str, Any] | None = None
    """What a print took (`jobs/printing.py`); None of programs without E words."""
    coating: Mapping[str, Any] | None = None
    """What was sprayed (`jobs/coating.py`); None where no gun was on."""
    path_accuracy: Mapping[str, Any] | None = None
    """How far the tip of an arm was off its path while it fed; None of machines that do not give way."""
    parts: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """What became of the parts of the cell (`jobs/grips.py`); empty where nothing moves any, or nothing was run."""
    columns: Sequence[Column] = ()
    """Columns of processes that stand in `tools` behind those that every run has."""
    sensors: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """What the sensors of the cell have read: how often, and a hash of the values."""
    channels: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    meetings: Mapping[str, Any] | None = None
    """Where several programs run at once: each by itself, and how they wait for each other."""
    target: TargetResult | None = None
    """The stock against the target of the cell; None without one, or where they could not be compared."""

    def as_json(self) -> dict[str, Any]:
        stopped = self.stopped_at
        value = {
            "schema": SCHEMA,
            "status": self.status,
            "stopped_at": None if stopped is None else {"file": stopped.file, "line": stopped.line},
            "inputs": dict(self.inputs),
            "findings": [as_json(finding) for finding in self.findings],
            "time": self.times.as_json(),
            "distance": {
                "feed_mm": rounded(self.feed_distance / MM),
                "rapid_mm": rounded(self.rapid_distance / MM),
            },
            "stocks": {name: stock.as_json() for name, stock in self.stocks.items()},
            "tools": list(self.tools),
            "operations": list(self.operations),
            "joints": list(self.joints),
            "not_simulated": list(self.not_simulated),
        }
        if self.probings:
            value["probings"] = [probing.as_json() for probing in self.probings]
        if self.sensors:
            value["sensors"] = {name: dict(sensor) for name, sensor in self.sensors.items()}
        if self.parts:
            value["parts"] = {name: dict(part) for name, part in self.parts.items()}
        if self.channels:
            value["channels"] = {name: dict(channel) for name, channel in self.channels.items()}
            value["meetings"] = dict(self.meetings or {})
        if self.coating is not None:
            value["coating"] = dict(self.coating)
        if self.printing is not None:
            value["printing"] = dict(self.printing)
        if self.target is not None:
            value["target"] = self.target.as_json()
        if self.path_accuracy is not None:
            value["path_accuracy"] = dict(self.path_accuracy)
        cleaned: dict[str, Any] = clean(value)
        return cleaned

    def text(self) -> str:
        """The file `results.json`: one value per line in the parts that people read."""
        return json.dumps(self.as_json(), ensure_ascii=False, allow_nan=False, indent=1) + "\n"

    def lines_csv(self) -> str:
        """The file `lines.csv`: one program line a row."""
        return self.lines.csv()


Ints = np.ndarray[Any, np.dtype[np.int64]]
LineEnd = tuple[int, Span, float]
"""The machine stands: before which path row, for which program line, how long [s]."""


@frozen(eq=False)
class LineRows:
    """Program lines (m,) in the order in which they first ran: which of the `files`, line number, and `numbers` (m, k).

    These are time [s], distance [mm], mean feed [mm/min], removed volume [mm³], greatest force [N], then least speed
    [mm/min], share of the time at the programmed feed, and the columns of processes, under `more` names.
    `channels` names that of each line where several programs run at once.
    """

    files: Sequence[str] = ()
    file: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    line: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    numbers: Array = field(default_factory=lambda: np.zeros((0, 5)))
    more: Sequence[str] = ()
    channels: Sequence[str] = ()

    def csv(self) -> str:
        """A text with a head; numbers have six digits."""
        known = ("file", "line", "time_s", "distance_mm", "feed_mm_min", "removed_mm3", "max_force_N")
        own = ("channel",) if self.channels else ()
        head = ",".join((*known, *self.more, *own))
        names = [_quoted(table_text(name)) for name in self.files]
        columns = (_six_digits(column) for column in self.numbers.T)
        more = ([_quoted(table_text(name)) for name in self.channels],) if self.channels else ()
        rows = zip((names[i] for i in self.file.tolist()), map(str, self.line.tolist()), *columns, *more, strict=True)
        return "\n".join([head, *map(",".join, rows), ""])


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\n\r') else text


_LEAST_PLAIN: Final = 1.01e-4
_MOST_PLAIN: Final = 0.99e6
"""Between these sizes six significant digits are written without a power of ten, by "%g" and in JSON alike."""


def _six_digits(values: Array) -> list[str]:
    """Numbers (m,) as text with six significant digits, written as in JSON."""
    if not values.any():
        return ["0"] * len(values)
    given = (values + 0.0).tolist()  # + 0.0 turns -0.0 into 0.0
    texts = ("%.6g " * len(given) % tuple(given)).split()
    size = np.abs(values)
    plain = (values == 0.0) | ((size > _LEAST_PLAIN) & (size < _MOST_PLAIN))
    for i in np.flatnonzero(~plain).tolist():  # with a power of ten, or no number
        texts[i] = str(clean(rounded(given[i], 6)))
    return texts


def line_rows(
    path: ToolPath,
    time: Array,
    distance: Array,
    totals: RowTotals | None,
    stands: Sequence[LineEnd] = (),
    ran: int | None = None,
    columns: Sequence[Column] = (),
    paces: RowPaces | None = None,
) -> LineRows:
    """One row a program line: file, line, time, distance, mean feed, removed volume, greatest force, least speed and

    share of the time at the programmed feed where `paces` are known, then `columns`.

    `time` [s] and `distance` [m] are those of each path row; a loop's passes are
    added up. The time of a line includes its dwells and tool changes, the mean feed does not.
    Where only the first `ran` path rows were reached, later lines are left out.
    """
    files, file, line, index, standing = _lines_of(path, stands)
    count = len(line)
    moving: Array = np.bincount(index, weights=time, minlength=count).astype(float)
    still = np.bincount(standing, weights=[seconds for _, _, seconds in stands], minlength=count)
    metres = np.bincount(index, weights=distance, minlength=count)
    removed: Array = np.zeros(count)
    force: Array = np.zeros(count)
    if totals is not None and len(path):
        removed += np.bincount(index, weights=totals["removed"] - totals["added"], minlength=count)
        np.maximum.at(force, index, totals["force"])
    speed = np.divide(metres, moving, out=np.zeros(count), where=moving > 0.0)
    reached = np.zeros(count, dtype=bool)
    reached[index[:ran]] = reached[standing] = True
    own = [_by_group(column, totals, index[:ran], count) / column.divisor for column in columns]
    if paces is not None:
        own = [*_paces_of(paces, time, index, moving), *own]
    numbers = np.stack([moving + still, metres / MM, speed / MM_PER_MINUTE, removed / MM3, force, *own], axis=1)
    return LineRows(
        files=files,
        file=file[reached],
        line=line[reached],
        numbers=numbers[reached],
        more=[*(PACES if paces is not None else ()), *(column.key for column in columns)],
    )


def _paces_of(paces: RowPaces, time: Array, index: Ints, moving: Array) -> tuple[Array, Array]:
    """Least speed [mm/min] of lines and the share of their moving time (m,) [s] at the programmed feed."""
    ran = time > 0.0
    least = np.full(len(moving), np.inf)
    np.minimum.at(least, index[ran], paces.least[ran])
    reached: Array = np.bincount(index, weights=np.minimum(paces.at_feed, time), minlength=len(moving)).astype(float)
    share = np.divide(reached, moving, out=np.zeros(len(moving)), where=moving > 0.0)
    return np.where(np.isfinite(least), least, 0.0) / MM_PER_MINUTE, share


def _by_group(column: Column, totals: RowTotals | None, group: Ints, count: int) -> Array:
    """One value (count,) for each group of path rows; these belong to `group` (r,), in the order in which they ran."""
    values: Array = np.zeros(count)
    if totals is None or not len(group):
        return values
    rows = totals[column.name][: len(group)]
    if column.of == "greatest":
        np.maximum.at(values, group, rows)
    elif column.of == "last":
        values[group] = rows
    else:
        np.add.at(values, group, rows)
    return values


def _lines_of(path: ToolPath, stands: Sequence[LineEnd]) -> tuple[list[str], Ints, Ints, Ints, Ints]:
    """The lines in the order in which they first ran: names of files, which of them, line numbers; and the index of the

    line of each path row and of each stand.
    """
    spans = SpanTable.of(path.spans)
    known, of_span = spans.files()
    resting = [(known.setdefault(span.file, len(known)), span.line) for _, span, _ in stands]
    file, line = np.array(resting, dtype=np.int64).reshape(-1, 2).T
    rows = path.source if len(path) else np.zeros(0, dtype=np.int64)
    file, line = np.append(of_span[rows], file), np.append(spans.lines[rows].astype(np.int64), line)
    when = np.append(2 * np.arange(len(rows)) + 1, np.array([2 * row for row, _, _ in stands], dtype=np.int64))
    order = np.argsort(when, kind="stable")
    _, first, which = np.unique((file << 32 | line)[order], return_index=True, return_inverse=True)
    by_time = np.argsort(first)
    rank = np.empty(len(first), dtype=np.int64)
    rank[by_time] = np.arange(len(first))
    index = np.empty(len(order), dtype=np.int64)
    index[order] = rank[which]
    shown = order[first[by_time]]
    return list(known), file[shown], line[shown], index[: len(rows)], index[len(rows) :]


def tool_rows(
    path: ToolPath,
    names: Mapping[int, str],
    time: Array,
    distance: Array,
    totals: RowTotals | None,
    columns: Sequence[Column] = (),
    figures: Callable[[NDArray[np.bool_]], Mapping[str, Any]] | None = None,
) -> list[dict[str, Any]]:
    """One entry a tool that was in the spindle while something moved; `time` [s] and `distance` [m] of path rows.

    `figures` has more of rows (n,). Its last keys are those of `columns`.
    """
    if not len(path):
        return []
    numbers = np.array([state.tool for state in path.states], dtype=np.int64)[path.state]
    feeds = (path.kind != RAPID) & (path.kind != HOME)
    entries = []
    for number in sorted(set(numbers.tolist())):
        mine = numbers == number
        if number == 0 and not (mine & feeds).any():
            continue
        entry: dict[str, Any] = {
            "number": int(number),
            "name": names.get(int(number), f"T{number}"),
            "time_s": rounded(float(time[mine].sum())),
            "feed_mm": rounded(float(distance[mine & feeds].sum() / MM)),
            **({} if figures is None else figures(mine)),
        }
        here = np.flatnonzero(mine)
        for column in _OF_TOOLS:
            entry[column.key] = _of_rows(column, totals, here)
        force = np.zeros(1) if totals is None else totals["force"][mine]
        strongest = here[int(force.argmax())] if force.max(initial=0.0) > 0.0 else None
        entry["line_of_max_force"] = None if strongest is None else path.span(int(strongest)).line
        for column in columns:
            entry[column.key] = _of_rows(column, totals, here)
        entries.append(entry)
    return entries


_OF_TOOLS: Final = (REMOVED, FORCE, TORQUE, POWER)


def _of_rows(column: Column, totals: RowTotals | None, rows: NDArray[np.intp]) -> float:
    """One value of path rows (r,), in the unit of the file."""
    if totals is None or not len(rows):
        return 0.0
    values = totals[column.name][rows]
    if column.of == "greatest":
        value = float(values.max())
    elif column.of == "last":
        value = float(values[-1])
    else:
        value = float(values.sum())
    return rounded(value / column.divisor)


def joint_rows(names: Iterable[str], joints: Joints, totals: JointTotals, path: ToolPath) -> list[dict[str, Any]]:
    """One entry for each joint: travel, least margin and its line, greatest speed, acceleration and effort."""
    entries = []
    for i, name in enumerate(names):
        revolute = joints.kinds[i] == "revolute"
        unit = DEG if revolute else MM
        below, above = totals.least[i] - joints.lower[i], joints.upper[i] - totals.most[i]
        margin = min(below, above)
        row = int(totals.least_row[i] if below <= above else totals.most_row[i])
        line = path.span(row).line if 0 <= row < len(path) else None
        entries.append(
            {
                "name": name,
                "unit": "deg" if revolute else "mm",
                "least": rounded(float(totals.least[i] / unit)),
                "most": rounded(float(totals.most[i] / unit)),
                "margin": rounded(float(margin / unit)) if np.isfinite(margin) else None,
                "line_of_margin": line if np.isfinite(margin) else None,
                "max_speed": rounded(float(totals.speed[i] / unit)) if totals.told else None,
                "max_acceleration": rounded(float(totals.acceleration[i] / unit)) if totals.told else None,
                "max_effort": rounded(float(totals.effort[i])) if totals.told else None,
            }
        )
    return entries
