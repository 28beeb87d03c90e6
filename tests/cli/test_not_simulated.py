"""Nothing is ignored silently; `checks` and `suppress` decide what counts."""

from __future__ import annotations

from pathlib import Path

import pytest

SKIPPING = "G21 G90\nT1 M6\nM8\nM7\nM100 P3\nG0 Z50\nM8\nM9\nM2\n"


def _cell(tmp_path: Path, more: str) -> str:
    path = tmp_path / "more.yaml"
    path.write_text((tmp_path / "cell.yaml").read_text() + more)
    return path.name


def test_words_are_listed_with_count_and_first_line(cli, write) -> None:
    write("part.nc", SKIPPING)
    done = cli("run", "part.nc", "--cell", "cell.yaml", "--format", "json")

    assert done.status == 0
    assert done.json["not_simulated"] == [
        {"word": "M8", "count": 2, "first_line": 3},
        {"word": "M7", "count": 1, "first_line": 4},
        {"word": "M100", "count": 1, "first_line": 5},
        {"word": "M9", "count": 1, "first_line": 8},
    ]
    notes = {(f["code"], f["line"], f["count"]) for f in done.json["findings"] if f["code"].startswith("GS9")}
    assert notes == {("GS901", 3, 2), ("GS901", 4, 1), ("GS907", 5, 1), ("GS901", 8, 1)}
    text = cli("check", "part.nc", "--cell", "cell.yaml").out
    assert "words not simulated" in text and "M8 (2), M7 (1), M100 (1), M9 (1)" in text


def test_many_words_stay_on_a_short_line(cli, write) -> None:
    unknown = "".join(f"M{100 + k}\n" * (3 if k == 7 else 1) for k in range(12))
    write("part.nc", f"G21 G90\nT1 M6\n{unknown}M2\n")

    (row,) = [line for line in cli("check", "part.nc", "--cell", "cell.yaml").out.splitlines() if "words not" in line]
    assert row.endswith("14  M107 (3), M100 (1), M101 (1), M102 (1), M103 (1) and 7 more: `--format json`")
    listed = cli("check", "part.nc", "--cell", "cell.yaml", "--format", "json").json["not_simulated"]
    assert len(listed) == 12


def test_the_total_is_printed_when_it_is_0(cli) -> None:
    rows = [row.split() for row in cli("check", "slot.nc", "--cell", "cell.yaml").out.splitlines()]
    assert ["words", "not", "simulated", "0"] in rows


def test_checks_make_errors_of_them(cli, write, tmp_path: Path) -> None:
    write("part.nc", SKIPPING)
    done = cli("run", "part.nc", "--cell", _cell(tmp_path, "checks: {GS9xx: error}\n"), "--format", "json")

    assert done.status == 1 and done.json["status"] == "findings" and done.json["stopped_at"] is None
    assert {code for code, _, _ in done.errors} == {"GS901", "GS907"}


def test_the_most_exact_pattern_counts(cli, write, tmp_path: Path) -> None:
    write("part.nc", SKIPPING)
    done = cli(
        "check", "part.nc", "--cell", _cell(tmp_path, "checks: {GS9xx: error, GS901: note}\n"), "--format", "json"
    )

    assert [code for code, _, _ in done.errors] == ["GS907"]


@pytest.mark.parametrize(
    ("entry", "gone"),
    [
        ("{code: GS907, reason: our own macro}", True),
        ("{code: GS907, line: 5, reason: our own macro}", True),
        ("{code: GS907, line: 6, reason: our own macro}", False),
        ('{code: GS907, block: "m100  p3", reason: our own macro}', True),
        ('{code: GS907, block: "M100 P4", reason: our own macro}', False),
        ("{code: GS9xx, line: 5, reason: our own macro}", True),
        ("{code: GS907, program: part.nc, reason: our own macro}", True),
        ("{code: GS907, program: other.nc, reason: our own macro}", False),
        ("{code: GS907, until: 2999-01-01, reason: our own macro}", True),
        ("{code: GS907, until: 2001-01-01, reason: our own macro}", False),
        ("{code: GS901, reason: our own macro}", False),
    ],
)
def test_suppressed_findings(cli, write, tmp_path: Path, entry: str, gone: bool) -> None:
    write("part.nc", SKIPPING)
    cell = _cell(tmp_path, f"checks: {{GS907: error}}\nsuppress:\n  - {entry}\n")
    done = cli("check", "part.nc", "--cell", cell, "--format", "json")

    assert done.status == (0 if gone else 1), done.out
    assert any(f["code"] == "GS907" for f in done.json["findings"]) is not gone
    assert {"word": "M100", "count": 1, "first_line": 5} in done.json["not_simulated"]  # listed all the same


@pytest.mark.parametrize(
    ("entry", "idle"),
    [
        ("{code: GS907, reason: our own macro}", False),
        ("{code: GS907, line: 6, reason: our own macro}", True),
        ("{code: GS907, until: 2001-01-01, reason: our own macro}", False),  # no date decides
        ("{code: GS907, program: other.nc, reason: our own macro}", False),  # another program's
        ("{code: GS401, reason: the rapid is fine}", False),  # only a run would tell
        ("{code: GS201, reason: the switch was moved}", True),
    ],
)
def test_a_suppression_that_nothing_falls_under(cli, write, tmp_path: Path, entry: str, idle: bool) -> None:
    write("part.nc", SKIPPING)
    done = cli("check", "part.nc", "--cell", _cell(tmp_path, f"suppress:\n  - {entry}\n"), "--format", "json")

    assert any(f["code"] == "GS733" and f["severity"] == "note" for f in done.json["findings"]) is idle


def test_a_run_tells_which_suppressions_are_idle(cli, write, tmp_path: Path) -> None:
    write("part.nc", SKIPPING)
    cell = _cell(tmp_path, "suppress:\n  - {code: GS401, reason: the rapid is fine}\n")
    done = cli("run", "part.nc", "--cell", cell, "--format", "json")

    assert [f["code"] for f in done.json["findings"] if f["code"] == "GS733"] == ["GS733"]


def test_optional_stop_is_said_to_have_no_effect(cli, tmp_path: Path) -> None:
    done = cli("check", "slot.nc", "--cell", _cell(tmp_path, "optional_stop: true\n"), "--format", "json")

    assert any(f["code"] == "GS909" and "optional_stop" in f["message"] for f in done.json["findings"])
