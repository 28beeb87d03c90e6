"""Words that are read and not simulated, as findings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.rs274.dialects import Dialect

_PROBES: Final = ("G38.2", "G38.3", "G38.4", "G38.5")
MAY_MISS: Final = ("G38.3", "G38.5")
"""Probe moves that may end without contact."""

_MISSED: Final = (
    "what the probe meets is not looked at: it trips at the end of the move, until the program goes in circles so; "
    "from there on it does not trip"
)
_SKIPPED: Final = (
    (("M7", "M8", "M9"), "GS901", "nothing that is simulated depends on coolant"),
    (("M48", "M49", "M50", "M51", "M52", "M53"), "GS902", "feeds and speeds run at 100 %, as nobody turns a knob"),
    (("M19",), "GS903", ""),
    (
        ("M62", "M63", "M64", "M65", "M67", "M68"),
        "GS904",
        "say in the cell what it switches, under `signals` or `m_codes`",
    ),
    (("M66",), "GS905", "every input reads 0 at once, and #5399 is 0: no time passes in waiting"),
    (("M30", "M60"), "GS906", ""),
    (("U", "V", "W"), "GS908", ""),
    (("G64",), "GS913", "R chooses the planner of LinuxCNC 2.10, and 2.9 refuses it; here, the cell says which"),
    (_PROBES, "GS913", "what the probe meets is not looked at: it trips at the end of the move"),
)


def not_simulated(
    words: Mapping[str, tuple[int, Span]], dialect: Dialect, *, probes_meet: bool
) -> Iterator[Diagnostic]:
    """A finding for each of the words, which come with their count and first place.

    `probes_meet`: whether it was taken for granted to the end that every probe meets something.
    """
    for word, (count, first) in words.items():
        code, hint = _code_and_hint(word, dialect)
        if word in MAY_MISS and not probes_meet:
            hint = _MISSED
        message = f"{word} is read, but not simulated"
        if word == "/":
            message = "the line is left out because of its slash"
        yield Diagnostic(code=code, message=message, span=first, hint=hint, count=count)


def _code_and_hint(word: str, dialect: Dialect) -> tuple[str, str]:
    """Code and hint of a word that is not simulated."""
    if word.startswith("("):
        hint = "no file is written and no code is run; texts of (LOG, …) are in the log of a run and in `canon`"
        return "GS912", hint
    head = word.split(" ")[0]
    for heads, code, hint in (*dialect.skipped, *_SKIPPED):
        if head in heads:
            return code, hint
    if head == "/":
        return "GS914", "the switch for lines with a slash is on (`block_delete`)"
    if head.startswith("G"):
        return "GS913", ""
    return "GS907", "say in the cell what it does, under `m_codes`"
