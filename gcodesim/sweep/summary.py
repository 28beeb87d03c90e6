"""What all rows of a sweep say together: how many fail, the least and greatest of each figure, and where."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Final

from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.diagnostics.show import as_json
from gcodesim.sweep.measure import figure, heading_of, names
from gcodesim.sweep.prepared import Prepared
from gcodesim.sweep.row import Row, further, limit_findings

SCHEMA: Final = "gcodesim-sweep/1"
_MOST_FAILING: Final = 100  # that are named


@dataclass(slots=True, kw_only=True)
class Extremes:
    """The least and the greatest of a figure, and the first runs that have them."""

    least: float
    least_run: int
    most: float
    most_run: int

    def take(self, value: float, run: int) -> None:
        if value < self.least:
            self.least, self.least_run = value, run
        if value > self.most:
            self.most, self.most_run = value, run


@dataclass(slots=True, kw_only=True)
class Summary:
    """`findings`: for each limit the run farthest beyond it, with how many are; `failing` the first runs that fail.

    `codes` says how many runs have an error or a warning of that code. Runs that stopped count for no figure.
    """

    count: int = 0
    failed: int = 0
    failing: list[int] = field(default_factory=list)
    codes: dict[str, int] = field(default_factory=dict)
    figures: dict[str, Extremes] = field(default_factory=dict)
    findings: list[Diagnostic] = field(default_factory=list)

    @staticmethod
    def of(ready: Prepared, rows: Iterable[Row], fail_on: str) -> Summary:
        summary = Summary()
        worst: dict[str, tuple[float, Diagnostic, int]] = {}
        shown = (*names(), *further(ready))
        for row in rows:
            summary.count += 1
            if row.fails(fail_on):
                summary.failed += 1
                if len(summary.failing) < _MOST_FAILING:
                    summary.failing.append(row.number)
            for one in {finding.code for finding in row.findings if finding.level >= Severity.WARNING}:
                summary.codes[one] = summary.codes.get(one, 0) + 1
            for name in shown if row.status != "failed" else ():  # a run that stopped says nothing about the others
                value = figure(name, row.figures)
                if value is not None:
                    known = summary.figures.setdefault(
                        name, Extremes(least=value, least_run=row.number, most=value, most_run=row.number)
                    )
                    known.take(value, row.number)
            for limit, finding in zip(
                (limit for limit in ready.study.fail if limit in row.broken), limit_findings(ready, row), strict=True
            ):
                excess = limit.excess(row.figures) or 0.0
                before = worst.get(limit.text)
                number = 1 if before is None else before[2] + 1
                if before is None or excess > before[0]:
                    worst[limit.text] = (excess, finding, number)
                else:
                    worst[limit.text] = (before[0], before[1], number)
        summary.findings = [replace(finding, count=number) for _, finding, number in worst.values()]
        return summary

    def table(self) -> list[list[str]]:
        """Rows for a terminal."""
        if not self.figures:
            return []
        lines = [["figure", "least", "run", "most", "run"]]
        for name, one in self.figures.items():
            least, most = f"{one.least:.6g}", f"{one.most:.6g}"
            lines.append([_heading(name), least, str(one.least_run), most, str(one.most_run)])
        return lines


def _heading(name: str) -> str:
    return name if "." in name else heading_of(name)


def summary_as_json(ready: Prepared, summary: Summary, total: int) -> dict[str, Any]:
    """The content of `sweep.json`."""
    return {
        "schema": SCHEMA,
        "study": {"name": ready.file.source.name, "sha256": ready.file.source.sha256},
        "total": total,
        "done": summary.count,
        "failed": summary.failed,
        "failing": summary.failing,
        "codes": {code: summary.codes[code] for code in sorted(summary.codes)},
        "figures": {
            _heading(name): {
                "least": one.least,
                "least_run": one.least_run,
                "most": one.most,
                "most_run": one.most_run,
            }
            for name, one in summary.figures.items()
        },
        "findings": [as_json(finding) for finding in summary.findings],
    }
