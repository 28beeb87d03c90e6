"""A suite's verdict as JSON."""

from __future__ import annotations

from typing import Any, Final

from gcodesim.diagnostics.show import as_json
from gcodesim.numbers import clean
from gcodesim.regress import show
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding, SuiteVerdict

SCHEMA: Final = "gcodesim-test/1"


def suite_as_json(verdict: SuiteVerdict) -> dict[str, Any]:
    """The whole verdict; equal for equal inputs, in whatever order cases ran or were known from an earlier run."""
    value: dict[str, Any] = clean(
        {
            "schema": SCHEMA,
            "failed": verdict.failed,
            "counts": {status: len(verdict.with_status(status)) for status in ("passed", "failed", "not_run")},
            "cases": [_case(case) for case in verdict.cases],
            "findings": [_found(one) for one in verdict.found],
            "gone_from_baseline": list(verdict.gone),
        }
    )
    return value


def _case(case: CaseVerdict) -> dict[str, Any]:
    return {
        "name": case.name,
        "file": case.file,
        "program": case.program,
        "cell": case.cell,
        "status": case.status,
        "quantities": list(case.quantities),
        "findings": [_found(one) for one in case.found],
        "comparison": None if case.comparison is None else show.as_json(case.comparison),
        "results": case.results,
    }


def _found(found: JudgedFinding) -> dict[str, Any]:
    return {"state": found.state, "reason": found.reason, **as_json(found.finding)}
