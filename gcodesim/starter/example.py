"""The program and the cell that `gcodesim init` writes for somebody who has neither."""

from __future__ import annotations

from importlib.resources import files
from typing import Final

PROGRAM: Final = "part.nc"
CELL: Final = "cell.yaml"


def start_files() -> dict[str, bytes]:
    """Contents of a first program and its cell by file name; they run as they are."""
    folder = files("gcodesim") / "data" / "init"
    return {name: (folder / name).read_bytes() for name in (PROGRAM, CELL)}
