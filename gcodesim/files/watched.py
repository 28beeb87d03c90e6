"""Files that somebody edits: which of them have changed since one last looked."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple


class FileState(NamedTuple):
    """What tells a file from how it was: `digest` is of its bytes, empty for a file that is not there."""

    modified_ns: int
    size: int
    digest: bytes


_GONE = FileState(0, 0, b"")


class WatchedFiles:
    """Files by their states. A file is read only if its time or size differ from before; `reads` counts that.

    A file that is gone has changed when it is still gone at the next look: an editor that writes a file anew may take
    it away first.
    """

    def __init__(self, paths: Iterable[Path] = ()) -> None:
        self.reads = 0
        self._states: dict[Path, FileState] = {}
        self._missed: set[Path] = set()
        self.watch(paths)

    def watch(self, paths: Iterable[Path]) -> None:
        """Watch these files and no others; those that were watched before keep their states."""
        self._states = {path: self._states.get(path) or self._state(path, _GONE) for path in sorted(set(paths))}

    def join(self, paths: Iterable[Path]) -> None:
        """Watch these files too; those that were not watched count as changed."""
        self._states |= {path: _GONE for path in paths if path not in self._states}

    def changed(self) -> list[Path]:
        """The files whose bytes differ from when this was last asked, in order, and those that came or went."""
        found = []
        for path, before in self._states.items():
            now = self._state(path, before)
            if now is _GONE and before is not _GONE and path not in self._missed:
                self._missed.add(path)
                continue
            self._missed.discard(path)
            if now.digest != before.digest:
                found.append(path)
            self._states[path] = now
        return found

    def _state(self, path: Path, before: FileState) -> FileState:
        try:
            stat = path.stat()
            if (stat.st_mtime_ns, stat.st_size) == before[:2] and before.digest:
                return before
            self.reads += 1
            return FileState(stat.st_mtime_ns, stat.st_size, hashlib.sha256(path.read_bytes()).digest())
        except OSError:
            return _GONE
