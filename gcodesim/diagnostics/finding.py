"""One finding: a stable code, one line of text, the place, a remedy."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum

from gcodesim.frozen import frozen


class Severity(IntEnum):
    """How bad a finding is; comparable, so that `--fail-on` is one comparison."""

    NOTE = 1
    WARNING = 2
    ERROR = 3

    @property
    def word(self) -> str:
        return self.name.lower()


@frozen(kw_only=False)
class Caller:
    """A call that led here: `line` of `file` called `name`."""

    file: str
    line: int
    name: str


@frozen(kw_only=False)
class Span:
    """A place in a text. Lines and columns count from 1, columns in code points; `end_column` is exclusive.

    `line` 0 means the file as a whole. `callers` is the chain of subprogram
    calls, outermost first.
    """

    file: str
    line: int = 0
    column: int = 0
    end_line: int = 0
    end_column: int = 0
    callers: tuple[Caller, ...] = ()

    @staticmethod
    def of_line(file: str, line: int, text: str, callers: tuple[Caller, ...] = ()) -> Span:
        """A whole line without the blanks around it."""
        start = len(text) - len(text.lstrip()) + 1
        return Span(file, line, start, line, max(start + 1, len(text.rstrip()) + 1), callers)


@frozen
class Diagnostic:
    """A finding. `severity` None means: what the catalogue says for this code.

    `value` and `limit` carry the two numbers in `unit`; `time` is simulated
    time [s]; `count` how often the same event occurred (the first one is shown);
    `bodies` are the two that touch, in a collision.
    """

    code: str
    message: str
    span: Span
    severity: Severity | None = None
    hint: str = ""
    related: Span | None = None
    count: int = 1
    time: float | None = None
    value: float | None = None
    limit: float | None = None
    unit: str | None = None
    bodies: tuple[str, ...] = ()

    @property
    def level(self) -> Severity:
        """The severity in force."""
        if self.severity is not None:
            return self.severity
        from gcodesim.diagnostics.catalogue import code_of

        return code_of(self.code).severity

    @property
    def order(self) -> tuple[str, int, int, str, str]:
        """Sort key: position first."""
        return (self.span.file, self.span.line, self.span.column, self.code, self.message)


@dataclass(slots=True)
class Findings:
    """A growing list of findings that folds repetitions of one event into one finding with a count."""

    _items: dict[tuple[object, ...], Diagnostic] = field(default_factory=dict)

    def add(self, finding: Diagnostic, *, key: tuple[object, ...] | None = None) -> None:
        """Add `finding`; a later one with the same `key` (default: code, message and place) only raises the count."""
        key = key or (finding.code, finding.message, finding.span)
        known = self._items.get(key)
        self._items[key] = finding if known is None else replace(known, count=known.count + finding.count)

    def extend(self, findings: Iterable[Diagnostic]) -> None:
        for finding in findings:
            self.add(finding)

    def copy(self) -> Findings:
        """The same findings in a list of its own."""
        return Findings(dict(self._items))

    def by_key(self) -> Mapping[tuple[object, ...], Diagnostic]:
        """The findings by the keys under which they are folded, in the order in which they were found."""
        return self._items

    def change(self, changed: Mapping[Diagnostic, Diagnostic]) -> None:
        """Replace findings by others: what was known before a run may be more severe after it."""
        self._items = {key: changed.get(finding, finding) for key, finding in self._items.items()}

    def withdraw(self, findings: Iterable[Diagnostic]) -> None:
        """Forget findings: a run has looked more closely."""
        gone = set(findings)
        self._items = {key: finding for key, finding in self._items.items() if finding not in gone}

    def __iter__(self) -> Iterator[Diagnostic]:
        """In the order of their places."""
        return iter(sorted(self._items.values(), key=lambda f: f.order))

    def __len__(self) -> int:
        return len(self._items)

    def has_errors(self) -> bool:
        return any(f.level >= Severity.ERROR for f in self._items.values())
