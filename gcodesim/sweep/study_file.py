"""`study.yaml`: what is run, what varies, and what a run must not be; read like a cell, with places."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any, Final

from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.files import Shelf, folders_of_the_user
from gcodesim.declarations.form_version import form_version
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Json, Range, document
from gcodesim.declarations.nodes import Node, compose
from gcodesim.declarations.plain_kinds import Choice, Switch, Text, Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.diagnostics import Findings, SourceText, Span
from gcodesim.files.repository import top_of
from gcodesim.frozen import frozen
from gcodesim.sweep.factor import CELL, FACTORS, PROGRAM, Factor
from gcodesim.sweep.limit import FigureKind, LimitKind, StudyLimit

VARY: Final = "vary"
MOST_RUNS: Final = 10_000_000
GRID, ROWS, SOBOL, LATIN = "grid", "rows", "sobol", "latin_hypercube"
DESIGNS: Final = (GRID, ROWS, SOBOL, LATIN)
_SPREAD: Final = (SOBOL, LATIN)
MODES: Final = ("run", "check")


@frozen
class Design:
    """How values are put together."""

    type: str = key(
        Choice(DESIGNS),
        "`grid`: each value with each other; `rows`: the first of all, the second of all …; `sobol`, "
        "`latin_hypercube`: points spread over all ranges",
        default=GRID,
    )
    runs: int | None = key(
        Whole(Range(least=1.0, most=float(MOST_RUNS))), "how many points are spread", default=None, quiet=True
    )
    seed: int = key(Whole(Range(least=0.0, most=2.0**32)), "which of all such spreads", default=1, quiet=True)

    def checked(self, to: Reading, path: Path) -> Design | Unread:
        if self.type in _SPREAD and self.runs is None:
            return to.fault("GS705", to.span(path), f"the design `{self.type}` lacks `runs`: how many points it has")
        if self.type not in _SPREAD and self.runs is not None:
            return to.fault("GS711", to.span(path), f"the number of runs of a `{self.type}` follows from its values")
        return self


@frozen
class Search:
    """A search for the best point, or for one that keeps all limits. Without `least` and `most` it is the latter."""

    least: str | None = key(FigureKind(), "the figure that is to be as small as it can be", default=None)
    most: str | None = key(FigureKind(), "the figure that is to be as great as it can be", default=None)
    runs: int = key(Whole(Range(least=8.0, most=1e6)), "after about so many runs it ends", default=200)
    seed: int = key(Whole(Range(least=0.0, most=2.0**32)), "which way it takes", default=1, quiet=True)

    def checked(self, to: Reading, path: Path) -> Search | Unread:
        if self.least is not None and self.most is not None:
            return to.fault(
                "GS711", to.span(path), "a search has one aim, `least` or `most`", "put the other into `fail`"
            )
        return self


@frozen
class RunOptions:
    """How each run is done; what is not given is as the cell says."""

    mode: str = key(Choice(MODES), "`run` it, or `check` it without material", default="run")
    world: str | None = key(Choice(("kinematic", "bullet")), "instead of what the cell says", default=None)
    dialect: str | None = key(Text(), "instead of what the cell says", default=None)
    block_delete: bool | None = key(Switch(), "whether blocks with / are skipped", default=None)
    max_blocks: int | None = key(Whole(Range(least=1.0)), "stop after so many blocks", default=None)
    time_limit: float | None = key(Quantity("time", POSITIVE), "stop reading after so long", default=None)

    def as_json(self) -> dict[str, Any]:
        """The options that are given."""
        names = ("mode", "world", "dialect", "block_delete", "max_blocks", "time_limit")
        return {name: value for name in names if (value := getattr(self, name)) is not None}


@frozen
class Study:
    """All keys of a study."""

    gcodesim_study: int = form_version("gcodesim-study")
    program: FileValue | None = key(File("a program"), "the program of all runs", default=None)
    cell: FileValue | None = key(File("a cell"), "the cell of all runs", default=None)
    job: FileValue | None = key(File("a job file"), "set-ups in place of program and cell", default=None)
    vary: Mapping[str, Factor] = key(FACTORS, "what varies, by name: the names are the columns of tables", default={})
    table: FileValue | None = key(File("a table (CSV)"), "values of factors, a run a line", default=None)
    design: Design = key(
        Record(Design, "the design", shorthand="type"), "how values are put together", default=Design(), quiet=True
    )
    fail: tuple[StudyLimit, ...] = key(
        ListOf(LimitKind(), single=True), "limits: a run that is beyond one fails", default=(), quiet=True
    )
    find: Search | None = key(Record(Search, "`find`"), "what --find searches for", default=None)
    columns: tuple[str, ...] = key(
        ListOf(FigureKind(), single=True), "further columns: paths of `results.json`", default=(), quiet=True
    )
    options: RunOptions = key(Record(RunOptions, "`options`"), "how each run is done", default=RunOptions(), quiet=True)

    def checked(self, to: Reading, path: Path) -> Study | Unread:
        if self.job is not None:
            given = [name for name in (PROGRAM, CELL) if getattr(self, name) is not None or name in self.vary]
            if given:
                return to.fault("GS711", to.span(("job",)), f"a study of a `job` has no `{given[0]}` of its own")
            return self
        for name in (PROGRAM, CELL):
            if getattr(self, name) is None and name not in self.vary:
                hint = "or `job` with a file of set-ups"
                return to.fault("GS705", to.span(()), f"the study lacks `{name}`: the name of a {name}", hint)
        return self


_ROOT: Final = Record(Study, "the study")


@frozen(eq=False)
class StudyFile:
    """A study as it was read. `study` is None when a finding is an error; `spans` are the places of keys."""

    path: FilePath
    source: SourceText
    study: Study | None
    findings: Findings
    spans: Mapping[Path, Span]
    files: Mapping[str, FilePath]

    def span(self, *path: str | int) -> Span:
        """The place of a key, or of what is around it."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.spans:
                return self.spans[path[:length]]
        return Span(self.source.name, 1, 1, 1, 2)


def read_study(source: SourceText, path: FilePath, allow_paths: Sequence[FilePath] = ()) -> StudyFile:
    """Read a study.

    Its files lie in its repository, below the folder of the command, in `allow_paths`, or where the user's settings
    allow.
    """
    findings = Findings()
    around = (top_of(path.parent), FilePath.cwd())
    shelf = Shelf(folder=path.parent, whose="study", allowed=(*around, *allow_paths, *folders_of_the_user()))
    to = Reading(file=source.name, findings=findings, shelf=shelf)
    root = compose(source, findings, what="study", example="program: part.nc")
    study = None
    if root is not None:
        read = _ROOT.read(root, to, ())
        if not isinstance(read, Unread):
            study = with_values(read, to)
    if findings.has_errors():
        study = None
    files = {name: file.path for name, file in shelf.read.items()}
    return StudyFile(path=path, source=source, study=study, findings=findings, spans=to.spans, files=files)


def with_values(study: Study, to: Reading) -> Study | None:
    """The study with the values of its table, with the files that factors name, and checked as a whole."""
    from gcodesim.sweep.table_of_values import values_of_table

    if study.table is not None:
        filled = values_of_table(study, to)
        if filled is None:
            return None
        study = filled
    for name, factor in study.vary.items():
        if factor.column is not None and factor.levels is None:
            hint = "give it `values`, `from` and `to`, or a `table` with such a column"
            to.fault("GS705", to.span((VARY, name)), f"nothing says which values `{name}` takes", hint)
        elif factor.target in (PROGRAM, CELL):
            for index, node in enumerate(factor.levels or ()):
                File(f"a {factor.target}").read(node, to, (VARY, name, "values", index))
    _check_design(study, to)
    headings: dict[str, str] = {}
    for name, factor in study.vary.items():
        if headings.setdefault(factor.heading, name) != name:
            to.fault(
                "GS711", to.span((VARY, name)), f"`{name}` has the same column `{factor.heading}` as another factor"
            )
    return study


def _check_design(study: Study, to: Reading) -> None:
    spread = study.design.type in _SPREAD
    at = to.span(("design",))
    if not study.vary and study.find is None:
        to.fault("GS705", to.span((VARY,)), "nothing varies: `vary` says what does")
    for name, factor in study.vary.items():
        if (
            factor.levels is None
            and factor.column is None
            and factor.steps is None
            and not spread
            and study.find is None
        ):
            message = f"the range of `{name}` lacks `steps`: how many values a {study.design.type} takes of it"
            hint = "`steps: 5`; or `design: {type: sobol, runs: 16}`, which spreads points over it"
            to.fault("GS705", to.span((VARY, name)), message, hint)
    if study.design.type == ROWS:
        counts = {name: len(factor.levels) if factor.levels else factor.steps for name, factor in study.vary.items()}
        if len(set(counts.values())) > 1:
            told = ", ".join(f"{name} {count}" for name, count in counts.items())
            to.fault("GS711", at, f"factors side by side need equally many values; there are: {told}")


def spans_of_values(name: str) -> Span:
    """The place that findings about values of a factor bear while they are away from the study."""
    return Span(f"{VARY}.{name}", 1, 1, 1, 2)


def travelling(factor: Factor) -> Factor:
    """The factor with values that do not say where in the study they stand, so that moving lines changes nothing."""
    if factor.levels is None:
        return factor
    return replace(factor, levels=tuple(_moved(node, spans_of_values(factor.name)) for node in factor.levels))


def _moved(node: Node, span: Span) -> Node:
    from gcodesim.declarations.nodes import Listing, Scalar
    from gcodesim.declarations.nodes import Mapping as MappingNode

    if isinstance(node, Scalar):
        return replace(node, span=span)
    if isinstance(node, Listing):
        return Listing(span=span, items=tuple(_moved(item, span) for item in node.items))
    entries = ((replace(name, span=span), _moved(value, span)) for name, value in node.entries)
    return MappingNode(span=span, entries=tuple(entries))


def study_schema() -> Json:
    """JSON Schema (2020-12) of studies, for editors."""
    definitions: dict[str, Json] = {}
    root = _ROOT.schema(definitions)
    return document("gcodesim study", root, definitions)
