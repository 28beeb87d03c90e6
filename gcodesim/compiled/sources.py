"""Which sources the machine code of a kernel depends on, and a hash of them, so that edited code is compiled anew.

numba's own check does not see that a kernel in another file has changed. Here a kernel depends on its file, on the
kernel files from which that file imports, directly or not, and on the way kernels are compiled; what is none of these
can be edited without compiling anything.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import CodeType
from typing import Final, NamedTuple

ROOT: Final = Path(__file__).parents[1]
_PACKAGE: Final = f"{ROOT.name}."
_THIS: Final = f"{ROOT.name}.compiled."
WAY: Final = (
    "arguments.py",
    "compiling.py",
    "entry.py",
    "lowering.py",
    "memory.py",
    "passes.py",
    "shortcuts.py",
    "target.py",
)
"""Files of this package on which machine code depends."""
_IMPORT: Final = re.compile(
    rb"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|.*)|import[ \t]+([\w.]+))", re.MULTILINE
)
_COMMENT: Final = re.compile(rb"#.*")


class _Source(NamedTuple):
    """A file and the files of the package that it imports."""

    path: Path
    digest: bytes
    imports: tuple[Path, ...]


def hash_of_sources(function: CodeType) -> str:
    """Hash of everything on which the machine code of a function of Python depends."""
    path = Path(function.co_filename)
    if not path.is_file():  # typed in
        return _sum([_way(), function.co_code, repr(function.co_consts).encode()])
    return _hash_of_file(path)


def edited_since(function: CodeType, time_ns: int) -> bool:
    """Whether a source on which the machine code of a function depends was written after this time, or is gone."""
    path = Path(function.co_filename)
    try:
        return path.is_file() and any(os.stat(file).st_mtime_ns > time_ns for file in _behind(path))
    except OSError:
        return True


@cache
def _hash_of_file(path: Path) -> str:
    return _sum([_way(), *(_read(file).digest for file in sorted(_behind(path)))])


def _behind(path: Path) -> set[Path]:
    """A file and what it takes from other files: kernels from kernel files and packages, constants from all."""
    seen = {path}
    ahead = [path]
    while ahead:
        for file in _read(ahead.pop()).imports:
            if file not in seen:
                seen.add(file)
                # the files beside the kernels say names of types and columns; what they import is of no concern
                if file.name.endswith("kernels.py") or file.name == "__init__.py":
                    ahead.append(file)
    return seen


@cache
def _read(path: Path) -> _Source:
    text = path.read_bytes()
    return _Source(path, hashlib.sha256(text).digest(), tuple(sorted(set(_imported(text)))))


def _imported(text: bytes) -> Iterator[Path]:
    """Files of the package, other than of this one, that a source names after `from` or `import`."""
    for package, names, module in _IMPORT.findall(text):
        file = _file((package or module).decode())
        if file is not None:
            yield file
        if file is None or file.name == "__init__.py":  # names may be those of modules
            for name in _COMMENT.sub(b"", names).strip(b"()").split(b","):
                words = name.split()
                found = _file(f"{package.decode()}.{words[0].decode()}") if words else None
                if found is not None:
                    yield found


@cache
def _file(module: str) -> Path | None:
    """The file of a module of this package, None for one of another package or of `compiled`."""
    if not module.startswith(_PACKAGE) or f"{module}.".startswith(_THIS):
        return None
    place = os.path.join(ROOT.parent, *module.split("."))
    for path in (f"{place}.py", os.path.join(place, "__init__.py")):
        if os.path.isfile(path):
            return Path(path)
    return None


@cache
def _way() -> bytes:
    return b"".join(hashlib.sha256((ROOT / "compiled" / name).read_bytes()).digest() for name in WAY)


def _sum(parts: list[bytes]) -> str:
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]
