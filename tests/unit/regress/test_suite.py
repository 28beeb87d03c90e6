"""Cases, expectations, baselines, the cache, and suites in parallel."""

from __future__ import annotations

import json
import subprocess
import sys
from datetime import date
from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.regress.accept import propose
from gcodesim.regress.baseline import Baseline, BaselineError
from gcodesim.regress.cache import Cache
from gcodesim.regress.case import collect
from gcodesim.regress.case_file import read_case_file
from gcodesim.regress.expectation import expectations
from gcodesim.regress.golden import GoldenError, read_golden
from gcodesim.regress.outcome import Judging
from gcodesim.regress.suite import baseline_of, run_suite
from gcodesim.regress.suite_json import suite_as_json
from gcodesim.regress.tolerance import Tolerance
from gcodesim.regress.tolerance_kind import tolerance_from

NO_SPINDLE = ("S8000 M3\n", "S8000\n")


def verdict_of(folder: Path, **options: object):
    return run_suite(collect([folder], folder), Judging(root=folder), **options)


def broken(folder: Path) -> Path:
    program = folder / "pocket.nc"
    program.write_text(program.read_text().replace(*NO_SPINDLE))
    return program


def codes(case, state: str = "counts") -> list[str]:
    return [one.finding.code for one in case.found if one.state == state]


def test_a_dropped_spindle_is_told_at_its_line(suite: Path) -> None:
    broken(suite)
    pocket, arm = verdict_of(suite).cases
    assert (pocket.status, arm.status) == ("failed", "passed")
    finding = next(one.finding for one in pocket.found if one.finding.code == "GS501")
    assert (finding.span.file, finding.span.line) == ("pocket.nc", 9)
    assert "spindle" in pocket.quantities and "tools.1.max_force_N" in pocket.quantities


def test_expected_findings_do_not_count_and_missing_ones_do(suite: Path) -> None:
    (suite / "pocket.golden.json").unlink()
    program = broken(suite)
    program.write_text(program.read_text().replace("G1 Z-1 F300", "G1 Z-1 F300 (expect: error GS501)"))
    pocket = verdict_of(suite).cases[0]
    assert pocket.status == "passed" and codes(pocket, "expected") == ["GS501"]
    program.write_text(program.read_text().replace(NO_SPINDLE[1], NO_SPINDLE[0]))
    pocket = verdict_of(suite).cases[0]
    assert pocket.status == "failed" and codes(pocket) == ["GS601"]


def test_an_accepted_finding_that_is_gone_is_told(suite: Path) -> None:
    program = broken(suite)
    (suite / "pocket.golden.json").unlink()
    (proposal,) = (propose(case, Judging(root=suite)) for case in collect([suite / "pocket.test.yaml"], suite).cases)
    assert proposal.text is not None
    (suite / "pocket.golden.json").write_text(proposal.text)
    program.write_text(program.read_text().replace(*NO_SPINDLE[::-1]))
    pocket = verdict_of(suite).cases[0]
    gone = [one.finding.message for one in pocket.found if one.finding.code == "GS606"]
    assert any(message.startswith("finding gone pocket.nc:9: error GS501: T1 feeds") for message in gone)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("G1 X1 (expect: GS501)", [("GS501", 1, None)]),
        ('G1 ; expect: error GS4xx "rapid"', [("GS4xx", 1, "rapid")]),
        ("(expect@+2: GS501, GS401)", [("GS501", 3, None), ("GS401", 3, None)]),
        ("(expect@*: GS501)", [("GS501", None, None)]),
        ("(expect@14: GS501)", [("GS501", 14, None)]),
        ("(we expect nothing)", []),
    ],
)
def test_expectations_in_comments(text: str, wanted: list[tuple[str, int | None, str | None]]) -> None:
    found, faults = expectations(SourceText("a.nc", text.encode()))
    assert [(w.finding.code, w.finding.line, w.finding.message) for w in found] == wanted and not faults


@pytest.mark.parametrize("text", ["(expect: G1)", "(expect:)", "(expect GS501)", "(expect@: GS501)"])
def test_expectations_that_cannot_be_read(text: str) -> None:
    found, faults = expectations(SourceText("a.nc", text.encode()))
    assert not found and [fault.code for fault in faults] == ["GS608"]


def test_an_unknown_key_has_a_place_and_a_suggestion(tmp_path: Path) -> None:
    read = read_case_file(SourceText("a.test.yaml", b"cell: a.yaml\ntolerance: {volume: 1 mm^3}\n"), tmp_path)
    (finding,) = read.findings
    assert (finding.code, finding.span.line, finding.span.column) == ("GS704", 2, 1) and "`tolerances`" in finding.hint


@pytest.mark.parametrize(
    ("text", "code", "place", "hint"),
    [
        ("cell: pockt.yaml", "GS610", (1, 7), "pocket.yaml"),
        ("cell: pocket.yaml\nprogram: poket.nc", "GS610", (2, 10), "pocket.nc"),
        ("program: pocket.nc", "GS610", (1, 1), "cell: cell.yaml"),
        ("cell: pocket.yaml\noptions: {dialect: fanc}", "GS612", (2, 20), "fanuc"),
        ("cell: pocket.yaml\noptions: {mode: dry}", "GS711", (2, 17), "lint"),
        ("", "GS705", (1, 1), "cell: cell.yaml"),
        ("cell: [", "GS701", (1, 7), ""),
    ],
)
def test_faults_of_a_test_file_have_places_and_hints(
    suite: Path, text: str, code: str, place: tuple[int, int], hint: str
) -> None:
    (suite / "pocket.golden.json").unlink()
    (suite / "slot_arm.test.yaml").unlink()
    (suite / "pocket.test.yaml").write_text(text)
    verdict = verdict_of(suite)
    found = [*verdict.found, *(one for case in verdict.cases for one in case.found)]
    (finding,) = (one.finding for one in found if one.state == "counts")
    assert verdict.failed and finding.code == code and finding.span.file == "pocket.test.yaml"
    assert (finding.span.line, finding.span.column) == place and hint in (finding.hint or "")
    assert "gcodesim init" not in (finding.hint or "")  # that writes no test file


@pytest.mark.parametrize(
    ("name", "text", "wanted"),
    [
        ("volume", "2 mm^3", Tolerance(2.0)),
        ("force", "5 %", Tolerance(0.0, 0.05)),
        ("time", "100 ms, 1 %", Tolerance(0.1, 0.01)),
        ("position", "0.01", Tolerance(0.01)),
    ],
)
def test_tolerances_are_written_with_units(name: str, text: str, wanted: Tolerance) -> None:
    assert tolerance_from(name, text) == wanted


@pytest.mark.parametrize(("name", "text"), [("volume", "2 mm"), ("force", "2"), ("time", "-1 s"), ("time", "soon")])
def test_tolerances_that_are_none(name: str, text: str) -> None:
    assert isinstance(tolerance_from(name, text), str)


def test_values(suite: Path) -> None:
    (suite / "pocket.test.yaml").write_text(
        "cell: pocket.yaml\nexpect:\n  status: ok\n  values:\n    time.total_s: {least: 5, most: 60}\n"
        "    stocks.stock.removed_mm3: {value: 10, tolerance: 1 %}\n    tools.1.max_force: 3\n"
    )
    pocket = verdict_of(suite).cases[0]
    assert [(one.finding.code, one.finding.span.line) for one in pocket.found if one.state == "counts"] == [
        ("GS602", 6),
        ("GS611", 7),
    ]


def test_accepted_results_named_by_a_shell_pattern_are_no_programs(suite, tmp_path):
    """`accept part*` names part.nc, part.test.yaml and part.golden.json: one case."""
    for kept in ("pocket.golden.json", "lone.nc.golden.json"):
        (suite / kept).write_text("{}")
    (suite / "lone.nc").write_text("G21\nM2\n")
    named = sorted(suite.glob("pocket*")) + sorted(suite.glob("lone*"))
    assert [case.name for case in collect(named, suite).cases] == ["lone.nc", "pocket"]


def test_one_file_for_a_folder_of_programs(suite: Path) -> None:
    (suite / "extra.nc").write_text("G21 G90\nT1 M6\nG43 H1\nG0 Z20\nM2\n")
    (suite / "all.test.yaml").write_text("program: '*.nc'\ncell: pocket.yaml\n")
    cases = collect([suite], suite).cases
    assert [case.name for case in cases] == ["all/extra.nc", "pocket", "slot_arm"]
    assert [case.name for case in collect([suite], suite, names=["slot*"]).cases] == ["slot_arm"]


def test_a_golden_that_was_changed_by_hand(suite: Path) -> None:
    path = suite / "pocket.golden.json"
    path.write_text(path.read_text().replace('"feed_mm": 107', '"feed_mm": 108'))
    with pytest.raises(GoldenError, match="digest"):
        read_golden(SourceText.read(path), "golden")
    assert codes(verdict_of(suite).cases[0]) == ["GS609"]


def test_accepting_twice_changes_nothing(suite: Path) -> None:
    for case in collect([suite], suite).cases:
        proposal = propose(case, Judging(root=suite))
        assert proposal.text is None and proposal.comparison is not None and proposal.comparison.same


def test_a_baseline_takes_old_faults_and_tells_those_that_went(suite: Path) -> None:
    (suite / "pocket.golden.json").unlink()
    program = broken(suite)
    text = baseline_of(verdict_of(suite), suite)
    assert "GS501" in text
    known = SourceText("b.json", text.encode())
    program.write_text("(a line more)\n" + program.read_text())
    verdict = verdict_of(suite, baseline=Baseline.read(known))
    assert not verdict.failed and "GS501" in codes(verdict.cases[0], "baseline") and not verdict.gone
    program.write_text(program.read_text().replace("S5000 M3", "S5000"))
    assert verdict_of(suite, baseline=Baseline.read(known)).failed
    program.write_text(program.read_text().replace("S5000\n", "S5000 M3\n").replace(NO_SPINDLE[1], NO_SPINDLE[0]))
    verdict = verdict_of(suite, baseline=Baseline.read(known))
    assert not verdict.failed and any("GS501" in text for text in verdict.gone)


@pytest.mark.parametrize("text", ["", "[]", '{"schema": "x"}', '{"schema": "gcodesim-baseline/1"}'])
def test_what_is_no_baseline(text: str) -> None:
    with pytest.raises(BaselineError):
        Baseline.read(SourceText("b.json", text.encode()))


def test_the_cache_knows_what_changed(suite: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    cache = Cache(tmp_path_factory.mktemp("cache"), suite, "")
    first = verdict_of(suite, cache=cache)
    again = verdict_of(suite, cache=cache, reuse=True)
    assert [case.unchanged for case in again.cases] == [True, True]
    assert suite_as_json(again) == suite_as_json(first)
    cell = suite / "pocket.yaml"
    cell.write_text(cell.read_text() + "# a remark\n")
    assert [case.unchanged for case in verdict_of(suite, cache=cache, reuse=True).cases] == [False, True]


def test_a_suppression_ends_with_its_day(suite: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    broken(suite)
    (suite / "pocket.golden.json").unlink()
    cell = suite / "pocket.yaml"
    cell.write_text(cell.read_text() + "suppress: [{code: GS501, reason: held by hand, until: 2030-01-01}]\n")
    cache = Cache(tmp_path_factory.mktemp("cache"), suite, "")
    collected = collect([suite / "pocket.test.yaml"], suite)
    for day, failed in ((date(2030, 1, 1), False), (date(2030, 1, 2), True)):
        verdict = run_suite(collected, Judging(root=suite, today=day), cache=cache, reuse=True)
        assert verdict.failed is failed
        reasons = {one.reason for one in verdict.cases[0].found if one.state == "suppressed"}
        assert reasons == (set() if failed else {"held by hand"})


def test_workers_and_stopping_early_leave_no_trace(suite: Path) -> None:
    broken(suite)
    one, two = (suite_as_json(verdict_of(suite, jobs=jobs)) for jobs in (1, 2))
    assert one == two
    one, two = (verdict_of(suite, jobs=jobs, fail_fast=True) for jobs in (1, 2))
    assert [case.status for case in one.cases] == ["failed", "not_run"]
    assert suite_as_json(one) == suite_as_json(two)


def test_a_fault_of_ours_in_one_case_leaves_the_others_their_verdicts(
    suite: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from gcodesim.cli import main
    from gcodesim.regress import judge

    prepare = judge.prepare

    def broken_prepare(program, *arguments):
        if program.name == "pocket.nc":
            raise ZeroDivisionError("made for this test")
        return prepare(program, *arguments)

    monkeypatch.setattr(judge, "prepare", broken_prepare)
    monkeypatch.chdir(suite)
    monkeypatch.setenv("GCODESIM_TEST_CACHE", str(suite / "cache"))
    assert main(["test", "--format", "json"]) == 70
    said = capsys.readouterr()
    pocket, arm = json.loads(said.out)["cases"]
    assert (pocket["status"], arm["status"]) == ("failed", "passed")
    assert [one["code"] for one in pocket["findings"]] == ["GS613"] and "made for this test" in said.err


def test_two_tests_of_one_name_are_told_and_the_first_one_runs(suite: Path) -> None:
    (suite / "pocket.test.yml").write_text("cell: pocket.yaml\n")
    (suite / "deep").mkdir()
    for name in ("a_b.nc", "deep/a.nc", "deep_a.nc"):
        (suite / name).write_text("G21 G90\nG0 Z20\nM2\n")
    (suite / "several.test.yaml").write_text("program: ['deep/*.nc', deep_a.nc, a_b.nc]\noptions: {mode: lint}\n")
    collected = collect([suite], suite)

    assert [case.name for case in collected.cases] == ["pocket", "several/a_b.nc", "several/deep/a.nc", "slot_arm"]
    assert collected.cases[0].file == "pocket.test.yaml"
    told = [(one.finding.span.file, one.finding.code, one.finding.message) for one in collected.found]
    assert [(file, code) for file, code, _ in told] == [("pocket.test.yml", "GS615"), ("several.test.yaml", "GS615")]
    assert "`pocket.test.yaml`" in told[0][2] and "`a.nc` of the same file" in told[1][2]


def test_accepted_results_hold_no_nan(suite: Path) -> None:
    path = suite / "pocket.golden.json"
    path.write_text(path.read_text().replace('"feed_mm": 107', '"feed_mm": NaN'))
    with pytest.raises(GoldenError, match="NaN is no number"):
        read_golden(SourceText.read(path), "golden")


def test_a_group_of_values_is_no_value(suite: Path) -> None:
    file = suite / "pocket.test.yaml"
    file.write_text(file.read_text() + "expect: {values: {time: {least: 1}, tools: 3}}\n")
    told = [one.finding for one in verdict_of(suite).cases[0].found if one.finding.code == "GS611"]
    assert [finding.message for finding in told] == [
        f"`{name}` is no value, but a group of some" for name in ("time", "tools")
    ]
    assert "`time.total_s`" in told[0].hint


@pytest.mark.parametrize(
    "harm",
    [b"", b"\xff\x00", b"[]", b'{"files": 3}', b'{"files": {}, "today": 5, "until": [], "verdict": {}}', b"null"],
)
def test_a_damaged_memory_costs_time_only(suite: Path, tmp_path_factory: pytest.TempPathFactory, harm: bytes) -> None:
    folder = tmp_path_factory.mktemp("cache")
    cache = Cache(folder, suite, "")
    collected = collect([suite / "pocket.test.yaml"], suite)
    run_suite(collected, Judging(root=suite), cache=cache)
    (entry,) = folder.glob("*/*.json")
    entry.write_bytes(harm)
    (case,) = run_suite(collected, Judging(root=suite), cache=cache, reuse=True).cases
    assert case.status == "passed" and not case.unchanged


def test_tidying_leaves_files_of_others_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from gcodesim.regress import cache as module

    monkeypatch.setattr(module, "_MOST_ENTRIES", 0)
    ours = tmp_path / "ab" / f"{'0' * 32}.json"
    others = [tmp_path / "suite" / "pocket.golden.json", tmp_path / "ab" / "notes.json"]
    for path in (ours, *others):
        path.parent.mkdir(exist_ok=True)
        path.write_text("{}")
    Cache(tmp_path, tmp_path, "").tidy()
    assert not ours.exists() and all(path.exists() for path in others)


_WHILE_A_WORKER_STARTS = """
import os, runpy, signal, sys
from multiprocessing.process import BaseProcess

signal.signal(signal.SIGINT, signal.default_int_handler)
start = BaseProcess.start

def start_and_interrupt(self):
    start(self)
    BaseProcess.start = start
    os.killpg(0, signal.SIGINT)  # to all processes of the command, as a terminal does

BaseProcess.start = start_and_interrupt
sys.argv[0] = "gcodesim"
runpy.run_module("gcodesim", run_name="__main__")
"""


def test_an_interrupt_of_workers_that_are_starting_leaves_no_trace(suite: Path) -> None:
    command = [sys.executable, "-c", _WHILE_A_WORKER_STARTS, "test", "-j", "2", str(suite)]
    done = subprocess.run(command, capture_output=True, text=True, start_new_session=True, timeout=600, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "gcodesim: interrupted\n")
