"""The folder for machine code; its name says for which sources, versions and processor the code was made.

numba's own check does not see that a kernel in another file has changed, and
would take code that was made on a processor with other instructions.
"""

from __future__ import annotations

import hashlib
import os
import platform
import sys
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import CodeType
from typing import Final

from gcodesim.files.own_folder import OwnFolder
from gcodesim.files.user_cache import kept_folders, refusals, user_cache

_COMPILERS: Final = {"numba": "_version.py", "llvmlite": "_version.py", "numpy": "version.py"}
"""Packages that make machine code or define how arrays lie in memory, and their files with the version."""


_ROOT: Final = Path(__file__).parents[1]


def folders() -> Iterator[OwnFolder]:
    """Folders that may hold code, the preferred one first; some may be read-only."""
    return kept_folders(_name())


def writable_folder() -> OwnFolder | None:
    """The folder in which code can be kept; None if nothing can be kept anywhere."""
    return user_cache(_name())


def obstacles() -> list[str]:
    """Why code is not kept where it should be."""
    return refusals(_name())


@cache
def _name() -> str:
    """Hash of every kernel source, of the way they are compiled, of the compiler's version and the processor."""
    digest = hashlib.sha256(f"{sys.implementation.cache_tag} {sys.abiflags} {platform.machine()}\n".encode())
    for path in (*sorted((_ROOT / "compiled").glob("*.py")), *sorted(_kernel_files(_ROOT))):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    for name in _COMPILERS:
        digest.update(_version(name) + b"\0")
    digest.update(_processor())
    return digest.hexdigest()[:16]


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


def package(name: str) -> Path:
    """Folder of an installed package, which is not imported."""
    spec = find_spec(name)
    if spec is None or not spec.submodule_search_locations:
        raise ImportError(name)
    return Path(next(iter(spec.submodule_search_locations)))


def _kernel_files(folder: Path) -> Iterator[Path]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith("kernels.py"):
                yield Path(entry.path)
            elif "." not in entry.name and entry.name != "__pycache__" and entry.is_dir():
                yield from _kernel_files(Path(entry.path))


def _version(name: str) -> bytes:
    """The file with the version; reading the package's metadata would take longer than the rest of this module."""
    try:
        return (package(name) / _COMPILERS[name]).read_bytes()
    except OSError:
        from importlib.metadata import version

        return version(name).encode()


def _processor() -> bytes:
    """The processor's name and features: code made on another one may hold instructions this one lacks."""
    lines = []
    try:
        with open("/proc/cpuinfo", "rb") as file:
            for line in file:
                if line.startswith((b"model name", b"flags", b"Features", b"CPU part")):
                    lines.append(line)
                if not line.strip():  # the next one follows, which has the same
                    break
    except OSError:
        return platform.processor().encode()
    return b"".join(lines)
