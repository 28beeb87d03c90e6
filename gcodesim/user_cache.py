"""Where this user's machine keeps what is computed once for a version: compiled kernels, tables of grammars."""

from __future__ import annotations

import getpass
import os
import tempfile
from pathlib import Path


def user_cache(name: str) -> Path | None:
    """The folder `name` in the first writable one of: NUMBA_CACHE_DIR, the user's cache, the temporary folder.

    None when nothing can be written anywhere.
    """
    user = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    roots = [Path(user) / "gcodesim", Path(tempfile.gettempdir()) / f"gcodesim-{getpass.getuser()}"]
    if "NUMBA_CACHE_DIR" in os.environ:
        roots.insert(0, Path(os.environ["NUMBA_CACHE_DIR"]))
    for root in roots:
        folder = root / name
        if _writable(folder):
            return folder
    return None


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False
