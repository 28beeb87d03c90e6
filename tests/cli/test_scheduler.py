"""`gcodesim test` with workers that share no disk: the same verdict, byte for byte."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.regress.case import collect
from gcodesim.regress.changes import Change, Comparison, FieldChange, FindingChange, MoveChange
from gcodesim.regress.outcome import Judging
from gcodesim.regress.suite import Judged, run_suite
from gcodesim.regress.suite_json import suite_as_json
from gcodesim.regress.travel import judged_by
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding
from gcodesim.scale.hands import Alone
from gcodesim.scale.plain_values import as_plain, from_plain
from tests.cli.conftest import CELL, SLOT
from tests.cluster import Cluster


@pytest.fixture
def suite(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A suite whose cases pass, differ, call a subprogram, cannot be read, and name a file absolutely."""
    folder = tmp_path / "repo" / "suite"
    folder.mkdir(parents=True)
    files = {
        "../cell.yaml": CELL,
        "good.nc": SLOT.replace("G0 X10 Y10", "G0 X10 Y10 (expect: GS501 error)"),
        "sub.ngc": "O<sub> SUB\nG1 X30\nO<sub> ENDSUB\n",
        "calls.ngc": SLOT.replace("G1 X30", "O<sub> CALL"),
        "calls.test.yaml": "cell: ../cell.yaml\nexpect: {status: ok, values: {tools.1.max_force_N: 1}}\n",
        "wrong.nc": SLOT.replace("G1 X30", "G1 X#<none>"),
        "wrong.test.yaml": "cell: ../cell.yaml\n",
        "absolute.nc": SLOT,
        "absolute.yaml": CELL + f"tool_table: {folder / 't.tbl'}\n",
        "absolute.test.yaml": "cell: absolute.yaml\n",
        "t.tbl": "T1 P1 D6 Z40\n",
    }
    for name, text in files.items():
        (folder / name).write_text(text)
    monkeypatch.chdir(folder.parent)
    return folder


def test_workers_elsewhere_come_to_the_same_verdict(suite: Path) -> None:
    root = suite.parent
    collected = collect([suite], root, cell=root / "cell.yaml")
    how = Judging(root=root)

    here = suite_as_json(run_suite(collected, how))
    there = suite_as_json(run_suite(collected, how, hands=Alone()))

    assert there == here
    assert {case["status"] for case in here["cases"]} == {"failed"} or len(here["cases"]) >= 4
    assert [one.files.keys() for one in judged_by(Alone(), collected.cases, how)]


def test_a_scheduler_prints_the_same_bytes(suite: Path, standing: Cluster, capsys: pytest.CaptureFixture[str]) -> None:
    from gcodesim.cli import main

    said = []
    for words in ([], ["--scheduler", standing.address]):
        for form in (["-v"], ["--format", "json"], ["--format", "junit"]):
            status = main(["test", "suite", "--cache", str(suite.parent.parent / f"cache{len(said)}"), *form, *words])
            said.append((status, capsys.readouterr().out))

    assert said[:3] == said[3:]
    assert said[0][0] == 1 and "GS602" in said[0][1]


def test_values_come_back_as_they_were(tmp_path: Path) -> None:
    place = Span("a.nc", 1, 2, 3, 4)
    finding = Diagnostic(code="GS501", span=place, message="ä", value=float("inf"), related=place, bodies=("x", "y"))
    verdict = CaseVerdict(
        name="a",
        file="a",
        program="a",
        cell=None,
        status="failed",
        found=(JudgedFinding(finding=finding, state="counts", reason="new"),),
        comparison=Comparison(
            moves=(MoveChange(kind="changed", what="line", fields=(FieldChange(name="Z", old=1.5, new=None),)),),
            changes=(Change(quantity="q", old=None, new=3),),
            findings=(FindingChange(kind="new", new={"code": "GS1", "n": [1, None]}),),
        ),
        results={"time": {"total_s": 1.0}, "odd": [float("nan")]},
    )
    value = Judged(verdict=verdict, files={"a.nc": tmp_path / "b" / "a.nc"})

    again = from_plain(as_plain(value, Judged, tmp_path), Judged, tmp_path)

    assert repr(again) == repr(value)


@pytest.mark.parametrize("change", [{"status": "odd"}, {"name": 5}, {"found": 1}])
def test_json_of_a_stranger_is_refused(change: dict[str, object], tmp_path: Path) -> None:
    verdict = CaseVerdict(name="a", file="a", program="a", cell=None, status="passed")
    plain = as_plain(verdict, CaseVerdict, tmp_path)

    with pytest.raises((TypeError, ValueError, KeyError)):
        from_plain({**plain, **change}, CaseVerdict, tmp_path)
