"""JSON for programs: one object on stdout, complete, free of NaN, the same as in the file."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

KEYS = [
    "schema", "status", "stopped_at", "inputs", "findings", "time", "distance",
    "stocks", "tools", "operations", "joints", "not_simulated",
]  # fmt: skip
FINDING = [
    "code", "severity", "message", "hint", "file", "line", "column", "end_line", "end_column",
    "callers", "count", "time_s", "value", "limit", "unit",
]  # fmt: skip
BAD = "G21 G90\nT1 M6\nG43 H1\nG0 Z20\nG0 X10\nM8\nG77\nG0 X20\nM2\n"


def _numbers(value: Any) -> list[float]:
    if isinstance(value, dict):
        return [n for v in value.values() for n in _numbers(v)]
    if isinstance(value, list):
        return [n for v in value for n in _numbers(v)]
    return [value] if isinstance(value, (int, float)) else []


def test_run_prints_the_results_file(cli, tmp_path: Path) -> None:
    done = cli("run", "slot.nc", "--cell", "cell.yaml", "--format", "json")

    assert done.status == 0 and done.out.count("\n") == 1
    value = done.json
    assert value == json.loads((tmp_path / "out" / "results.json").read_text())
    assert list(value) == KEYS and value["schema"] == "gcodesim-results/1" and value["status"] == "ok"
    assert list(value["inputs"]) == ["gcodesim", "seed", "world", "program", "cell", "files"]
    assert list(value["stocks"]["stock"]) == [
        "material", "initial_mm3", "removed_mm3", "deposited_mm3", "remaining_mm3", "resolution_mm", "error_bound_mm3",
        "body",
    ]  # fmt: skip
    time = value["time"]
    assert math.isclose(
        time["total_s"], time["feed_s"] + time["rapid_s"] + time["dwell_s"] + time["tool_change_s"], rel_tol=1e-9
    )
    assert 0 < time["engaged_s"] <= time["feed_s"]
    assert value["tools"][0]["line_of_max_force"] in (7, 8)
    assert [joint["name"] for joint in value["joints"]] == ["machine/X", "machine/Y", "machine/Z"]
    assert all(math.isfinite(n) and (n or math.copysign(1.0, n) > 0) for n in _numbers(value))
    assert "NaN" not in done.out and "Infinity" not in done.out


def test_the_same_object_with_status_1(cli, write, tmp_path: Path) -> None:
    write("bad.nc", BAD)
    done = cli("run", "bad.nc", "--cell", "cell.yaml", "--format", "json")

    assert done.status == 1
    value = done.json
    assert value == json.loads((tmp_path / "out" / "results.json").read_text())
    assert value["status"] == "failed" and value["stopped_at"] == {"file": "bad.nc", "line": 7}
    error = next(f for f in value["findings"] if f["severity"] == "error")
    assert list(error) == FINDING
    assert (error["code"], error["file"], error["line"], error["column"]) == ("GS012", "bad.nc", 7, 1)
    assert (error["end_line"], error["end_column"]) == (7, 4)


def test_check_has_no_stocks(cli) -> None:
    value = cli("check", "slot.nc", "--cell", "cell.yaml", "--format", "json").json

    assert list(value) == KEYS
    assert value["stocks"] == {} and value["status"] == "ok"
    assert value["time"]["total_s"] > 0


def test_check_and_run_agree_on_time_and_distance(cli) -> None:
    ran = cli("run", "slot.nc", "--cell", "cell.yaml", "--format", "json").json
    checked = cli("check", "slot.nc", "--cell", "cell.yaml", "--format", "json").json

    assert ran["distance"] == checked["distance"]
    assert {k: v for k, v in ran["time"].items() if k != "engaged_s"} == {
        k: v for k, v in checked["time"].items() if k != "engaged_s"
    }


def test_a_wrong_cell_gives_an_object_too(cli, write, tmp_path: Path) -> None:
    write("wrong.yaml", "gcodesim: 1\nmachin: gantry_xyz\n")
    done = cli("run", "slot.nc", "--cell", "wrong.yaml", "--format", "json")

    assert done.status == 1 and list(done.json) == KEYS
    assert done.json["status"] == "failed" and done.json["stopped_at"]["file"] == "wrong.yaml"
    assert not (tmp_path / "out" / "run.mcap").exists()


def test_canon_and_lint_and_validate(cli, write) -> None:
    write("bad.nc", BAD)
    canon = cli("canon", "bad.nc", "--cell", "cell.yaml", "--format", "json")
    assert canon.status == 1 and canon.json["status"] == "error" and canon.json["error"]["line"] == 7
    lint = cli("lint", "bad.nc", "--format", "json")
    assert lint.status == 1 and ("GS012", 7, 1) in lint.errors
    cell = cli("cell", "validate", "cell.yaml", "--format", "json")
    assert cell.status == 0 and cell.json == {"findings": []}


def test_lines_csv_adds_up(cli, write, tmp_path: Path) -> None:
    slot, cell = (tmp_path / "slot.nc").read_text(), (tmp_path / "cell.yaml").read_text()
    write("slot.nc", slot.replace("G1 X30", "G4 P0.7\nG1 X30"))
    write("cell.yaml", cell + "magazine: {change_time: 4 s}\n")
    value = cli("run", "slot.nc", "--cell", "cell.yaml", "--format", "json").json
    head, *rows = (tmp_path / "out" / "lines.csv").read_text().splitlines()

    assert head.startswith("file,line,time_s,distance_mm,")
    table = [row.split(",") for row in rows]
    assert [row[0] for row in table] == ["slot.nc"] * len(table)
    total = value["time"]["total_s"]
    assert math.isclose(sum(float(row[2]) for row in table), total, abs_tol=1e-5 * len(table))
    lines = [int(row[1]) for row in table]
    assert lines == sorted(lines)  # each line once, in the order in which they ran
    seconds = {int(row[1]): float(row[2]) for row in table}
    assert (seconds[2], seconds[8]) == (4.0, 0.7)  # the tool change and the dwell
    removed = sum(float(row[5]) for row in table)
    assert math.isclose(removed, value["stocks"]["stock"]["removed_mm3"], rel_tol=1e-4)
