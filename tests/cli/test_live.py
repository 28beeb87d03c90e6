"""`gcodesim run --live`: a viewer while the run goes on."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from gcodesim.log.logfile import LogFile
from tests.viewer import Viewer

BODY = "".join(f"G1 X{10 + i % 60} Y{5 + i % 40} F3000\n" for i in range(300))
PROGRAM = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 Z5\nG1 Z-0.2 F300\n" + BODY + "G0 Z20\nM5\nM2\n"
PATIENT = """  # a run that begins when its viewer is there, and ends when it has gone
import sys, time
from gcodesim.cli import main
from gcodesim.log import live

live._LINGER = 600.0
opened = live.LiveView.open

def opened_and_seen(self, topics):
    opened(self, topics)
    while not all(channel.has_sinks() for channel in self._channels):
        time.sleep(0.01)

live.LiveView.open = opened_and_seen
sys.exit(main(sys.argv[1:]))
"""


def test_a_viewer_follows_a_run_and_changes_nothing(cli, write, tmp_path: Path) -> None:
    write("part.nc", PROGRAM)
    assert cli("run", "part.nc", "--cell", "cell.yaml", "--out", "alone").status == 0
    log = LogFile.open(tmp_path / "alone" / "run.mcap")
    stored = {(log.channels[m.channel].topic, m.t_ns, m.data) for m in log.messages()}
    topics = {channel.topic for channel in log.channels.values()}
    last = {topic for topic, t_ns, _ in stored if t_ns == log.end_ns}
    assert last
    process = subprocess.Popen(
        [sys.executable, "-c", PATIENT, "run", "part.nc", "--cell", "cell.yaml", "--live", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONHASHSEED": "7"},
    )
    assert process.stderr is not None
    said = process.stderr.readline()
    assert said.startswith("live at ws://localhost:")
    viewer = Viewer(said.split()[2])
    viewer.wait(lambda: {topic for topic, t_ns, _ in viewer.messages if t_ns == log.end_ns} >= last)
    viewer.leave()
    _, errors = process.communicate(timeout=600)

    assert process.returncode == 0, errors
    for path in sorted((tmp_path / "alone").iterdir()):
        assert path.read_bytes() == (tmp_path / "out" / path.name).read_bytes(), path.name
    assert set(viewer.messages) <= stored
    assert {topic for topic, _, _ in viewer.messages} == topics


@pytest.mark.parametrize("value", ["part.nc", "-1", "65536", "8765.5"])
def test_what_is_no_port(cli, value: str) -> None:
    done = cli("run", "slot.nc", "--cell", "cell.yaml", f"--live={value}")
    assert done.status == 2 and f"'{value}' is no port from 0 to 65535" in done.err


def test_without_the_package_nothing_is_begun(cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gcodesim.extras._is_installed", lambda package: package != "foxglove-sdk")
    done = cli("run", "slot.nc", "--cell", "cell.yaml", "--live")
    assert done.status == 2 and "needs the extra `live`" in done.err and "foxglove-sdk" in done.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("value", ["viewer.example.org", "https://viewer/x", "null"])
def test_what_is_no_origin(cli, value: str) -> None:
    done = cli("run", "slot.nc", "--cell", "cell.yaml", "--live", "0", f"--live-from={value}")
    assert done.status == 2 and f"'{value}' is no origin of pages" in done.err
