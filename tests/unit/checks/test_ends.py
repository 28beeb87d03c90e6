"""What is still on when a program ends."""

from __future__ import annotations

from gcodesim.checks.ends import end_findings
from gcodesim.diagnostics import Span
from gcodesim.units import RPM


def test_what_is_on_at_the_end() -> None:
    last = Span("part.nc", 9, 1)

    assert end_findings(last) == []
    findings = end_findings(last, spindle=-12000 * RPM, process="extruder", flood=True, mist=True)

    assert [f.code for f in findings] == ["GS503", "GS504", "GS505"]
    assert "M4" in findings[0].message and "12000 rpm" in findings[0].message
    assert "extruder" in findings[1].message
    assert "flood and mist" in findings[2].message
    assert all(f.span is last for f in findings)
