"""Program blocks in the order in which they run, as the log shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import Action, Event, OptionalStop, Pause, Stop, ToolChange, Trip
from gcodesim.canon import Output as OutputEvent
from gcodesim.canon.systems import name_of_system
from gcodesim.cell.signal_values import SIGNAL
from gcodesim.diagnostics.span_table import SpanTable
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.log import BlockColumns, BlockMessages, OutputState, ProgramShown
from gcodesim.recorder.lines import texts_of
from gcodesim.recorder.ways import Ways

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gcodesim.diagnostics import SourceText
    from gcodesim.motion.tool_path import ToolPath, ToolState
    from gcodesim.motion.trajectory import TimedEvent
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop

Ints = NDArray[np.int64]

STATES: Final = ("running", "toolchange", "paused")
"""What `/program` calls the state of a block."""


class _Entries(NamedTuple):
    """Blocks (m,) as they begin: when, in which order, the first path row or, without motion, the first event (else −1)

    and which of the `STATES` that event brings.
    """

    t_ns: Ints
    order: Ints
    row: Ints
    event: Ints
    state: Ints


@frozen(kw_only=False, eq=False)
class Blocks:
    """m blocks as the log shows them, in the order in which they begin."""

    messages: BlockMessages

    @property
    def columns(self) -> BlockColumns:
        return self.messages.columns

    @staticmethod
    def of(plan: Plan, shop: Shop, sources: Mapping[str, SourceText], ways: Ways, frame: str = "world") -> Blocks:
        """One entry for each block that moves, and one for each event of a block that does not; drawn in `frame`."""
        return Blocks(BlockMessages(_columns(_entries(plan), plan, shop, sources, ways, frame)))

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of all outputs that the program sets."""
        return tuple(sorted({output.name for modal in self.columns.modals for output in modal.outputs}))

    def before(self, t_ns: int) -> int:
        """How many blocks begin before then."""
        return int(np.searchsorted(self.columns.t_ns, t_ns))


def _rests(timed: TimedEvent) -> bool:
    """Whether the machine stands still for an event, or would until somebody presses a button."""
    return timed.duration > 0.0 or isinstance(timed.event, (Stop, OptionalStop))


def _state(timed: TimedEvent) -> str:
    """What `/program` calls the state that an event brings."""
    if not _rests(timed):
        return "running"
    return "toolchange" if isinstance(timed.event, ToolChange) else "paused"


def _entries(plan: Plan) -> _Entries:
    """The blocks in the order in which they begin."""
    path, trajectory = plan.path, plan.trajectory
    first = _first_rows(path)
    starts = np.asarray(trajectory.row_ns[0], dtype=np.int64)[first]
    rests: list[tuple[int, int, int, int, int]] = []
    last = (-1, "", -1)
    for i, timed in enumerate(trajectory.events):
        if isinstance(timed.event, (Pause, Trip)):  # said by the run, not by a block
            continue
        span, t_ns = timed.event.span, round(timed.time * 1e9)
        here = (t_ns, span.file, span.line)
        if here == last and _rests(timed):  # such as T1 M6: the block is known, and the machine stands still
            rests[-1] = (*rests[-1][:4], STATES.index(_state(timed)))
        elif span.line and here != last and not _moves(path, first, starts, here):
            rests.append((t_ns, 2 * timed.row, -1, i, STATES.index(_state(timed))))
            last = here
    running = STATES.index("running")
    moving = (starts, 2 * first + 1, first, np.full(len(first), -1), np.full(len(first), running))
    still = np.array(rests, dtype=np.int64).reshape(-1, 5).T
    columns = [np.concatenate(both) for both in zip(moving, still, strict=True)]
    ranked = np.lexsort(columns[3::-1])
    return _Entries(*(column[ranked] for column in columns))


def _first_rows(path: ToolPath) -> Ints:
    """The row with which each block of a path begins."""
    return np.flatnonzero(np.diff(path.block, prepend=-1) != 0) if len(path) else np.zeros(0, dtype=np.int64)


def _moves(path: ToolPath, first: Ints, starts: Ints, here: tuple[int, str, int]) -> bool:
    """Whether one of the blocks that begin with rows `first` at `starts` has the time, file and line of `here`."""
    a, b = np.searchsorted(starts, [here[0], here[0] + 1])
    spans = (path.span(int(row)) for row in first[a:b])
    return any((span.file, span.line) == here[1:] for span in spans)


def _switches(plan: Plan, entries: _Entries) -> tuple[Ints, list[tuple[OutputState, ...]]]:
    """The states of all outputs, and which of them (m,) is in force once each block has begun."""
    switches = ((timed, _switched(timed.event)) for timed in plan.trajectory.events)
    events = [(round(timed.time * 1e9), 2 * timed.row, to) for timed, to in switches if to is not None]
    now: dict[str, OutputState] = {}
    shown: list[tuple[OutputState, ...]] = [()]
    for _, _, output in events:
        now[output.name] = output
        shown.append(tuple(now[name] for name in sorted(now)))
    t_ns = np.concatenate([[event[0] for event in events], entries.t_ns]).astype(np.int64)
    order = np.concatenate([[event[1] for event in events], entries.order]).astype(np.int64)
    is_block = np.arange(len(t_ns)) >= len(events)
    ranked = np.lexsort((is_block, order, t_ns))
    passed = np.cumsum(~is_block[ranked])
    count = np.empty(len(t_ns), dtype=np.int64)
    count[ranked] = passed
    return count[len(events) :], shown


def _switched(event: Event) -> OutputState | None:
    if isinstance(event, OutputEvent):
        return OutputState(f"{event.type} {event.index}", event.value)
    if isinstance(event, Action) and event.target == SIGNAL:
        return OutputState(event.verb, verb="default") if event.q is None else OutputState(event.verb, event.q)
    if isinstance(event, Action):
        return OutputState(event.target, verb=event.verb)
    return None


def _columns(
    entries: _Entries,
    plan: Plan,
    shop: Shop,
    sources: Mapping[str, SourceText],
    ways: Ways,
    frame: str,
) -> BlockColumns:
    path = plan.path
    names, file, line = _places(entries, plan)
    moving = entries.row >= 0
    at = np.where(moving, entries.row, np.minimum(entries.order // 2, len(path) - 1))
    state = np.where(at >= 0, path.state[np.maximum(at, 0)], 0) if len(path) else np.zeros(len(at), dtype=np.int64)
    feed = np.zeros(len(at))
    feed[moving] = path.feed[entries.row[moving]]
    feed[~np.isfinite(feed)] = 0.0
    switched, shown = _switches(plan, entries)
    keys = np.stack([file, moving, state, feed.view(np.int64), entries.state, switched], axis=1).astype(np.int64)
    which, first = _groups(keys)
    modals = [
        _modal(shop, path.states[state[i]], names[file[i]], moving[i], feed[i], STATES[entries.state[i]], shown[j])
        for i, j in zip(first.tolist(), switched[first].tolist(), strict=True)
    ]
    points, point_starts = _points(entries, path, ways)
    return BlockColumns(
        t_ns=entries.t_ns,
        line=line,
        block=np.arange(len(at), dtype=np.int64),
        text=texts_of(sources, names, file, line),
        modal=which,
        modals=modals or [ProgramShown()],
        points=points,
        point_starts=point_starts,
        frame=frame,
    )


def _places(entries: _Entries, plan: Plan) -> tuple[list[str], Ints, Ints]:
    """The files by name; file and line (m,) of each block."""
    spans = SpanTable.of(plan.path.spans)
    known, of_span = spans.files()
    file, line = np.zeros((2, len(entries.t_ns)), dtype=np.int64)
    moving = np.flatnonzero(entries.row >= 0)
    source = plan.path.source[entries.row[moving]]
    if len(moving):
        file[moving], line[moving] = of_span[source], spans.lines[source]
    for i in np.flatnonzero(entries.row < 0).tolist():
        span = plan.trajectory.events[entries.event[i]].event.span
        file[i], line[i] = known.setdefault(span.file, len(known)), span.line
    return list(known), file, line


def _groups(keys: Ints) -> tuple[Ints, Ints]:
    """Numbers (m,) of equal rows of `keys` (m, k), and the first row of each number."""
    ranked = np.lexsort(keys.T)
    fresh = (np.diff(keys[ranked], axis=0, prepend=keys[ranked[:1]] - 1) != 0).any(axis=1)
    which = np.empty(len(keys), dtype=np.int64)
    which[ranked] = np.cumsum(fresh) - 1
    return which, ranked[fresh]


def _modal(
    shop: Shop, state: ToolState, file: str, moving: bool, feed: float, word: str, outputs: tuple[OutputState, ...]
) -> ProgramShown:
    """What the blocks of one group share; `word` is their state."""
    tool = shop.tool(state.tool)
    return ProgramShown(
        file=file,
        motion=state.word if moving else "",
        tool=state.tool,
        tool_name=tool.name if tool is not None else "",
        wcs=name_of_system(state.system),
        feed=float(feed),
        spindle=state.spindle,
        state=word,
        flood=state.flood,
        mist=state.mist,
        outputs=outputs,
    )


def _points(entries: _Entries, path: ToolPath, ways: Ways) -> tuple[Array, Ints]:
    """The paths of all blocks, one after another, and where each begins (m + 1,)."""
    first = _first_rows(path)
    row = entries.row
    after = np.append(first[1:], len(path))[np.searchsorted(first, np.maximum(row, 0))] if len(first) else row
    begin = ways.starts[np.maximum(row, 0)]
    count = np.where(row >= 0, ways.starts[np.maximum(after, 0)] - begin, 0)
    starts = np.concatenate([[0], np.cumsum(count)])
    return ways.points[np.repeat(begin - starts[:-1], count) + np.arange(starts[-1])], starts
