"""The script that uses a session: its text, and the line that calls."""

from __future__ import annotations

import sys
from pathlib import Path
from types import FrameType
from typing import Final

from gcodesim.diagnostics import SourceText, Span

_OWN: Final = str(Path(__file__).parents[1])
_NO_SCRIPT: Final = "session"


def _place() -> tuple[str, int] | None:
    """File and line of the nearest caller outside gcodesim."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_code.co_filename.startswith(_OWN):
        frame = frame.f_back
    return None if frame is None else (frame.f_code.co_filename, frame.f_lineno)


def script() -> SourceText:
    """The file that calls, or an empty text where there is none, as at a prompt."""
    place = _place()
    try:
        return SourceText.read(Path(place[0])) if place is not None else SourceText(_NO_SCRIPT, b"")
    except OSError:
        return SourceText(_NO_SCRIPT, b"")


def line() -> Span:
    """The line of the script that called."""
    place = _place()
    return Span(_NO_SCRIPT) if place is None else Span(Path(place[0]).name, place[1])
