"""Every kind of broken program gives its code, line and column, whichever command reads it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from gcodesim.cell import LoadedCell, load_cell
from gcodesim.cell.language import settings_of_cell
from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.diagnostics.show import as_text
from gcodesim.rs274 import interpret, lint
from gcodesim.simulation import Options, check, prepare
from tests.effort import growth

DATA = Path(__file__).parents[1] / "data" / "programs"
BROKEN = DATA / "broken"
PROGRAMS = sorted(BROKEN.glob("*.nc"))
MOST_BLOCKS = 20_000


def _expected() -> dict[str, list[tuple[str, int, int]]]:
    table = {}
    for row in (BROKEN / "expected.txt").read_text().splitlines():
        if row.startswith("#"):
            continue
        name, _, findings = row.partition(": ")
        found = re.findall(r"(GS\d{3}) (\d+):(\d+)", findings)
        table[name] = [(code, int(line), int(column)) for code, line, column in found]
    return table


EXPECTED = _expected()


@pytest.fixture(scope="module")
def cell() -> LoadedCell:
    loaded = load_cell(DATA / "cell.yaml")
    assert loaded.cell is not None
    return loaded


def _errors(findings: object) -> list[tuple[str, int, int]]:
    return [(f.code, f.span.line, f.span.column) for f in findings if f.level is Severity.ERROR]  # type: ignore[attr-defined]


def _limited(settings: object) -> object:
    from dataclasses import replace

    return replace(settings, max_blocks=MOST_BLOCKS)  # type: ignore[type-var]


def test_every_program_has_its_expectation() -> None:
    assert [path.name for path in PROGRAMS] == sorted(EXPECTED)
    assert len(PROGRAMS) >= 60
    assert all(EXPECTED.values())


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_check_lint_and_canon_tell_the_same(path: Path, cell: LoadedCell) -> None:
    source = SourceText.read(path)
    assert cell.cell is not None
    settings = _limited(settings_of_cell(cell.cell)[0])
    job = prepare(source, cell, Options(settings=_limited))  # type: ignore[arg-type]
    results = check(job)
    shown = "\n".join(as_text(f, job.sources) for f in results.findings)

    assert _errors(results.findings) == EXPECTED[path.name], shown
    assert results.status == "failed" and results.stopped_at is not None
    assert _errors(lint(source, settings)) == EXPECTED[path.name]  # type: ignore[arg-type]
    reading = interpret(source, settings)  # type: ignore[arg-type]
    assert all(event.span.line <= reading.source.text.count("\n") + len(source.lines) for event in reading)
    assert isinstance(reading.failed, Diagnostic)
    place = (reading.failed.code, reading.failed.span.line, reading.failed.span.column)
    assert place in EXPECTED[path.name]


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_messages_are_one_good_line(path: Path, cell: LoadedCell) -> None:
    source = SourceText.read(path)
    job = prepare(source, cell, Options(settings=_limited))  # type: ignore[arg-type]
    for finding in job.findings:
        assert finding.message and "\n" not in finding.message and not finding.message.endswith(".")
        assert str(DATA) not in finding.message + finding.hint
        span = finding.span
        assert not span.line or (span.end_line, span.end_column) > (span.line, span.column)
        lines = as_text(finding, job.sources).splitlines()
        assert max(map(len, lines)) < 400


def test_a_line_of_a_million_characters(cell: LoadedCell) -> None:
    source = SourceText("long.nc", b"G21\nG1 X1" + b"0" * 1_000_000 + b" F100\nM2\n")

    findings = lint(source)

    assert _errors(findings) == [("GS002", 2, 253)]
    assert all(len(line) < 400 for f in findings for line in as_text(f, {source.name: source}).splitlines())


def test_a_million_brackets_and_letters() -> None:
    for body in (b"[" * 1_000_000, b"G" * 1_000_000, b"(" * 1_000_000, b"#" * 1_000_000, b"G1 X1 " * 170_000):
        assert _errors(lint(SourceText("long.nc", b"#1=" + body + b"\nM2\n")))[0][:2] == ("GS002", 1)


@pytest.mark.parametrize("text", [b"[", b"G", b"(", b"#", b"G1 X1 ", b"0"])
def test_the_work_of_a_long_line_grows_with_its_length(text: bytes) -> None:
    def read(length: int) -> None:
        lint(SourceText("long.nc", b"#1=" + text * (length // len(text)) + b"\nM2\n"))

    assert growth(read, 200_000, 8, 24) < 24  # 8 where it is linear, 64 where each character looks at all others


@pytest.mark.slow
def test_a_million_lines(cell: LoadedCell) -> None:
    """Read and planned without end of memory or patience; one fault near the end is found at its place."""
    count = 1_000_000
    moves = b"".join(b"G1 X%.3f Y%.3f\n" % (i % 90 + 0.5, i % 50 + 0.25) for i in range(count))
    source = SourceText("million.nc", b"G21 G90 G94\nF1000\n" + moves + b"G1 X5 Y\nM2\n")

    findings = lint(source)

    assert _errors(findings) == [("GS004", count + 3, 7)]
