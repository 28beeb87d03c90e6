"""Names of files in a report: from the top of the repository, as build servers expect."""

from __future__ import annotations

import posixpath
from collections.abc import Mapping
from dataclasses import field
from pathlib import Path

from gcodesim.diagnostics import SourceText
from gcodesim.files.repository import top_of
from gcodesim.frozen import frozen
from gcodesim.regress.case import shown_path
from gcodesim.regress.sources import Sources


@frozen
class FilePlaces:
    """`sources` by the names that a verdict gives files, from the folder of the run.

    `prefix` is the path to that folder from the top of the repository.
    """

    sources: Mapping[str, SourceText] = field(default_factory=dict)
    prefix: str = ""

    @staticmethod
    def of(root: Path) -> FilePlaces:
        """For a run in the folder `root`: its files, and its path within its repository."""
        root, top = root.resolve(), top_of(root)
        prefix = "" if top == root else shown_path(root, top)
        return FilePlaces(sources=Sources(root), prefix=prefix)

    def shown(self, name: str) -> str:
        """`name` from the top, with `/` and without detours."""
        return posixpath.normpath(posixpath.join(self.prefix, name))

    def line(self, name: str, number: int) -> str:
        """A line of a file, empty if it does not exist."""
        source = self.sources.get(name)
        return "" if source is None else source.line(number)
