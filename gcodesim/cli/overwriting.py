"""What a command writes must not be what it reads, nor a file's name an option."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final

from gcodesim.cli.exits import UsageError
from gcodesim.files.output_folder import names_of

# --write-parameters and --write-baseline may name the files of --parameters and --baseline, to update them
_READ: Final = ("program", "programs", "paths", "cell", "old_cell", "tools", "log", "other", "old", "new")
_WRITTEN: Final = ("out", "junit", "sarif", "gitlab", "html", "write_parameters", "write_baseline")
_OF_RUNS: Final = names_of(("*",), ("*",))
_HEAD: Final = 1 << 16


def refuse_files_like_options(words: Sequence[str]) -> None:
    """UsageError for a word that is an option by its first letter and a file by its name.

    Hooks and patterns of a shell put the names of a repository's files on the command line; `--out=x.nc` may be one.
    """
    for word in words:
        if word == "--":
            return
        if word.startswith("-") and os.path.lexists(word):
            raise UsageError(f"{word} is the name of a file here; write ./{word} for the file, or rename it")


def refuse_own_inputs(arguments: argparse.Namespace) -> None:
    """UsageError if the command line names a file for writing that it also reads."""
    targets = [(name, path) for name in _WRITTEN if (path := getattr(arguments, name, None)) is not None]
    targets = [(name, path) for name, path in targets if path.is_file()]
    if not targets:
        return
    inputs = list(_inputs(arguments))
    for name, path in targets:
        for read in inputs:
            with suppress(OSError):
                if path.samefile(read):
                    option = "-o" if name == "out" else f"--{name.replace('_', '-')}"
                    raise UsageError(f"{option} {path} would overwrite what the command reads; nothing was done")


def _inputs(arguments: argparse.Namespace) -> Iterator[Path]:
    for name in _READ:
        value = getattr(arguments, name, None)
        for path in value if isinstance(value, list) else [value]:
            if not isinstance(path, Path):
                continue
            if not path.is_dir():
                yield path
                continue
            for pattern in _OF_RUNS:
                yield from path.glob(pattern)


def refuse_foreign(path: Path) -> None:
    """UsageError if a command would write to a path of its own choice where there is a file of somebody else."""
    if not path.is_file():
        return
    with path.open("rb") as file:
        if b"gcodesim" in file.read(_HEAD).lower():
            return
    raise UsageError(f"{path} is there already, and gcodesim did not write it; name a file with -o")
