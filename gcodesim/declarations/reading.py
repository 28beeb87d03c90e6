"""What a cell file is read with: findings, places of values, defaults taken, files opened."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Final, Literal

from gcodesim.declarations.files import Shelf
from gcodesim.declarations.units import Unit, find
from gcodesim.diagnostics import Diagnostic, Findings, Span
from gcodesim.frozen import frozen

Path = tuple[str | int, ...]
"""Where a value stands: `("tools", 7, "diameter")`."""


class Unread(Enum):
    """Read in place of a value that could not be read; the reason is among the findings."""

    UNREAD = "unread"


UNREAD: Final = Unread.UNREAD


@frozen
class Default:
    """A value that nobody wrote; `why` is the rule that gave it, empty for a constant."""

    path: Path
    value: Any
    why: str = ""


@frozen
class PlainUnits:
    """What a number without unit means."""

    length: Unit
    angle: Unit

    def of(self, dimension: str) -> Unit | None:
        return {"length": self.length, "angle": self.angle}.get(dimension)


def _unit(name: str, dimension: str) -> Unit:
    unit = find(name, dimension)
    assert unit is not None
    return unit


@frozen
class Reference:
    """A name that stands for something elsewhere in the cell, to be looked up when all of it is read."""

    what: Literal["frame", "material", "device", "sensor"]
    name: str
    path: Path


@dataclass(slots=True, kw_only=True)
class Reading:
    """The one mutable thing while a cell is read; every kind writes into it."""

    file: str
    findings: Findings
    shelf: Shelf
    spans: dict[Path, Span] = field(default_factory=dict)
    keys: dict[Path, Span] = field(default_factory=dict)
    references: list[Reference] = field(default_factory=list)
    broken: set[Path] = field(default_factory=set)
    """Sections that could not be read at all, so that nothing can be said about what should stand in them."""
    defaults: list[Default] = field(default_factory=list)
    about: str = ""
    """What the key means whose value is being read; the hint of faults that have none of their own."""
    plain: PlainUnits = field(
        default_factory=lambda: PlainUnits(length=_unit("mm", "length"), angle=_unit("deg", "angle"))
    )

    def fault(self, code: str, span: Span, message: str, hint: str = "", *, related: Span | None = None) -> Unread:
        """Add a finding; returns UNREAD, so that a kind can `return to.fault(…)`."""
        self.findings.add(Diagnostic(code=code, span=span, message=message, hint=hint or self.about, related=related))
        return UNREAD

    def span(self, path: Path) -> Span:
        """The place of `path`, or of what is around it if it has none."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.spans:
                return self.spans[path[:length]]
        return Span(self.file, 1, 1, 1, 2)

    def named(self, path: Path, span: Span) -> None:
        """Remember where the key of `path` stands; its value takes its own place in `spans` when it is read."""
        self.keys[path] = self.spans[path] = span

    def key(self, path: Path) -> Span:
        """The place of the key of `path`, for findings about its being there at all."""
        return self.keys.get(path) or self.span(path)

    def names_in(self, section: str) -> list[str]:
        """The names that a section gives, sound or not, such as those of `frames`."""
        return [str(path[1]) for path in self.keys if len(path) == 2 and path[0] == section]

    def default(self, path: Path, value: Any, why: str = "") -> None:
        self.defaults.append(Default(path=path, value=value, why=why))


def dotted(path: Iterable[str | int]) -> str:
    """A path as people read it: `tools.7.diameter`, `home[2]`."""
    text = ""
    for part in path:
        text += (
            f"[{part}]"
            if isinstance(part, int) and text.endswith(("home", "axes"))
            else f".{part}"
            if text
            else str(part)
        )
    return text


def suggestion(word: str, known: Sequence[str]) -> str:
    """`did you mean …` if a known word is near, otherwise the known words if they are few."""
    by_lower = {k.lower(): k for k in reversed(known)}
    close = difflib.get_close_matches(word.lower(), by_lower, n=1, cutoff=0.6)
    if close:
        return f"did you mean `{by_lower[close[0]]}`?"
    if not known:
        return ""
    listed = ", ".join(f"`{k}`" for k in known[:16])
    return f"known are {listed}{' …' if len(known) > 16 else ''}"
