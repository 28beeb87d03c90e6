"""Programs with a name in place of a number: `<PART>` or `O<PART>` opens one, `M98 <PART>` and `G65 <PART>` call it.

Inside, a name is a number far above those of O words, so that calls, files and messages treat both alike.
"""

from __future__ import annotations

import re
from typing import Final
from zlib import crc32

from gcodesim.rs274.block import ColumnRange

_NAME: Final = r"<([^<>]{1,32})>"
_HEAD = re.compile(rf"\s*+(?:[Oo]\s*+)?{_NAME}\s*+(?:[(;].*)?")
_CALL = re.compile(rf"(?:M\s*0*98|G\s*0*6[56](?:\s*\.\s*1)?)\s*{_NAME}", re.IGNORECASE)
_FIRST: Final = 10**10


def number_of_name(name: str) -> int:
    """The number that stands for `name`, the same in every file."""
    return _FIRST + crc32(name.strip().upper().encode())


def head_name(text: str) -> str | None:
    """The name of the program that a line opens."""
    match = _HEAD.fullmatch(text)
    return None if match is None else match[1].strip()


def called_name(text: str) -> tuple[str, ColumnRange] | None:
    """The name that a line calls, and the place of its angle brackets."""
    match = _CALL.search(text)
    return None if match is None else (match[1].strip(), (match.start(1) - 1, match.end(1) + 1))
