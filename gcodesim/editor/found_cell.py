"""Which cell belongs to a program that is open in an editor."""

from __future__ import annotations

from pathlib import Path
from typing import Final

_BESIDE: Final = "cell.yaml"


def cell_of(program: Path, given: Path | None) -> Path | None:
    """The cell that is given; else that of the program's test file; else `cell.yaml` beside it, as `init` writes it."""
    if given is not None:
        return given if given.is_file() else None
    return _of_test_file(program) or _if_file(program.parent / _BESIDE)


def _if_file(path: Path) -> Path | None:
    return path if path.is_file() else None


def _of_test_file(program: Path) -> Path | None:
    from gcodesim.regress.case import collect

    if not program.is_file():
        return None
    try:
        cases = collect([program], program.parent).cases
    except OSError:
        return None
    return next((case.cell for case in cases if case.cell is not None and case.program.resolve() == program), None)
