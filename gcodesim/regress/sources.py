"""Files by the names that findings give them, read on demand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import read_program


class Sources(Mapping[str, SourceText]):
    """Texts by their path from `root`; files that cannot be read are left out."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._read: dict[str, SourceText | None] = {}

    def __getitem__(self, name: str) -> SourceText:
        if name not in self._read:
            try:
                self._read[name] = read_program(self._root / name, name)
            except (OSError, ValueError):
                self._read[name] = None
        source = self._read[name]
        if source is None:
            raise KeyError(name)
        return source

    def __iter__(self) -> Iterator[str]:
        return (name for name, source in self._read.items() if source is not None)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def line(self, name: str, number: int) -> str:
        """A line of a file, empty if it does not exist."""
        source = self.get(name)
        return "" if source is None else source.line(number)
