"""Whole runs for tests: a program and a cell as texts in, results, stocks and the columns of the log out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.executor import Execution
from gcodesim.jobs.results import Results, StockResult
from gcodesim.shop import Shop
from gcodesim.simulation import Job, Options, prepare, run
from tests.log_columns import read_columns
from tests.tops import top_at

ARM_HOME = "[0, -90, 90, 0, 90, 0]"


@dataclass(frozen=True, kw_only=True)
class Ran:
    """A program that was run in a cell; `log` is None when none was asked for."""

    job: Job
    results: Results
    execution: Execution
    log: Path | None

    @property
    def shop(self) -> Shop:
        assert self.job.shop is not None
        return self.job.shop

    @property
    def stock(self) -> StockResult:
        """Volumes of the only stock."""
        (stock,) = self.results.stocks.values()
        return stock

    @property
    def bad(self) -> list[Diagnostic]:
        """Findings above a note."""
        return [f for f in self.results.findings if f.level > Severity.NOTE]

    @property
    def misuse(self) -> list[tuple[str, int]]:
        """Code and line of every finding above a note."""
        return [(f.code, f.span.line) for f in self.bad]

    def column(self, topic: str, *fields: str) -> np.ndarray:
        """Fields of a logged topic as columns (n, fields)."""
        assert self.log is not None
        columns = read_columns(self.log, topic, fields)
        return np.column_stack([columns[field] for field in fields])

    def times(self, topic: str) -> np.ndarray:
        """Times [s] of a logged topic."""
        assert self.log is not None
        return read_columns(self.log, topic, [])["t_ns"] * 1e-9


def run_texts(
    program: str, cell: str, out: Path | None = None, *, world: str = "kinematic", folder: Path | None = None
) -> Ran:
    """Run `program` in `cell`, both as texts; `folder` is where files that the cell names are."""
    here = folder or Path(".")
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), here / "cell.yaml")
    job = prepare(SourceText("program.nc", program.encode()), loaded, Options(world=world))
    results, execution = run(job, out)
    assert execution is not None, [f.message for f in results.findings]
    return Ran(job=job, results=results, execution=execution, log=None if out is None else out / "run.mcap")


def height_at(ran: Ran, x: float, y: float) -> float:
    """Top of the material [m] in stock coordinates, in the column that holds (x, y); -inf where there is none."""
    (placed,) = ran.shop.stocks.values()
    return top_at(placed.stock, x, y)
