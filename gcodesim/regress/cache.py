"""Which cases passed with which inputs, so that `--changed` runs only what changed.

The key of an entry is known beforehand: version and sources of gcodesim and of packages that extend it, the case, its
test file, program, cell and accepted results. It lists the other files that the run read (subprograms, meshes, tool
tables) with their hashes, and the days on which suppressions end; it counts only if all of that still holds. Only
passed cases are kept.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from datetime import date
from pathlib import Path
from typing import Any, Final

from gcodesim.diagnostics.stored import as_stored, from_stored
from gcodesim.files.code_digest import code_digest
from gcodesim.files.digest import digest_of_texts
from gcodesim.files.own_folder import NotOwn, OwnFolder, open_own_folder
from gcodesim.files.user_cache import user_cache
from gcodesim.regress.case import Case, shown_path
from gcodesim.regress.changes import SAME
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding

VARIABLE: Final = "GCODESIM_TEST_CACHE"
_MOST_ENTRIES: Final = 20_000
_ABOVE: Final = re.compile(r"[0-9a-f]{2}")
_ENTRY: Final = re.compile(r"[0-9a-f]{32}\.json")


def default_folder() -> Path | None:
    """Where entries are kept: `GCODESIM_TEST_CACHE`, else in the user's cache; None when nothing can be kept."""
    if os.environ.get(VARIABLE):
        return Path(os.environ[VARIABLE])
    folder = user_cache("tests")
    return None if folder is None else folder.path


class Cache:
    """Entries in a folder; if it cannot be written to, or others can write to it, this costs only time."""

    def __init__(self, folder: Path | None, root: Path, settings: str) -> None:
        """`settings` is everything from the command line on which a verdict depends."""
        self.refused = ""
        self._folder: OwnFolder | None = None
        if folder is not None:
            try:
                self._folder = open_own_folder(Path(os.path.abspath(folder)), make=True)
            except NotOwn as reason:
                self.refused = str(reason)
        self._root = root
        self._settings = settings
        self._version = code_digest()

    def find(self, case: Case, today: date) -> CaseVerdict | None:
        """The verdict of an earlier run with the same inputs, None when there is none."""
        folder, name = self._place(case, make=False)
        known = None if folder is None else folder.read(name)
        if known is None:
            return None
        try:
            entry = json.loads(known)
            if any(_digest(self._root / name) != digest for name, digest in entry["files"].items()):
                return None
            then = date.fromisoformat(entry["today"])
            ends = [date.fromisoformat(text) for text in entry["until"]]
            if any((today > end) != (then > end) for end in ends):
                return None
            return _verdict(entry["verdict"])
        except (OSError, ValueError, LookupError, TypeError, AttributeError):  # whatever somebody has put there
            return None

    def keep(
        self, case: Case, verdict: CaseVerdict, files: dict[str, Path], until: tuple[date, ...], today: date
    ) -> None:
        """Remember a case that passed; forget it if it did not."""
        if verdict.status != "passed":
            return
        paths = {shown_path(path, self._root): path for path in files.values()}
        entry = {
            "files": {name: _digest(paths[name]) for name in sorted(paths)},
            "until": sorted({end.isoformat() for end in until}),
            "today": today.isoformat(),
            "verdict": _entry(verdict),
        }
        folder, name = self._place(case, make=True)
        if folder is not None:
            folder.write(name, json.dumps(entry).encode())

    def tidy(self) -> None:
        """Delete the oldest entries when there are too many, and nothing else in the folder."""
        if self._folder is None:
            return
        entries = []
        for above in self._folder.names():
            folder = self._folder.folder(above) if _ABOVE.fullmatch(above) else None
            if folder is not None:
                names = filter(_ENTRY.fullmatch, folder.names())
                entries += [(folder.changed_ns(name), above, name, folder) for name in names]
        for _, _, name, folder in sorted(entries, key=lambda entry: entry[:3])[: max(0, len(entries) - _MOST_ENTRIES)]:
            folder.delete(name)

    def _place(self, case: Case, *, make: bool) -> tuple[OwnFolder | None, str]:
        """The folder of a case's entry, and the entry's name in it."""
        parts = [self._version, self._settings, case.name, case.file, repr(case.options)]
        parts += [_digest(path) for path in (case.test_file, case.program, case.cell, case.golden)]
        parts += [f"{name} {_digest(path)}" for name, path in sorted(case.channels.items())]
        # folders that the command line lets the cell read count by their names
        parts += [shown_path(folder, self._root) for folder in case.allow_path]
        key = digest_of_texts(*parts)
        folder = None if self._folder is None else self._folder.folder(key[:2], make=make)
        return folder, f"{key[2:34]}.json"


def _digest(path: Path | None) -> str:
    if path is None:
        return ""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return "absent"


def _entry(verdict: CaseVerdict) -> dict[str, Any]:
    return {
        "name": verdict.name,
        "file": verdict.file,
        "program": verdict.program,
        "cell": verdict.cell,
        "compared": verdict.comparison is not None,
        "results": verdict.results,
        "found": [
            {
                "finding": as_stored(one.finding),
                "state": one.state,
                "reason": one.reason,
            }
            for one in verdict.found
        ],
    }


def _verdict(entry: dict[str, Any]) -> CaseVerdict:
    return CaseVerdict(
        name=entry["name"],
        file=entry["file"],
        program=entry["program"],
        cell=entry["cell"],
        status="passed",
        found=tuple(
            JudgedFinding(finding=from_stored(one["finding"]), state=one["state"], reason=one["reason"])
            for one in entry["found"]
        ),
        comparison=SAME if entry["compared"] else None,
        results=entry["results"],
        unchanged=True,
    )
