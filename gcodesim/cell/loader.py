"""A cell file → `Cell`, with all findings at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path

from gcodesim.cell.cell import Cell, LoadedCell
from gcodesim.cell.own_code import CODE
from gcodesim.cell.resolve import resolve
from gcodesim.declarations.deep_value import DeepValue
from gcodesim.declarations.files import InputFile, Shelf, folders_of_the_user
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.nodes import Node, Scalar, compose
from gcodesim.declarations.reading import Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.diagnostics import Findings, SourceText
from gcodesim.frozen import frozen

# keys that decide how others are read
_FIRST = ("units", "packages", CODE)

ROOT = Record(Cell, "the cell", lenient=True)


@frozen
class CellChange:
    """Keys that another file gives in place of those of a cell: `entries` of its `part`, from `source` in `folder`.

    `values` are single ones, deep in the cell, each by its path; files that they name are seen from `home`.
    `left` are folders in which earlier set-ups left their stocks, by the names of these: `stock: {from: NAME}`.
    """

    source: SourceText
    part: str
    folder: Path
    entries: tuple[tuple[Scalar, Node], ...] = ()
    values: tuple[DeepValue, ...] = ()
    home: Path | None = None
    left: Mapping[str, Path] = field(default_factory=dict)

    def over(self, root: MappingNode, to: Reading) -> MappingNode:
        """The keys of a cell with the changed ones; a value without a place in it is a fault."""
        changed = {name.text for name, _ in self.entries}
        kept = tuple(entry for entry in root.entries if entry[0].text not in changed)
        root = replace(root, entries=(*kept, *self.entries))
        for value in self.values:
            root = value.put(root, to)
        return root

    def files(self) -> tuple[InputFile, ...]:
        """The part as an input of a run, if it changes anything; its hash is that of its keys, with their places."""
        if not self.entries and not self.values:
            return ()
        name = f"{self.source.name}#{self.part}"
        own = SourceText(name, repr((self.entries, self.values) if self.values else self.entries).encode())
        return (InputFile(name=name, path=self.folder / self.source.name, sha256=own.sha256),)


def load_cell(
    path: Path | str,
    allow_paths: Sequence[Path] = (),
    *,
    name: str | None = None,
    allow_code: bool = False,
    change: CellChange | None = None,
) -> LoadedCell:
    """Read the cell at `path`; OSError when the file itself cannot be read.

    Files that the cell names may lie in its folder, in `allow_paths` and in what the user's own settings allow
    (`GCODESIM_ALLOW_PATH`). `name` is how findings call the cell (default: the file's name). `allow_code` runs the
    Python files that it names under `code`; nothing in a cell or a program can ask for that. `change`: keys that
    another file gives in place of its own.
    """
    path = Path(path)
    return read_cell(SourceText.read(path, name), path, allow_paths, allow_code=allow_code, change=change)


def read_cell(
    source: SourceText,
    path: Path,
    allow_paths: Sequence[Path] = (),
    *,
    allow_code: bool = False,
    change: CellChange | None = None,
) -> LoadedCell:
    """Like `load_cell`, from a text whose file is at `path`."""
    findings = Findings()
    shelf = Shelf(folder=path.parent, allowed=(*allow_paths, *folders_of_the_user()), runs_code=allow_code)
    if change is not None:
        shelf.allowed = (*shelf.allowed, change.folder)
        shelf.homes, shelf.left = {change.source.name: change.folder}, change.left
        if change.home is not None:
            shelf.homes |= {value.node.span.file: change.home for value in change.values}
            shelf.allowed = (*shelf.allowed, change.home)
    to = Reading(file=source.name, findings=findings, shelf=shelf)
    root = compose(source, findings)
    if root is not None and change is not None:
        root = change.over(root, to)
    cell = None if root is None else _cell(root, to)
    own = InputFile(name=source.name, path=path, sha256=source.sha256)
    return LoadedCell(
        cell=None if findings.has_errors() else cell,
        findings=findings,
        sources={source.name: source, **shelf.sources, **({change.source.name: change.source} if change else {})},
        files=(own, *(() if change is None else change.files()), *shelf.files()),
        path=path,
    )


def _cell(root: MappingNode, to: Reading) -> Cell | None:
    entries = sorted(root.entries, key=lambda entry: entry[0].text not in _FIRST)
    if not to.shelf.runs_code and any(name.text == CODE for name, _ in entries):
        # what the files would add is not known, so nothing else can be judged
        ROOT.read(replace(root, entries=tuple(entry for entry in entries if entry[0].text == CODE)), to, ())
        return None
    cell = ROOT.read(replace(root, entries=tuple(entries)), to, ())
    if isinstance(cell, Unread):
        return None
    return resolve(replace(cell, name=to.file), to)
