"""Motors at their limit: the motion or the process needs more than a joint can deliver."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks import Spans
from gcodesim.checks.lasting import in_words
from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.frames import Array
from gcodesim.kinematics.chain import JointKind

EFFORT: Final = "GS230"

BRIEF: Final = 0.05
"""[s] at a time up to which a motor at its limit is a note."""


def saturation_findings(
    names: Sequence[str],
    kinds: Sequence[JointKind],
    *,
    limit: Array,
    effort: Array,
    first_row: NDArray[np.int64],
    seconds: Array,
    longest: Array,
    begin: Array,
    spans: Spans,
) -> list[Diagnostic]:
    """One finding GS230 for each joint that was at its effort limit.

    Columns (j,): `limit` and greatest `effort` [N·m, N], `first_row` of the path
    at which it happened (-1: never), for how long in all and at most at a time [s],
    and when it did so first, `begin` [s]. It is a note where motors were at
    their limit for moments only: the tip is where the run says, a little late.
    """
    found = []
    for joint, name in enumerate(names):
        if first_row[joint] < 0:
            continue
        unit = "N" if kinds[joint] == "prismatic" else "N·m"
        needed, allowed = abs(float(effort[joint])), float(limit[joint])
        # a world with motors stops at the limit, one without them says what effort would have been needed
        capped = needed <= allowed * (1.0 + 1e-6)
        what = "more would be needed" if capped else f"{needed:.1f} {unit} would be needed"
        brief = capped and longest[joint] <= BRIEF
        found.append(
            Diagnostic(
                code=EFFORT,
                severity=Severity.NOTE if brief else None,
                message=f"{name} is at its limit of {allowed:.1f} {unit}, {what}, "
                f"for {in_words(float(seconds[joint]), float(longest[joint]))}",
                span=spans(int(first_row[joint])),
                time=float(begin[joint]),
                hint="it lacks torque for moments only; the path accuracy tells how far off the tip is"
                if brief
                else "cut less deep or slower, hold the tool closer to the robot, or use a stronger one",
                value=needed,
                limit=allowed,
                unit=unit,
            )
        )
    return found
