"""Program blocks in the order in which they run, as the log shows them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.cell.placing import SYSTEMS
from gcodesim.log import BlockColumns, ProgramState
from gcodesim.recorder.ways import Ways

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gcodesim.diagnostics import SourceText
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """m blocks: begin `t_ns`, first path row `row` (−1: a block without motion), and what the log says of each."""

    columns: BlockColumns

    @staticmethod
    def of(plan: Plan, shop: Shop, sources: Mapping[str, SourceText], ways: Ways) -> Blocks:
        """One entry a program block that moves, and one for each event of a block that does not."""
        path, trajectory = plan.path, plan.trajectory
        starts = trajectory.row_ns[0]
        first = np.flatnonzero(np.diff(path.block, prepend=-1) != 0) if len(path) else np.zeros(0, dtype=np.int64)
        entries: list[tuple[int, int, int, int]] = []  # time, order, row or −1, event or −1
        entries += [(int(starts[row]), 2 * int(row) + 1, int(row), -1) for row in first]
        moving = {(path.span(int(row)).file, path.span(int(row)).line, int(starts[row])) for row in first}
        last = (-1, "", -1)
        for i, timed in enumerate(trajectory.events):
            span, t_ns = timed.event.span, round(timed.time * 1e9)
            here = (t_ns, span.file, span.line)
            if span.line and here != last and (span.file, span.line, t_ns) not in moving:
                entries.append((t_ns, 2 * timed.row, -1, i))
                last = here
        entries.sort(key=lambda e: (e[0], e[1], e[3]))
        return Blocks(_columns(entries, plan, shop, sources, ways))

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


def _columns(
    entries: list[tuple[int, int, int, int]],
    plan: Plan,
    shop: Shop,
    sources: Mapping[str, SourceText],
    ways: Ways,
) -> BlockColumns:
    path = plan.path
    modals: dict[tuple[object, ...], int] = {}
    states: list[ProgramState] = []
    lines, texts, modal, spans = [], [], [], []
    point_starts, pieces = [0], []
    block_end = np.flatnonzero(np.diff(path.block, append=-1) != 0) if len(path) else np.zeros(0, dtype=np.int64)
    for number, (_, order, row, event) in enumerate(entries):
        at = row if row >= 0 else min(order // 2, len(path) - 1)
        span = path.span(row) if row >= 0 else plan.trajectory.events[event].event.span
        state = path.states[path.state[at]] if at >= 0 else path.states[0]
        feed = float(path.feed[row]) if row >= 0 and np.isfinite(path.feed[row]) else 0.0
        word = state.word if row >= 0 else ""
        key = (span.file, word, state.tool, state.system, feed, state.spindle)
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
        t_ns=np.array([entry[0] for entry in entries], dtype=np.int64),
        line=np.array(lines, dtype=np.int64),
        block=np.array(spans, dtype=np.int64),
        text=texts,
        modal=np.array(modal, dtype=np.int64),
        modals=states or [ProgramState()],
        points=np.concatenate(pieces) if pieces else np.zeros((0, 3)),
        point_starts=np.array(point_starts, dtype=np.int64),
    )
