"""Saturated joints: one finding each, at the first line, with both numbers."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.checks.saturation import saturation_findings
from gcodesim.diagnostics import Severity, Span


def test_one_finding_for_each_joint_that_was_at_its_limit() -> None:
    findings = saturation_findings(
        ("arm/joint_1", "arm/joint_2", "rail"),
        ("revolute", "revolute", "prismatic"),
        limit=np.array([288.4, 312.0, 5000.0]),
        effort=np.array([100.0, -312.0, 6200.0]),
        first_row=np.array([-1, 3, 5]),
        steps=np.array([0, 50, 10]),
        dt=0.004,
        spans=lambda row: Span("part.nc", row + 1, 1),
        starts=np.arange(6) * 0.5,
    )

    assert [(f.code, f.level, f.span.line) for f in findings] == [
        ("GS230", Severity.ERROR, 4),
        ("GS230", Severity.ERROR, 6),
    ]
    assert [f.time for f in findings] == [1.5, 2.5]
    assert findings[0].message == "arm/joint_2 is at its limit of 312.0 N·m, more would be needed, for 0.200 s"
    assert findings[1].message == "rail is at its limit of 5000.0 N, 6200.0 N would be needed, for 0.040 s"
    assert (findings[1].value, findings[1].limit, findings[1].unit) == (pytest.approx(6200.0), 5000.0, "N")
