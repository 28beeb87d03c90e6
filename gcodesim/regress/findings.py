"""Compares findings of two runs: the same fault stays the same when lines move or numbers change a little."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from gcodesim.regress.changes import FindingChange
from gcodesim.regress.tolerance import DEFAULTS, Tolerance, Tolerances

Json = Mapping[str, Any]
_NUMBER = re.compile(r"(?<![A-Za-z0-9_.])[+-]?[0-9]+(?:\.[0-9]+)?")


def compare_findings(
    old: Sequence[Json],
    new: Sequence[Json],
    tolerances: Tolerances = DEFAULTS,
    line_of: Callable[[str, int], int | None] | None = None,
) -> list[FindingChange]:
    """Findings (as in `results.json`) that are new, gone, or changed in their numbers.

    `line_of` gives the new line of an old one where the programs were compared move by move; None: unknown. Without
    it lines do not count. New and gone findings keep the order of the files.
    """
    left = list(new)
    changes: list[FindingChange] = []
    unmatched = []
    for finding in old:
        twin = _twin(finding, left, line_of)
        if twin is None:
            unmatched.append(finding)
            continue
        left.remove(twin)
        if not _alike(finding, twin, tolerances["finding"]):
            changes.append(FindingChange(kind="changed", old=dict(finding), new=dict(twin)))
    changes += [FindingChange(kind="gone", old=dict(finding)) for finding in unmatched]
    changes += [FindingChange(kind="new", new=dict(finding)) for finding in left]
    return changes


def without_numbers(message: str) -> str:
    """A message with `#` for each number in it: what it says, regardless of place and amount."""
    return _NUMBER.sub("#", message)


def _kind(finding: Json) -> tuple[str, str, str, str]:
    file = finding["file"] if not finding["line"] else ""
    return finding["code"], finding["severity"], without_numbers(finding["message"]), file


def _twin(finding: Json, among: Sequence[Json], line_of: Callable[[str, int], int | None] | None) -> Json | None:
    """The finding that says the same at the same place; if places are not known, the first that says the same."""
    alike = [other for other in among if _kind(other) == _kind(finding)]
    if line_of is None or not finding["line"]:
        same_numbers = (other for other in alike if other["message"] == finding["message"])
        return next(same_numbers, alike[0] if alike else None)
    line = line_of(finding["file"], finding["line"])
    if line is None:
        return alike[0] if alike else None
    return next((other for other in alike if other["line"] == line), None)


def _alike(old: Json, new: Json, tolerance: Tolerance) -> bool:
    return old["count"] == new["count"] and all(tolerance.allows(a, b) for a, b in _pairs(old, new))


def _pairs(old: Json, new: Json) -> Iterator[tuple[float, float]]:
    """The numbers of two messages of one kind, one by one."""
    yield from (
        (float(a), float(b))
        for a, b in zip(_NUMBER.findall(old["message"]), _NUMBER.findall(new["message"]), strict=True)
    )
