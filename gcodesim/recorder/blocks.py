"""Program blocks in the order in which they run, as the log shows them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import Action, Event, OptionalStop, Stop, ToolChange
from gcodesim.canon import Output as OutputEvent
from gcodesim.cell.placing import SYSTEMS
from gcodesim.log import BlockColumns, Output, ProgramState
from gcodesim.recorder.ways import Ways

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gcodesim.diagnostics import SourceText
    from gcodesim.motion.trajectory import TimedEvent
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop

Ints = NDArray[np.int64]


class _Entry(NamedTuple):
    """A block that begins: when, in which order, its first path row or, without motion, its first event (else −1)."""

    t_ns: int
    order: int
    row: int = -1
    event: int = -1
    state: str = "running"


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """m blocks as the log tells of them, in the order of their begin."""

    columns: BlockColumns

    @staticmethod
    def of(plan: Plan, shop: Shop, sources: Mapping[str, SourceText], ways: Ways, frame: str = "world") -> Blocks:
        """One entry a block that moves, and one for each event of a block that does not; ways are drawn in `frame`."""
        path, trajectory = plan.path, plan.trajectory
        starts = trajectory.row_ns[0]
        first = np.flatnonzero(np.diff(path.block, prepend=-1) != 0) if len(path) else np.zeros(0, dtype=np.int64)
        entries = [_Entry(int(starts[row]), 2 * int(row) + 1, row=int(row)) for row in first]
        moving = {(path.span(int(row)).file, path.span(int(row)).line, int(starts[row])) for row in first}
        last = (-1, "", -1)
        for i, timed in enumerate(trajectory.events):
            span, t_ns = timed.event.span, round(timed.time * 1e9)
            here = (t_ns, span.file, span.line)
            if here == last and _rests(timed):  # as T1 M6: the block is known, and stands still
                entries[-1] = entries[-1]._replace(state=_state(timed))
            elif span.line and here != last and (span.file, span.line, t_ns) not in moving:
                entries.append(_Entry(t_ns, 2 * timed.row, event=i, state=_state(timed)))
                last = here
        entries.sort()
        return Blocks(_columns(entries, plan, shop, sources, ways, frame))

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of all outputs that the program sets."""
        return tuple(sorted({output.name for modal in self.columns.modals for output in modal.outputs}))

    def between(self, first_ns: int, end_ns: int) -> BlockColumns:
        """The blocks that begin at `first_ns` or later, before `end_ns`."""
        c = self.columns
        a, b = np.searchsorted(c.t_ns, [first_ns, end_ns])
        starts = c.point_starts[a : b + 1]
        return BlockColumns(
            t_ns=c.t_ns[a:b],
            line=c.line[a:b],
            block=c.block[a:b],
            text=c.text[a:b],
            modal=c.modal[a:b],
            modals=c.modals,
            points=c.points[starts[0] : starts[-1]] if len(starts) else c.points[:0],
            point_starts=starts - (starts[0] if len(starts) else 0),
            frame=c.frame,
        )


def _rests(timed: TimedEvent) -> bool:
    """Whether the machine stands still for an event, or would until somebody presses a button."""
    return timed.duration > 0.0 or isinstance(timed.event, (Stop, OptionalStop))


def _state(timed: TimedEvent) -> str:
    """What `/program` calls the state that an event brings."""
    if not _rests(timed):
        return "running"
    return "toolchange" if isinstance(timed.event, ToolChange) else "paused"


class _Outputs:
    """The outputs that the program has set, from event to event."""

    def __init__(self, plan: Plan) -> None:
        switches = ((timed, _switched(timed.event)) for timed in plan.trajectory.events)
        self._events = [((round(timed.time * 1e9), 2 * timed.row), to) for timed, to in switches if to is not None]
        self._next = 0
        self._now: dict[str, Output] = {}
        self.shown: tuple[Output, ...] = ()

    def at(self, entry: _Entry) -> tuple[Output, ...]:
        """Those in force once the block of `entry` has begun; entries come in their order."""
        before = self._next
        while self._next < len(self._events) and self._events[self._next][0] <= entry[:2]:
            output = self._events[self._next][1]
            self._now[output.name] = output
            self._next += 1
        if self._next > before:
            self.shown = tuple(self._now[name] for name in sorted(self._now))
        return self.shown


def _switched(event: Event) -> Output | None:
    if isinstance(event, OutputEvent):
        return Output(f"{event.type} {event.index}", event.value)
    if isinstance(event, Action):
        return Output(event.target, verb=event.verb)
    return None


def _columns(
    entries: list[_Entry],
    plan: Plan,
    shop: Shop,
    sources: Mapping[str, SourceText],
    ways: Ways,
    frame: str,
) -> BlockColumns:
    path = plan.path
    modals: dict[tuple[object, ...], int] = {}
    states: list[ProgramState] = []
    lines, texts, modal, spans = [], [], [], []
    point_starts, pieces = [0], []
    block_end = np.flatnonzero(np.diff(path.block, append=-1) != 0) if len(path) else np.zeros(0, dtype=np.int64)
    outputs = _Outputs(plan)
    for number, entry in enumerate(entries):
        row, order = entry.row, entry.order
        at = row if row >= 0 else min(order // 2, len(path) - 1)
        span = path.span(row) if row >= 0 else plan.trajectory.events[entry.event].event.span
        state = path.states[path.state[at]] if at >= 0 else path.states[0]
        feed = float(path.feed[row]) if row >= 0 and np.isfinite(path.feed[row]) else 0.0
        word = state.word if row >= 0 else ""
        switched = outputs.at(entry)
        coolant = (state.flood, state.mist)
        key = (span.file, word, state.tool, state.system, feed, state.spindle, entry.state, coolant, switched)
        if key not in modals:
            modals[key] = len(states)
            tool = shop.tool(state.tool)
            states.append(
                ProgramState(
                    file=span.file,
                    motion=word,
                    tool=state.tool,
                    tool_name=tool.name if tool is not None else "",
                    wcs=SYSTEMS[state.system - 1],
                    feed=feed,
                    spindle=state.spindle,
                    state=entry.state,
                    flood=state.flood,
                    mist=state.mist,
                    outputs=switched,
                )
            )
        source = sources.get(span.file)
        lines.append(span.line)
        texts.append(source.line(span.line).strip() if source is not None else "")
        modal.append(modals[key])
        spans.append(number)
        if row >= 0:
            end = int(block_end[np.searchsorted(block_end, row)]) + 1
            pieces.append(ways.points[ways.starts[row] : ways.starts[end]])
        point_starts.append(point_starts[-1] + (len(pieces[-1]) if row >= 0 else 0))
    return BlockColumns(
        t_ns=np.array([entry.t_ns for entry in entries], dtype=np.int64),
        line=np.array(lines, dtype=np.int64),
        block=np.array(spans, dtype=np.int64),
        text=texts,
        modal=np.array(modal, dtype=np.int64),
        modals=states or [ProgramState()],
        points=np.concatenate(pieces) if pieces else np.zeros((0, 3)),
        point_starts=np.array(point_starts, dtype=np.int64),
        frame=frame,
    )
