"""What a program does by operation: from one tool change, or one comment that stands alone, to the next."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import ToolChange
from gcodesim.diagnostics import Span
from gcodesim.diagnostics.line_table import LineTable
from gcodesim.diagnostics.span_table import SpanTable
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.jobs.paces import RowPaces
from gcodesim.motion.tool_path import HOME, RAPID, ToolPath
from gcodesim.numbers import rounded
from gcodesim.units import MM, MM3, MM_PER_MINUTE

_ALONE: Final = re.compile(r"\s*/?\s*(?:[Nn]\d+\s*)?(?:\(([^()]*)\)|;(.*))\s*")
_NO_NAME: Final = re.compile(r"\s*(?:finish|end|msg|debug|print|log|expect|probe)", re.IGNORECASE)
"""Comments that end an operation, or that a control or gcodesim acts upon."""
_SAID: Final = re.compile(r".*\boperation\s*[:=]\s*(.+)", re.IGNORECASE)


@frozen(eq=False)
class RowTimes:
    """What is known of the rows of a path (n,): `time` [s], `distance` [m] and paces; and where the machine stood.

    `engaged` [s]: how long the tool acted on something; `removed` [m³]; None where nothing was cut, as in a check.
    """

    time: Array
    distance: Array
    paces: RowPaces
    stands: Sequence[tuple[int, Span, float]]
    engaged: Array | None = None
    removed: Array | None = None


class Operations(NamedTuple):
    """Which operation each row of a path is of: `number` (n,) counts up from 0; `names` of each, empty if none."""

    number: NDArray[np.int64]
    names: Sequence[str]

    def name_of(self, row: int, tools: Mapping[int, str], tool: int) -> str:
        """How the operation of a row is called: as its comment says, or as its tool."""
        return self.names[int(self.number[row])] or tools.get(tool, f"T{tool}")


def pace_figures(rows: NDArray[np.bool_], path: ToolPath, known: RowTimes) -> dict[str, Any]:
    """How the feed moves among these rows (n,) ran: mean and least speed, share of the time at the programmed feed.

    And the share of the time in which the tool was in the air.
    """
    feeds = (path.kind != RAPID) & (path.kind != HOME)
    fed, ran = rows & feeds, known.time > 0.0
    seconds, metres = float(known.time[fed].sum()), float(known.distance[fed].sum())
    least = known.paces.least[fed & ran]
    reached = float(np.minimum(known.paces.at_feed, known.time)[fed].sum())
    return {
        "mean_feed_mm_min": rounded(metres / seconds / MM_PER_MINUTE if seconds else 0.0),
        "least_feed_mm_min": rounded(float(least.min()) / MM_PER_MINUTE if len(least) else 0.0),
        "share_at_feed": rounded(reached / seconds if seconds else 0.0),
        "air_share": None if known.engaged is None else _air_share(known.time[fed], known.engaged[fed]),
    }


def _air_share(time: Array, engaged: Array) -> float:
    whole = float(time.sum())
    return rounded(1.0 - float(np.minimum(engaged, time).sum()) / whole if whole else 0.0)


def operations_of(path: ToolPath, file: str, lines: LineTable) -> Operations:
    """The operations of a path, in the order of the run; `lines` are those of `file`.

    An operation begins where a tool is changed or a comment stands alone in the program, if something was fed since
    the one before. Its name is the last comment that says `operation: NAME`, else the last.
    """
    starts = _merged(_heads(path, file, lines), path) if len(path) else {}
    number = np.zeros(len(path), dtype=np.int64)
    number[list(starts)[1:]] = 1
    return Operations(np.cumsum(number), tuple(starts.values()))


def operation_rows(
    path: ToolPath, file: str, lines: LineTable, names: Mapping[int, str], known: RowTimes
) -> list[dict[str, Any]]:
    """One entry an operation that feeds, in the order of the run: name, tool, lines, time, volume and paces."""
    if not len(path):
        return []
    operations = operations_of(path, file, lines)
    feeds = (path.kind != RAPID) & (path.kind != HOME)
    stood = np.zeros(len(operations.names))
    for row, _, seconds in known.stands:
        stood[operations.number[min(row, len(path) - 1)]] += seconds
    entries = []
    for index in range(len(operations.names)):
        rows = operations.number == index
        if not (rows & feeds).any():
            continue
        fed = np.flatnonzero(rows & feeds)
        tool = path.state_of(int(fed[0])).tool
        spans = [path.span(int(row)) for row in (np.flatnonzero(rows)[0], np.flatnonzero(rows)[-1])]
        entries.append(
            {
                "name": operations.name_of(int(fed[0]), names, tool),
                "tool": int(tool),
                "first_line": spans[0].line,
                "last_line": spans[1].line,
                "time_s": rounded(float(known.time[rows].sum()) + float(stood[index])),
                "feed_mm": rounded(float(known.distance[rows & feeds].sum()) / MM),
                "rapid_mm": rounded(float(known.distance[rows & ~feeds].sum()) / MM),
                "removed_mm3": rounded(0.0 if known.removed is None else float(known.removed[rows].sum()) / MM3),
                **pace_figures(rows, path, known),
            }
        )
    return entries


class OperationName(NamedTuple):
    """How an operation is called; `said`: its comment calls itself one."""

    text: str = ""
    said: bool = False

    def or_later(self, other: OperationName) -> OperationName:
        """Which of two counts, of which `other` comes later."""
        return other if other.text and other.said >= self.said else self


def _name_of(line: str) -> OperationName:
    """The name that a line gives: a comment that stands alone."""
    match = _ALONE.fullmatch(line)
    text = "" if match is None else (match[1] or match[2] or "").strip()
    if not text or _NO_NAME.match(text):
        return OperationName()
    said = _SAID.fullmatch(text)
    return OperationName(text) if said is None else OperationName(said[1].strip(), said=True)


def _heads(path: ToolPath, file: str, lines: LineTable) -> dict[int, OperationName]:
    """Rows before which an operation may begin, in order, each with its name or none."""
    spans = SpanTable.of(path.spans)
    comments = {index + 1: name for index in lines.with_any(b"(;") if (name := _name_of(lines[index])).text}
    heads = {e.row: OperationName() for e in path.events if isinstance(e.event, ToolChange) and e.row < len(path)}
    places = np.array(sorted(comments), dtype=np.int64)
    files, number = spans.files()
    own = (number == files.get(file, -1))[path.source]
    at = spans.lines.astype(np.int64)[path.source]
    rows = np.flatnonzero(own)
    passed = np.searchsorted(places, at[rows])
    before = np.concatenate([[0], passed[:-1]])
    for k in np.flatnonzero(passed > before):
        row = int(rows[k])
        for place in places[before[k] : passed[k]]:
            heads[row] = heads.get(row, OperationName()).or_later(comments[int(place)])
    return dict(sorted(heads.items()))


def _merged(heads: Mapping[int, OperationName], path: ToolPath) -> dict[int, str]:
    """The same without those before which nothing was fed since the one before."""
    feeds = np.concatenate([[0], np.cumsum((path.kind != RAPID) & (path.kind != HOME))])
    starts = {0: OperationName()}
    for row, name in heads.items():
        last = next(reversed(starts))
        if feeds[row] > feeds[last]:
            starts[row] = name
        else:
            starts[last] = starts[last].or_later(name)
    return {row: name.text for row, name in starts.items()}
