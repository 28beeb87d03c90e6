"""The folder for machine code; its name says for which sources, versions and instructions the code was made.

numba's own check does not see that a kernel in another file has changed, and
would take code that was made on a processor with other instructions.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import sys
import time
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import CodeType
from typing import Final

from gcodesim.compiled.target import level
from gcodesim.files.own_folder import OwnFolder
from gcodesim.files.user_cache import delete_unused, kept_folders, refusals, user_cache

_COMPILERS: Final = {"numba": "_version.py", "llvmlite": "_version.py", "numpy": "version.py"}
"""Packages that make machine code or define how arrays lie in memory, and their files with the version."""


_ROOT: Final = Path(__file__).parents[1]


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
    """Delete this user's folders for other sources and versions that were not used for a month."""
    delete_unused(re.compile(r"[0-9a-f]{16}"), _FILES, keep=_name(), older_ns=30 * _DAY_NS)


_DAY_NS: Final = 24 * 3600 * 10**9
_FILES: Final = (".kernel", ".part", ".nbi", ".nbc")
"""Endings of our files, and of numba's, which earlier versions kept."""


def obstacles() -> list[str]:
    """Why code is not kept where it should be."""
    return refusals(_name())


@cache
def _name() -> str:
    """Hash of the sources, of the interpreter, of the compiler's version and of the instructions it may use."""
    digest = hashlib.sha256(f"{sources()} {sys.implementation.cache_tag} {sys.abiflags} {level()}\n".encode())
    digest.update(f"{sys.platform} {platform.machine()}\n".encode())
    for name in _COMPILERS:
        digest.update(_version(name) + b"\0")
    return digest.hexdigest()[:16]


@cache
def sources() -> str:
    """Hash of every kernel source and of the way they are compiled."""
    digest = hashlib.sha256()
    for path in (*sorted(map((_ROOT / "compiled").joinpath, _WAY)), *sorted(_kernel_files(_ROOT))):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


_WAY: Final = ("arguments.py", "compiling.py", "entry.py", "memory.py")
"""Files of this package on which machine code depends."""


@cache
def source_beside(function: CodeType) -> bytes:
    """Source of a function outside this package, which does not count in the name of the folder."""
    path = Path(function.co_filename)
    if path.is_relative_to(_ROOT):
        return b""
    try:
        return path.read_bytes()
    except OSError:  # typed in
        return function.co_code + repr(function.co_consts).encode()


def _kernel_files(folder: Path) -> Iterator[Path]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith("kernels.py"):
                yield Path(entry.path)
            elif "." not in entry.name and entry.name != "__pycache__" and entry.is_dir():
                yield from _kernel_files(Path(entry.path))


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
