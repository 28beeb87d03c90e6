"""M-codes that call actions in Python: what each is told, and what it answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.actions import ACTIONS, Moment, WordAction, Wrong
from gcodesim.arithmetic.matrices import multiplied
from gcodesim.canon import Action
from gcodesim.cell.channel import CALL
from gcodesim.diagnostics import Diagnostic

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop

_EARLY = 1e-9  # share of a step by which a time may be rounded


class Calls:
    """The calls of a channel, in the order of their times; each is done once."""

    def __init__(self, plan: Plan, shop: Shop, dt: float) -> None:
        self._shop, self._dt, self._done = shop, dt, 0
        self._actions: dict[str, WordAction] = {}
        self.follow(plan)

    def follow(self, plan: Plan) -> None:
        """Go on with a plan that has further legs."""
        self._plan = plan
        self._calls = [
            (max(int(-(-(timed.time / self._dt - _EARLY) // 1)) - 1, 0), timed.time, timed.event)
            for timed in plan.trajectory.events
            if isinstance(timed.event, Action) and timed.event.target == CALL
        ]

    def of(self, record: StepRecord) -> list[Diagnostic]:
        """What the calls in the steps of a record say."""
        found = []
        ticks = record.window.ticks
        while self._done < len(self._calls) and self._calls[self._done][0] < ticks[-1]:
            step, time, event = self._calls[self._done]
            self._done += 1
            found += self._call(record, max(int(np.searchsorted(ticks, step, side="right")) - 1, 0), time, event)
        return found

    def _call(self, record: StepRecord, k: int, time: float, event: Action) -> list[Diagnostic]:
        action = self._actions.get(event.verb)
        if action is None:
            action = self._actions[event.verb] = ACTIONS[event.verb]()
        said = action.act(self._moment(record, k, time, event))
        if not said:
            return []
        code = "GS581" if isinstance(said, Wrong) else "GS580"
        text = " ".join(str(said).split())
        return [Diagnostic(code=code, span=event.span, message=f"{event.verb}: {text}", time=time)]

    def _moment(self, record: StepRecord, k: int, time: float, event: Action) -> Moment:
        q = record.world.q[k]
        tip = self._plan.tip(q[None], record.window.row[k : k + 1])[0]
        tip[:3, 3] += record.deflection[k, :3]
        return Moment(
            time=time,
            line=event.span.line,
            m=event.m,
            p=event.p,
            q=event.q,
            tool=int(record.window.tool[k]),
            joints=dict(zip(self._shop.kinematics.joints.names, q.tolist(), strict=True)),
            X_WT=multiplied(self._shop.X_WB.matrix, tip),
            values={column.name: float(record[column.name][k]) for column in record.sheet.columns},
        )
