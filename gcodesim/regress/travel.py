"""Cases that are judged by workers elsewhere: each travels with its files, and its verdict comes back as JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from gcodesim.cell import LoadedCell, load_cell
from gcodesim.declarations.files import folders_of_the_user
from gcodesim.diagnostics import SourceText
from gcodesim.files.digest import digest_of_texts
from gcodesim.regress.case import Case
from gcodesim.regress.outcome import Judging
from gcodesim.regress.suite import Judged, judged
from gcodesim.regress.workers import WorkerLostError
from gcodesim.scale.abilities import CODE, abilities
from gcodesim.scale.bundle import FileBundle
from gcodesim.scale.hands import Hands, Parcel, WorkerTask
from gcodesim.scale.inputs import CannotTravelError, files_of_cell, gathered, subprograms
from gcodesim.scale.plain_values import as_plain, from_plain
from gcodesim.setups.naming import is_job_file
from gcodesim.setups.setup_file import folders_of_job, read_job_file

_KEY: Final = 64


def judged_by(hands: Hands, cases: Sequence[Case], how: Judging) -> Generator[Judged, None, None]:
    """The verdicts on all cases, in their order, by workers who share no disk with this process.

    A case that names a file by its absolute path is judged here. WorkerLostError if a case kills its workers.
    """
    how = replace(how, allow_paths=(*how.allow_paths, *folders_of_the_user()))
    waiting: dict[str, list[int]] = {}
    ready: dict[int, Judged] = {}

    def tasks() -> Iterator[WorkerTask]:
        for number, case in enumerate(cases):
            try:
                task, root = _task(case, how)
            except (CannotTravelError, OSError):
                ready[number] = judged(case, how)
                continue
            known = waiting.setdefault(task.key, [])
            known.append(number)
            roots[task.key] = root
            if len(known) == 1:
                yield task

    roots: dict[str, Path] = {}
    following = 0
    ending = hands.do(judge_one, tasks())
    try:
        for end in ending:
            if end.lost:
                raise WorkerLostError(end.lost)
            if end.fault:
                raise RuntimeError(end.fault)
            done = from_plain(end.made.said, Judged, roots.pop(end.task.key))
            ready |= dict.fromkeys(waiting.pop(end.task.key), done)
            while following in ready:
                yield ready.pop(following)
                following += 1
        while following in ready:
            yield ready.pop(following)
            following += 1
    finally:
        ending.close()


def judge_one(said: Mapping[str, Any], folder: Path) -> FileBundle:
    """Judge a case, on a worker."""
    case, how = from_plain(said["case"], Case, folder), from_plain(said["how"], Judging, folder)
    how.root.mkdir(parents=True, exist_ok=True)
    return FileBundle(files={}, said=as_plain(judged(case, how), Judged, folder))


def _task(case: Case, how: Judging) -> tuple[WorkerTask, Path]:
    """The task of a case, and the folder from which its paths are told."""
    inputs = gathered(dict.fromkeys(_files(case, how)), root=how.root)
    allowed = [*how.allowed(case), *(folders_of_job(case.program) if is_job_file(case.program) else ())]
    here = replace(how, allow_paths=tuple(_there(allowed, inputs.root)))
    said = {
        "case": as_plain(replace(case, allow_path=()), Case, inputs.root),
        "how": as_plain(here, Judging, inputs.root),
    }
    parcel = Parcel.of(inputs.bundle)
    decides = json.dumps([abilities()[CODE], parcel.digest, said], sort_keys=True, ensure_ascii=False)
    key = digest_of_texts(decides)[:_KEY]
    return WorkerTask(key=key, said=said, parcel=parcel), inputs.root


def _there(folders: Iterable[Path], root: Path) -> Iterator[Path]:
    """The allowed folders as far as files of theirs travel: those below `root`, and `root` for those around it."""
    top = Path(os.path.realpath(root))
    for folder in folders:
        real = Path(os.path.realpath(folder))
        if real.is_relative_to(top):
            yield root / real.relative_to(top)
        elif top.is_relative_to(real):
            yield root


def _files(case: Case, how: Judging) -> Iterator[Path]:
    """All files that a case may read. OSError, CannotTravelError."""
    if case.edits:
        raise CannotTravelError("texts of a changed case are in no file")
    yield case.program
    yield from (path for path in (case.test_file, case.golden) if path is not None and path.is_file())
    if is_job_file(case.program):
        yield from _files_of_job(case, how)
        return
    folders: list[Path] = []
    if case.cell is not None:
        loaded = load_cell(case.cell, how.allowed(case), allow_code=how.allow_code)
        yield from files_of_cell(loaded)
        folders = _subroutines(loaded)
    for program in (case.program, *case.channels.values()):
        yield program
        yield from subprograms(program, folders)


def _files_of_job(case: Case, how: Judging) -> Iterator[Path]:
    allowed = (*folders_of_job(case.program), *how.allowed(case))
    job = read_job_file(SourceText.read(case.program), case.program, allowed)
    setups = job.setups or ()
    nowhere = dict.fromkeys((setup.name for setup in setups), case.program.parent)
    for setup in setups:
        loaded = load_cell(
            setup.cell, allowed, allow_code=how.allow_code, change=setup.change(job.source, job.path.parent, nowhere)
        )
        yield from files_of_cell(loaded)
        yield setup.program
        yield from subprograms(setup.program, _subroutines(loaded))


def _subroutines(loaded: LoadedCell) -> list[Path]:
    if loaded.cell is None:
        return []
    return [folder.path for channel in loaded.cell.channels.values() for folder in channel.subroutines]
