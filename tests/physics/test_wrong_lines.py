"""One wrong line in a long job, run against the part that the job makes: exactly that line is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.jobs.job import Options
from gcodesim.simulation import prepare, run
from tests.slow import some_slow
from tests.wrong_jobs import FAULTS, MilledJob, planted, pockets, relief

CODE = {"plunge": "GS441", "offset": "GS441", "rapid": "GS401"}


def blamed(job: MilledJob, folder: Path) -> set[tuple[str, int]]:
    """Code and line of every finding above a note."""
    job.mesh.export(folder / "part.stl")
    (folder / "cell.yaml").write_text(job.cell)
    source = SourceText("part.nc", job.program.encode())
    results, _ = run(prepare(source, load_cell(folder / "cell.yaml"), Options()), None)
    return {(finding.code, finding.span.line) for finding in results.findings if finding.level > Severity.NOTE}


SMALL = {"relief": lambda: relief(700, seed=4), "pockets": lambda: pockets(2, 2, 3, seed=4)}


@pytest.mark.parametrize("kind", SMALL)
def test_a_good_job_has_no_finding(kind: str, tmp_path: Path) -> None:
    assert blamed(SMALL[kind](), tmp_path) == set()


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("kind", some_slow(SMALL, "relief"))
def test_one_wrong_line_is_named(kind: str, fault: str, tmp_path: Path) -> None:
    job, line = planted(SMALL[kind](), fault, np.random.default_rng(7))
    assert blamed(job, tmp_path) == {(CODE[fault], line)}


LONG = {"relief": lambda: relief(20_000, seed=11), "pockets": lambda: pockets(11, 11, 4, seed=11)}


@pytest.mark.slow
@pytest.mark.parametrize("kind", LONG)
def test_one_wrong_line_of_twenty_thousand_is_named(kind: str, tmp_path: Path) -> None:
    good = LONG[kind]()
    assert len(good.moves) > 20_000
    assert blamed(good, tmp_path) == set()
    draw = np.random.default_rng(12)
    for fault in [*FAULTS] * 3:
        job, line = planted(good, fault, draw)
        assert blamed(job, tmp_path) == {(CODE[fault], line)}, fault
