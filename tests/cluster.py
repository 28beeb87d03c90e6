"""Schedulers and workers of Dask as processes of their own, on the loopback of this machine."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from distributed import Security

_LATEST_S = 600.0  # on a busy machine


@dataclass
class Cluster:
    """A scheduler with its workers; all end with the test."""

    folder: Path
    address: str = ""
    scheduler: subprocess.Popen[bytes] | None = None
    words: list[str] = field(default_factory=list)
    secret: Security | None = None
    workers: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def start(self, workers: int = 0) -> None:
        """Begin a scheduler with so many workers; all are there when this returns."""
        file = self.folder / "scheduler.json"
        command = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
        self.scheduler = self._process(*command, *self.words, "--scheduler-file", str(file))
        until = time.monotonic() + _LATEST_S
        while not self.address:
            assert time.monotonic() < until and self.scheduler.poll() is None, "the scheduler did not start"
            time.sleep(0.05)
            with suppress(FileNotFoundError, ValueError):  # it is being written
                self.address = json.loads(file.read_text())["address"]
        for _ in range(workers):
            self.add()
        if workers:
            self.wait_for_workers(workers)

    def wait_for_workers(self, count: int) -> None:
        """Until the scheduler knows of so many workers, and of no others."""
        from distributed import Client

        until = time.monotonic() + _LATEST_S
        with Client(self.address, security=self.secret, set_as_default=False, timeout=_LATEST_S) as client:
            while (known := len(client.nthreads())) != count:
                assert time.monotonic() < until, f"{known} workers in place of {count}"
                time.sleep(0.05)

    def add(self, before: str = "") -> subprocess.Popen[bytes]:
        """One more worker, whose interpreter runs the lines `before` first; it joins some time later."""
        own = self.folder / f"worker-{len(self.workers)}"
        own.mkdir()
        (own / "sitecustomize.py").write_text(before)
        command = ["distributed.cli.dask_worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
        command += self.words
        path = os.pathsep.join([str(own), os.environ.get("PYTHONPATH", "")])
        worker = self._process(*command, "--local-directory", str(own), env={**os.environ, "PYTHONPATH": path})
        self.workers.append(worker)
        return worker

    def _process(self, module: str, *words: str, env: dict[str, str] | None = None) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", module, *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=self.folder,
            env=env,
        )

    def stop(self) -> None:
        for process in (*self.workers, *([] if self.scheduler is None else [self.scheduler])):
            kill(process)


def kill(process: subprocess.Popen[bytes]) -> None:
    """`kill -9`, and wait until it is gone."""
    if process.poll() is None:
        process.send_signal(signal.SIGKILL)
    process.wait()


@pytest.fixture
def cluster(tmp_path: Path):
    """Makes clusters, for tests that kill their parts."""
    made: list[Cluster] = []

    def make(workers: int = 0, words: list[str] | None = None, secret: Security | None = None) -> Cluster:
        folder = tmp_path / f"cluster-{len(made)}"
        folder.mkdir()
        one = Cluster(folder=folder, words=words or [], secret=secret)
        made.append(one)
        one.start(workers)
        return one

    yield make
    for one in made:
        one.stop()
