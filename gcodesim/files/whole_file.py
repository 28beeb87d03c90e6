"""Files that are there as a whole or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

_DEVICES: Final = (Path("/dev"), Path("/dev/fd"), Path("/proc/self/fd"))


def new_file(path: Path, *, buffering: int = -1) -> BinaryIO:
    """A file of ours to write. Whatever was there is removed, so nothing is written through a planted link."""
    path.unlink(missing_ok=True)
    return open(path, "xb", buffering=buffering)


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """A file to write, beside `path`, that gets that name at the end; nothing is left behind if that fails.

    Missing folders are created. A device or a pipe such as /dev/stdout is written to directly, even if it leads
    to a file. OSError when the disk does not take it.
    """
    if _is_device(path):
        with path.open("wb") as device:
            yield device
        return
    part = path.with_name(path.name + ".part")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with new_file(part) as file:
            yield file
        part.replace(path)
    except BaseException as error:
        with suppress(OSError):  # the first failure is the one to report
            part.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:  # for a write, the system does not name the file
            error.filename = str(path)
        raise


def _is_device(path: Path) -> bool:
    """Whether `path` is something other than a file. A link counts as such only in the folder of devices."""
    if path.is_absolute() and path.parent in _DEVICES:
        return path.exists()
    return path.exists() and not (path.is_symlink() or path.is_file() or path.is_dir())


def write_whole(path: Path, data: bytes) -> None:
    """Write `data` to `path`, completely or not at all; OSError if the disk does not take it."""
    with whole_file(path) as file:
        file.write(data)
