"""Which files the tests of a stranger may read: those of the repository of the run, and of folders the user names."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from gcodesim.declarations.files import folders_of_the_user
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.files.repository import top_of
from gcodesim.frozen import frozen


@frozen(kw_only=False)
class Readable:
    """`folders` with all links followed."""

    folders: tuple[Path, ...]

    @staticmethod
    def of(root: Path, named: Iterable[Path], allowed: Sequence[Path]) -> Readable:
        """The repository of the run, folders that the command line names or whose files it names, and allowed ones."""
        beside = (path if path.is_dir() else path.parent for path in named)
        folders = (top_of(root), *beside, *allowed, *folders_of_the_user())
        return Readable(tuple(dict.fromkeys(Path(os.path.realpath(folder)) for folder in folders)))

    def has(self, path: Path) -> bool:
        """Whether `path` lies in one of the folders, also after all links are followed."""
        real = Path(os.path.realpath(path))
        return any(real.is_relative_to(folder) for folder in self.folders)

    @staticmethod
    def fault(what: str, span: Span) -> Diagnostic:
        """GS715 about `what`, which lies elsewhere."""
        return Diagnostic(
            code="GS715",
            span=span,
            message=f"{what} lies outside the repository, or the folder, of the run",
            hint="only who runs gcodesim can open another one to tests: `--allow-path DIR`, or GCODESIM_ALLOW_PATH",
        )

    def link_fault(self, name: str) -> Diagnostic:
        """GS715 about a file that was found by its name and leads elsewhere; no line of it is shown."""
        return self.fault(f"`{name}` is a link; what it leads to", Span(name))
