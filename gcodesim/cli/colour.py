"""Colours on a terminal: when there are any, and which piece of a finding has which."""

from __future__ import annotations

import os
from typing import Final, TextIO, cast

from gcodesim.diagnostics.plain import raw
from gcodesim.diagnostics.show import Paint, Role, unpainted

# codes of ECMA-48, "select graphic rendition": the eight colours that each terminal's own palette defines
_CODES: Final[dict[Role, str]] = {
    "path": "1",  # bold
    "place": "36",  # cyan
    "error": "31;1",
    "warning": "33;1",
    "note": "36;1",
    "frame": "34;1",  # blue
    "label": "36;1",
}


def wants_colour(stream: TextIO) -> bool:
    """Colour on a terminal that knows it; NO_COLOR switches it off, FORCE_COLOR on, also in a pipe.

    As no-color.org and force-color.org say: a variable that is set to anything counts, and NO_COLOR is the stronger.
    """
    if os.environ.get("NO_COLOR"):
        return False
    return bool(os.environ.get("FORCE_COLOR")) or (stream.isatty() and os.environ.get("TERM") != "dumb")


def paint_for(stream: TextIO) -> Paint:
    """How the pieces of a finding are coloured on this stream."""
    return _painted if wants_colour(stream) else unpainted


def painted(stream: TextIO) -> TextIO:
    """Where text goes that has our colours, if the stream shows any: what they are around has been made fit before."""
    return cast(TextIO, raw(stream)) if wants_colour(stream) else stream


def coloured(text: str, code: str, stream: TextIO) -> str:
    """`text` in the colour `code`, if the stream shows it."""
    return f"\033[{code}m{text}\033[0m" if wants_colour(stream) else text


def _painted(role: Role, text: str) -> str:
    return f"\033[{_CODES[role]}m{text}\033[0m"
