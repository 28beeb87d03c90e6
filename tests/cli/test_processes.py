"""What only whole processes show: imports, signals, and equal bytes in every process and folder."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

CHECK_LOG = Path(__file__).parents[1] / "data" / "log" / "check_log.py"
HEAVY = {"numpy", "numba", "scipy", "pybullet", "rich", "trimesh", "mcap"}


def _spawn(*arguments: object, cwd: Path, **more: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "gcodesim", *map(str, arguments)],
        cwd=cwd,
        env={**os.environ, **more},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # who runs the tests in the background may have SIGINT ignored, and a child would inherit that
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def _modules(arguments: list[str], cwd: Path) -> set[str]:
    code = (
        "import sys\nfrom gcodesim.cli import main\n"
        f"try:\n    main({arguments!r})\nexcept SystemExit:\n    pass\n"
        "print('MODULES', *sorted({name.partition('.')[0] for name in sys.modules}))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=cwd, capture_output=True, text=True, check=True)
    return set(done.stdout.rpartition("MODULES")[2].split())


@pytest.mark.parametrize(
    "arguments", [["--help"], ["run", "--help"], ["canon", "slot.nc"], ["lint", "slot.nc"], ["explain", "GS203"]]
)
def test_light_commands_import_nothing_heavy(cli, tmp_path: Path, arguments: list[str]) -> None:
    assert _modules(arguments, tmp_path) & HEAVY == set()


def test_check_of_a_short_program_does_without_the_compiler(cli, tmp_path: Path) -> None:
    assert _modules(["check", "slot.nc", "--cell", "cell.yaml"], tmp_path) & HEAVY == {"numpy"}


def test_statuses_of_the_program_itself(cli, write, tmp_path: Path) -> None:
    write("bad.nc", "G21 G90\nG1 X5 Y\nM2\n")
    ends = {}
    for name, arguments in {
        "clean": ("lint", "slot.nc"),
        "findings": ("lint", "bad.nc"),
        "usage": ("lint", "absent.nc"),
        "option": ("lint", "--frobnicate"),
    }.items():
        process = _spawn(*arguments, cwd=tmp_path)
        _, said = process.communicate(timeout=600)
        ends[name] = process.returncode
        assert "Traceback" not in said
    assert ends == {"clean": 0, "findings": 1, "usage": 2, "option": 2}


def test_output_into_a_pipe_that_closes(cli, write, tmp_path: Path) -> None:
    write("long.nc", "G21 G90\n" + "G0 X1\nG0 X2\n" * 20_000 + "M2\n")
    process = _spawn("canon", "long.nc", cwd=tmp_path)
    assert process.stdout is not None and process.stderr is not None
    process.stdout.readline()
    process.stdout.close()
    assert "Traceback" not in process.stderr.read()
    process.stderr.close()
    assert process.wait(600) == 0


def test_a_verdict_stands_when_nobody_reads_it_to_the_end(cli, write, tmp_path: Path) -> None:
    write("wrong.nc", "G21 G90\n" + "".join(f"G1 X{i} Y F100\n" for i in range(3000)) + "M2\n")
    for arguments in (("lint", "wrong.nc"), ("check", "wrong.nc", "--cell", "cell.yaml", "--format", "json")):
        process = _spawn(*arguments, cwd=tmp_path)
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        assert "Traceback" not in process.stderr.read()
        process.stderr.close()
        assert process.wait(600) == 1


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_an_interrupt_leaves_a_log_that_opens(cli, write, tmp_path: Path, world: str) -> None:
    body = "".join(f"G1 X{10 + i % 60} Y{5 + i % 40} F200\n" for i in range(6000))
    write("part.nc", "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 Z5\nG1 Z-0.2 F300\n" + body + "G0 Z20\nM5\nM2\n")
    process = _spawn("run", "part.nc", "--cell", "cell.yaml", "--world", world, cwd=tmp_path)
    begin = time.monotonic()
    part = tmp_path / "out" / "run.mcap.part"
    while time.monotonic() - begin < 600 and not (part.exists() and part.stat().st_size > 300_000):
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    said, errors = process.communicate(timeout=600)

    assert process.returncode == 130, said + errors
    assert "Traceback" not in errors
    assert "stopped at part.nc:" in said
    assert (tmp_path / "out" / "run.mcap").exists() and not part.exists()
    told = cli("info", "out/run.mcap")
    assert told.status == 0
    line = int(told.out.split("incomplete, stopped at part.nc:")[1].split()[0].rstrip(","))
    assert 6 < line < 6006
    results = json.loads((tmp_path / "out" / "results.json").read_text())
    assert results["status"] == "failed"
    rows = list(csv.DictReader((tmp_path / "out" / "lines.csv").read_text().splitlines()))
    assert max(int(row["line"]) for row in rows) == line == results["stopped_at"]["line"]
    assert sum(float(row["time_s"]) for row in rows) == pytest.approx(results["time"]["total_s"], rel=1e-4)
    assert results["tools"][0]["feed_mm"] == pytest.approx(results["distance"]["feed_mm"])
    ended = cli("info", "out/run.mcap", "--format", "json").json["duration_s"]
    assert results["time"]["total_s"] == pytest.approx(ended, abs=0.05)  # of a begun line what ran


@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGINT])
def test_workers_end_with_a_test_run_however_it_ends(cli, write, tmp_path: Path, by: signal.Signals) -> None:
    long = "".join(f"G1 X{10 + i % 60} Y{5 + i % 40} F200\n" for i in range(6000))
    for name in ("a.nc", "b.nc"):
        write(name, f"G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 Z5\nG1 Z-0.2 F300\n{long}M5\nM2\n")
    process = _spawn("test", "-j", "2", "--cell", "cell.yaml", cwd=tmp_path)
    workers: list[int] = []
    begin = time.monotonic()
    while len(workers) < 3 and time.monotonic() - begin < 600:  # the third keeps count of what workers share
        workers = [int(pid) for pid in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]
        time.sleep(0.02)
    assert process.poll() is None and len(workers) == 3
    process.send_signal(by)
    said, errors = process.communicate(timeout=600)  # workers hold the same streams: this ends when all have ended
    assert process.returncode == (130 if by == signal.SIGINT else -by), said + errors
    assert "Traceback" not in errors


def test_a_worker_that_is_killed_is_told(cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from gcodesim.regress import suite

    for name in ("a.nc", "b.nc"):
        (tmp_path / name).write_bytes((tmp_path / "slot.nc").read_bytes())
    monkeypatch.setattr(suite, "judged", _killed)
    done = cli("test", "-j", "2", "--cell", "cell.yaml")
    assert done.status == 2 and "one of 2 workers was killed, perhaps for want of memory" in done.err


def _killed(*_: object) -> None:
    """What a worker does instead of its case, at the hand of a system without memory."""
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize("cell", ["cell.yaml", "arm.yaml"])
@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_the_same_bytes_in_every_process_and_folder(cli, tmp_path: Path, cell: str, world: str) -> None:
    runs = []
    for number in (1, 2):
        folder = tmp_path / ("a" * number)
        folder.mkdir()
        for name in ("slot.nc", cell):
            (folder / name).write_bytes((tmp_path / name).read_bytes())
        seed = str(number * 1234)
        out = f"out{number}"
        arguments = ("run", "slot.nc", "--cell", cell, "--world", world, "--out", out)
        runs.append((_spawn(*arguments, cwd=folder, PYTHONHASHSEED=seed), folder / out))
    contents = []
    for process, folder in runs:
        said, errors = process.communicate(timeout=600)
        assert process.returncode == 0, said + errors
        contents.append({path.name: path.read_bytes() for path in sorted(folder.iterdir())})

    first, second = contents
    assert set(first) == {"run.mcap", "results.json", "lines.csv", "stock.stl", "stock.stock"}
    assert [name for name in first if first[name] != second[name]] == []
    assert not any(str(tmp_path).encode() in data for data in first.values())
    checked = subprocess.run([sys.executable, CHECK_LOG, runs[0][1] / "run.mcap"], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def _files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_the_same_bytes_on_one_core_and_beside_others(cli, tmp_path: Path) -> None:
    """One run alone, then four at once, two of them on one core: which thread is first must not show."""
    assert cli("run", "slot.nc", "--cell", "cell.yaml", "--out", "alone").status == 0
    runs = [_spawn("run", "slot.nc", "--cell", "cell.yaml", "--out", f"out{i}", cwd=tmp_path) for i in range(4)]
    for process in runs[:2]:
        os.sched_setaffinity(process.pid, {min(os.sched_getaffinity(0))})
    for number, process in enumerate(runs):
        said, errors = process.communicate(timeout=600)
        assert process.returncode == 0, said + errors
        assert _files(tmp_path / f"out{number}") == _files(tmp_path / "alone")


@pytest.mark.slow
@pytest.mark.parametrize("cell", ["cell.yaml", "arm.yaml"])
def test_the_same_bytes_with_a_cold_cache(cli, tmp_path: Path, cell: str) -> None:
    """Kernels that were compiled just now, those of the cache, and those of a cache of their own."""
    assert cli("run", "slot.nc", "--cell", cell, "--world", "bullet", "--out", "known").status == 0
    for name in ("cold", "warm"):
        arguments = ("run", "slot.nc", "--cell", cell, "--world", "bullet", "--out", name)
        process = _spawn(*arguments, cwd=tmp_path, XDG_CACHE_HOME=str(tmp_path / "cache"))
        said, errors = process.communicate(timeout=900)
        assert process.returncode == 0, said + errors
        assert ("compiling kernels" in errors) == (name == "cold")
        assert _files(tmp_path / name) == _files(tmp_path / "known")
