"""Where this user's machine keeps what is computed once for a version: compiled kernels, tables of grammars."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path


def kept_folders(name: str) -> Iterator[Path]:
    """The folders `name` that are there, that to be preferred first; some may be read only."""
    for root in _roots():
        folder = root / name
        if _is_ours(folder):
            yield folder


def user_cache(name: str) -> Path | None:
    """The folder `name` in the first writable one of: NUMBA_CACHE_DIR, the user's cache, the temporary folder.

    None when nothing can be written anywhere.
    """
    for root in _roots():
        folder = root / name
        if _is_writable(folder):
            return folder
    return None


def _roots() -> Iterator[Path]:
    if "NUMBA_CACHE_DIR" in os.environ:
        yield Path(os.environ["NUMBA_CACHE_DIR"])
    yield Path(os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")) / "gcodesim"
    import getpass
    import tempfile

    yield Path(tempfile.gettempdir()) / f"gcodesim-{getpass.getuser()}"


def _is_writable(folder: Path) -> bool:
    import tempfile  # with what it brings it takes longer than a look at what is kept

    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return _is_ours(folder)
    except OSError:
        return False


def _is_ours(folder: Path) -> bool:
    """Whether the folder is there, and what lies in it was put there by this user or by the administrator."""
    try:
        known = folder.stat()
    except OSError:
        return False
    return not hasattr(os, "getuid") or known.st_uid in (os.getuid(), 0)
