"""A run that is killed, and a disk that is full: what can be read afterwards, and what nobody may take for whole."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from gcodesim.log.logfile import LogFile

SCRIPT = Path(__file__).with_name("crashes.py")
HEAD = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 Z5\nG1 Z-0.2 F300\n"
BODY = "".join(f"G1 X{10 + i % 60} Y{5 + i % 40} F3000\n" for i in range(900))
PROGRAM = HEAD + BODY + "G0 Z20\nM5\nM2\n"
FINAL = {"run.mcap", "results.json", "lines.csv", "stock.stl", "stock.stock"}


@pytest.fixture
def crash(cli, write, tmp_path: Path):
    """Let runs of one program die; beside them stands a whole run in `whole`."""
    write("part.nc", PROGRAM)
    cell = tmp_path / "cell.yaml"
    cell.write_text(cell.read_text() + "log: {period: 4 ms}\n")

    def crash(deaths: list[dict[str, Any]]) -> list[dict[str, Any]]:
        order = [sys.executable, SCRIPT, json.dumps(deaths), "part.nc", "cell.yaml"]
        done = subprocess.run(order, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        answer: list[dict[str, Any]] = json.loads(done.stdout.rpartition("DEATHS")[2])
        return answer

    return crash


def _final_files_are_whole(out: Path) -> set[str]:
    """The files under their final names, each equal to that of the whole run."""
    names = {path.name for path in out.iterdir() if path.suffix != ".part"}
    assert names <= FINAL
    whole = out.parent / "whole"
    assert [name for name in sorted(names) if (out / name).read_bytes() != (whole / name).read_bytes()] == []
    return names


def _log_is_the_start_of_the_whole(out: Path, seen: int) -> LogFile | None:
    """What is left of the log: at least `seen` bytes, and as far as it reads the start of the whole one."""
    if not (out / "run.mcap.part").exists():
        return None
    log = LogFile.open(out / "run.mcap")
    whole = (out.parent / "whole" / "run.mcap").read_bytes()
    left = log.path.read_bytes()
    assert seen <= log.whole <= len(left)
    assert whole.startswith(left[: log.whole])
    assert log.size - log.whole < 2 << 20  # only one record can be half
    for message in log.messages():
        assert message.t_ns <= log.end_ns
    return log


def _info_names_what_is_missing(cli, log: LogFile) -> None:
    facts = cli("info", log.path, "--format", "json").json
    assert not facts["complete"] and "incomplete" in facts["verdict"]
    if facts["result"]:
        assert facts["missing"] == ["the index"] and facts["verdict"].startswith("finished")
        return
    assert {"the index", "the result"} <= set(facts["missing"])
    if facts["chunks"]:
        place = facts["stopped_at"]
        assert f"what came after {facts['duration_s']:.3f} s, in or after part.nc:{place['line']}" in facts["missing"]
    else:
        assert "every message" in facts["missing"]


def _killed(crash, cli, tmp_path: Path, count: int, seed: int) -> list[int]:
    """Kill `count` runs at drawn places of their log; how many chunks each left behind."""
    draw = random.Random(seed)
    deaths = [{"out": f"killed{i}", "killed": draw.uniform(-0.05, 1.05)} for i in range(count)]
    chunks = []
    for death, found in zip(deaths, crash(deaths), strict=True):
        out = tmp_path / death["out"]
        names = _final_files_are_whole(out)
        log = _log_is_the_start_of_the_whole(out, found["seen"])
        if "files in" in found["said"]:
            assert names == FINAL and log is None
        if log is not None and log.complete:  # killed just before it got its name
            assert log.path.read_bytes() == (tmp_path / "whole" / "run.mcap").read_bytes()
        elif log is not None:
            assert "run.mcap" not in names
            _info_names_what_is_missing(cli, log)
            chunks.append(len(log.chunks))
    return chunks


def test_three_kills(crash, cli, tmp_path: Path) -> None:
    assert any(_killed(crash, cli, tmp_path, 3, 1)), "no run was killed while it logged"


@pytest.mark.slow
def test_fifty_kills(crash, cli, tmp_path: Path) -> None:
    chunks = _killed(crash, cli, tmp_path, 50, 2)
    assert len(set(chunks)) > 5, "the places are not spread"


def test_full_disks(crash, cli, tmp_path: Path) -> None:
    """Full in the head of the log, half way, and in the summary at its end, where only few bytes are missing."""
    deaths = [{"out": f"full{i}", "full": share} for i, share in enumerate((0.0, 0.3, 0.7, 0.998))]
    for death, found in zip(deaths, crash(deaths), strict=True):
        out = tmp_path / death["out"]
        assert found["status"] == 2 and "Traceback" not in found["said"], found["said"]
        assert "the log cannot be written: File too large; what was logged so far is in" in found["said"]
        assert [path.name for path in out.iterdir()] == ["run.mcap.part"]
        log = _log_is_the_start_of_the_whole(out, 0)
        assert log is not None
        _info_names_what_is_missing(cli, log)
        assert log.size == log.whole, "half a record was left"
        assert bool(log.chunks) == (death["full"] > 0.0)
    assert "gcodesim.result" in log.metadata, "the last disk was full before the end of the run"
