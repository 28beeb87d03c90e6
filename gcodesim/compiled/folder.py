"""The folder for machine code; its name says for which versions and instructions the code was made.

numba's own check would take code that was made on a processor with other instructions. For which sources code was
made is in its own name, see `sources`.
"""

from __future__ import annotations

import hashlib
import platform
import re
import sys
import time
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from gcodesim.compiled.target import level
from gcodesim.files.own_folder import OwnFolder
from gcodesim.files.user_cache import delete_unused, kept_folders, refusals, user_cache

_COMPILERS: Final = {"numba": "_version.py", "llvmlite": "_version.py", "numpy": "version.py"}
"""Packages that make machine code or define how arrays lie in memory, and their files with the version."""


def folders() -> Iterator[OwnFolder]:
    """Folders that may hold code, the preferred one first; some may be read-only."""
    return kept_folders(_name())


def writable_folder() -> OwnFolder | None:
    """The folder in which code can be kept; None if nothing can be kept anywhere."""
    return user_cache(_name())


def mark_used(folder: OwnFolder) -> None:
    """Note, at most once a day, that a folder is in use, so that it is not deleted as an old one."""
    if time.time_ns() - folder.last_used_ns() > _DAY_NS:
        folder.mark_used()


def delete_old() -> None:
    """Delete this user's folders for other versions that were not used for a month, and code that is one of too many.

    Who edits kernels fills the folder with code of sources that are no more.
    """
    delete_unused(re.compile(r"[0-9a-f]{16}"), _FILES, keep=_name(), older_ns=30 * _DAY_NS)
    for folder in folders():
        names = [name for name in folder.names() if name.endswith(_FILES)]
        if len(names) > _MOST:
            for name in sorted(names, key=folder.changed_ns)[: len(names) - _MOST // 2]:
                folder.delete(name)


_MOST: Final = 8000
"""Files that a folder may hold; a version of all kernels is a few hundred."""
_DAY_NS: Final = 24 * 3600 * 10**9
_FILES: Final = (".kernel", ".part", ".nbi", ".nbc")
"""Endings of our files, and of numba's, which earlier versions kept."""


def obstacles() -> list[str]:
    """Why code is not kept where it should be."""
    return refusals(_name())


@cache
def _name() -> str:
    """Hash of the interpreter, of the compiler's version and of the instructions it may use."""
    digest = hashlib.sha256(f"{sys.implementation.cache_tag} {sys.abiflags} {level()}\n".encode())
    digest.update(f"{sys.platform} {platform.machine()}\n".encode())
    for name in _COMPILERS:
        digest.update(_version(name) + b"\0")
    return digest.hexdigest()[:16]


def _version(name: str) -> bytes:
    """The file with the version; reading the package's metadata would take longer than the rest of this module."""
    spec = find_spec(name)
    if spec is None or not spec.submodule_search_locations:
        return b"not installed"
    try:
        return (Path(next(iter(spec.submodule_search_locations))) / _COMPILERS[name]).read_bytes()
    except OSError:
        from importlib.metadata import version

        return version(name).encode()
