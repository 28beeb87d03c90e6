"""`run`, `check`, `test`, `accept`, `report` and `diff` of a job with two set-ups, as users meet them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import CELL, SLOT

STOCK = "stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 1}\n"
JOB = """gcodesim-job: 1
setups:
  top: {program: slot.nc, cell: machine.yaml, stock: {box: [40, 20, 8], zero: top-front-left, resolution: 0.5}}
  bottom: {program: slot.nc, cell: machine.yaml, stock: {from: top, xyz: [0, 20, -8], rpy: [180, 0, 0]}}
"""


@pytest.fixture(autouse=True)
def job(cli, write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GCODESIM_TEST_CACHE", str(tmp_path / "cache"))
    assert STOCK in CELL
    write("machine.yaml", CELL.replace(STOCK, ""))
    write("job.yaml", JOB)


def test_one_command_runs_both_and_says_one_verdict(cli) -> None:
    done = cli("run", "job.yaml")

    assert done.status == 0
    assert "== top: slot.nc in machine.yaml" in done.out and "bottom: no errors, no warnings" in done.out
    assert "set-up" in done.out and "look at it: `gcodesim report out`" in done.out
    value = json.loads(Path("out/setups.json").read_text())
    assert value["status"] == "ok" and list(value["setups"]) == ["top", "bottom"]
    own = json.loads(Path("out/bottom/results.json").read_text())
    assert value["setups"]["bottom"] == own
    assert value["time"]["total_s"] == pytest.approx(2 * own["time"]["total_s"], rel=1e-6)
    again = cli("run", "job.yaml")
    assert again.status == 0 and again.out.count("unchanged since the last run") == 2


def test_an_error_in_one_fails_all(cli, write) -> None:
    write("fast.nc", SLOT.replace("G1 X30", "G0 X30"))
    write("job.yaml", JOB.replace("slot.nc", "fast.nc", 1))
    done = cli("run", "job.yaml", "--sarif", "found.sarif")

    assert done.status == 1 and "fast.nc:8:1: error GS401" in done.out
    assert "bottom: no errors" in done.out  # the other one ran as well
    found = json.loads(Path("found.sarif").read_text())["runs"][0]["results"]
    assert [one["ruleId"] for one in found if one["level"] == "error"] == ["GS401"]
    value = cli("run", "job.yaml", "--format", "json").json
    assert value["status"] == "findings" and value["setups"]["top"]["status"] == "findings"


def test_check_needs_no_folder(cli) -> None:
    done = cli("check", "job.yaml")

    assert done.status == 0 and "GS919" in done.out and not Path("out").exists()


def test_a_faulty_job_is_named_with_its_place(cli, write) -> None:
    write("job.yaml", JOB.replace("from: top", "from: tpo"))
    done = cli("run", "job.yaml")
    assert done.status == 1 and "job.yaml:4:64: error GS714" in done.out and "did you mean `top`?" in done.out

    write("job.yaml", JOB.replace("cell: machine", "cel: machine", 1))
    done = cli("run", "job.yaml")
    assert done.status == 1 and "job.yaml:3:27: error GS704" in done.out and "did you mean `cell`?" in done.out

    assert cli("run", "no.yaml").status == 2
    done = cli("run", "job.yaml", "--cell", "machine.yaml")
    assert done.status == 2 and "--cell does not go with a job" in done.err


def test_it_is_a_case_of_a_suite(cli, write) -> None:
    write("job.test.yaml", "expect:\n  values: {setups.bottom.stocks.stock.removed_mm3: {least: 100}}\n")
    assert "1 accepted" in cli("accept", "job.test.yaml").out
    assert cli("test", "job.test.yaml").status == 0
    assert "1 unchanged" in cli("test", "job.test.yaml", "--changed").out

    write("job.yaml", JOB.replace("-8]", "-9]"))  # a millimetre too low: less is cut
    done = cli("test", "job.test.yaml", "--changed")
    assert done.status == 1 and "setups.bottom.stocks.stock.removed_mm3" in done.out
    assert "setups.top" not in done.out


def test_a_page_shows_all_set_ups(cli) -> None:
    assert cli("run", "job.yaml").status == 0
    assert cli("report", "out").status == 0 and Path("report.html").stat().st_size > 100_000
    done = cli("plot", "out")
    assert done.status == 2 and "those of set-ups: out/bottom, out/top" in done.err


def test_two_runs_of_a_job_compare(cli, write) -> None:
    assert cli("run", "job.yaml", "--out", "old").status == 0
    write("job.yaml", JOB.replace("-8]", "-9]"))
    assert cli("run", "job.yaml", "--out", "new").status == 0

    done = cli("diff", "old", "new")

    assert done.status == 1 and "bottom" in done.out and "removed_mm3" in done.out
