"""What runs on a worker. Everything that comes and goes is bytes: JSON and bundles of files, never objects of ours."""

from __future__ import annotations

import json
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from gcodesim.numbers import read_json
from gcodesim.scale.abilities import abilities, misfits
from gcodesim.scale.bundle import BundleError, FileBundle, digest_of

Work = Callable[[Any, Path], FileBundle]
"""Does a task: what it is told, and the folder with its files, which it must not change."""

NEEDED: Final = "needed"
UNFIT: Final = "unfit"
DONE: Final = "done"
_MOST_FOLDERS: Final = 8

_one_at_a_time = threading.Lock()  # a run has its process for itself, however many threads a worker has
_folders: dict[str, TemporaryDirectory[str]] = {}  # they go with this process


def hello() -> bytes:
    """What this process can do."""
    return json.dumps(dict(abilities())).encode()


def carried(data: bytes) -> bytes:
    """A bundle on its way: a task of its own, which a cluster copies, and does again where its result is lost."""
    return data


def work(task: Work, request: bytes, bundle: bytes) -> bytes:
    """Do one task: `request` is JSON with what is told, and what is needed for it; `bundle` holds its files.

    The reply is a bundle as well: what it says has the `state` (done, or unfit with a reason) and the time it took.
    """
    begin = time.perf_counter()
    asked = read_json(bytes(request))
    if misfits(abilities(), asked[NEEDED]):
        return FileBundle(files={}, said={"state": UNFIT, "abilities": dict(abilities())}).pack()
    with _one_at_a_time:
        try:
            made = task(asked["said"], _folder_of(bundle))
        except Exception:  # a fault of ours or of a plugin goes back as text, not as an object
            return FileBundle(files={}, said={"state": DONE, "fault": traceback.format_exc()}).pack()
    took = time.perf_counter() - begin
    return FileBundle(files=made.files, said={"state": DONE, "said": made.said, "took_s": took}).pack()


def _folder_of(data: bytes) -> Path:
    """A folder with the files of a bundle; the last few are kept, because many tasks have the same."""
    digest = digest_of(data)
    known = _folders.get(digest)
    if known is not None and Path(known.name).is_dir():
        return Path(known.name)
    bundle = FileBundle.unpack(data)
    while len(_folders) >= _MOST_FOLDERS:
        _folders.pop(next(iter(_folders))).cleanup()
    place = TemporaryDirectory(prefix="gcodesim-", dir=_own_place(), ignore_cleanup_errors=True)
    bundle.write(Path(place.name))
    _folders[digest] = place
    return Path(place.name)


def _own_place() -> str | None:
    """The folder of this worker, which the engine clears away, also after a worker that was killed."""
    with suppress(ImportError, ValueError):  # no worker
        from distributed import get_worker

        return str(get_worker().local_directory)
    return None


def stand_in(said: Any, folder: Path) -> FileBundle:
    """A task that takes `said["takes_s"]` and does nothing: for measuring what a cluster bears."""
    del folder
    time.sleep(float(said["takes_s"]))
    return FileBundle(files={}, said={"number": said["number"]})


__all__ = ["DONE", "NEEDED", "UNFIT", "BundleError", "Work", "carried", "hello", "stand_in", "work"]
