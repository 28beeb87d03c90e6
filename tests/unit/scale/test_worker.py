"""What a task leaves on the machine on which it was done."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

_DONE = """
from pathlib import Path
from gcodesim.scale.bundle import FileBundle
from gcodesim.scale.hands import Alone, Parcel, WorkerTask

def read(said, folder):
    return FileBundle(files={}, said=(folder / "sub" / f"{said}.nc").read_text())

def task(number):
    parcel = Parcel.of(FileBundle(files={f"sub/{number}.nc": b"M2"}))
    return WorkerTask(key=str(number), said=number, parcel=parcel)

print([end.made.said for end in Alone().do(read, [*map(task, range(20)), task(19)])])
"""


def test_the_files_of_tasks_go_with_the_process_that_did_them(tmp_path: Path) -> None:
    """Twenty bundles, more than are kept for the tasks to come."""
    environment = os.environ | {"TMPDIR": str(tmp_path)}

    done = subprocess.run([sys.executable, "-c", _DONE], env=environment, capture_output=True, text=True, check=True)

    assert done.stdout.strip() == str(["M2"] * 21)
    assert list(tmp_path.iterdir()) == []
