"""What is installed beside gcodesim, told from the names of the packages' own folders.

The standard library's reader of package metadata takes 25 ms to import, a twentieth of a short run. Almost all that is
asked needs no metadata: which version a package has, and whether any package adds something to gcodesim. Where folders
give no clear answer, the standard library is asked.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from importlib.machinery import PathFinder
from typing import Final

_OWN_GROUP: Final = re.compile(rb"^\s*\[\s*gcodesim\.", re.MULTILINE)
_WHEEL: Final = ".dist-info"
_METADATA: Final = (_WHEEL, ".egg-info")


def version_of(package: str) -> str:
    """The version of an installed package; importlib.metadata.PackageNotFoundError without it."""
    found = {path: version for path, name, version in _wheels() if name == _plain(package)}
    if len(found) == 1:
        return next(iter(found.values()))
    from importlib.metadata import version

    return version(package)


def may_extend() -> bool:
    """Whether a package may have an entry point in a group of ours: False means that certainly none has."""
    if any(hasattr(finder, "find_distributions") for finder in sys.meta_path if finder is not PathFinder):
        return True  # there are packages that only their finder knows
    return any(map(_may_extend_from, dict.fromkeys(sys.path)))


def _may_extend_from(folder: str) -> bool:
    for name in _names_in(folder):
        if name.endswith(_METADATA):
            try:
                with open(os.path.join(folder, name, "entry_points.txt"), "rb") as file:
                    if _OWN_GROUP.search(file.read()):
                        return True
            except OSError:  # it has none
                continue
        elif name.endswith(".egg"):
            return True
    return os.path.isfile(folder)  # an archive


def _names_in(folder: str) -> list[str]:
    try:
        return os.listdir(folder or os.curdir)
    except OSError:
        return []


@cache
def _wheels() -> tuple[tuple[str, str, str], ...]:
    return tuple(_wheels_in(tuple(dict.fromkeys(sys.path))))


def _wheels_in(folders: tuple[str, ...]) -> Iterator[tuple[str, str, str]]:
    """Folder, name and version of each package whose folder of metadata says both."""
    for folder in folders:
        for entry in _names_in(folder):
            if entry.endswith(_WHEEL):
                name, _, version = entry.removesuffix(_WHEEL).partition("-")
                yield os.path.join(folder, entry), _plain(name), version


def _plain(name: str) -> str:
    """The one spelling among `Foo.Bar`, `foo-bar` and `foo_bar`."""
    return re.sub(r"[-_.]+", "_", name).lower()
