"""Which cell belongs to a program that is open in an editor."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

_BESIDE: Final = "cell.yaml"


def cell_of(program: Path, given: Path | None) -> Path | None:
    """The cell that is given; else that of the program's test file; else `cell.yaml` beside it, as `init` writes it."""
    if given is not None:
        return _if_file(given)
    return _of_test_file(program) or _if_file(program.parent / _BESIDE)


def _if_file(path: Path) -> Path | None:
    return path if os.path.isfile(path) else None  # not the method, which raises where a name is too long


def _of_test_file(program: Path) -> Path | None:
    from gcodesim.regress.case import collect

    if _if_file(program) is None:
        return None
    try:
        cases = collect([program], program.parent).cases
    except OSError:
        return None
    return next((case.cell for case in cases if case.cell is not None and case.program.resolve() == program), None)
