"""The text of a program or cell file: bytes in, lines out, never a failure."""

from __future__ import annotations

import errno
import hashlib
import os
import re
from collections.abc import Sequence
from dataclasses import field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.diagnostics.line_table import LineTable

_LINE_END = re.compile(r"\r\n|\n|\r")
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"

LONG: Final = 200_000
"""Bytes from which on a text is long: then its lines are not a list of strings, and the compiled lane pays."""


def shown_name(path: Path) -> str:
    """The name of a file as findings and results call it: bytes of it that are no UTF-8 become U+FFFD."""
    return os.fsencode(path.name).decode("utf-8", "replace")


@frozen(slots=False, kw_only=False)
class SourceText:
    """A file as it was read: `name` is how findings call it (no folder of this machine), `raw` its bytes.

    `folder` is where it is, and where files that it names may be; None for a text that is not a file.
    """

    name: str
    raw: bytes
    folder: Path | None = field(default=None, compare=False)

    @staticmethod
    def read(path: Path, name: str | None = None) -> SourceText:
        """Read a file; OSError if it cannot be read, or is a pipe or device, which may never end."""
        if path.exists() and not path.is_file() and not path.is_dir():
            raise OSError(errno.EINVAL, "it is no regular file")
        return SourceText(name or shown_name(path), path.read_bytes(), path.parent)

    @cached_property
    def encoding(self) -> str:
        """UTF-8 when every byte fits, else Latin-1, which accepts every byte."""
        if self.raw.isascii():
            return "utf-8"
        try:
            self.raw.decode("utf-8")
        except UnicodeDecodeError:
            return "latin-1"
        return "utf-8"

    @cached_property
    def text(self) -> str:
        """The whole text, without a byte order mark. A long one is better taken line by line."""
        return self.raw[self._begin :].decode(self.encoding)

    @property
    def _begin(self) -> int:
        """Where the text begins: after a byte order mark, unless the bytes are not UTF-8."""
        marked = self.raw.startswith(_BYTE_ORDER_MARK) and self.encoding == "utf-8"
        return len(_BYTE_ORDER_MARK) if marked else 0

    @cached_property
    def lines(self) -> Sequence[str]:
        """Lines without their ends. Only LF, CRLF and CR end a line; an end after the last line opens no other."""
        if len(self.raw) >= LONG:
            return self.table
        lines = _LINE_END.split(self.text)
        if lines and lines[-1] == "":
            lines.pop()
        return lines

    @cached_property
    def table(self) -> LineTable:
        """The lines as offsets into the bytes."""
        from gcodesim.diagnostics.line_table import LineTable

        return LineTable(self.raw, self._begin, self.encoding)

    @cached_property
    def sha256(self) -> str:
        """Hash of the raw bytes, hexadecimal."""
        return hashlib.sha256(self.raw).hexdigest()

    def line(self, number: int) -> str:
        """The text of line `number` (from 1), empty when there is no such line."""
        return self.lines[number - 1] if 1 <= number <= len(self.lines) else ""
