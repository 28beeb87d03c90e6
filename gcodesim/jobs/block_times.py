"""When each block of a program that takes time or waits was executed."""

from __future__ import annotations

from typing import Any

import numpy as np

from gcodesim.canon import Action, ToolAwaited
from gcodesim.jobs.marks import name_of
from gcodesim.motion.trajectory import Trajectory
from gcodesim.numbers import rounded
from gcodesim.planning.marks import is_mark, is_wait


def block_times(trajectory: Trajectory, *, unended: bool) -> list[dict[str, Any]]:
    """Blocks in the order of execution, as in the JSON of a check; `unended`: the last mark is never passed."""
    path = trajectory.path
    timed: list[tuple[int, int, dict[str, Any]]] = []
    start, end = trajectory.row_start, trajectory.row_end
    moved = np.flatnonzero(end > start)
    if len(moved):
        new = np.flatnonzero(np.diff(path.block[moved], prepend=path.block[moved[0]] - 1) != 0)
        first, last = moved[new], moved[np.append(new[1:], len(moved)) - 1]
        for a, b in zip(first.tolist(), last.tolist(), strict=True):
            span = path.span(a)
            timed.append((2 * a + 1, 0, _entry(span.file, span.line, float(start[a]), float(end[b]))))
    last = len(trajectory.events) - 1
    for index, timed_event in enumerate(trajectory.events):
        event = timed_event.event
        if timed_event.duration > 0.0 or is_mark(event) or (unended and index == last):
            entry = _entry(event.span.file, event.span.line, timed_event.time, timed_event.time + timed_event.duration)
            if isinstance(event, (Action, ToolAwaited)) and is_wait(event):
                entry["mark"] = name_of(event)
            timed.append((2 * timed_event.row, index, entry))
    timed.sort(key=lambda item: item[:2])
    blocks = [entry for _, _, entry in timed]
    if unended:
        blocks[-1]["end_s"] = None
    return blocks


def _entry(file: str, line: int, begin: float, end: float) -> dict[str, Any]:
    return {"file": file, "line": line, "begin_s": rounded(begin), "end_s": rounded(end)}
