"""A program as a file has it: text, or binary G-code, which becomes the text that it stands for."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

from gcodesim.diagnostics import SourceText

_BINARY: Final = re.compile(rb"GCDE[\x00-\x08\x0e-\x1f]")  # a version follows; in a text it would be a letter or blank


def read_program(path: Path, name: str | None = None) -> SourceText:
    """Read the file of a program; OSError as from `SourceText.read`."""
    return as_text(SourceText.read(path, name))


def as_text(source: SourceText) -> SourceText:
    """The program as text; binary G-code that cannot be read stays as it is, and reading it as a program says why."""
    if not is_binary(source.raw):
        return source
    from gcodesim.rs274.binary.blocks import BinaryReadError
    from gcodesim.rs274.binary.text import text_of

    try:
        return SourceText(source.name, text_of(source.raw), source.folder)
    except BinaryReadError:
        return source


def is_binary(raw: bytes) -> bool:
    """Whether a file is binary G-code, by its first bytes."""
    return _BINARY.match(raw) is not None


def why_unreadable(source: SourceText) -> str:
    """Why `as_text` left binary G-code as it is; empty for a text."""
    if not is_binary(source.raw):
        return ""
    from gcodesim.rs274.binary.blocks import BinaryReadError
    from gcodesim.rs274.binary.text import text_of

    try:
        text_of(source.raw)
    except BinaryReadError as fault:
        return str(fault)
    return ""
