"""Known findings of old programs: they fail nothing, new ones do, and those that are gone are listed.

An entry names a finding by file, code, the words of its line and what it says without numbers, so it stays the same
when lines move. An entry covers as many findings as its count says.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final

from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.numbers import read_json
from gcodesim.regress.findings import without_numbers
from gcodesim.regress.moves import LineText

SCHEMA: Final = "gcodesim-baseline/1"

FindingKey = tuple[str, str, str, str]
"""File, code, words of the line, message without numbers."""


class BaselineError(ValueError):
    """The file is not a baseline; the text says why."""


def entry_of(finding: Diagnostic, text: LineText) -> FindingKey:
    """The key of a finding in a baseline; `text` gives the line of a file."""
    span = finding.span
    line = " ".join(text(span.file, span.line).split()) if span.line else ""
    return span.file, finding.code, line, without_numbers(finding.message)


@dataclass(slots=True)
class Baseline:
    """Known findings, and how many of each are still to be found."""

    left: dict[FindingKey, int]

    @staticmethod
    def read(source: SourceText) -> Baseline:
        """BaselineError when the file is not a baseline."""
        try:
            value = read_json(source.raw)
            if not isinstance(value, dict) or value.get("schema") != SCHEMA:
                raise BaselineError(f"it does not have the form {SCHEMA}")
            left: dict[FindingKey, int] = {}
            for one in value["findings"]:
                entry = (str(one["file"]), str(one["code"]), str(one["line"]), str(one["message"]))
                left[entry] = left.get(entry, 0) + int(one.get("count", 1))
            return Baseline(left)
        except BaselineError:
            raise
        except (ValueError, KeyError, TypeError) as error:
            raise BaselineError(f"it is damaged: {error}") from error

    def knows(self, finding: Diagnostic, text: LineText) -> bool:
        """Whether an entry covers `finding`; it is used up then."""
        entry = entry_of(finding, text)
        if self.left.get(entry, 0) < 1:
            return False
        self.left[entry] -= 1
        return True

    @property
    def gone(self) -> tuple[str, ...]:
        """Entries that were not found, for people to read."""
        rest = [(entry, count) for entry, count in self.left.items() if count > 0]
        return tuple(
            f"{file}: {code}: {message}{f' ({count} times)' if count > 1 else ''}{f' — {line}' if line else ''}"
            for (file, code, line, message), count in rest
        )


def baseline_text(findings: Iterable[Diagnostic], text: LineText) -> str:
    """The file for these findings: sorted, one a line."""
    counts: dict[FindingKey, int] = {}
    for finding in findings:
        entry = entry_of(finding, text)
        counts[entry] = counts.get(entry, 0) + 1
    lines = [_line(entry, counts[entry]) for entry in sorted(counts)]
    body = "[\n" + ",\n".join(f"  {line}" for line in lines) + "\n ]" if lines else "[]"
    return f'{{\n "schema": {json.dumps(SCHEMA)},\n "findings": {body}\n}}\n'


def _line(entry: FindingKey, count: int) -> str:
    file, code, line, message = entry
    value: dict[str, Any] = {"file": file, "code": code, "line": line, "message": message}
    return json.dumps(value | ({"count": count} if count > 1 else {}), ensure_ascii=False)
