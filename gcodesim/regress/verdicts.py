"""The result of a test run as values: a verdict for each case, one for all. All report formats are written from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, Literal

from gcodesim.diagnostics import Diagnostic
from gcodesim.frozen import frozen
from gcodesim.regress.changes import Comparison

FindingState = Literal["counts", "told", "expected", "accepted", "baseline", "suppressed"]
CaseStatus = Literal["passed", "failed", "not_run"]

NOTHING_ACCEPTED: Final = "GS607"
"""The code for a case without accepted results."""


@frozen
class JudgedFinding:
    """A finding of a case, and its effect on the verdict.

    `counts`      makes the case fail; `reason` is not empty if it does so only because it is new
    `told`        is below `fail_on`
    `expected`    the test file or a comment of the program expects it
    `accepted`    is part of the accepted results
    `baseline`    is listed in the baseline file
    `suppressed`  the cell's `suppress:` says why it is not a fault; `reason` has its words

    Spans name files by their path from the folder of the test run, with `/`.
    """

    finding: Diagnostic
    state: FindingState
    reason: str = ""


@frozen
class CaseVerdict:
    """The verdict on one program in one cell.

    `name` is unique in the suite (`suite/slot`), `file` the test file or, without one, the program; `program` and
    `cell` are paths too, all from the folder of the test run, with `/`. `found` holds everything that was said, in
    the order of places: findings of the run, and GS6xx for each difference from what was accepted or expected, so
    that a format needs nothing else. `comparison` is against the accepted results; None when there are none.
    `results` is the content of `results.json`, None when nothing ran. `unchanged`: taken from an earlier run with
    the same inputs. No clock and no folder of this machine is in any of it.
    """

    name: str
    file: str
    program: str
    cell: str | None
    status: CaseStatus
    found: tuple[JudgedFinding, ...] = ()
    comparison: Comparison | None = None
    results: Mapping[str, Any] | None = None
    unchanged: bool = False

    @property
    def counting(self) -> tuple[Diagnostic, ...]:
        """The findings that make the case fail."""
        return tuple(found.finding for found in self.found if found.state == "counts")

    @property
    def simulated_s(self) -> float:
        """Time of the simulated run [s]; 0 when nothing ran."""
        return 0.0 if self.results is None else float(self.results["time"]["total_s"])

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of all quantities that differ from what was accepted."""
        return () if self.comparison is None else self.comparison.quantities


@frozen
class SuiteVerdict:
    """All cases in the order of their names; `gone` are entries of the baseline that no finding needed.

    `found` holds findings that belong to no case, such as a test file that cannot be read.
    """

    cases: tuple[CaseVerdict, ...]
    found: tuple[JudgedFinding, ...] = ()
    gone: tuple[str, ...] = ()

    def with_status(self, status: CaseStatus) -> tuple[CaseVerdict, ...]:
        return tuple(case for case in self.cases if case.status == status)

    @property
    def failed(self) -> bool:
        return any(case.status == "failed" for case in self.cases) or any(f.state == "counts" for f in self.found)
