"""Settings of the language reader from the command line, and from the cell when there is one."""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gcodesim.cli.exits import UsageError
from gcodesim.cli.nearest import no_such
from gcodesim.cli.options import read_source
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.rs274 import Run, Settings, ToolTable, interpret, read_parameters

if TYPE_CHECKING:
    from gcodesim.cell import Cell, LoadedCell


@dataclass(slots=True)
class Language:
    """Options of a command line about reading; files that they name are read once."""

    arguments: argparse.Namespace
    tools: ToolTable | None = None
    parameters: dict[int, float] = field(default_factory=dict)
    findings: list[Diagnostic] = field(default_factory=list)
    sources: dict[str, SourceText] = field(default_factory=dict)

    @staticmethod
    def of(arguments: argparse.Namespace) -> Language:
        """UsageError for files that do not exist or cannot be read."""
        from gcodesim.rs274.dialects import DIALECTS

        language = Language(arguments)
        if arguments.dialect is not None and arguments.dialect not in DIALECTS:
            raise UsageError(no_such("dialect", arguments.dialect, DIALECTS))
        for folder in arguments.subs:
            if not folder.is_dir():
                raise UsageError(f"the folder of subroutines {folder} is not there")
        if arguments.tools is not None:
            source = read_source(arguments.tools, "tool table")
            language.tools, problems = ToolTable.read(source)
            language._take(source, problems)
        if arguments.parameters is not None:
            source = read_source(arguments.parameters, "parameter file")
            language.parameters, problems = read_parameters(source)
            language._take(source, problems)
        return language

    def _take(self, source: SourceText, problems: Iterable[Diagnostic]) -> None:
        self.sources[source.name] = source
        self.findings += problems

    def over(self, settings: Settings) -> Settings:
        """`settings` with the options of the command line added."""
        given = self.arguments
        changes = {
            "dialect": given.dialect,
            "tool_table": self.tools,
            "parameters": {**settings.parameters, **self.parameters} if self.parameters else None,
            "presets": {**settings.presets, **given.presets} or None,
            "subroutines": (*settings.subroutines, *given.subs) if given.subs else None,
            "block_delete": given.block_delete,
            "options": {**settings.options, "decimal_point": given.decimal_point} if given.decimal_point else None,
            "max_blocks": given.max_blocks,
            "time_limit": given.time_limit,
        }
        return replace(settings, **{name: value for name, value in changes.items() if value is not None})


@dataclass(slots=True)
class ProgramReading:
    """A program that `lint` or `canon` is about to read, and what else is known.

    `run` is None when the cell has errors, which are then in `before`.
    """

    program: SourceText
    run: Run | None
    cell: Cell | None
    before: list[Diagnostic]
    sources: dict[str, SourceText]
    loaded: LoadedCell | None = None

    def _all(self) -> list[Diagnostic]:
        return sorted([*self.before, *(self.run.findings if self.run is not None else ())], key=lambda f: f.order)

    def findings(self, today: date | None = None) -> list[Diagnostic]:
        """All findings, with the severities of the cell and without those that it suppresses on the day `today`."""
        if self.cell is None:
            return self._all()
        from gcodesim.cell.verdict import final_findings

        return final_findings(self._all(), self.cell, self.program, today)

    @property
    def folders(self) -> Sequence[Path]:
        """Where subprograms were looked for."""
        return () if self.run is None else self.run.settings.subroutines

    def suppressed(self, today: date | None = None) -> list[tuple[Diagnostic, str]]:
        """The findings that the cell suppresses on the day `today`, with its reasons."""
        if self.cell is None:
            return []
        from gcodesim.cell.verdict import suppressed_findings

        pairs = suppressed_findings(self._all(), self.cell, self.program, today)
        return [(finding, entry.reason) for finding, entry in pairs]


def files_of(
    arguments: argparse.Namespace,
    program: Path,
    names: Iterable[str],
    folders: Sequence[Path],
    loaded: LoadedCell | None,
) -> dict[str, Path]:
    """Paths by the names that findings of a command give files: `names`, in `folders`, of the cell, of its options."""
    from gcodesim.regress.places import files_read

    given = [path for path in (arguments.tools, arguments.parameters) if path is not None]
    return {path.name: path for path in given} | files_read(program, names, folders, loaded)


_READING: Final = ("dialect", "block_delete", "decimal_point", "max_blocks", "time_limit", "presets")


def said_of_reading(arguments: argparse.Namespace) -> str:
    """All that the options of a command line say of reading, files by their content: equal where they say the same."""
    said = {name: getattr(arguments, name) for name in _READING}
    files = [path for path in (arguments.tools, arguments.parameters) if path is not None]
    digests = [hashlib.sha256(path.read_bytes()).hexdigest() for path in files]
    return repr((said, [str(folder) for folder in arguments.subs], digests))


def write_parameters(run: Run | None, arguments: argparse.Namespace) -> None:
    """Write the parameter file that the command line requests; none if the program did not get to its end."""
    from gcodesim.cli.output import note
    from gcodesim.files.whole_file import write_whole
    from gcodesim.rs274 import parameter_text

    path: Path | None = arguments.write_parameters
    if path is None:
        return
    if run is None or run.failed is not None:
        note(f"{path} is not written: the program did not come to its end")
        return
    try:
        write_whole(path, parameter_text(run.parameters, run.kept).encode())
    except OSError as error:
        raise UsageError(f"parameter file {path} cannot be written: {error.strerror}") from None
    note(f"wrote {path}")


def reading_of(arguments: argparse.Namespace, path: Path) -> ProgramReading:
    """The program at `path`, to be read as the options of a command line and its cell say.

    Without a cell and a tool table every tool is known, because a program alone does not say which tools there are.
    """
    program = read_source(path, "program")
    language = Language.of(arguments)
    settings, before, sources = Settings(), list(language.findings), dict(language.sources)
    cell = loaded = None
    if arguments.cell is not None:
        from gcodesim.cell import load_cell
        from gcodesim.simulation import settings_in_cell

        read_source(arguments.cell, "cell")
        loaded = load_cell(arguments.cell, arguments.allow_path, allow_code=arguments.allow_code)
        sources |= loaded.sources
        cell = loaded.cell
        if cell is None:
            return ProgramReading(program, None, None, [*loaded.findings, *before], sources, loaded)
        settings, problems = settings_in_cell(cell)
        before += problems
    elif arguments.tools is None:
        from gcodesim.rs274.assumed import assumed_tools

        settings = replace(settings, tool_table=assumed_tools(program))
    run = interpret(program, language.over(settings))
    return ProgramReading(program, run, cell, before, {**sources, program.name: program}, loaded)
