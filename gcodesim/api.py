"""What `import gcodesim` offers to a Python program: `read`, `load_cell`, `simulate`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from gcodesim import simulation
from gcodesim.cell import Cell, LoadedCell
from gcodesim.cell import load_cell as read_cell_file
from gcodesim.cell.show import cell_as_text
from gcodesim.declarations.files import InputFile
from gcodesim.diagnostics import Diagnostic, Findings, Severity, SourceText
from gcodesim.diagnostics.show import as_text
from gcodesim.jobs.job import Options
from gcodesim.jobs.results import Results
from gcodesim.motion import ToolPath, build_tool_path
from gcodesim.motion.tool_path import ZERO
from gcodesim.rs274 import Settings, interpret, read_program
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.rs274.dialects import DIALECTS


class InputError(ValueError):
    """A program or a cell has errors, so what it describes cannot be returned; `findings` has all findings."""

    def __init__(self, findings: Sequence[Diagnostic], sources: Mapping[str, SourceText]) -> None:
        self.findings = tuple(findings)
        super().__init__("\n".join(as_text(finding, sources) for finding in self.findings))


def read(program: Path | str, settings: Settings | None = None) -> ToolPath:
    """The tool path of a program [m, rad], from machine zero on, as the program alone describes it.

    Without `settings` there is no tool table: every tool that the program names
    is assumed to exist, with length 0. Raises `InputError` with all findings when
    one is an error, OSError when the file cannot be read.
    """
    source = read_program(Path(program))
    reading = interpret(source, settings or Settings(tool_table=assumed_tools(source)))
    dialect = DIALECTS[reading.settings.dialect]
    path = build_tool_path(
        reading.stream(), ZERO, rapids_stand=dialect.rapids_stand, only_changes_stop=dialect.only_changes_stop
    )
    if any(finding.level >= Severity.ERROR for finding in reading.findings):
        raise InputError(list(reading.findings), reading.sources)
    return path


def load_cell(path: Path | str, allow_paths: Sequence[Path | str] = (), *, allow_code: bool = False) -> Cell:
    """The cell that a file describes. Raises `InputError` when it has errors, OSError when it cannot be read.

    `allow_paths` are folders besides that of the cell that may be read; `allow_code` runs the Python files that it
    names under `code`.
    """
    loaded = read_cell_file(Path(path), tuple(map(Path, allow_paths)), allow_code=allow_code)
    if loaded.cell is None:
        raise InputError(list(loaded.findings), loaded.sources)
    return loaded.cell


def simulate(
    program: Path | str,
    cell: Cell | Path | str,
    out: Path | str | None = None,
    *,
    channels: Mapping[str, Path | str] | None = None,
    force: bool = False,
    allow_paths: Sequence[Path | str] = (),
    allow_code: bool = False,
) -> Results:
    """Run `program` in `cell`; with `out`, a folder, write there what `gcodesim run` writes.

    `channels` names programs that run at the same time in further channels of the cell; `allow_paths` are folders
    besides that of the cell that its file may read, `allow_code` runs the Python files that it names.

    Files in `out` that the run reads, or that gcodesim did not write, are overwritten only with `force` (GS750).

    `cell` is a file, or a `Cell`, which may have been changed since it was read: then the log carries what
    `gcodesim cell show` prints of it in place of the file, and the results the hash of that.

    Faults of the program or the cell are findings in the results, as on the command line. OSError when a file
    cannot be read or written, `WorldUnavailable` when the world cannot be opened here. KeyboardInterrupt, on Ctrl-C,
    once the files in `out` are closed; it is a `gcodesim.simulation.RunInterrupted` when there are results so far.
    """
    if isinstance(cell, Cell):
        loaded = _as_loaded(cell)
    else:
        loaded = read_cell_file(Path(cell), tuple(map(Path, allow_paths)), allow_code=allow_code)
    further = {name: read_program(Path(path)) for name, path in (channels or {}).items()}
    job = simulation.prepare(read_program(Path(program)), loaded, Options(force=force, channels=further))
    results, _ = simulation.run(job, None if out is None else Path(out))
    return results


def _as_loaded(cell: Cell) -> LoadedCell:
    """A cell without a file, represented by its own listing."""
    source = SourceText(cell.name, cell_as_text(cell).encode())
    own = InputFile(name=source.name, path=Path(source.name), sha256=source.sha256)
    return LoadedCell(cell=cell, findings=Findings(), sources={source.name: source}, files=(own,), path=own.path)
