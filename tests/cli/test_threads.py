"""A command starts no thread that waits for work by spinning."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import sys
from gcodesim.__main__ import main
status = main()
import numpy
threads = open("/proc/self/status").read().split("Threads:")[1].split()[0]
print("threads", threads, file=sys.stderr)
sys.exit(status)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="threads are counted in /proc")
@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="numpy starts no threads on one core")
def test_numpy_starts_no_threads_for_a_command(tmp_path):
    program = tmp_path / "part.nc"
    program.write_text("G21 G90\nG1 X1 F100\nM2\n")
    surroundings = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, "lint", str(program)], env=surroundings, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "threads 1\n" in done.stderr
