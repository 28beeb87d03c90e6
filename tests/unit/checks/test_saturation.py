"""Saturated joints: one finding each, at the first line, with both numbers."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from gcodesim.checks.lasting import Lasting
from gcodesim.checks.saturation import saturation_findings
from gcodesim.diagnostics import Severity, Span


def test_one_finding_for_each_joint_that_was_at_its_limit() -> None:
    findings = saturation_findings(
        ("arm/joint_1", "arm/joint_2", "rail"),
        ("revolute", "revolute", "prismatic"),
        limit=np.array([288.4, 312.0, 5000.0]),
        effort=np.array([100.0, -312.0, 6200.0]),
        first_row=np.array([-1, 3, 5]),
        seconds=np.array([0.0, 0.2, 0.04]),
        longest=np.array([0.0, 0.2, 0.04]),
        begin=np.array([-0.002, 1.6, 2.5]),
        spans=lambda row: Span("part.nc", row + 1, 1),
    )

    assert [(f.code, f.level, f.span.line) for f in findings] == [
        ("GS230", Severity.ERROR, 4),
        ("GS230", Severity.ERROR, 6),
    ]
    assert [f.time for f in findings] == [1.6, 2.5]
    assert findings[0].message == "arm/joint_2 is at its limit of 312.0 N·m, more would be needed, for 0.200 s"
    assert findings[1].message == "rail is at its limit of 5000.0 N, 6200.0 N would be needed, for 0.040 s"
    assert (findings[1].value, findings[1].limit, findings[1].unit) == (pytest.approx(6200.0), 5000.0, "N")


@pytest.mark.parametrize(
    ("effort", "longest", "severity"),
    [(312.0, 0.05, Severity.NOTE), (312.0, 0.051, Severity.ERROR), (320.0, 0.004, Severity.ERROR)],
)
def test_motors_at_their_limit_for_moments_are_a_note(effort: float, longest: float, severity: Severity) -> None:
    """Where a world has motors, the tip is where it says; one without them says what would have been needed."""
    [finding] = saturation_findings(
        ("arm/joint_1",),
        ("revolute",),
        limit=np.array([312.0]),
        effort=np.array([effort]),
        first_row=np.array([0]),
        seconds=np.array([0.3]),
        longest=np.array([longest]),
        begin=np.zeros(1),
        spans=lambda row: Span("part.nc", row + 1, 1),
    )
    assert finding.level is severity
    assert finding.message.endswith(f"for 0.300 s in all, {longest:.3f} s at most at a time")


def test_how_long_something_lasts_does_not_ask_how_steps_come() -> None:
    holds = np.random.default_rng(5).random((400, 3)) < 0.7
    holds[:9, 1] = False
    ticks = np.random.default_rng(6).integers(1, 5, 400)
    parts = [0, 1, 7, 8, 150, 400]
    whole, pieces = Lasting(3), Lasting(3)
    whole.add(holds, ticks)
    for begin, end in pairwise(parts):
        pieces.add(holds[begin:end], ticks[begin:end])

    for j in range(3):
        longest = going = 0
        for now, tick in zip(holds[:, j], ticks, strict=True):
            going = going + tick if now else 0
            longest = max(longest, going)
        assert whole.longest[j] == pieces.longest[j] == longest
        assert whole.total[j] == pieces.total[j] == ticks[holds[:, j]].sum()
        assert whole.begin[j] == pieces.begin[j] == ticks[: int(holds[:, j].argmax())].sum()
