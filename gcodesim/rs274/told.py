"""Which findings were made already, so that those that are alike are told once and counted."""

from __future__ import annotations

from typing import Any, Final

from gcodesim.diagnostics import Diagnostic

_MOST_ALIKE: Final = 20  # findings with the same words; further ones are counted
_MOST_KINDS: Final = 100  # messages of one warning that differ in a number or name
_OF_ONE_CAUSE: Final = frozenset(("GS012", "GS013", "GS107", "GS131", "GS160", "GS915"))  # one remedy for all places
_FURTHER: Final = "further"

FindingKey = tuple[object, ...]


class Told:
    """Gives each finding of a program the key under which `Findings` counts those that are alike."""

    def __init__(self) -> None:
        self.faults = 0
        self._places: dict[Any, set[Any]] = {}  # where each message was given
        self._kinds: dict[Any, set[Any]] = {}  # messages of the warnings with one code

    def key_of_fault(self, finding: Diagnostic) -> FindingKey:
        """One for each place, and after many with the same words one for all others."""
        self.faults += 1
        span, what = finding.span, (finding.code, finding.message)
        place = (span.file, span.line, span.column)
        places = self._places.setdefault(what, set())
        places.add(place)
        if finding.code in _OF_ONE_CAUSE or len(places) > _MOST_ALIKE:
            return (*what, _FURTHER)
        return (*what, *place)

    def key_of_note(self, note: Diagnostic) -> FindingKey:
        """One for each message, and after many with one code one for all others."""
        kinds = self._kinds.setdefault(note.code, set())
        if note.message not in kinds and len(kinds) >= _MOST_KINDS:
            return note.code, _FURTHER
        kinds.add(note.message)
        return note.code, note.message

    def carry_over(self, now: Told, then: Told) -> None:
        """What `now` has told in place of `then`, from which this one went on."""
        self.faults += now.faults - then.faults
        self._places = _with_later(self._places, now._places, then._places)
        self._kinds = _with_later(self._kinds, now._kinds, then._kinds)


def is_of_many(key: FindingKey) -> bool:
    """Whether a key stands for all findings that came after many alike."""
    return _FURTHER in key


def _with_later(later: dict[Any, set[Any]], now: dict[Any, set[Any]], then: dict[Any, set[Any]]) -> dict[Any, set[Any]]:
    out = {key: set(values) for key, values in now.items()}
    for key, values in later.items():
        if fresh := values - then.get(key, set()):
            out.setdefault(key, set()).update(fresh)
    return out
