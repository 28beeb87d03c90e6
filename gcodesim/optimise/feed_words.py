"""F words of a program's text: where they stand, and the same text with others."""

from __future__ import annotations

import re
from collections.abc import Mapping

from gcodesim.units import INCH, MINUTE, MM_PER_MINUTE

_COMMENT = re.compile(r"\([^)]*\)|;.*$")
_NAME = re.compile(r"<[^>]*>")
_F = re.compile(r"F\s*(?P<value>[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)|\[|#)", re.IGNORECASE)
_CODE = re.compile(r"G\s*0*([0-9]+(?:\.[0-9]+)?)", re.IGNORECASE)
_OTHER_FEED = frozenset(("93", "95"))
_FEED_PER_MINUTE = frozenset(("94", "98"))
_LED = frozenset(("33", "33.1", "74", "76", "84"))
"""Codes in which the spindle leads the feed."""


def without_comments(line: str) -> str:
    """The line with blanks in place of comments and names of parameters, as long as before."""
    for pattern in (_COMMENT, _NAME):
        line = pattern.sub(lambda found: " " * len(found.group()), line)
    return line


def rewritten(lines: list[str], feeds: Mapping[int, float], branching: bool) -> tuple[list[str], list[int]]:
    """The lines with feeds [m/s] by line number from 1, and the numbers of lines whose feed cannot be written.

    An F word is replaced where there is one; elsewhere one is added where the feed is not that of the line before.
    In a program that is `branching`, whose lines may follow others than the one above, each of them gets its own.
    """
    out, refused = list(lines), []
    unit, per_minute = MM_PER_MINUTE, True
    modal: str | None = None
    for number, line in enumerate(lines, 1):
        plain = without_comments(line)
        codes = {found.group(1) for found in _CODE.finditer(plain)}
        unit = INCH / MINUTE if "20" in codes else MM_PER_MINUTE if "21" in codes else unit
        per_minute = False if codes & _OTHER_FEED else True if codes & _FEED_PER_MINUTE else per_minute
        word = _F.search(plain)
        if number not in feeds:
            if word is not None:
                modal = word.group("value") if word.group("value") not in "[#" else None
            continue
        if not per_minute or codes & _LED or (word is not None and word.group("value") in "[#"):
            refused.append(number)
            modal = None
            continue
        wanted = written(feeds[number] / unit)
        if word is not None:
            if float(word.group("value")) != float(wanted):
                out[number - 1] = line[: word.start()] + f"F{wanted}" + line[word.end() :]
        elif branching or modal is None or float(modal) != float(wanted):
            end = len(plain.rstrip())
            out[number - 1] = f"{line[:end]} F{wanted}{line[end:]}"
        modal = wanted
    return out, refused


def written(value: float) -> str:
    """A feed as programs have it: at most four significant digits, never above the value."""
    digits = 0 if value >= 1000.0 else 1 if value >= 100.0 else 2 if value >= 10.0 else 4
    scale = 10**digits
    down = int(value * scale * (1.0 + 1e-9)) / scale
    return f"{down:.{digits}f}".rstrip("0").rstrip(".") if digits else str(int(down))
