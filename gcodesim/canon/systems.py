"""Work systems by number and name: 1 to 9 are G54 to G59.3, and 101 to 400 are G54.1 P1 to P300."""

from __future__ import annotations

import re
from typing import Final

SYSTEMS: Final = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")
ADDITIONAL: Final = 100
"""The number of G54.1 P1 is one more."""
MOST_ADDITIONAL: Final = 300
SYSTEM_PATTERN: Final = (
    r"[Gg]5(4|5|6|7|8|9(\.[123])?)|[Gg](54|54\.1|154)\s*[Pp]\s*0*([1-9][0-9]?|[12][0-9][0-9]|300)"  # G154: Haas
)
_ADDITIONAL_NAME = re.compile(r"G(?:54|54\.1|154)\s*P\s*0*([1-9][0-9]{0,2})", re.IGNORECASE)


def name_of_system(index: int) -> str:
    """`G54`, `G59.3`, `G54.1 P17`."""
    return SYSTEMS[index - 1] if index <= len(SYSTEMS) else f"G54.1 P{index - ADDITIONAL}"


def system_name(text: str) -> str | None:
    """The one spelling of a name: `g54` → `G54`, `G54 P1` → `G54.1 P1`; None when it is no work system."""
    if text.upper() in SYSTEMS:
        return text.upper()
    match = _ADDITIONAL_NAME.fullmatch(text.strip())
    if match is None or int(match[1]) > MOST_ADDITIONAL:
        return None
    return f"G54.1 P{int(match[1])}"


def system_index(name: str) -> int:
    """1 for G54 … 9 for G59.3, 101 for G54.1 P1; the name as `system_name` spells it."""
    return SYSTEMS.index(name) + 1 if name in SYSTEMS else ADDITIONAL + int(name.rpartition("P")[2])
