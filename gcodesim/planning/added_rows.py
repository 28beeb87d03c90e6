"""Rows that are put into a path where an arm drives to stands for a change of tools."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from gcodesim.canon import ToolAwaited, ToolReturned
from gcodesim.diagnostics.span_table import SpanTable, join
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import HOME, PathEvent, ToolPath, ToolState


@frozen
class AddedStop:
    """A move in joint space to `goal` (j,) with a tool; `changes`: a tool is taken, or set down, where it ends."""

    tool: int
    goal: Array
    changes: bool = False


@frozen
class Moments:
    """After how many of the added stops a change waits for the new tool, has made it, and gives the old one back."""

    awaited: int
    changed: int
    returned: int

    def spread(self, own: Sequence[PathEvent]) -> list[PathEvent]:
        """A change and its marks along the stops; what is given back is so before the next is waited for."""

        def at(noted: PathEvent) -> int:
            if isinstance(noted.event, ToolAwaited):
                return self.awaited
            return self.returned if isinstance(noted.event, ToolReturned) else self.changed

        moved = [replace(noted, row=noted.row + at(noted)) for noted in own]
        return sorted(moved, key=lambda each: (each.row, isinstance(each.event, ToolAwaited)))


@dataclass(slots=True)
class AddedRows:
    """Rows that are put into a path."""

    old: ToolPath
    goals: dict[int, Array] = field(default_factory=dict)
    _changes: list[tuple[PathEvent, Sequence[AddedStop], Moments]] = field(default_factory=list)

    def add(self, noted: PathEvent, stops: Sequence[AddedStop], moments: Moments) -> None:
        """Go to `stops` at a change."""
        self._changes.append((noted, stops, moments))

    def path(self) -> ToolPath:
        """The path with all rows; fills `goals`."""
        if not self._changes:
            return self.old
        path = self.old if len(self.old) else _standing(self.old)
        counts = [len(stops) for _, stops, _ in self._changes]
        before = np.repeat([noted.row for noted, _, _ in self._changes], counts)
        before = np.minimum(before, len(self.old))
        template = np.minimum(before, len(path) - 1)
        names = [f.name for f in fields(ToolPath) if f.name not in ("states", "spans", "events")]
        columns: dict[str, Any] = {}
        for name in names:
            column = getattr(path, name)
            own = column[: len(self.old)]
            columns[name] = np.insert(own, before, column[template], axis=0)
        at = before + np.arange(len(before))
        ahead = before < len(self.old)
        here = np.where(ahead[:, None], path.start[template], path.end[template])
        columns["start"][at] = columns["end"][at] = here
        columns["kind"][at], columns["feed"][at], columns["sweep"][at] = HOME, np.inf, 0.0
        columns["rotary_feed"][at], columns["stop"][at], columns["active"][at] = False, True, False
        columns["extrude"][at] = 0.0
        states = dict.fromkeys(path.states)
        stops = [stop for _, own, _ in self._changes for stop in own]
        for row, stop, old in zip(at.tolist(), stops, template.tolist(), strict=True):
            self.goals[row] = stop.goal
            state = replace(path.states[int(path.state[old])], tool=stop.tool)
            states.setdefault(state)
            columns["state"][row] = list(states).index(state)
        first = len(path.spans)
        columns["source"][at] = first + np.repeat(np.arange(len(counts)), counts)
        spans = [noted.event.span for noted, _, _ in self._changes]
        return replace(
            path,
            **columns,
            states=tuple(states),
            spans=join([SpanTable.of(path.spans), SpanTable.of(spans)]),
            events=tuple(self._moved()),
        )

    def _moved(self) -> Iterator[PathEvent]:
        """The events of the path, in their order."""
        added, events = 0, self.old.events
        waiting = list(self._changes)
        for own in _with_marks(events):
            now = [replace(noted, row=noted.row + added) for noted in own]
            if waiting and any(noted is waiting[0][0] for noted in own):
                _, stops, moments = waiting.pop(0)
                yield from moments.spread(now)
                added += len(stops)
            else:
                yield from now


def _with_marks(events: Sequence[PathEvent]) -> Iterator[list[PathEvent]]:
    """Events one by one, but a change together with what says when its tools are awaited and given back."""
    group: list[PathEvent] = []
    for noted in events:
        follows = bool(group) and (isinstance(group[-1].event, ToolAwaited) or isinstance(noted.event, ToolReturned))
        if group and not follows:
            yield group
            group = []
        group.append(noted)
    if group:
        yield group


def _standing(path: ToolPath) -> ToolPath:
    """A path without moves, as one row that does not move."""
    still = ToolPath.from_points(np.zeros((2, 3)))
    states = path.states or (ToolState(),)
    return replace(still, states=states, spans=path.spans or still.spans, events=path.events)
