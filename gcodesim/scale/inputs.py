"""All files that runs of programs in cells read, gathered below one folder, so that they can run anywhere."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import Final

from gcodesim.cell import LoadedCell
from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.rs274.marlin.duet.macro_call import files_of
from gcodesim.scale.bundle import FileBundle

_SUBPROGRAMS: Final = (".ngc", ".nc", ".gcode", ".tap", ".cnc", ".mpf", ".gc", ".g", ".txt", "")
_LARGEST: Final = 5_000_000  # bytes of a file that may be a subprogram
_COMPUTED: Final = re.compile(r"(?:o|p)(?:\[|#|\{)")
_MACRO: Final = re.compile(r'\bM0*98[ \t]*P[ \t]*"([^"]+)"', re.IGNORECASE)
_BLANK: Final = re.compile(r"\s+")


class CannotTravelError(Exception):
    """An input has no place below a common folder; the text says which, and why."""


@frozen(eq=False)
class Inputs:
    """`bundle` has the files by their names below `root`."""

    root: Path
    bundle: FileBundle

    def name(self, path: Path) -> str:
        """How a file is called in the bundle."""
        return _below(path, self.root)


def files_of_cell(loaded: LoadedCell) -> Iterator[Path]:
    """The files that a cell reads, itself first. CannotTravelError for one that it names by its absolute path."""
    for file in loaded.files:
        if "#" in file.name:  # keys of another file
            continue
        if os.path.isabs(file.name):
            raise CannotTravelError(
                f"{file.name} is named by its absolute path, which a worker elsewhere does not have: name it relative "
                f"to {loaded.path.name}"
            )
        yield file.path


def subprograms(program: Path, folders: Sequence[Path]) -> Iterator[Path]:
    """Files beside the program and in `folders` that it may call, directly or through others.

    A file counts if its name stands anywhere in a text that counts; where numbers of subprograms are computed, all do.
    """
    within = tuple(dict.fromkeys((*folders, program.parent)))
    found: dict[Path, str] = {}
    for folder in within:
        try:
            listed = sorted(folder.iterdir())
        except OSError:
            continue
        for path in listed:
            if path.suffix.lower() in _SUBPROGRAMS and path.is_file():
                found.setdefault(path, _stem(path))
    ahead, seen = [program], {program}
    while ahead:
        written = SourceText.read(ahead.pop()).text
        text = _squeezed(written)
        everything = _COMPUTED.search(text) is not None
        called = [path for path, stem in found.items() if everything or (stem and stem in text)]
        for path in (*called, *_macros(written, within)):
            if path not in seen and path.stat().st_size <= _LARGEST:
                seen.add(path)
                yield path
                ahead.append(path)


def _macros(text: str, folders: Iterable[Path]) -> Iterator[Path]:
    """The files of macros that a program of RepRapFirmware names, also in folders below."""
    for name in _MACRO.findall(text):
        ways = [folder / way for folder in folders for way in files_of(name)]
        yield from (path for path in ways if path.is_file())


def gathered(paths: Iterable[Path], *, root: Path | None = None) -> Inputs:
    """The files at `paths` as a bundle below the folder that they share, and that `root` is in or above.

    OSError if one cannot be read.
    """
    files = {Path(os.path.abspath(path)): None for path in paths}
    tops = [str(path.parent) for path in files] + ([] if root is None else [os.path.abspath(root)])
    top = Path(os.path.commonpath(tops))
    return Inputs(root=top, bundle=FileBundle(files={_below(path, top): path.read_bytes() for path in files}))


def _below(path: Path, root: Path) -> str:
    return PurePosixPath(*Path(os.path.relpath(os.path.abspath(path), root)).parts).as_posix()


def _squeezed(text: str) -> str:
    return _BLANK.sub("", text).lower()


def _stem(path: Path) -> str:
    """The name of a subprogram as it may stand in a call: `sub`, or the digits of O0100."""
    stem = _squeezed(path.stem)
    digits = stem.removeprefix("o")
    return (digits.lstrip("0") or "0") if digits.isdigit() else stem
