"""What the options of reading do, the same in lint, canon and check."""

from __future__ import annotations

import json
import subprocess
import sys
from io import BytesIO, TextIOWrapper
from pathlib import Path

import pytest

DRILL = "O1\nG21 G90 G17 G94\nG0 X10 Y0 Z5\nM30\n"


@pytest.mark.parametrize("command", [["lint"], ["check", "--cell", "cell.yaml"], ["run", "--cell", "cell.yaml"]])
def test_findings_of_option_files_are_findings_like_others(cli, write, command: list[str]) -> None:
    write("bad.tbl", "T1 P1 Z50 D6\nT2 P2 Z62,5\n")
    done = cli(command[0], "slot.nc", *command[1:], "--tools", "bad.tbl", "--format", "json")

    assert [(f["file"], f["line"]) for f in done.json["findings"] if f["code"] == "GS020"] == [("bad.tbl", 2)]
    text = cli(command[0], "slot.nc", *command[1:], "--tools", "bad.tbl")
    assert "  2 | T2 P2 Z62,5\n" in text.out


def test_canon_tells_the_findings_of_lint(cli, write) -> None:
    write("bad.nc", "G21 G90\nT1 M6\nG43 H2\nF100\nG1 X5 Y\nG1 X2 P7\nM2\n")
    listed = cli("canon", "bad.nc", "--format", "json").json
    linted = cli("lint", "bad.nc", "--format", "json").json

    assert [f["code"] for f in linted["findings"]] == ["GS161", "GS004", "GS104"]
    assert listed["findings"] == linted["findings"]
    assert listed["error"] == {"message": linted["findings"][1]["message"], "line": 5}
    text = cli("canon", "bad.nc")
    assert "bad.nc:5:7: error GS004" in text.out and "2 more findings" in text.err


def test_check_tells_the_findings_of_lint(cli, write) -> None:
    write("bad.nc", "G21 G90\nT1 M6\nG43 H2\nF100\nG1 X5 Y\nG1 X2 P7\nM2\n")
    wanted = {"GS161", "GS004", "GS104"}
    told = [
        [f for f in cli(*command, "--format", "json").json["findings"] if f["code"] in wanted]
        for command in (
            ("lint", "bad.nc", "--cell", "cell.yaml"),
            ("canon", "bad.nc", "--cell", "cell.yaml"),
            ("check", "bad.nc", "--cell", "cell.yaml"),
            ("run", "bad.nc", "--cell", "cell.yaml"),
        )
    ]

    assert len(told[0]) == 3
    assert all({**f, "time_s": None} in told[0] for other in told[1:] for f in other)
    assert all(len(other) == 3 for other in told)


def test_warnings_do_not_fail(cli, write) -> None:
    write("warned.nc", "G21 G90\nT1 M6\nG43 H2\nG0 X5\nM2\n")

    for command in (("lint", "warned.nc"), ("check", "warned.nc", "--cell", "cell.yaml")):
        assert cli(*command).status == 0
        assert cli(*command, "--fail-on", "warning").status == 1


def test_lint_follows_checks_and_suppress_of_the_cell(cli, write, tmp_path: Path) -> None:
    write("warned.nc", "G21 G90\nT1 M6\nG43 H2\nG0 X5\nM2\n")
    cell = (tmp_path / "cell.yaml").read_text()
    write("strict.yaml", cell + "checks: {GS161: error}\n")
    write("mild.yaml", cell + "suppress:\n  - {code: GS161, line: 3, reason: H2 is the measured one}\n")

    assert cli("lint", "warned.nc", "--cell", "strict.yaml").status == 1
    assert cli("lint", "warned.nc", "--cell", "mild.yaml", "--fail-on", "warning").status == 0


def test_a_broken_cell_is_told_in_both_formats(cli, write) -> None:
    write("broken.yaml", "gcodesim: 1\nmachine: gantry_xy\n")
    for command in ("lint", "canon"):
        done = cli(command, "slot.nc", "--cell", "broken.yaml", "--format", "json")
        assert done.status == 1
        assert [f["code"] for f in done.json["findings"]] == ["GS712"]
        assert "GS712" in cli(command, "slot.nc", "--cell", "broken.yaml").out


def test_decimal_point(cli, write, tmp_path: Path) -> None:
    write("drill.nc", DRILL)
    write("old.yaml", (tmp_path / "cell.yaml").read_text() + "dialect: fanuc\ndecimal_point: increments\n")

    def first_move(*options: object) -> list[float]:
        events = cli("canon", "drill.nc", "--format", "json", *options).json["events"]
        return next(event["end"] for event in events if event["kind"] == "rapid")[:1]

    assert first_move("--dialect", "fanuc") == [10]
    assert first_move("--dialect", "fanuc", "--decimal-point", "increments") == [0.01]
    x_of = {name: first_move("--cell", name, *more)[0] for name, more in (("old.yaml", ()),)}
    calculator = first_move("--cell", "old.yaml", "--decimal-point", "calculator")[0]
    assert calculator - x_of["old.yaml"] == pytest.approx(9.99)


def test_json_alone_stands_on_stdout(cli, write, tmp_path: Path) -> None:
    write("bad.var", "5221 12O\n")
    done = subprocess.run(
        [sys.executable, "-m", "gcodesim", "lint", "slot.nc", "--parameters", "bad.var", "--format", "json"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )

    assert [f["code"] for f in json.loads(done.stdout)["findings"]] == ["GS021"]


def test_a_program_may_come_from_stdin(cli, monkeypatch):
    monkeypatch.setattr("sys.stdin", TextIOWrapper(BytesIO(b"G0 X1\nG1 Y\nM2\n")))
    told = cli("lint", "-")
    assert told.status == 1
    assert told.out.startswith("-:2:4: error GS004: Y has no number\n")

    monkeypatch.setattr("sys.stdin", TextIOWrapper(BytesIO(b"G0 X1\nM2\n")))
    done = cli("canon", "-", "--format", "json")
    assert done.status == 0 and [event["kind"] for event in done.json["events"]][-2:] == ["rapid", "end"]


def test_an_empty_program_stops_at_its_end(cli, write):
    done = cli("canon", write("empty.nc", ""))

    assert done.status == 1
    hint = "  hint: a program ends with M2 or M30"
    assert done.out.splitlines()[-2:] == ["empty.nc: error GS010: the file is empty", hint]
    assert done.err == "stopped at the end of empty.nc\n"


def test_parameters_are_written_when_asked_for(cli, write):
    """As LinuxCNC keeps them: all that it stores, what the file listed, and nothing of a program that fails."""
    write("machine.var", "100 3\n5161 1\n5220 2\n5300 7\n")
    write("part.ngc", "G21 G90\nG10 L2 P2 X100\nG0 X10 Y5\nG28.1\nG92 Z3\n#5300=4\n#101=8\nM2\n")
    done = cli("canon", "part.ngc", "--parameters", "machine.var", "--write-parameters", "new.var")

    lines = [line.split("\t") for line in Path("new.var").read_text().splitlines()]
    kept = {int(number): float(value) for number, value in lines}
    assert done.status == 0 and "wrote new.var" in done.err
    assert {number: value for number, value in kept.items() if value} == {
        100: 3,
        5161: 110,
        5162: 5,
        5210: 1,
        5213: -3,
        5220: 1,
        5241: 100,
        5300: 4,
    }
    assert list(kept) == sorted(kept) and {5169, 5230, 5390} <= kept.keys() and 101 not in kept
    cli("run", "slot.nc", "--cell", "cell.yaml", "--write-parameters", "more.var")
    assert "5220\t1\n5221\t550\n" in Path("more.var").read_text()  # G54, where the cell places it

    write("wrong.ngc", "G0 X\nM2\n")
    assert "is not written" in cli("canon", "wrong.ngc", "--write-parameters", "wrong.var").err
    assert not Path("wrong.var").exists()


def test_fanuc_keeps_variables_and_offsets(cli, write):
    write("part.nc", "O1\nG21 G90\nG10 L20 P7 X10.\n#500=4.\n#100=3.\nG10 L10 P3 R5.\nM30\n")
    cli("canon", "part.nc", "--dialect", "fanuc", "--write-parameters", "kept.var")

    assert Path("kept.var").read_text() == "500\t4\n7121\t10\n11003\t5\n"
    write("more.nc", "O1\nG54.1 P7\nG0 X#500\nM30\n")
    done = cli("canon", "more.nc", "--dialect", "fanuc", "--parameters", "kept.var", "--format", "json")
    assert [event["end"][0] for event in done.json["events"] if event["kind"] == "rapid"] == [14]
