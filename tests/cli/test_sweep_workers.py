"""A sweep whose workers, client and schedulers die: after `--resume` each run stands once, as if run alone."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from gcodesim.cli import main
from gcodesim.sweep.journal import Journal
from tests.cli.test_sweep import CELL, PROGRAM
from tests.cluster import Cluster, cluster, kill

__all__ = ["cluster"]
STUDY = """program: slot.nc
cell: cell.yaml
vary:
  feed: {parameter: feed, from: 200, to: 400, steps: 8}
  depth: {parameter: depth, values: [1]}
"""


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a study of eight runs."""
    folder = tmp_path / "study"
    folder.mkdir()
    for name, text in (("slot.nc", PROGRAM), ("cell.yaml", CELL), ("study.yaml", STUDY)):
        (folder / name).write_text(text)
    monkeypatch.chdir(folder)
    return folder


def client(*words: str, alone: bool = False) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "gcodesim", "sweep", "study.yaml", "--out", "out", *words]
    return subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=alone,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # tests may run in the background
    )


def rows_kept(folder: Path) -> int:
    journal = folder / "out" / "runs.jsonl"
    return max(journal.read_bytes().count(b"\n") - 1, 0) if journal.is_file() else 0


def wait_for(folder: Path, rows: int, process: subprocess.Popen[bytes]) -> None:
    while rows_kept(folder) < rows and process.poll() is None:
        time.sleep(0.01)


def ask_for(folder: Path, runs: int) -> None:
    """Make the study so large that it is not done before somebody dies."""
    (folder / "study.yaml").write_text(STUDY.replace("steps: 8", f"steps: {runs}"))


def as_if_alone(folder: Path, count: int = 8) -> bool:
    """Whether tables and the runs kept are those of a sweep in one process."""
    assert main(["sweep", "study.yaml", "--out", "alone", "-j", "1"]) == 0
    tables = all(
        (folder / "out" / name).read_bytes() == (folder / "alone" / name).read_bytes()
        for name in ("runs.csv", "runs.parquet", "sweep.json")
    )
    runs = [sorted((folder / out / "runs.jsonl").read_bytes().splitlines()) for out in ("out", "alone")]
    return tables and runs[0] == runs[1] and len(runs[0]) == count + 1


def test_a_worker_and_the_scheduler_die_and_no_run_is_lost(
    study: Path, cluster, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr("gcodesim.scale.crew._AHEAD", 1)  # else all may have ended before the third is kept
    monkeypatch.setattr("gcodesim.scale.crew._LEAST_AHEAD", 2)
    one = cluster(workers=2)
    dies = {1: one.workers[0], 3: one.scheduler}
    add = Journal.add

    def add_and_kill(journal: Journal, key: str, said: object) -> None:
        add(journal, key, said)
        if (process := dies.pop(rows_kept(study), None)) is not None:
            kill(process)

    monkeypatch.setattr(Journal, "add", add_and_kill)

    assert main(["sweep", "study.yaml", "--out", "out", "--scheduler", one.address]) == 2

    said = capsys.readouterr().err
    assert "the scheduler is gone" in said and "`--resume` goes on" in said
    assert 3 <= rows_kept(study) < 8
    assert main(["sweep", "study.yaml", "--out", "out", "--resume", "-j", "1"]) == 0
    assert as_if_alone(study)


def test_ctrl_c_keeps_what_is_done(study: Path, standing: Cluster):
    check_that_ctrl_c_keeps_what_is_done(study, "--scheduler", standing.address)


def check_that_ctrl_c_keeps_what_is_done(folder: Path, *words: str) -> None:
    ask_for(folder, 1000)
    process = client(*words, alone=True)
    wait_for(folder, 1, process)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all processes of the command

    said = process.communicate(timeout=600)[0].decode()

    assert process.returncode == 130
    assert "Traceback" not in said and "`--resume` goes on" in said
    assert (folder / "out" / "runs.csv").read_text().count("\n") == rows_kept(folder) + 1


@pytest.mark.slow
def test_ctrl_c_reaches_the_command_and_leaves_no_worker(study: Path):
    check_that_ctrl_c_keeps_what_is_done(study, "-j", "2")


@pytest.mark.slow
def test_two_schedulers_die_and_a_third_process_finishes(study: Path, cluster):
    ask_for(study, 200)
    first = cluster(workers=2)
    process = client("--scheduler", first.address)
    wait_for(study, 1, process)
    kill(first.workers[0])
    wait_for(study, 3, process)
    kill(first.scheduler)
    said = process.communicate()[0].decode()
    assert process.returncode == 2, said
    assert "the scheduler is gone" in said and "`--resume` goes on" in said
    kept = rows_kept(study)
    assert 3 <= kept < 200

    second = cluster(workers=1)
    process = client("--scheduler", second.address, "--resume")
    wait_for(study, kept + 1, process)
    kill(process)
    assert main(["sweep", "study.yaml", "--out", "out", "--resume", "--scheduler", second.address]) == 0

    assert as_if_alone(study, 200)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_whatever_dies_at_random_moments(study: Path, cluster, seed: int):
    chance = random.Random(seed)
    for _ in range(4):
        one = cluster(workers=2)
        process = client("--scheduler", one.address)
        wait_for(study, rows_kept(study) + chance.randrange(3), process)
        time.sleep(chance.random() * 0.3)
        kill(chance.choice([process, one.scheduler, one.workers[0]]))
        process.communicate()
        one.stop()
    process = client("-j", "2")
    wait_for(study, rows_kept(study) + 1, process)
    kill(process)
    process.communicate()
    assert main(["sweep", "study.yaml", "--out", "out", "--resume", "-j", "1"]) == 0

    assert as_if_alone(study)
