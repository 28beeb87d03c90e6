"""One row: a run of a study with its values, its verdict and its figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.diagnostics.stored import from_stored
from gcodesim.frozen import frozen
from gcodesim.sweep.design import Point
from gcodesim.sweep.limit import StudyLimit
from gcodesim.sweep.measure import Figures, figure, heading_of, names
from gcodesim.sweep.prepared import Prepared, placed

Cell = str | int | float | None
"""What stands in a cell of a table."""

LIMIT: Final = "GS630"
"""A run beyond a limit of its study."""


@frozen(eq=False)
class Row:
    """A run that is done; `number` is its place in the study, from 0."""

    number: int
    key: str
    point: Point
    status: str
    figures: Figures
    findings: Sequence[Diagnostic]
    results_sha256: str
    broken: Sequence[StudyLimit]

    def fails(self, fail_on: str) -> bool:
        """Whether it has a finding at or above `fail_on`, is beyond a limit, or did not get to its end."""
        if fail_on == "never":
            return False
        least = Severity[fail_on.upper()]
        return bool(self.broken) or self.status == "failed" or any(one.level >= least for one in self.findings)

    def title(self) -> str:
        """The values of the run in words."""
        return ", ".join(f"{name} {level.node_text}" for name, level in self.point.items())


def row_of(ready: Prepared, number: int, key: str, point: Point, kept: Mapping[str, Any]) -> Row:
    """The row of a run from what its worker sent; KeyError, TypeError or ValueError if that is none."""
    figures = kept["figures"]
    return Row(
        number=number,
        key=key,
        point=point,
        status=str(kept["status"]),
        figures=figures,
        findings=[placed(from_stored(one), ready.file) for one in kept["findings"]],
        results_sha256=str(kept["results_sha256"]),
        broken=[limit for limit in ready.study.fail if limit.is_broken(figures)],
    )


def limit_findings(ready: Prepared, row: Row) -> Iterator[Diagnostic]:
    """GS630 for each limit that a run is beyond."""
    for index, limit in enumerate(ready.study.fail):
        if limit in row.broken:
            value = figure(limit.what, row.figures)
            yield Diagnostic(
                code=LIMIT,
                span=ready.file.span("fail", index),
                message=f"run {row.number}: {limit.broken_text(row.figures)}",
                hint=row.title(),
                value=value,
                limit=limit.value,
                unit=limit.unit or None,
            )


@frozen(kw_only=False)
class ColumnHeading:
    """A column: its name, whether its cells are numbers, and whether it is an input or a result."""

    name: str
    kind: str
    role: str


def headings(ready: Prepared) -> list[ColumnHeading]:
    """The columns of all tables of a study."""
    study = ready.study
    inputs = [ColumnHeading(f.heading, "number" if f.numeric else "text", "input") for f in study.vary.values()]
    figures = [ColumnHeading(heading_of(name), "number", "figure") for name in names()]
    figures += [ColumnHeading(name if "." in name else heading_of(name), "number", "figure") for name in further(ready)]
    return [
        ColumnHeading("run", "whole", "run"),
        *inputs,
        ColumnHeading("verdict", "text", "verdict"),
        ColumnHeading("status", "text", "verdict"),
        ColumnHeading("errors", "whole", "verdict"),
        ColumnHeading("warnings", "whole", "verdict"),
        ColumnHeading("notes", "whole", "verdict"),
        ColumnHeading("codes", "text", "verdict"),
        ColumnHeading("limits", "text", "verdict"),
        ColumnHeading("first_finding", "text", "verdict"),
        *figures,
        ColumnHeading("inputs_sha256", "text", "hash"),
        ColumnHeading("results_sha256", "text", "hash"),
    ]


def further(ready: Prepared) -> list[str]:
    """Paths of the results that the study asks for, as columns or in its limits and its search."""
    study = ready.study
    asked = [*study.columns, *(limit.what for limit in study.fail)]
    if study.find is not None:
        asked += [name for name in (study.find.least, study.find.most) if name is not None]
    return [name for name in dict.fromkeys(asked) if name not in names()]


def cells(ready: Prepared, row: Row, fail_on: str) -> list[Cell]:
    """The cells of a row, in the order of `headings`."""
    levels = [finding.level for finding in row.findings]
    first = next((one for one in sorted(row.findings, key=lambda one: -one.level)), None)
    return [
        row.number,
        *(level.shown for level in row.point.values()),
        "fail" if row.fails(fail_on) else "ok",
        row.status,
        levels.count(Severity.ERROR),
        levels.count(Severity.WARNING),
        levels.count(Severity.NOTE),
        " ".join(sorted({one.code for one in row.findings})),
        "; ".join(limit.text for limit in row.broken),
        "" if first is None else f"{first.code}: {first.message}",
        *(figure(name, row.figures) for name in (*names(), *further(ready))),
        row.key,
        row.results_sha256,
    ]
