"""Two results against each other, quantity by quantity."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A difference is none up to ``max(absolute, relative * old)``; `absolute` in the unit of the quantity."""

    absolute: float
    relative: float = 0.0

    def allows(self, old: float, new: float) -> bool:
        return abs(new - old) <= max(self.absolute, self.relative * abs(old))


# by the end of a quantity's name, as units stand in the names; the first that fits counts
TOLERANCES: Final[Mapping[str, Tolerance]] = {
    "_mm3": Tolerance(0.5, 1e-3),
    "_s": Tolerance(0.01, 1e-3),
    "_mm": Tolerance(0.01, 1e-4),
    "_N": Tolerance(0.5, 0.01),
    "_Nm": Tolerance(0.01, 0.01),
    "_W": Tolerance(1.0, 0.01),
    "": Tolerance(1e-3, 1e-3),
}

# what identifies a run or places a number, but is no result
_NOT_COMPARED: Final = frozenset(
    {"inputs", "schema", "line_of_max_force", "line_of_margin", "first_line", "error_bound_mm3"}
)
_NAMES: Final = ("number", "name", "word")


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One quantity that differs, `quantity` as a path: ``stocks.stock.removed_mm3``; None where it is missing."""

    quantity: str
    old: Any
    new: Any
    allowed: float | None = None

    @property
    def text(self) -> str:
        """One line for people."""
        if isinstance(self.old, (int, float)) and isinstance(self.new, (int, float)):
            limit = "" if self.allowed is None else f", {self.allowed:.4g} is allowed"
            return f"{self.quantity}: {self.old:.6g} → {self.new:.6g} ({self.new - self.old:+.4g}{limit})"
        return f"{self.quantity}: {_shown(self.old)} → {_shown(self.new)}"


def _shown(value: Any) -> str:
    return "nothing" if value is None else str(value)


def compare_results(
    old: Mapping[str, Any], new: Mapping[str, Any], tolerances: Mapping[str, Tolerance] = TOLERANCES
) -> list[Change]:
    """What differs in meaning between two contents of `results.json`, in the order of the file.

    Findings are the same when code and message are: lines may move when a
    program is renumbered. Hashes, names of inputs and line numbers do not count.
    """
    return list(_compare("", old, new, tolerances))


def _compare(path: str, old: Any, new: Any, tolerances: Mapping[str, Tolerance]) -> Iterator[Change]:
    if path == "findings":
        yield from _findings(old or [], new or [])
    elif isinstance(old, Mapping) and isinstance(new, Mapping):
        for key in [*old, *(key for key in new if key not in old)]:
            if key not in _NOT_COMPARED and key != "stopped_at":
                yield from _compare(f"{path}.{key}" if path else key, old.get(key), new.get(key), tolerances)
    elif isinstance(old, list) and isinstance(new, list):
        yield from _compare(path, _by_name(old), _by_name(new), tolerances)
    elif _is_number(old) and _is_number(new):
        tolerance = next(t for end, t in tolerances.items() if path.endswith(end))
        if not tolerance.allows(old, new):
            yield Change(
                quantity=path, old=old, new=new, allowed=max(tolerance.absolute, tolerance.relative * abs(old))
            )
    elif old != new:
        yield Change(quantity=path, old=old, new=new)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _by_name(entries: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """List entries by what they call themselves, so that an entry more does not shift all others."""
    return {str(next((entry[name] for name in _NAMES if name in entry), i)): entry for i, entry in enumerate(entries)}


def _findings(old: Sequence[Mapping[str, Any]], new: Sequence[Mapping[str, Any]]) -> Iterator[Change]:
    def told(findings: Sequence[Mapping[str, Any]]) -> list[str]:
        return [f"{finding['severity']} {finding['code']}: {finding['message']}" for finding in findings]

    before, after = told(old), told(new)
    for text in before:
        if text in after:
            after.remove(text)
        else:
            yield Change(quantity="findings", old=text, new=None)
    for text in after:
        yield Change(quantity="findings", old=None, new=text)
