"""Whatever happens to the process or the disk, what is on disk can be read and nothing half has the final name."""

import errno
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from gcodesim.log import LogWriteError
from gcodesim.log.summary import summary

MS = 1_000_000

ENDLESS = """
import sys
from pathlib import Path
import numpy as np
sys.path.insert(0, sys.argv[1])
import synthetic
from gcodesim.log import LogWriter
log = LogWriter(Path(sys.argv[2]), synthetic.description())
k = 0
while True:
    t = (np.arange(50) + 50 * k) * 20_000_000
    log.program(int(t[0]), file="part.nc", line=k % 6 + 1, text=f"block {k}", block=k)
    log.window(t, **synthetic.columns(t))
    if k:
        log.flush_before(int(t[0]))
        print(int(t[0]), flush=True)
    k += 1
"""


def test_the_final_name_comes_with_the_end(run, new_log, tmp_path):
    path = tmp_path / "out" / "run.mcap"
    path.parent.mkdir()
    path.write_text("a log of another run")
    log = new_log(path)

    assert [p.name for p in path.parent.iterdir()] == ["run.mcap.part"]
    log.close(0, "finished")
    assert [p.name for p in path.parent.iterdir()] == ["run.mcap"]
    assert summary(path).verdict == "finished"


def test_a_killed_run_leaves_all_that_it_reported(run, tmp_path):
    path = tmp_path / "run.mcap"
    folder = str(Path(run.__file__).parent)
    child = subprocess.Popen([sys.executable, "-c", ENDLESS, folder, str(path)], stdout=subprocess.PIPE, text=True)
    reported = 0
    for _ in range(20):
        reported = int(child.stdout.readline())
    time.sleep(0.003)
    child.send_signal(signal.SIGKILL)
    child.wait()
    child.stdout.close()

    found = summary(path)
    assert found.path.name == "run.mcap.part"
    assert not found.complete and found.problem == "the file ends before its index"
    assert found.duration_ns >= reported - 20 * MS
    assert found.verdict == f"incomplete, stopped at part.nc:{found.stopped_at.line}"
    assert found.run["program"] == "part.nc" and "program.nc" in found.attachments
    counts = {topic.name: topic.count for topic in found.topics}
    assert counts["/tf"] == counts["/wrench"] >= reported // (20 * MS)


def test_a_full_disk_is_told_and_leaves_whole_records(run, new_log, tmp_path):
    """A limit on the size of files acts like a disk that is full after 1.5 MB."""
    path = tmp_path / "run.mcap"
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    old = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    log = new_log(path)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1_500_000, before[1]))
    try:
        with pytest.raises(LogWriteError, match="cannot be written") as caught:
            for k in range(100):
                t = (np.arange(500) + 500 * k) * 20 * MS
                log.window(t, **run.columns(t))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, old)
    assert caught.value.errno == errno.EFBIG
    assert caught.value.filename == str(tmp_path / "run.mcap.part")
    with pytest.raises(LogWriteError, match="closed already"):
        log.close(10**12, "failed")

    found = summary(path)
    assert not path.exists() and not found.complete
    assert 1_000_000 < os.path.getsize(found.path) <= 1_500_000
    assert found.duration_ns > 0


def test_a_folder_that_cannot_be_used_is_told(run, new_log, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(LogWriteError, match="cannot be written"):
        new_log(tmp_path / "file" / "run.mcap")


def test_an_exception_keeps_what_was_given(run, new_log, tmp_path):
    t = np.arange(10) * 20 * MS
    with pytest.raises(ZeroDivisionError), new_log(tmp_path / "run.mcap") as log:
        log.program(0, file="part.nc", line=2, text="T1 M6")
        log.window(t, **run.columns(t))
        raise ZeroDivisionError

    found = summary(tmp_path / "run.mcap")
    assert found.verdict == "incomplete, stopped at part.nc:2"
    assert found.duration_ns == 180 * MS


def test_an_exception_before_anything_has_moved_leaves_no_file(run, new_log, tmp_path):
    """As Ctrl-C while a run begins."""
    with pytest.raises(KeyboardInterrupt), new_log(tmp_path / "run.mcap") as log:
        log.program(0, file="part.nc", line=2, text="T1 M6")
        raise KeyboardInterrupt

    assert list(tmp_path.iterdir()) == []


def test_an_attachment_comes_once(run, new_log, tmp_path):
    log = new_log(tmp_path / "run.mcap")
    with pytest.raises(ValueError, match=r"'cell\.yaml' already"):
        log.close(0, "finished", attachments={"cell.yaml": b""})
