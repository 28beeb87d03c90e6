"""A study ready to run: its files gathered, its values tried in the cell, and a task for each point."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from pathlib import Path
from typing import Any, Final

from gcodesim.cell import LoadedCell, load_cell
from gcodesim.cell.loader import CellChange
from gcodesim.diagnostics import Diagnostic, Severity, SourceText, Span
from gcodesim.files.digest import digest_of_texts
from gcodesim.frozen import frozen
from gcodesim.scale.abilities import CODE, abilities
from gcodesim.scale.hands import Parcel, WorkerTask
from gcodesim.scale.inputs import CannotTravelError, Inputs, files_of_cell, gathered, subprograms
from gcodesim.setups.setup_file import folders_of_job, read_job_file
from gcodesim.sweep.design import Point, all_levels
from gcodesim.sweep.factor import CELL, PROGRAM, Factor
from gcodesim.sweep.one import SOURCE
from gcodesim.sweep.study_file import VARY, Study, StudyFile, travelling
from gcodesim.sweep.values import deep_values, point_as_json

_OF_THE_VALUE: Final = ("GS704", "GS706", "GS707", "GS708", "GS709")
"""What no other value of another factor can mend: there is no such key, or its values are of another kind."""


@frozen(eq=False)
class Allowed:
    """What the command line lets the cells of a study do."""

    paths: Sequence[Path] = ()
    code: bool = False
    today: date | None = None


@frozen(eq=False)
class Prepared:
    """A study that can run."""

    file: StudyFile
    study: Study
    inputs: Inputs
    parcel: Parcel
    common: Mapping[str, Any]
    sources: Mapping[str, SourceText]

    def task(self, point: Point, *, keep: bool = False) -> WorkerTask:
        """The task of a point. Its key depends on nothing that its results do not depend on."""
        said = {**self.common, **point_as_json(self.study.vary, point)}
        for name in (PROGRAM, CELL):
            if name in self.study.vary:
                said[name] = self.inputs.name(self.file.path.parent / str(point[name].shown))
        decides = json.dumps([abilities()[CODE], self.parcel.digest, said], sort_keys=True, ensure_ascii=False)
        key = digest_of_texts(decides)
        return WorkerTask(key=f"{key}-logs" if keep else key, said={**said, "keep": keep}, parcel=self.parcel)

    def tasks(self, points: Iterator[Point]) -> Iterator[tuple[Point, WorkerTask]]:
        return ((point, self.task(point)) for point in points)


@dataclass(slots=True, kw_only=True)
class _Gathering:
    """What is found while the cells of a study are read with some of its values."""

    file: StudyFile
    allowed: Allowed
    paths: dict[Path, None] = field(default_factory=dict)
    findings: dict[Diagnostic, None] = field(default_factory=dict)
    sources: dict[str, SourceText] = field(default_factory=dict)
    scanned: set[tuple[Path, ...]] = field(default_factory=set)
    ends: bool = False

    def take(self, loaded: LoadedCell) -> None:
        """Its files; errors of the cell as it is."""
        self.paths |= dict.fromkeys(files_of_cell(loaded))
        self.sources |= loaded.sources
        if loaded.cell is not None:
            self.ends |= any(entry.until is not None for entry in loaded.cell.suppress)

    def programs(self, program: Path, loaded: LoadedCell) -> None:
        folders: list[Path] = []
        if loaded.cell is not None:
            folders = [folder.path for one in loaded.cell.channels.values() for folder in one.subroutines]
        if (program, *folders) not in self.scanned:
            self.scanned.add((program, *folders))
            self.paths |= dict.fromkeys((program, *subprograms(program, folders)))


def prepared(file: StudyFile, study: Study, allowed: Allowed) -> tuple[Prepared | None, list[Diagnostic]]:
    """A study ready to run, and what is wrong with its cells and values; None after an error.

    OSError if a file cannot be read.
    """
    study = replace(study, vary={name: travelling(factor) for name, factor in study.vary.items()})
    gathering = _Gathering(file=file, allowed=allowed, sources={file.source.name: file.source})
    common: dict[str, Any] = {
        "options": study.options.as_json(),
        "allow_code": allowed.code,
        "fail_on": "error",
    }
    try:
        if study.job is not None:
            setups = _take_job(study, study.job.path, gathering)
            common["setups"] = setups
        else:
            _take_cells(study, gathering)
    except CannotTravelError as reason:
        span = file.span("cell") if study.job is None else file.span("job")
        gathering.findings[Diagnostic(code="GS631", span=span, message=str(reason))] = None
    found = sorted(gathering.findings, key=lambda one: one.order)
    if any(one.level >= Severity.ERROR for one in found):
        return None, found
    inputs = gathered(gathering.paths, root=file.path.parent)
    common["today"] = (allowed.today or date.today()).isoformat() if gathering.ends else None
    common["home"] = inputs.name(file.path.parent)
    for name in (PROGRAM, CELL, "job"):
        given = getattr(study, name)
        if given is not None:
            common[name] = inputs.name(given.path)
    ready = Prepared(
        file=file,
        study=study,
        inputs=inputs,
        parcel=Parcel.of(inputs.bundle),
        common=common,
        sources=gathering.sources,
    )
    return ready, found


def _files(study: Study, name: str, folder: Path) -> list[Path]:
    """The programs or cells of a study."""
    if name in study.vary:
        return [folder / str(level.shown) for level in all_levels(study.vary[name])]
    given = study.program if name == PROGRAM else study.cell
    assert given is not None
    return [given.path]


def _take_cells(study: Study, to: _Gathering) -> None:
    folder = to.file.path.parent
    programs = _files(study, PROGRAM, folder)
    for path in _files(study, CELL, folder):
        loaded = load_cell(path, to.allowed.paths, allow_code=to.allowed.code)
        to.take(loaded)
        for program in programs:
            to.programs(program, loaded)
        for one in loaded.findings:
            if one.level >= Severity.ERROR:
                to.findings[one] = None
        if loaded.cell is None:
            continue
        for factor, values in _trials(study):
            change = CellChange(
                source=SourceText(SOURCE, b""), part=VARY, folder=folder, home=folder, values=tuple(deep_values(values))
            )
            tried = load_cell(path, to.allowed.paths, allow_code=to.allowed.code, change=change)
            _take_trial(factor, tried, to)
            for program in programs:
                to.programs(program, tried)


def _take_job(study: Study, path: Path, to: _Gathering) -> list[str]:
    """The files of all set-ups; their names."""
    allowed = (*folders_of_job(path), *to.allowed.paths)
    job = read_job_file(SourceText.read(path), path, allowed)
    to.paths[path] = None
    to.sources[job.source.name] = job.source
    to.findings |= dict.fromkeys(job.findings)
    setups = job.setups or ()
    names = [setup.name for setup in setups]
    with tempfile.TemporaryDirectory(prefix="gcodesim-") as nothing:
        left = dict.fromkeys(names, Path(nothing))
        for setup in setups:
            before = setup.change(job.source, path.parent, left)
            plain = load_cell(setup.cell, allowed, allow_code=to.allowed.code, change=before)
            to.take(plain)
            to.programs(setup.program, plain)
            for factor, values in _trials(study):
                own = [replace_path(value, names, setup.name) for value in values]
                deep = tuple(deep_values([value for value in own if value is not None]))
                change = replace(before, values=deep, home=to.file.path.parent)
                _take_trial(factor, load_cell(setup.cell, allowed, allow_code=to.allowed.code, change=change), to)
    return names


def replace_path(value: dict[str, Any], setups: Sequence[str], setup: str) -> dict[str, Any] | None:
    """A value as one set-up of a job sees it; None if it is for another one."""
    first = value["path"][0]
    if first not in setups:
        return value
    return {**value, "path": value["path"][1:]} if first == setup else None


def _trials(study: Study) -> Iterator[tuple[Factor, list[dict[str, Any]]]]:
    """Each value of each key that may name a file, and two of the numbers: as `point_as_json` has them."""
    for name, factor in study.vary.items():
        if factor.target != "key":
            continue
        levels = all_levels(factor)
        if factor.numeric and len(levels) > 2:
            levels = [levels[0], levels[-1]]
        for level in levels:
            yield factor, point_as_json({name: factor}, {name: level})["values"]


def _take_trial(factor: Factor, tried: LoadedCell, to: _Gathering) -> None:
    to.take(tried)
    for one in tried.findings:
        if one.level >= Severity.ERROR and one.code in _OF_THE_VALUE and one.span.file == f"{VARY}.{factor.name}":
            to.findings[placed(one, to.file)] = None


def placed(finding: Diagnostic, file: StudyFile) -> Diagnostic:
    """A finding about a value of a factor, placed in the study; any other as it is."""

    def moved(span: Span) -> Span:
        return file.span(VARY, span.file[len(VARY) + 1 :]) if span.file.startswith(f"{VARY}.") else span

    related = None if finding.related is None else moved(finding.related)
    return replace(finding, span=moved(finding.span), related=related)
