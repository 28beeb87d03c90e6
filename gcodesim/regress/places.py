"""Paths of the files that findings name, and findings with their places named from one folder."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gcodesim.diagnostics import Caller, Diagnostic, Span
from gcodesim.regress.case import shown_path

if TYPE_CHECKING:
    from gcodesim.cell import LoadedCell


def files_read(
    program: Path, names: Iterable[str], folders: Sequence[Path], loaded: LoadedCell | None
) -> dict[str, Path]:
    """Paths by the names that findings give files: those of the cell, the program, and what stands beside it.

    `names` are all sources, `folders` those in which subprograms were looked for. A name without a file is left out.
    """
    files = {} if loaded is None else {file.name: file.path for file in loaded.files}
    files[program.name] = program
    for name in names:
        if name not in files:
            near = (folder / name for folder in (program.parent, *folders))
            found = next((path for path in near if path.is_file()), None)
            if found is not None:
                files[name] = found
    return files


def relocated(finding: Diagnostic, files: Mapping[str, Path], root: Path) -> Diagnostic:
    """`finding` with all its places named from `root`."""

    def shown(name: str) -> str:
        return shown_path(files[name], root) if name in files else name

    def moved(span: Span) -> Span:
        callers = tuple(Caller(shown(c.file), c.line, c.name) for c in span.callers)
        return replace(span, file=shown(span.file), callers=callers)

    related = None if finding.related is None else moved(finding.related)
    return replace(finding, span=moved(finding.span), related=related)
