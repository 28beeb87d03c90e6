"""Motors at their limit: the motion or the process needs more than a joint can deliver."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks import Spans
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array
from gcodesim.kinematics.chain import JointKind


def saturation_findings(
    names: Sequence[str],
    kinds: Sequence[JointKind],
    *,
    limit: Array,
    effort: Array,
    first_row: NDArray[np.int64],
    steps: NDArray[np.int64],
    dt: float,
    spans: Spans,
    starts: Array,
) -> list[Diagnostic]:
    """One finding GS230 for each joint that was at its effort limit.

    Columns (j,): `limit` and greatest `effort` [N·m, N], `first_row` of the path
    at which it happened (-1: never), `steps` for how long, each `dt` [s];
    `starts` [s] tells when each path row begins.
    """
    found = []
    for joint, name in enumerate(names):
        if first_row[joint] < 0:
            continue
        unit = "N" if kinds[joint] == "prismatic" else "N·m"
        needed, allowed = abs(float(effort[joint])), float(limit[joint])
        # a world with motors stops at the limit, one without them says what effort would have been needed
        what = f"{needed:.1f} {unit} would be needed" if needed > allowed * (1.0 + 1e-6) else "more would be needed"
        found.append(
            Diagnostic(
                code="GS230",
                message=f"{name} is at its limit of {allowed:.1f} {unit}, {what}, for {float(steps[joint]) * dt:.3f} s",
                span=spans(int(first_row[joint])),
                time=float(starts[first_row[joint]]),
                hint="cut less deep or slower, hold the tool closer to the robot, or use a stronger one",
                value=needed,
                limit=allowed,
                unit=unit,
            )
        )
    return found
