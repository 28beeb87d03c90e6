"""Which cases passed with which inputs, so that `--changed` runs only what changed.

An entry is found by what is known beforehand: version and sources of gcodesim, the case, its test file, program, cell
and accepted results. It lists the other files that the run read (subprograms, meshes, tool tables) with their hashes,
and the days on which suppressions end; it counts only when all of that is still so. Nothing but passed cases is kept.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import tempfile
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Final

from gcodesim.diagnostics import Caller, Diagnostic, Severity, Span
from gcodesim.diagnostics.show import as_json
from gcodesim.regress.case import Case, shown_path
from gcodesim.regress.changes import SAME
from gcodesim.regress.verdicts import CaseVerdict, Found
from gcodesim.user_cache import user_cache

VARIABLE: Final = "GCODESIM_TEST_CACHE"
_LIBRARIES: Final = ("numpy", "scipy", "numba", "pybullet", "trimesh")
_MOST_ENTRIES: Final = 20_000
_ENTRY: Final = re.compile(r"[0-9a-f]{2}/[0-9a-f]{32}\.json")


def default_folder() -> Path:
    """Where entries are kept: `GCODESIM_TEST_CACHE`, else in the user's cache."""
    if VARIABLE in os.environ:
        return Path(os.environ[VARIABLE])
    return user_cache("tests") or Path(tempfile.gettempdir()) / "gcodesim-tests"


class Cache:
    """Entries in a folder; one that cannot be written costs nothing but time."""

    def __init__(self, folder: Path, root: Path, settings: str) -> None:
        """`settings` is all that the command line says and a verdict depends on."""
        self._folder = folder
        self._root = root
        self._settings = settings
        self._version = _version_digest()

    def find(self, case: Case, today: date) -> CaseVerdict | None:
        """The verdict of an earlier run with the same inputs, None when there is none."""
        try:
            entry = json.loads(self._path(case).read_bytes())
            if any(_digest(self._root / name) != digest for name, digest in entry["files"].items()):
                return None
            then = date.fromisoformat(entry["today"])
            ends = [date.fromisoformat(text) for text in entry["until"]]
            if any((today > end) != (then > end) for end in ends):
                return None
            return _verdict(entry["verdict"])
        except (OSError, ValueError, LookupError, TypeError, AttributeError):  # whatever somebody put there
            return None

    def keep(
        self, case: Case, verdict: CaseVerdict, files: dict[str, Path], until: tuple[date, ...], today: date
    ) -> None:
        """Remember a case that passed; others are forgotten."""
        if verdict.status != "passed":
            return
        paths = {shown_path(path, self._root): path for path in files.values()}
        entry = {
            "files": {name: _digest(paths[name]) for name in sorted(paths)},
            "until": sorted({end.isoformat() for end in until}),
            "today": today.isoformat(),
            "verdict": _entry(verdict),
        }
        path = self._path(case)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(
                "w", dir=path.parent, suffix=".part", delete=False, encoding="utf-8"
            ) as part:
                json.dump(entry, part, ensure_ascii=False)
            Path(part.name).replace(path)
        except OSError:
            return

    def tidy(self) -> None:
        """Delete the oldest entries when there are too many, and nothing else that lies in the folder."""
        try:
            ours = (
                path for path in self._folder.glob("*/*.json") if _ENTRY.fullmatch(f"{path.parent.name}/{path.name}")
            )
            entries = sorted(ours, key=lambda path: path.stat().st_mtime)
            for path in entries[: max(0, len(entries) - _MOST_ENTRIES)]:
                path.unlink(missing_ok=True)
        except OSError:
            return

    def _path(self, case: Case) -> Path:
        parts = [self._version, self._settings, case.name, case.file, repr(case.options)]
        parts += [_digest(path) for path in (case.test_file, case.program, case.cell, case.golden)]
        # folders that the command line lets the cell read come by their names
        parts += [shown_path(folder, self._root) for folder in case.allow_path]
        key = hashlib.sha256("\0".join(parts).encode()).hexdigest()
        return self._folder / key[:2] / f"{key[2:34]}.json"


def _digest(path: Path | None) -> str:
    if path is None:
        return ""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return "absent"


def _version_digest() -> str:
    """Version and sources of gcodesim (by size and time, as compilers do) and the versions of what it computes with."""
    import gcodesim

    digest = hashlib.sha256(gcodesim.__version__.encode())
    top = Path(gcodesim.__file__).parent
    for path in sorted(top.rglob("*.py")):
        stat = path.stat()
        digest.update(f"{path.relative_to(top)} {stat.st_size} {stat.st_mtime_ns}\n".encode())
    for name in _LIBRARIES:
        try:
            digest.update(f"{name} {version(name)}\n".encode())
        except PackageNotFoundError:
            digest.update(f"{name} none\n".encode())
    return digest.hexdigest()


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
                "finding": as_json(one.finding),
                "related": _related(one.finding),
                "state": one.state,
                "reason": one.reason,
            }
            for one in verdict.found
        ],
    }


def _related(finding: Diagnostic) -> list[Any] | None:
    span = finding.related
    return None if span is None else [span.file, span.line, span.column, span.end_line, span.end_column]


def _verdict(entry: dict[str, Any]) -> CaseVerdict:
    return CaseVerdict(
        name=entry["name"],
        file=entry["file"],
        program=entry["program"],
        cell=entry["cell"],
        status="passed",
        found=tuple(
            Found(finding=_finding(one["finding"], one["related"]), state=one["state"], reason=one["reason"])
            for one in entry["found"]
        ),
        comparison=SAME if entry["compared"] else None,
        results=entry["results"],
        unchanged=True,
    )


def _finding(value: dict[str, Any], related: list[Any] | None) -> Diagnostic:
    callers = tuple(Caller(c["file"], c["line"], c["name"]) for c in value["callers"])
    place = (value["file"], value["line"], value["column"], value["end_line"], value["end_column"])
    return Diagnostic(
        code=value["code"],
        message=value["message"],
        span=Span(*place, callers),
        severity=Severity[value["severity"].upper()],
        hint=value["hint"],
        related=None if related is None else Span(*related),
        count=value["count"],
        time=value["time_s"],
        value=value["value"],
        limit=value["limit"],
        unit=value["unit"],
    )
