"""Where this user's machine keeps things that are computed once per version: compiled kernels, grammar tables.

Never below a folder with a known name that anybody could create, as in the temporary folder, and only in folders
that nobody else can write to; otherwise everything is computed again.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from gcodesim.files.own_folder import NotOwn, OwnFolder, open_own_folder


def kept_folders(name: str) -> Iterator[OwnFolder]:
    """The existing folders `name`, the preferred one first; some may be read-only."""
    for root in _roots():
        folder = _open(root, name, make=False)
        if isinstance(folder, OwnFolder):
            yield folder


def user_cache(name: str) -> OwnFolder | None:
    """The folder `name` in the first place that can be written to: NUMBA_CACHE_DIR, then the user's cache.

    None when nothing can be kept anywhere.
    """
    for root in _roots():
        folder = _open(root, name, make=True)
        if isinstance(folder, OwnFolder) and os.access(folder.path, os.W_OK):
            return folder
    return None


def refusals(name: str) -> list[str]:
    """Why nothing is kept where it should be, with a line for each place that cannot be used."""
    folders = (_open(root, name, make=True) for root in _roots())
    return [folder for folder in folders if isinstance(folder, str)]


def delete_unused(names: re.Pattern[str], files: tuple[str, ...], *, keep: str, older_ns: int) -> None:
    """Delete folders whose whole name is one of `names`, with all files that have one of these endings.

    Only in the place that is used, only folders of this user's own (never through a link), and none that was used
    within the last `older_ns`, nor `keep`. A folder that holds anything else stays.
    """
    used = user_cache(keep)
    if used is None:
        return
    try:
        place = open_own_folder(used.path.parent)
    except NotOwn:
        return
    for name in place.names():
        folder = place.folder(name) if names.fullmatch(name) and name != keep else None
        if folder is None or time.time_ns() - folder.last_used_ns() < older_ns:
            continue
        for file in folder.names():
            if file.endswith(files):
                folder.delete(file)
        place.delete_folder(name)


class _Root(NamedTuple):
    """A folder below which things are kept; its last `own` parts have to be this user's."""

    path: Path
    own: int


def _roots() -> Iterator[_Root]:
    """The place that the user names, then the usual one; both absolute, since no folder in a project is trusted."""
    named = os.environ.get("NUMBA_CACHE_DIR")
    if named:
        yield _Root(Path(named), 1)
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    yield _Root(Path(caches) / "gcodesim", 2)


def _open(root: _Root, name: str, *, make: bool) -> OwnFolder | str:
    folder = _OPEN.get((root, name))
    if folder is not None and folder.is_there:
        return folder
    try:
        _OPEN[root, name] = folder = open_own_folder(root.path / name, own=root.own + 1, make=make)
    except NotOwn as reason:
        return str(reason)
    return folder


_OPEN: dict[tuple[_Root, str], OwnFolder] = {}
