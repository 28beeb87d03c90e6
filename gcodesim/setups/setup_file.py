"""`job.yaml`: the set-ups of a part in their order, read like a cell, with places."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path as FilePath
from typing import Final

from gcodesim.cell.cell import Cell
from gcodesim.cell.loader import CellChange
from gcodesim.cell.placing import names_of
from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.files import Shelf, folders_of_the_user
from gcodesim.declarations.form_version import form_version
from gcodesim.declarations.keys import all_keys, key
from gcodesim.declarations.kind import Json, Kind, document
from gcodesim.declarations.map_of import MapOf
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.nodes import Node, Scalar, compose
from gcodesim.declarations.plain_kinds import Switch
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record, known_keys, not_a_mapping
from gcodesim.diagnostics import Findings, SourceText
from gcodesim.files.repository import top_of
from gcodesim.frozen import frozen

_FROM: Final = "from"


@frozen
class OwnKeys:
    """What a set-up says besides the keys of a cell."""

    program: FileValue = key(File("a program"), "its program")
    cell: FileValue = key(File("a cell"), "its cell")
    skip: bool = key(Switch(), "leave it out", default=False, quiet=True)


@frozen
class Setup:
    """One set-up: a program in a cell, some keys of which it gives itself."""

    name: str
    program: FilePath
    cell: FilePath
    skip: bool
    entries: tuple[tuple[Scalar, Node], ...] = ()

    def change(self, source: SourceText, folder: FilePath, left: Mapping[str, FilePath]) -> CellChange:
        """What this set-up changes in its cell; `left` are folders with the stocks of earlier ones."""
        return CellChange(source=source, part=self.name, folder=folder, entries=self.entries, left=left)


_OWN: Final = Record(OwnKeys, "the set-up")
_CELL_KEYS: Final = tuple(name for name in all_keys(Cell) if name not in ("gcodesim", *all_keys(OwnKeys)))


@frozen(kw_only=False)
class SetupKind(Kind):
    """A mapping with the keys of a set-up and any of a cell."""

    @property
    def expected(self) -> str:
        return "a mapping with `program`, `cell`, and keys that replace those of the cell, such as `stock`"

    def read(self, node: Node, to: Reading, path: Path) -> Setup | Unread:
        if not isinstance(node, MappingNode):
            return not_a_mapping(node, self.expected, to, path)
        names = all_keys(OwnKeys)
        known = list(known_keys(node.entries, [*names, *_CELL_KEYS], "the set-up", to))
        own = _OWN.read_entries(tuple((name, value) for key, name, value in known if key in names), to, path)
        entries = tuple((_called(name, key), value) for key, name, value in known if key not in names)
        if isinstance(own, Unread):
            return UNREAD
        return Setup(name=str(path[-1]), program=own.program.path, cell=own.cell.path, skip=own.skip, entries=entries)

    def schema(self, definitions: dict[str, Json]) -> Json:
        own, cell = _OWN.schema(definitions), Record(Cell, "the cell").schema(definitions)
        of = {**definitions[own["$ref"].rpartition("/")[2]]}
        of["properties"] = {
            **of["properties"],
            **{name: definitions[cell["$ref"].rpartition("/")[2]]["properties"][name] for name in _CELL_KEYS},
        }
        return of


def _called(name: Scalar, key: str) -> Scalar:
    """The key as it is meant, in place of one that is nearly it."""
    return name if name.text == key else Scalar(span=name.span, text=key, plain=name.plain)


def _left_by(stock: Node) -> list[Scalar]:
    """The values of `from` in a stock, or in several by name."""
    if not isinstance(stock, MappingNode):
        return []
    own = [value for name, value in stock.entries if name.text == _FROM and isinstance(value, Scalar)]
    return own + [text for _, value in stock.entries for text in _left_by(value)]


@frozen
class Content:
    """All keys of a job file."""

    gcodesim_job: int = form_version("gcodesim-job")
    setups: Mapping[str, Setup] = key(
        MapOf(names_of("set-up"), SetupKind(), "set-ups by name, such as `top: {program: top.nc, cell: top.yaml}`"),
        "the set-ups of the part, in their order",
    )

    def checked(self, to: Reading, path: Path) -> Content | Unread:
        if not self.setups:
            return to.fault("GS705", to.span(("setups",)), "there is no set-up", "`top: {program: top.nc, cell: …}`")
        ahead = list(self.setups)
        for name, setup in self.setups.items():
            for text in _left_by(MappingNode(span=to.span(("setups", name)), entries=setup.entries)):
                if text.text in ahead:
                    what = "this set-up itself" if text.text == name else "a later set-up"
                    why = "set-ups run in the order of the file"
                    to.fault("GS711", text.span, f"`from` names {what}, `{text.text}`", why)
            ahead.remove(name)
        return self


_ROOT: Final = Record(Content, "the job")


@frozen
class JobFile:
    """A job file as it was read. `setups` is None when a finding is an error."""

    path: FilePath
    source: SourceText
    setups: tuple[Setup, ...] | None
    findings: Findings


def folders_of_job(path: FilePath) -> tuple[FilePath, ...]:
    """Where the files of a job may be, besides its own folder: in its repository, and below the folder of the run."""
    return (top_of(path.parent), FilePath.cwd())


def read_job_file(source: SourceText, path: FilePath, allow_paths: Sequence[FilePath] = ()) -> JobFile:
    """Read a job file. Programs and cells lie in its folder or in `allow_paths`, or where the user's settings allow."""
    findings = Findings()
    shelf = Shelf(folder=path.parent, whose="job", allowed=(*allow_paths, *folders_of_the_user()))
    to = Reading(file=source.name, findings=findings, shelf=shelf)
    root = compose(source, findings, what="job", example="setups: {top: {program: top.nc, cell: top.yaml}}")
    if root is None:
        return JobFile(path=path, source=source, setups=None, findings=findings)
    if root.get("setups") is None and {"machine", "robots"} & {name.text for name, _ in root.entries}:
        hint = "`gcodesim run PROGRAM --cell CELL` runs one program"
        to.fault("GS705", root.span, "this is a cell, no list of `setups`", hint)
        return JobFile(path=path, source=source, setups=None, findings=findings)
    read = _ROOT.read(root, to, ())
    good = not isinstance(read, Unread) and not findings.has_errors()
    return JobFile(path=path, source=source, setups=tuple(read.setups.values()) if good else None, findings=findings)


def job_schema() -> Json:
    """JSON Schema (2020-12) of job files, for editors."""
    definitions: dict[str, Json] = {}
    root = _ROOT.schema(definitions)
    return document("gcodesim job", root, definitions)
