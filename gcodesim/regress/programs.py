"""Which files are programs, by their names."""

from __future__ import annotations

from pathlib import Path
from typing import Final

PROGRAMS: Final = (".nc", ".ngc", ".gcode", ".tap", ".cnc", ".mpf", ".gc", ".bgcode")


def programs_in(folder: Path) -> list[Path]:
    """The programs of a folder and the folders in it, in order."""
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in PROGRAMS and path.is_file())
