"""What somebody meant who typed a name that does not exist."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

_MOST: Final = 3
_NEARLY: Final = 0.6


def nearest(word: str, known: Iterable[str]) -> list[str]:
    """At most three of `known`, those first that are most alike."""
    from difflib import get_close_matches

    by_fold = {name.casefold(): name for name in known}
    near = get_close_matches(word.casefold(), by_fold, n=_MOST, cutoff=_NEARLY)
    return [by_fold[name] for name in near]


def no_such(kind: str, word: str, known: Iterable[str]) -> str:
    """`there is no dialect fanuk; did you mean fanuc? (there are linuxcnc, fanuc)`."""
    known = list(known)
    return f"there is no {kind} {word}{did_you_mean(nearest(word, known))} (there are {', '.join(known)})"


def did_you_mean(names: Iterable[str]) -> str:
    """`; did you mean run or report?`, or nothing when there are no names."""
    names = list(names)
    if not names:
        return ""
    before = f"{', '.join(names[:-1])} or " if len(names) > 1 else ""
    return f"; did you mean {before}{names[-1]}?"
