"""A sweep as a suite: each run a case, for JUnit, SARIF and the other formats."""

from __future__ import annotations

from collections.abc import Iterable

from gcodesim.diagnostics import Severity
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding, SuiteVerdict
from gcodesim.sweep.prepared import Prepared
from gcodesim.sweep.row import Row, limit_findings


def verdict_of(ready: Prepared, rows: Iterable[Row], fail_on: str) -> SuiteVerdict:
    """The verdict on all runs, in the order of the study; files are named from the folder of the run."""
    return SuiteVerdict(cases=tuple(_case(ready, row, fail_on) for row in rows))


def _case(ready: Prepared, row: Row, fail_on: str) -> CaseVerdict:
    name = ready.file.source.name
    least = None if fail_on == "never" else Severity[fail_on.upper()]
    findings = [*row.findings, *limit_findings(ready, row)]
    found = tuple(
        JudgedFinding(finding=one, state="counts" if least is not None and one.level >= least else "told")
        for one in findings
    )
    return CaseVerdict(
        name=f"{name}/run {row.number} ({row.title()})",
        file=name,
        program=name,
        cell=None,
        status="failed" if row.fails(fail_on) else "passed",
        found=found,
        results={"time": {"total_s": row.figures.get("time.total_s") or 0.0}},
    )
