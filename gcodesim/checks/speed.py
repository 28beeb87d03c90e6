"""Spindle speeds that the cell's spindle does not reach."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.diagnostics import Diagnostic
from gcodesim.units import RPM

if TYPE_CHECKING:
    from gcodesim.planning.plan import Plan


def speed_findings(plan: Plan, limit: float | None) -> list[Diagnostic]:
    """GS513 at the first row of the plan that needs more than `limit` [rad/s] of the spindle; None: unlimited."""
    path = plan.path
    if limit is None or not len(path):
        return []
    speed = np.abs([state.spindle for state in path.states])[path.state]
    fast = np.flatnonzero(speed > limit * (1.0 + 1e-9))
    if not len(fast):
        return []
    asked = float(speed[fast].max())
    return [
        Diagnostic(
            code="GS513",
            message=f"the program asks for {asked / RPM:.0f} rpm; the spindle turns {limit / RPM:.0f} rpm at most",
            span=path.span(int(fast[0])),
            hint="change `S`, or `spindle_speed` under `limits` of the cell",
            time=float(plan.trajectory.row_start[fast[0]]),
            value=asked / RPM,
            limit=limit / RPM,
            unit="rpm",
        )
    ]
