"""Files that are there as a whole or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

_DEVICES: Final = (Path("/dev"), Path("/dev/fd"), Path("/proc/self/fd"))


def new_file(path: Path, *, buffering: int = -1) -> BinaryIO:
    """A file of ours to write. What stood there goes: through a link that somebody planted nothing is written."""
    path.unlink(missing_ok=True)
    return open(path, "xb", buffering=buffering)


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """A file to write that stands beside `path` and gets its name at the end; nothing is left when that fails.

    Folders on the way to it are made. A device or a pipe is written itself, such as /dev/stdout, also where that leads
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
        with suppress(OSError):  # the first failure is the one to be told
            part.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:  # of a write the system does not tell the file
            error.filename = str(path)
        raise


def _is_device(path: Path) -> bool:
    """Whether `path` stands for something other than a file. A link does so in the folder of devices only."""
    if path.is_absolute() and path.parent in _DEVICES:
        return path.exists()
    return path.exists() and not (path.is_symlink() or path.is_file() or path.is_dir())


def write_whole(path: Path, data: bytes) -> None:
    """Write `data` to `path`, as a whole or not at all; OSError when the disk does not take it."""
    with whole_file(path) as file:
        file.write(data)
