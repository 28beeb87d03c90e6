"""Verdicts for machines on the command line: scenario 5, every command, several programs, baselines, suppressions."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

MOVES = "G0 X10 Y10\nG0 Z2\nG1 Z-1 F400\nG1 X30\nG0 Z20\nM5\nM2\n"
GOOD = f"G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\n{MOVES}"
WITHOUT_SPINDLE = GOOD.replace(" M3", "")
MACHINES = ("sarif", "junit", "github", "gitlab")
STOPPED = [("GS501", "suite/slot.nc", 7)]


@pytest.fixture(autouse=True)
def suite(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cli: object) -> Path:
    """`suite/slot.nc`, which feeds with the spindle stopped, and its test file."""
    monkeypatch.setenv("GCODESIM_TEST_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "suite"
    folder.mkdir()
    (folder / "slot.nc").write_text(WITHOUT_SPINDLE)
    (folder / "slot.test.yaml").write_text("cell: ../cell.yaml\n")
    return folder


def failing(path: str | Path) -> list[tuple[str, str, int]]:
    """Code, file and line of the results of a SARIF file that are errors and not suppressed."""
    results: list[dict[str, Any]] = json.loads(Path(path).read_text(encoding="utf-8"))["runs"][0]["results"]
    places = [
        (one["ruleId"], one["locations"][0]["physicalLocation"])
        for one in results
        if one["level"] == "error" and not one.get("suppressions")
    ]
    return [(code, place["artifactLocation"]["uri"], place["region"]["startLine"]) for code, place in places]


def test_a_post_processor_dropped_the_spindle(cli) -> None:
    """Scenario 5."""
    done = cli("test", "suite/", "--junit", "j.xml", "--sarif", "s.sarif", "--github")
    assert done.status == 1
    assert "suite/slot.nc:7:1: error GS501: T1 feeds" in done.out
    assert "\n::error file=suite/slot.nc,line=7,endLine=7,col=1,endColumn=12,title=GS501 " in done.out
    root = ElementTree.parse("j.xml").getroot()
    assert root.attrib["failures"] == "1" and len(list(root.iter("failure"))) == 1
    assert failing("s.sarif") == STOPPED
    Path("suite/slot.nc").write_text(GOOD)
    repaired = cli("test", "suite/", "--junit", "j.xml", "--sarif", "s.sarif", "--github")
    assert repaired.status == 0 and "::" not in repaired.out
    assert failing("s.sarif") == []


@pytest.mark.parametrize(
    "command",
    [
        ("test", "suite"),
        ("lint", "suite/slot.nc"),
        ("check", "suite/slot.nc", "--cell", "cell.yaml"),
        ("run", "suite/slot.nc", "--cell", "cell.yaml"),
        ("cell", "validate", "cell.yaml"),
    ],
)
@pytest.mark.parametrize("program", [GOOD, "G21\nG1 X5\nM2\n"])
def test_every_format_has_stdout_for_itself_and_the_same_status(cli, command: tuple[str, ...], program: str) -> None:
    Path("suite/slot.nc").write_text(program)
    if command[0] == "cell" and program != GOOD:
        Path("cell.yaml").write_text(Path("cell.yaml").read_text() + "feet: 2\n")
    status, printed = cli(*command).status, {}
    readers = {"sarif": json.loads, "gitlab": json.loads, "junit": lambda text: ElementTree.fromstring(text.encode())}
    for form in ("json", *MACHINES):
        done = cli(*command, "--format", form)
        assert done.status == status
        readers.get(form, str)(done.out)
        if form == "github":
            assert all(line.startswith("::") for line in done.out.splitlines())
            assert ("::error" in done.out) == (status == 1)
        if form == "github":
            cli(*command, "--sarif", "out.sarif", "--gitlab", "out.gitlab", "--junit", "out.junit")
        else:
            printed[form] = done.out
    for form in ("sarif", "gitlab", "junit"):
        assert Path(f"out.{form}").read_text(encoding="utf-8") == printed[form]


def test_annotations_leave_json_alone(cli) -> None:
    done = cli("test", "suite", "--format", "json", "--github")
    assert done.json["failed"] and "::error" not in done.out and "::error file=suite/slot.nc" in done.err


def test_paths_begin_at_the_top_of_the_repository(cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / ".git").mkdir()
    monkeypatch.chdir(tmp_path / "suite")
    assert cli("test", "--sarif", "s.sarif").status == 1
    assert failing("s.sarif") == STOPPED
    assert cli("run", "slot.nc", "--cell", "../cell.yaml", "--sarif", "t.sarif").status == 1
    assert failing("t.sarif") == STOPPED


def test_several_programs_are_told_apart(cli, tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    for folder in ("suite", "other"):
        (tmp_path / folder / "slot.nc").write_text("G21\nG1 X5\nM2\n")
    done = cli("lint", "suite/slot.nc", "other/slot.nc", "slot.nc", "--sarif", "s.sarif")
    assert done.status == 1
    for folder in ("suite", "other"):
        assert f"{folder}/slot.nc:2:1: error GS107" in done.out and f"{folder}/slot.nc: 1 error" in done.out
    assert "slot.nc: no errors" in done.out
    assert failing("s.sarif") == [("GS107", "other/slot.nc", 2), ("GS107", "suite/slot.nc", 2)]
    findings = cli("lint", "suite/slot.nc", "other/slot.nc", "--format", "json").json["findings"]
    assert {one["file"] for one in findings} == {"suite/slot.nc", "other/slot.nc"}
    lines = cli("check", "suite/slot.nc", "slot.nc", "--cell", "cell.yaml", "--format", "json").out.splitlines()
    assert [json.loads(line)["status"] for line in lines] == ["failed", "ok"]
    assert cli("lint", "slot.nc", "absent.nc").status == 2


@pytest.mark.parametrize("command", [("test", "suite"), ("run", "suite/slot.nc", "--cell", "cell.yaml")])
def test_a_baseline_works_with_every_format(cli, command: tuple[str, ...]) -> None:
    assert cli(*command, "--write-baseline", "known.json", "--sarif", "before.sarif").status == 0
    assert failing("before.sarif") == STOPPED
    for form in ("text", "github"):
        done = cli(*command, "--baseline", "known.json", "--format", form, "--sarif", "s.sarif", "--junit", "j.xml")
        assert done.status == 0 and "::error" not in done.out
        assert failing("s.sarif") == []
        assert ElementTree.parse("j.xml").getroot().attrib["failures"] == "0"
    assert "it stands in the baseline" in Path("s.sarif").read_text()


def test_one_baseline_serves_all_commands(cli) -> None:
    cli("run", "suite/slot.nc", "--cell", "cell.yaml", "--write-baseline", "known.json")
    assert cli("test", "suite", "--baseline", "known.json").status == 0
    done = cli("check", "suite/slot.nc", "--cell", "cell.yaml", "--baseline", "known.json")
    assert done.status == 0 and "gone from the baseline: suite/slot.nc: GS501" in done.out


@pytest.mark.parametrize("command", [("test", "suite"), ("run", "suite/slot.nc", "--cell", "cell.yaml")])
def test_a_suppression_counts_until_its_day_in_every_format(cli, command: tuple[str, ...]) -> None:
    entry = "suppress: [{code: GS501, program: slot.nc, line: 7, reason: dry run, until: 2027-03-01}]\n"
    Path("cell.yaml").write_text(Path("cell.yaml").read_text() + entry)
    for form in ("text", "github"):
        before = cli(*command, "--today", "2027-03-01", "--format", form, "--sarif", "s.sarif")
        assert before.status == 0 and "::error" not in before.out
        results = json.loads(Path("s.sarif").read_text(encoding="utf-8"))["runs"][0]["results"]
        [suppressed] = [one for one in results if one["ruleId"] == "GS501"]
        assert suppressed["suppressions"][0]["justification"] == "dry run"
        after = cli(*command, "--today", "2027-03-02", "--format", form, "--sarif", "s.sarif")
        assert after.status == 1 and failing("s.sarif") == STOPPED
        assert "2027-03" not in Path("s.sarif").read_text()
        if form == "text":
            assert "its suppression in cell.yaml:" in after.out and "has ended (dry run)" in after.out
            assert "has ended" not in before.out


@pytest.mark.parametrize(("fail_on", "status"), [("error", 0), ("warning", 1), ("never", 0)])
def test_what_fails_is_an_error_annotation(cli, fail_on: str, status: int) -> None:
    Path("suite/slot.nc").write_text(GOOD.replace("M5\n", ""))  # a warning: the spindle is on at the end
    done = cli("test", "suite", "--fail-on", fail_on, "--format", "github")
    assert done.status == status and done.out.count("\n") == 1
    assert done.out.startswith("::error " if status else "::warning ")


@pytest.mark.parametrize("name", ["slot.nc/j.xml", "suite"])
def test_a_file_that_cannot_be_written_is_wrong_usage(cli, name: str) -> None:
    done = cli("lint", "slot.nc", "--junit", name)
    assert done.status == 2 and f"{name} cannot be written" in done.err


def test_schema_prints_each(cli) -> None:
    for name in ("results", "findings", "test", "diff", "canon", "baseline", "cell", "test-file"):
        assert cli("schema", name).json["$schema"].endswith("2020-12/schema")
    done = cli("schema", "result")
    assert done.status == 2 and "results" in done.err


def test_equal_bytes_in_other_processes_folders_and_hash_seeds(tmp_path: Path) -> None:
    """All files and all that is printed, twice; nothing tells where or when."""
    texts = {name: (tmp_path / name).read_bytes() for name in ("cell.yaml", "suite/slot.nc", "suite/slot.test.yaml")}
    told = []
    for seed, name in ((1, "a"), (2, "deep/er/b")):
        folder = tmp_path / name
        (folder / "suite").mkdir(parents=True)
        for file, text in texts.items():
            (folder / file).write_bytes(text)
        files = ("j.xml", "s.sarif", "q.json")
        done = subprocess.run(
            [sys.executable, "-m", "gcodesim", "test", "--github"]
            + [word for pair in zip(("--junit", "--sarif", "--gitlab"), files, strict=True) for word in pair],
            cwd=folder,
            env={**os.environ, "PYTHONHASHSEED": str(seed), "TZ": ("UTC", "Asia/Tokyo")[seed - 1]},
            capture_output=True,
            check=False,
        )  # fmt: skip
        assert done.returncode == 1
        told.append([done.stdout, *((folder / file).read_bytes() for file in files)])
    assert told[0] == told[1]
    assert str(tmp_path).encode() not in b"".join(told[0])


def test_what_is_known_from_an_earlier_run_says_the_same(cli) -> None:
    """`--changed` gives a verdict back; whether it did shows in no file."""
    Path("suite/slot.nc").write_text(GOOD.replace("M5\n", "M8\n"))
    written = []
    for _ in range(2):
        done = cli("test", "--changed", "--junit", "j.xml", "--sarif", "s.sarif", "--gitlab", "q.json", "--github")
        assert done.status == 0
        written.append([Path(name).read_bytes() for name in ("j.xml", "s.sarif", "q.json")])
    assert "1 unchanged" in done.out and written[0] == written[1]


def test_every_ending_has_its_status_in_every_format(cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """2 for what is not there, 130 for an interrupt: nothing is printed or written as a verdict."""
    from gcodesim.regress import judge

    for form in ("text", "json", *MACHINES):
        absent = cli("test", "absent", "--format", form, "--sarif", "s.sarif")
        assert (absent.status, absent.out) == (2, "")
        assert cli("run", "slot.nc", "--cell", "absent.yaml", "--format", form).status == 2

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(judge, "judge", interrupted)
    for form in ("text", *MACHINES):
        done = cli("test", "suite", "--format", form, "--sarif", "s.sarif")
        assert (done.status, done.out) == (130, "")
    assert not Path("s.sarif").exists()


def test_the_folder_of_a_verdict_is_made(cli) -> None:
    assert cli("lint", "slot.nc", "--junit", "reports/today/j.xml").status == 0
    assert Path("reports/today/j.xml").read_text().startswith("<?xml")
