"""A program that is open in an editor: its text, how it is read, its cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.diagnostics.plain import one_line
from gcodesim.editor.found_cell import cell_of
from gcodesim.frozen import frozen
from gcodesim.rs274 import Settings
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.rs274.dialects import DIALECTS, Dialect
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.incremental import LineMoment, LiveReading
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.tokens import Token

if TYPE_CHECKING:
    from gcodesim.cell import Cell, LoadedCell

AT_ONCE: Final = 600
"""Blocks that are read before an answer to a change: what the change does itself."""


@frozen
class Choices:
    """What the workspace says: the cell of all programs, the dialect of those without, folders, the last run."""

    cell: Path | None = None
    dialect: str | None = None
    subroutines: tuple[Path, ...] = ()
    allow_paths: tuple[Path, ...] = ()
    out: Path | None = None


@dataclass(frozen=True, slots=True)
class _CellState:
    """A cell as it was read, and the bytes that it was read from."""

    path: Path
    raw: bytes
    loaded: LoadedCell
    settings: Settings
    problems: tuple[Diagnostic, ...]


class ProgramDocument:
    """The program at `path`, with its text as the editor has it."""

    def __init__(self, path: Path, text: str, choices: Choices) -> None:
        self.path = path
        self.choices = choices
        self._cell: _CellState | None = None
        self.reading: LiveReading | None = None
        self.source = self._source(text)
        self._read()

    def _source(self, text: str) -> SourceText:
        return SourceText(self.path.name, text.encode("utf-8", "surrogatepass"), self.path.parent)

    # -- changes

    def update(self, text: str) -> None:
        """Take a new text."""
        self.source = self._source(text)
        self._read()

    def look_at_cell(self) -> None:
        """Read the cell again if its file has changed."""
        self._read()

    def _read(self) -> None:
        settings = self._settings()
        if settings is None:
            self.reading = None
        elif self.reading is None:
            self.reading = LiveReading(self.source, settings)
        else:
            self.reading.update(self.source, settings)
        if self.reading is not None:
            self.reading.go_on(AT_ONCE)

    def _settings(self) -> Settings | None:
        """How the program is read; None where the cell has errors."""
        self._load_cell()
        settings = Settings()
        if self._cell is not None:
            if self._cell.loaded.cell is None:
                return None
            settings = self._cell.settings
        else:
            settings = replace(settings, tool_table=assumed_tools(self.source))
        if self.choices.dialect is not None:
            settings = replace(settings, dialect=self.choices.dialect)
        return replace(settings, subroutines=(*settings.subroutines, *self.choices.subroutines))

    def _load_cell(self) -> None:
        from gcodesim.cell import read_cell
        from gcodesim.simulation import settings_in_cell

        path = cell_of(self.path, self.choices.cell)
        if path is None:
            self._cell = None
            return
        source = SourceText.read(path)
        if self._cell is not None and (self._cell.path, self._cell.raw) == (path, source.raw):
            return
        loaded = read_cell(source, path, self.choices.allow_paths)
        settings, problems = Settings(), list[Diagnostic]()
        if loaded.cell is not None:
            settings, problems = settings_in_cell(loaded.cell)
        self._cell = _CellState(path, source.raw, loaded, settings, tuple(problems))

    # -- what is known

    @property
    def is_done(self) -> bool:
        """Whether the program is read to its end."""
        return self.reading is None or self.reading.is_done

    def go_on(self, blocks: int) -> bool:
        """Read on; whether all is read."""
        return self.reading is None or self.reading.go_on(blocks)

    @property
    def findings(self) -> list[Diagnostic]:
        """Those of `lint`, of the program and of its cell."""
        from gcodesim.cell.verdict import final_findings

        found = [] if self.reading is None else list(self.reading.findings)
        if self._cell is None:
            return found
        before = [*(self._cell.loaded.findings if self._cell.loaded.cell is None else ()), *self._cell.problems]
        everything = sorted([*before, *found], key=lambda finding: finding.order)
        return final_findings(everything, self._cell.loaded.cell, self.source)

    @property
    def cell(self) -> Cell | None:
        return None if self._cell is None else self._cell.loaded.cell

    @property
    def tool_names(self) -> dict[int, str]:
        """What the tools of the cell are, by number: name and kind."""
        tools = {} if self.cell is None else self.cell.tools
        return {
            number: tool.kind if tool.name == f"T{number}" else f"{one_line(tool.name)}, {tool.kind}"
            for number, tool in sorted(tools.items())
        }

    @property
    def cell_path(self) -> Path | None:
        return None if self._cell is None else self._cell.path

    @property
    def dialect(self) -> Dialect:
        dialect: Dialect = DIALECTS[Settings().dialect if self.reading is None else self.reading.settings.dialect]
        return dialect

    @property
    def file(self) -> ProgramFile | None:
        """The lines of the program."""
        return None if self.reading is None else self.reading.executor.file

    @property
    def files(self) -> Sequence[ProgramFile]:
        """The program, then the files with subroutines that were read."""
        if self.reading is None:
            return ()
        own = self.reading.executor.file
        return (own, *(one for one in self.reading.executor.flow.files.values() if one is not own))

    def tokens(self, line: int) -> list[Token]:
        """The pieces of the line with this index; none where it cannot be read."""
        file = self.file
        if file is None or not 0 <= line < len(file.lines):
            return []
        try:
            return file.tokens(line)
        except Fault:
            return []

    def moment(self, line: int) -> LineMoment | None:
        """What the control knows around the first time that a line is executed."""
        return None if self.reading is None else self.reading.moment(line)
