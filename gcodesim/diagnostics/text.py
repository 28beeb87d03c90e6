"""The text of a program or cell file: bytes in, lines out, never a failure."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

_LINE_END = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True)
class SourceText:
    """A file as it was read: `name` is how findings call it (no folder of this machine), `raw` its bytes."""

    name: str
    raw: bytes

    @staticmethod
    def read(path: Path, name: str | None = None) -> SourceText:
        """Read a file; OSError when it cannot be read."""
        return SourceText(name or path.name, path.read_bytes())

    @cached_property
    def text(self) -> str:
        """UTF-8 with or without byte order mark, else Latin-1, which accepts every byte."""
        try:
            return self.raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            return self.raw.decode("latin-1")

    @cached_property
    def lines(self) -> list[str]:
        """Lines without their ends. Only LF, CRLF and CR end a line; an end after the last line opens no new one."""
        lines = _LINE_END.split(self.text)
        if lines and lines[-1] == "":
            lines.pop()
        return lines

    @cached_property
    def sha256(self) -> str:
        """Hash of the raw bytes, hexadecimal."""
        return hashlib.sha256(self.raw).hexdigest()

    def line(self, number: int) -> str:
        """The text of line `number` (from 1), empty when there is no such line."""
        return self.lines[number - 1] if 1 <= number <= len(self.lines) else ""
