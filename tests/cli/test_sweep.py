"""`gcodesim sweep` as users meet it, in one process."""

from __future__ import annotations

import base64
import csv
import json
import re
import zlib
from pathlib import Path

import jsonschema
import pytest

from gcodesim.formats.schemas import schema_of

PROGRAM = """G21 G90 G61
T1 M6
G43 H1
S8000 M3
G0 X-5 Y10 Z3
G1 Z-#<depth> F1000
X10 F#<feed>
M2
"""
CELL = """machine: gantry_xyz
stock: {box: [20, 20, 8], zero: top-front-left, material: al6082_t6, resolution: 1}
tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 2, length: 40}
simulation: {world: kinematic}
"""
STUDY = """program: slot.nc
cell: cell.yaml
vary:
  feed: {parameter: feed, values: [200, 400]}
  depth: {parameter: depth, from: 1, to: 2, steps: 2}
fail: [force > 60 N]
columns: tools.1.share_at_feed
"""


@pytest.fixture(autouse=True)
def study(cli, write) -> None:
    write("slot.nc", PROGRAM)
    write("cell.yaml", CELL)
    write("study.yaml", STUDY)


def table(folder: Path) -> list[dict[str, str]]:
    with (folder / "runs.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_row_a_run_a_verdict_and_the_same_run_alone(cli, tmp_path: Path):
    done = cli("sweep", "study.yaml", "-j", "1", "--out", "out")

    rows = table(tmp_path / "out")
    assert [(row["feed"], row["depth"]) for row in rows] == [("200", "1"), ("200", "2"), ("400", "1"), ("400", "2")]
    failing = [row["run"] for row in rows if row["verdict"] == "fail"]
    assert done.status == (1 if failing else 0)
    assert all((float(row["force_N"]) > 60.0) == (row["verdict"] == "fail") for row in rows)
    assert float(rows[1]["removed_mm3"]) > 1.9 * float(rows[0]["removed_mm3"])
    value = json.loads((tmp_path / "out" / "sweep.json").read_text())
    jsonschema.validate(value, schema_of("sweep"))

    alone = cli("sweep", "study.yaml", "--run", "3", "--out", "alone")
    import hashlib

    assert alone.status == done.status
    digest = hashlib.sha256((tmp_path / "alone" / "results.json").read_bytes()).hexdigest()
    assert digest == rows[3]["results_sha256"]
    assert (tmp_path / "alone" / "run.mcap").is_file()


def test_known_runs_are_not_run_again_and_a_study_may_grow(cli, write, tmp_path: Path, monkeypatch):
    cli("sweep", "study.yaml", "-j", "1", "--out", "out")
    before = {name: (tmp_path / "out" / name).read_bytes() for name in ("runs.csv", "runs.parquet", "sweep.json")}
    journal = (tmp_path / "out" / "runs.jsonl").read_bytes()
    lines = journal.splitlines(keepends=True)

    # cut off within the third run, as a power cut leaves it
    (tmp_path / "out" / "runs.jsonl").write_bytes(b"".join(lines[:3]) + lines[3][:100])
    write("study.yaml", "# a comment moves all lines\n" + STUDY)
    again = cli("sweep", "study.yaml", "-j", "1", "--out", "out", "--resume")

    assert "4 runs, 2 of them known from before" in again.out
    assert (tmp_path / "out" / "runs.jsonl").read_bytes() == journal
    assert {name: (tmp_path / "out" / name).read_bytes() for name in before if name != "sweep.json"} == {
        name: before[name] for name in before if name != "sweep.json"
    }
    write("study.yaml", STUDY.replace("200, 400", "400, 200, 800"))
    assert "6 runs, 4 of them known from before" in cli("sweep", "study.yaml", "-j", "1", "--out", "out").out
    write("cell.yaml", CELL.replace("flutes: 2", "flutes: 3"))
    assert "6 runs; " in cli("sweep", "study.yaml", "-j", "1", "--out", "out").out


def test_keys_of_the_cell_files_and_wrong_values(cli, write, tmp_path: Path):
    vary = "vary:\n  tools.1.diametr: [6, 8 mm]\n  tools.1.flutes: [2 mm]\n"
    write("study.yaml", f"program: slot.nc\ncell: cell.yaml\n{vary}")
    bad = cli("sweep", "study.yaml", "-j", "1")

    assert bad.status == 1
    assert "study.yaml:4:" in bad.out and "GS704" in bad.out and "diameter" in bad.out
    assert "study.yaml:5:" in bad.out
    assert not (tmp_path / "sweep").exists()

    write("b.nc", PROGRAM.replace("#<depth>", "1").replace("#<feed>", "100"))
    vary = "  tools.1.diameter: [4, 6 mm]\n  stock.box: [[20, 20, 8], [30, 20, 8 mm]]\n"
    write("study.yaml", f"cell: cell.yaml\nvary:\n  program: [b.nc]\n{vary}")
    assert cli("sweep", "study.yaml", "-j", "1").status == 0
    rows = table(tmp_path / "sweep")
    assert [row["tools.1.diameter_mm"] for row in rows] == ["4", "4", "6", "6"]
    assert rows[1]["stock.box"] == "[30, 20, 8 mm]"
    assert float(rows[1]["remaining_mm3"]) > float(rows[0]["remaining_mm3"])


def test_a_value_that_the_program_does_not_read_is_told_in_the_row(cli, write, tmp_path: Path):
    write("study.yaml", STUDY.replace("depth: {parameter: depth", "deep: {parameter: deep"))
    done = cli("sweep", "study.yaml", "-j", "1", "--out", "out")

    assert done.status == 1  # and the program misses #<depth>
    assert "GS120 in 4" in done.out


def test_a_search_finds_the_best_within_limits_and_is_the_same_again(cli, write, tmp_path: Path):
    write("study.yaml", STUDY.replace("values: [200, 400]", "from: 100, to: 800").replace("steps: 2", "whole: true"))
    with (tmp_path / "study.yaml").open("a") as file:
        file.write("find: {most: removed, runs: 12}\n")

    done = cli("sweep", "study.yaml", "-j", "1", "--find", "--out", "out", "--format", "json")
    value = json.loads(done.out)
    jsonschema.validate(value, schema_of("sweep"))
    rows = table(tmp_path / "out")
    good = [row for row in rows if row["verdict"] == "ok"]
    assert done.status == (0 if good else 1)
    if good:
        best = max(good, key=lambda row: float(row["removed_mm3"]))
        assert float(rows[value["best"]]["removed_mm3"]) == float(best["removed_mm3"])
    before = (tmp_path / "out" / "runs.csv").read_bytes()
    assert json.loads(cli("sweep", "study.yaml", "-j", "1", "--find", "--out", "out", "--format", "json").out) == value
    assert (tmp_path / "out" / "runs.csv").read_bytes() == before


def test_the_page_leads_to_replays_of_the_best_and_the_worst(cli, tmp_path: Path):
    said = cli("sweep", "study.yaml", "-j", "1", "--out", "out", "--keep-logs", "--replay", "--fail-on", "never")
    assert said.status == 0
    assert "4 runs; " in said.out  # none of them "known from before"

    reports = sorted(path.relative_to(tmp_path / "out").as_posix() for path in (tmp_path / "out").rglob("report.html"))
    page = (tmp_path / "out" / "sweep.html").read_text()
    index = re.search(r'id="index">(.*?)<', page)
    assert index is not None
    content = json.loads(zlib.decompress(base64.b64decode(index[1])))
    assert len(reports) == 2 and sorted(content["links"].values()) == reports
    assert len(content["rows"]) == 4


def test_junit_has_a_case_a_run(cli, tmp_path: Path):
    cli("sweep", "study.yaml", "-j", "1", "--out", "out", "--junit", "j.xml", "--sarif", "s.json")

    text = (tmp_path / "j.xml").read_text()
    assert text.count("<testcase") == 4
    assert json.loads((tmp_path / "s.json").read_text())["version"] == "2.1.0"


def test_usage(cli, write, tmp_path: Path):
    assert cli("sweep", "study.yaml", "--resume", "--out", "out").status == 2
    assert cli("sweep", "study.yaml", "--run", "4", "--out", "out").status == 2
    assert cli("sweep", "study.yaml", "--find", "--out", "out").status == 2
    assert cli("sweep", "study.yaml", "--tls-ca", "a", "-j", "1", "--out", "out").status == 2
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "runs.csv").write_text("my,own\n")
    assert cli("sweep", "study.yaml", "-j", "1", "--out", "mine").status == 2
    assert (tmp_path / "mine" / "runs.csv").read_text() == "my,own\n"


def test_tables_hold_no_formula(cli, write, tmp_path: Path):
    write("=1+1.nc", PROGRAM.replace("#<depth>", "1").replace("#<feed>", "100"))
    write("study.yaml", "cell: cell.yaml\nvary: {program: ['=1+1.nc']}\n")

    assert cli("sweep", "study.yaml", "-j", "1", "--out", "out").status == 0
    assert table(tmp_path / "out")[0]["program"] == "'=1+1.nc"
