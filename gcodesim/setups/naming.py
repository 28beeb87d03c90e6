"""How a job file is told from a program: by its name, since every `run` and `check` asks."""

from __future__ import annotations

from pathlib import Path
from typing import Final

SUFFIXES: Final = (".yaml", ".yml")


def is_job_file(path: Path) -> bool:
    """Whether a file named in place of a program lists set-ups; no control takes programs of that name."""
    return path.suffix.lower() in SUFFIXES
