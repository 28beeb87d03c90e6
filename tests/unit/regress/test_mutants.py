"""What a suite would not see: drawn by a seed, judged as cases, nothing written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gcodesim.cli import main
from gcodesim.regress import CaseVerdict, judge
from gcodesim.regress.case import Case, collect
from gcodesim.regress.mutants import draw, judge_mutants
from gcodesim.regress.outcome import Judging


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_a_seed_draws_the_same_changes(suite: Path) -> None:
    cases = collect([suite], suite).cases
    one, same, other = (draw(cases, suite, 8, seed) for seed in (1, 1, 2))

    assert [(m.file, m.mutation) for m in one] == [(m.file, m.mutation) for m in same]
    assert [m.mutation for m in one] != [m.mutation for m in other]
    assert len({(m.case.name, m.mutation.text) for m in one}) == 8


def test_accepted_results_see_changes_and_nothing_is_written(suite: Path) -> None:
    before = contents(suite)
    verdicts = judge_mutants(draw(collect([suite], suite).cases, suite, 6, 3), Judging(root=suite))

    assert contents(suite) == before
    assert sum(one.fate == "seen" for one in verdicts) >= 4
    assert all(one.quantities for one in verdicts if one.fate == "not_seen")


def test_an_original_runs_once_for_all_its_changes(suite: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Changes of two cases, drawn to and fro, none of them seen: two runs of originals, and the order stays."""
    for golden in suite.glob("*.golden.json"):
        golden.unlink()
    cases = collect([suite], suite).cases[:2]
    mutants = draw(cases, suite, 8, 3)
    ran: list[tuple[str, bool]] = []

    def counted(case: Case, how: Judging) -> tuple[CaseVerdict, Any]:
        ran.append((case.name, bool(case.edits)))
        return judged(case, how)

    judged = judge.judge
    monkeypatch.setattr(judge, "judge", counted)
    verdicts = judge_mutants(mutants, Judging(root=suite))

    unseen = {one.mutant.case.name for one in verdicts if one.fate != "seen"}
    assert sum(one.fate != "seen" for one in verdicts) > len(unseen) == 2
    assert sorted(name for name, changed in ran if not changed) == sorted(unseen)
    assert [one.mutant for one in verdicts] == list(mutants)


def test_programs_and_cells_of_the_set_ups_of_a_job_are_changed(tmp_path: Path) -> None:
    """In memory, set-up by set-up; a feed that halves the time of one is seen in the results of the job."""
    (tmp_path / "cell.yaml").write_text(
        "gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n"
        "tools: {1: {type: flat_end_mill, diameter: 6}}\n"
    )
    for name, feed in (("one", 600), ("two", 900)):
        text = f"G21 G90 G94\nT1 M6\nG0 X10 Y10\nG1 X50 F{feed}\nX10\nM2\n"
        (tmp_path / f"{name}.nc").write_text(text)
    (tmp_path / "job.yaml").write_text(
        "gcodesim-job: 1\nsetups:\n  first: {program: one.nc, cell: cell.yaml}\n"
        "  second: {program: two.nc, cell: cell.yaml}\n"
    )
    (tmp_path / "job.test.yaml").write_text("program: job.yaml\n")
    before = contents(tmp_path)
    (case,) = collect([tmp_path], tmp_path).cases
    mutants = draw([case], tmp_path, 30, 1)
    assert {one.file for one in mutants} == {"one.nc", "two.nc", "cell.yaml"}
    feeds = [one for one in mutants if one.mutation.operator == "feed"]
    fates = {one.fate for one in judge_mutants(feeds[:2], Judging(root=tmp_path))}

    assert fates == {"not_seen"}  # something differs, and nothing is accepted that it could be compared with
    assert contents(tmp_path) == before


def test_a_suite_that_compares_nothing_sees_little(
    suite: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without accepted results only what becomes an error is seen; the rest is told, and the status says so."""
    for golden in suite.glob("*.golden.json"):
        golden.unlink()
    monkeypatch.chdir(suite)

    assert main(["test", "--mutate", "8", "--seed", "3"]) == 1
    text = capsys.readouterr().out
    assert text.count("NOT SEEN ") >= 2 and "8 changes drawn with seed 3: " in text

    main(["test", "--mutate", "8", "--seed", "3", "--format", "json"])
    answer = json.loads(capsys.readouterr().out)
    assert answer["counts"]["not_seen"] == text.count("NOT SEEN ")
    assert {one["fate"] for one in answer["mutants"]} <= {"seen", "not_seen", "no_effect"}


def test_asking_for_no_change_is_wrong_usage(suite: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(suite)
    assert main(["test", "--mutate", "0"]) == 2
