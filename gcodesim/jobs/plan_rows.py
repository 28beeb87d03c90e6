"""What checks of a run ask of the rows of its plan."""

from __future__ import annotations

from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import dots
from gcodesim.canon import AXIS_LETTERS, Dwell, ToolChange
from gcodesim.cell.signal_values import value_after
from gcodesim.diagnostics import Span
from gcodesim.diagnostics.events import Flags
from gcodesim.executor.tasks import RowColumns
from gcodesim.processes.gripping import Gripping
from gcodesim.processes.rows import Rows
from gcodesim.processes.signal import SPINDLE
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.planning import Plan
    from gcodesim.tools.tool import Tool


class PlanRows:
    """The rows of a plan as checks see them, each part worked out when somebody asks for it.

    The plan of a session grows with each of its legs, and nothing may ask before its end.
    """

    def __init__(self, plan: Plan, shop: Shop) -> None:
        self._plan, self._shop = plan, shop

    def span(self, row: int) -> Span:
        """Where a row comes from; the cell's name for one that there is not."""
        path = self._plan.path
        return path.span(row) if 0 <= row < len(path) else Span(self._shop.cell.name)

    @cached_property
    def turns(self) -> dict[str, Flags]:
        """Rows (n,) in which a rotary axis turns whose place the cell does not give, by its letter."""
        return _blind_turns(self._plan, self._shop)

    @cached_property
    def shape(self) -> Rows:
        """The rows for processes to judge, without columns."""
        plan, shop = self._plan, self._shop
        rows = RowColumns.of(plan.path, shop)
        spindle = rows.signals[SPINDLE.name]
        setting = np.cumsum(np.diff(rows.tool, prepend=rows.tool[:1]) != 0)
        setting = setting + np.cumsum(np.diff(spindle, prepend=spindle[:1]) != 0.0)
        return Rows(
            rapid=rows.rapid,
            tool=rows.tool,
            setting=setting.astype(np.int64),
            changed=np.diff(rows.tool, prepend=-1) != 0,
            retreat=_straight_up(plan, shop),
            time=plan.trajectory.row_start if len(plan.path) else np.zeros(1),
            columns={},
            span=self.span,
            with_word=cache(lambda words: _rows_of(plan, words)),
            tools=shop.cell.tools,
            turns=self.turns,
            change_spans={
                timed.row: timed.event.span for timed in plan.path.events if isinstance(timed.event, ToolChange)
            },
            stay_spans=_stay_spans(plan),
            grain=_grain(shop),
        )

    @cached_property
    def switches(self) -> list[tuple[float, Span]]:
        """Words that tell a gripper something, with their times [s]."""
        return [
            (each.time, each.event.span)
            for each in self._plan.trajectory.events
            if any(value_after(each.event, signal, self._shop.signal_sources) is not None for signal in Gripping.reads)
        ]

    @cached_property
    def kinds(self) -> dict[str, Flags]:
        """Rows (n,) whose tool does a kind of process, by that kind."""
        shop, tool = self._shop, self.shape.tool
        return {
            kind: np.isin(tool, [n for n, each in shop.cell.tools.items() if _does(shop, kind, each)])
            for kind in shop.sheet.kinds[1:]
        }


def _does(shop: Shop, kind: str, tool: Tool) -> bool:
    """Whether a tool may carry out this kind of process: on a lathe any turns, drills as well."""
    return kind in tool.acts_by or (kind == "turning" and shop.mover.lathe)


def _rows_of(plan: Plan, words: frozenset[str]) -> Flags:
    """Rows (n,) whose motion word is one of `words`."""
    path = plan.path
    if not len(path):
        return np.zeros(1, dtype=np.bool_)
    return np.array([state.word in words for state in path.states], dtype=np.bool_)[path.state]


def _straight_up(plan: Plan, shop: Shop) -> Flags:
    """Rows (n,) along the spindle's axis away from the work, as out of a hole: the tool has been down there already."""
    path = plan.path
    up = np.zeros(max(len(path), 1), dtype=np.bool_)
    retreat = shop.mover.retreat
    if len(path) and retreat is not None:
        way = path.end - path.start
        along = dots(way[:, :3], retreat)
        way[:, :3] -= along[:, None] * retreat
        up[:] = (along > 0.0) & (np.abs(way).max(axis=1) < 1e-9)
    return up


def _stay_spans(plan: Plan) -> dict[int, Span]:
    """Where the program asks for the stay before a row: filament that comes out there, else a dwell."""
    trajectory = plan.trajectory
    stays = None if trajectory.filament is None else trajectory.filament.stays
    spans: dict[int, Span] = {}
    for k, timed in enumerate(trajectory.events):
        if isinstance(timed.event, Dwell) if stays is None else stays[k] > 0.0:
            spans.setdefault(min(timed.row, max(len(plan.path) - 1, 0)), timed.event.span)
    return spans


def _grain(shop: Shop) -> float:
    """Volume [m³] of a cell of the coarsest stock."""
    cells = (placed.stock.spacing for placed in shop.stocks.values())
    return max((float(dx * dy * max(dx, dy)) for dx, dy in cells), default=0.0)


def _blind_turns(plan: Plan, shop: Shop) -> dict[str, Flags]:
    """Rows (n,) in which a rotary axis turns whose place the cell does not give, by its letter; only axes that turn."""
    start, end = plan.path.start, plan.path.end
    columns = {letter: AXIS_LETTERS.index(letter) for letter in shop.mover.timed_only} if len(plan.path) else {}
    turns = {letter: start[:, column] != end[:, column] for letter, column in columns.items()}
    return {letter: rows for letter, rows in turns.items() if rows.any()}
