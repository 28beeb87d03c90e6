"""Who plays which part: the programs of a run and the channels of the cell in which they run."""

from __future__ import annotations

from collections.abc import Mapping

from gcodesim.cell import Cell
from gcodesim.cell.cell import MAIN
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.jobs.job import Job
from gcodesim.rs274 import read_program


def cast_of(cell: Cell, program: SourceText, further: Mapping[str, SourceText]) -> dict[str, SourceText]:
    """The programs of a run by channel: `main` first if it runs, the others in the order of their names.

    `further` are those that the command line names for channels of the cell; the cell names others. `program` is that
    of the channel for which the cell names this very file, else of `main`, else of the first channel without a program.
    """
    channels = cell.channels
    named = {
        name: file
        for name, channel in channels.items()
        if (file := channel.program) is not None and name not in further
    }
    own = _file_of(program)
    chosen = next((name for name, file in named.items() if own is not None and file.path.resolve() == own), None)
    if chosen is None:
        waiting = [name for name in channels if name not in further]
        without = [name for name in waiting if name not in named]
        chosen = MAIN if MAIN in waiting else next(iter([*without, *waiting, *channels]))
    cast = {name: read_program(file.path, file.name) for name, file in named.items()}
    cast |= further
    cast[chosen] = program
    ordered = sorted(cast, key=lambda name: (name != MAIN, name))
    return _told_apart({name: cast[name] for name in ordered})


def _file_of(program: SourceText) -> object:
    """Where a program was read from; None if it is no file."""
    return None if program.folder is None else (program.folder / program.name).resolve()


def _told_apart(cast: dict[str, SourceText]) -> dict[str, SourceText]:
    """Programs with names that tell them apart: different texts of one name bear that of their channel as well."""
    known: dict[str, bytes] = {}
    found = {}
    for name, source in cast.items():
        if known.setdefault(source.name, source.raw) != source.raw:
            source = SourceText(f"{name}:{source.name}", source.raw)
        found[name] = source
    return found


def is_of_cell(finding: Diagnostic, job: Job) -> bool:
    """Whether a finding is about the cell or another file than the job's program and its subprograms."""
    own = {job.program.name, *(job.reading.sources if job.reading is not None else ())}
    return finding.span.file not in own
