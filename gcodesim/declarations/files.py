"""Files that a cell names: where they may lie, and what was read, with hashes."""

from __future__ import annotations

import errno
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Final

from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen

VARIABLE: Final = "GCODESIM_ALLOW_PATH"
"""The user's own settings: folders from which cells may take files, separated as in PATH."""

_LARGEST: Final = 2_000_000_000  # bytes of a file that a cell names; a hole in a file costs its author nothing


def folders_of_the_user() -> tuple[Path, ...]:
    """What `GCODESIM_ALLOW_PATH` allows; only absolute folders, since whoever is judged could choose the others."""
    named = os.environ.get(VARIABLE, "").split(os.pathsep)
    return tuple(Path(folder) for folder in named if os.path.isabs(folder))


@frozen
class InputFile:
    """A file that the cell reads: `name` as the cell writes it, never a folder of this machine."""

    name: str
    path: Path
    sha256: str


@frozen
class Refused:
    """Why a file cannot be had: `outside` the allowed folders, `absent`, `special`, or no `file` or `folder`."""

    reason: str
    tried: str


@dataclass(slots=True, kw_only=True)
class Shelf:
    """Finds the files of one cell and remembers what was read.

    A name is looked up beside the cell. It may leave that folder only into a folder of `allowed`, which the user names
    and never the cell; symbolic links are followed first. `homes` has the folders of other files from which keys of the
    cell come, by their names in findings; `left` the folders of earlier set-ups, by the names of these. `whose`
    files they are, people are told. `runs_code`: the user lets it run Python that the cell names, whose `modules` it
    then remembers.
    """

    folder: Path
    whose: str = "cell"
    allowed: Sequence[Path] = ()
    runs_code: bool = False
    modules: list[str] = field(default_factory=list)
    packages: dict[str, Path] = field(default_factory=dict)
    homes: dict[str, Path] = field(default_factory=dict)
    left: Mapping[str, Path] = field(default_factory=dict)
    read: dict[str, InputFile] = field(default_factory=dict)
    sources: dict[str, SourceText] = field(default_factory=dict)

    def may_read(self, path: Path) -> bool:
        """Whether `path` lies in an allowed folder."""
        real = Path(os.path.realpath(path))
        roots = (self.folder, *self.allowed, *self.left.values())
        return any(real.is_relative_to(os.path.realpath(root)) for root in roots)

    def seen_from_cell(self, name: str, file: str) -> str:
        """How the cell would write `name`, which stands in `file`: files are named from where they are named."""
        home = self.homes.get(file)
        known = name.startswith("package://") or name.partition("/")[0] in self.left or os.path.isabs(name)
        if home is None or known or "\0" in name:
            return name
        return PurePosixPath(os.path.relpath(home / name, self.folder)).as_posix()

    def locate(self, name: str, *, is_folder: bool = False) -> Path | Refused:
        """The path that `name` means, or why there is none. `package://NAME/…` looks into `packages`."""
        path = self._spelled(name)
        if path is None:
            return Refused(reason="package", tried=name)
        if "\0" in name:
            return Refused(reason="absent", tried=name.replace("\0", "?"))
        tried = self._shown(path, name)
        if not self.may_read(path):
            return Refused(reason="outside", tried=tried)
        if not path.exists():
            return Refused(reason="absent", tried=tried)
        if is_folder != path.is_dir():
            return Refused(reason="folder" if is_folder else "file", tried=tried)
        if not is_folder and not path.is_file():
            return Refused(reason="special", tried=tried)
        return path

    def open(self, name: str, path: Path) -> SourceText:
        """Read and hash the file at `path`, which the cell calls `name`; OSError when that fails."""
        if path.stat().st_size > _LARGEST:
            raise OSError(errno.EFBIG, "it is larger than 2 GB")
        source = SourceText.read(path, name)
        self.note(name, path, source)
        return source

    def note(self, name: str, path: Path, source: SourceText) -> None:
        self.sources.setdefault(name, source)
        self.read.setdefault(name, InputFile(name=name, path=path, sha256=source.sha256))

    def files(self) -> tuple[InputFile, ...]:
        return tuple(self.read[name] for name in sorted(self.read))

    def _spelled(self, name: str) -> Path | None:
        if name.startswith("package://"):
            package, _, rest = name.removeprefix("package://").partition("/")
            root = self.packages.get(package)
            return None if root is None else root / rest
        setup, _, rest = name.partition("/")
        if setup in self.left:
            return self.left[setup] / rest
        return self.folder / name

    def _shown(self, path: Path, name: str) -> str:
        """Where it was looked for, seen from the cell's folder, so that no message depends on the machine."""
        if os.path.isabs(name):
            return name
        return PurePosixPath(os.path.relpath(path, self.folder)).as_posix()
