"""What happens again in one place is told once."""

from __future__ import annotations

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.processes.repeated import folded


def _at(line: int, time: float, value: float, code: str = "GS401") -> Diagnostic:
    return Diagnostic(code=code, message=f"takes {value:g}", span=Span("p.nc", line, 1, 4), time=time, value=value)


def test_the_worst_is_told_with_the_first_time_and_a_count() -> None:
    found = folded([_at(3, 1.0, 0.2), _at(4, 2.0, 5.0), _at(3, 3.0, 9.3), _at(3, 4.0, 0.1), _at(3, 5.0, 1.0, "GS431")])

    assert [(f.code, f.span.line, f.message, f.time, f.count) for f in found] == [
        ("GS401", 3, "takes 9.3", 1.0, 3),
        ("GS401", 4, "takes 5", 2.0, 1),
        ("GS431", 3, "takes 1", 5.0, 1),
    ]
