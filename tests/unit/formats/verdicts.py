"""Verdicts made by hand: every state, spans of every kind, the same fault in two cases, odd characters."""

from __future__ import annotations

from dataclasses import dataclass

from gcodesim.diagnostics import Caller, Diagnostic, Severity, SourceText, Span
from gcodesim.formats import FilePlaces
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding, SuiteVerdict

PROGRAM = "suite/a b.nc"
CELL = "cell.yaml"
LINES = ["G21 G90", "(ü \U0001f529) G1 Z-1 F400", "G1 X30 \x01 ]]>", "o100 call"]


def finding(
    code: str = "GS501", line: int = 2, message: str = "T1 feeds through 3.5 mm³, 100 %", **more: object
) -> Diagnostic:
    """A finding of the program, by default about all of its line."""
    span = Span(PROGRAM, line, 1, line, len(LINES[line - 1]) + 1) if line else Span(PROGRAM)
    return Diagnostic(**{"code": code, "message": message, "span": span, **more})  # type: ignore[arg-type]


@dataclass(frozen=True)
class Example:
    """A verdict and what it names."""

    verdict: SuiteVerdict
    places: FilePlaces


def suite(*found: JudgedFinding, prefix: str = "", lines: list[str] = LINES) -> Example:
    """One case `suite/a` with these findings."""
    states = [one.state for one in found]
    case = CaseVerdict(
        name="suite/a", file="suite/a.test.yaml", program=PROGRAM, cell=CELL,
        status="failed" if "counts" in states else "passed", found=found,
        results={"time": {"total_s": 12.3456}},
    )  # fmt: skip
    return example(case, prefix=prefix, lines=lines)


def example(
    *cases: CaseVerdict, prefix: str = "", lines: list[str] = LINES, faults: tuple[JudgedFinding, ...] = ()
) -> Example:
    sources = {
        PROGRAM: SourceText(PROGRAM, "\n".join(lines).encode()),
        CELL: SourceText(CELL, b"gcodesim: 1\nmachine: gantry_xyz\n"),
    }
    verdict = SuiteVerdict(cases=cases, found=faults)
    return Example(verdict, FilePlaces(sources=sources, prefix=prefix))


def everything() -> Example:
    """All that a verdict can have."""
    inside = Span("suite/o100.ngc", 7, 4, 7, 9, (Caller(PROGRAM, 4, "o100"),))
    odd = finding(line=3, message="two\nlines: 50 %, \x01 <&>\r", hint="write `G0`, not G1", severity=Severity.WARNING)
    shared = JudgedFinding(
        finding=Diagnostic(code="GS733", message="nothing is suppressed", span=Span(CELL, 2, 1, 2, 8)), state="told"
    )
    first = CaseVerdict(
        name="suite/a", file="suite/a.test.yaml", program=PROGRAM, cell=CELL, status="failed",
        found=(
            JudgedFinding(
                finding=finding(count=3, time=1.5, value=3.5e-9, limit=0.0, unit="m^3", hint="M3"), state="counts"
            ),
            JudgedFinding(finding=odd, state="counts", reason="new since the results were accepted"),
            JudgedFinding(finding=finding("GS111", 0), state="told"),
            JudgedFinding(finding=Diagnostic(code="GS203", message="out of reach", span=inside), state="accepted"),
            JudgedFinding(finding=finding("GS401", 2), state="baseline"),
            JudgedFinding(finding=finding("GS302", 2), state="suppressed", reason="the clamp is taken away"),
            JudgedFinding(finding=finding("GS111", 3, related=Span(CELL, 1, 1, 1, 9)), state="expected"),
            shared,
        ),
        results={"time": {"total_s": 12.3456}},
    )  # fmt: skip
    second = CaseVerdict(name="suite/deep/b", file="x", program="b.nc", cell=CELL, status="passed", found=(shared,))
    third = CaseVerdict(name="c", file="c.nc", program="c.nc", cell=None, status="not_run")
    fault = JudgedFinding(
        finding=Diagnostic(code="GS610", message="no cell is named", span=Span("suite/x.test.yaml", 1, 1, 1, 2)),
        state="counts",
    )
    return example(first, second, third, faults=(fault,))
