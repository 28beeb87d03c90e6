"""What a run finds, in its results, its log and by `info`: one answer."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from gcodesim.log.event import BEGINS, LogEvent, settled
from gcodesim.log.logfile import LogFile
from gcodesim.log.reader import decoded

# the spindle stands while a slot is cut for many windows
PROGRAM = "G21 G90 G17 G94\nT1 M6\nG43 H1\nG0 X10 Y10\nG0 Z2\nG1 Z-2 F400\nG1 X80 F600\nG1 Y40\nG0 Z20\nM2\n"


@pytest.fixture
def results(cli, write, tmp_path: Path) -> list[dict[str, object]]:
    write("part.nc", PROGRAM)
    assert cli("run", "part.nc", "--cell", "cell.yaml").status == 1
    findings = json.loads((tmp_path / "out" / "results.json").read_text())["findings"]
    return [finding for finding in findings if finding["code"] == "GS501"]


def _events(tmp_path: Path) -> list[tuple[int, str]]:
    log = LogFile.open(tmp_path / "out" / "run.mcap")
    return [(t_ns, event.message) for t_ns, event in decoded(log, "/event") if event.code == "GS501"]


def test_an_event_says_that_it_begins_and_another_what_it_came_to(results, tmp_path: Path) -> None:
    (finding,) = results
    (begin_ns, begins), (end_ns, told) = _events(tmp_path)
    assert begins.endswith(BEGINS)
    assert told == finding["message"]
    assert finding["time_s"] * 1e9 - 1 <= begin_ns < end_ns
    log = LogFile.open(tmp_path / "out" / "run.mcap")
    lines = [line.message for _, line in decoded(log, "/log") if line.message.startswith("GS501")]
    assert lines == [f"GS501: {begins}", f"GS501: {told}"]


def test_info_tells_what_the_results_tell(cli, results, tmp_path: Path) -> None:
    (finding,) = results
    (told,) = [one for one in cli("info", "out", "--format", "json").json["findings"] if one["code"] == "GS501"]
    for key in ("message", "severity", "file", "line"):
        assert told[key] == finding[key]
    assert told["time_s"] == pytest.approx(finding["time_s"])
    said = cli("info", "out").out
    assert said.count("GS501") == 1 and str(finding["message"]) in said


def test_a_log_without_results_tells_each_finding_once() -> None:
    def event(t_ns: int, code: str, line: int, message: str) -> LogEvent:
        return LogEvent(
            t_ns=t_ns, code=code, severity="error", file="a.nc", line=line, message=message, value=float(t_ns)
        )

    begins, other = event(5, "GS501", 7, f"feeds: {BEGINS}"), event(6, "GS401", 8, f"rapid: {BEGINS}")
    start, ends = event(0, "start", 0, "a.nc starts"), event(9, "GS501", 7, "T1 feeds through 3 mm³")
    assert settled([start, begins, other]) == (start, begins, other)  # killed before the end
    assert settled([start, begins, other, ends]) == (start, replace(ends, t_ns=5), other)


@pytest.mark.parametrize(
    ("old", "new"),
    [(b"20000000", b"2000000x"), (b"4000000", b"4_0e000"), (b"20000000", b"-0000020"), (b"part.nc", b"part\x00nc")],
)
def test_records_that_were_edited_are_no_fault_of_ours(cli, results, tmp_path: Path, old: bytes, new: bytes) -> None:
    log = tmp_path / "out" / "run.mcap"
    log.write_bytes(log.read_bytes().replace(old, new))
    for command in (
        ("info", "out"),
        ("info", "out", "--format", "json"),
        ("report", "out", "--times"),
        ("report", "out"),
        ("plot", "out", "-o", "a.svg"),
        ("export", "out", "--to", "csv", "-o", "a.csv"),
        ("export", "out", "--to", "jsonl", "-o", "a.jsonl"),
        ("export", "out", "--to", "stl", "-o", "a.stl"),
        ("export", "out", "--to", "glb", "-o", "a.glb"),
        ("diff", "out", "out"),
    ):
        done = cli(*command)
        assert done.status in (0, 1, 2) and "Traceback" not in done.err, (command, done.err)


@pytest.mark.parametrize(
    "edited",
    [
        b"",
        b"[]",
        b"{",
        b'{"status": 1}',
        ("findings", [7]),
        ("findings", [{"code": 1}]),
        ("findings", None),
        ("time", {"total_s": "long"}),
        ("time", []),
        ("joints", [{"name": "X"}]),
        ("tools", {"number": 1}),
        ("tools", [{"number": "1"}]),
    ],
    ids=str,
)
def test_results_that_were_edited_are_left_out_and_told(cli, results, tmp_path: Path, edited: object) -> None:
    out = tmp_path / "out"
    log = (out / "run.mcap").read_bytes()
    (out / "run.mcap").write_bytes(log.replace(b"results.json", b"rosults.json"))  # so those of the folder count
    whole = json.loads((out / "results.json").read_text())
    text = edited if isinstance(edited, bytes) else json.dumps({**whole, edited[0]: edited[1]}).encode()
    (out / "results.json").write_bytes(text)
    for command in (("report", "out", "--times"), ("report", "out"), ("info", "out"), ("plot", "out")):
        done = cli(*command)
        assert done.status in (0, 1) and "Traceback" not in done.err, (command, done.err)
        if command[0] == "report":
            assert done.status == 1 and "results.json holds no results of gcodesim" in done.err


@pytest.mark.parametrize("damage", ["whole", "cut", "interrupted"])
def test_info_fails_on_a_log_that_is_not_whole(cli, results, monkeypatch, tmp_path: Path, damage: str) -> None:
    log = tmp_path / "out" / "run.mcap"
    if damage == "cut":
        log.write_bytes(log.read_bytes()[:-40])
    elif damage == "interrupted":
        from gcodesim.executor import loop

        move, left = loop.move_through, [3]

        def interrupted(*arguments):
            left[0] -= 1
            if left[0] == 0:
                raise KeyboardInterrupt
            return move(*arguments)

        monkeypatch.setattr(loop, "move_through", interrupted)
        assert cli("run", "part.nc", "--cell", "cell.yaml").status == 130
    for form in ("text", "json"):
        assert cli("info", "out", "--format", form).status == 0
        asked = cli("info", "out", "--format", form, "--fail-on", "incomplete")
        assert asked.status == (0 if damage == "whole" else 1)
        assert asked.out

        def gone(*_: object) -> None:
            raise BrokenPipeError

        with monkeypatch.context() as reader:
            reader.setattr("gcodesim.cli.commands.info._print", gone)
            reader.setattr("gcodesim.cli.output.print_json", gone)
            assert cli("info", "out", "--format", form, "--fail-on", "incomplete").status == asked.status
