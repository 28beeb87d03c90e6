"""What a suite would not see: seeded changes of its programs and cells, each judged in the case that it changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, Final, Literal
from uuid import uuid4

from gcodesim.diagnostics import SourceText
from gcodesim.files.repository import top_of
from gcodesim.frozen import frozen
from gcodesim.regress.case import Case, shown_path
from gcodesim.regress.mutation import CELL_OPERATORS, PROGRAM_OPERATORS, Mutation, mutate_cell, mutate_program
from gcodesim.regress.tolerance import DEFAULTS, Tolerance
from gcodesim.regress.workers import in_parallel
from gcodesim.rs274 import read_program
from gcodesim.setups.naming import is_job_file
from gcodesim.setups.setup_file import read_job_file

if TYPE_CHECKING:
    from gcodesim.regress.facts import Facts
    from gcodesim.regress.outcome import Judging

SCHEMA: Final = "gcodesim-mutants/1"

_Ground = tuple[Case, Path, Path | None]
"""A case, and a program and cell of it that may be changed."""

Fate = Literal["seen", "not_seen", "no_effect"]
"""The case fails; it passes although something differs, or nothing was there to compare with; nothing differs."""

_SHARE_OF_PROGRAMS: Final = 0.7  # the other changes are of cells
_TRIES: Final = 50  # draws for each mutant: an operator may find nothing to change, or repeat an earlier draw
_EXACT: Final = {name: Tolerance(1e-6 * default.absolute, 1e-9) for name, default in DEFAULTS.items()}


@frozen
class Mutant:
    """A case with one change of its program or its cell."""

    case: Case
    file: str
    mutation: Mutation


@frozen
class MutantVerdict:
    """What became of a mutant; `quantities` are those that differ, within tolerance where it was not seen."""

    mutant: Mutant
    fate: Fate
    quantities: tuple[str, ...] = ()


def draw(cases: Sequence[Case], root: Path, count: int, seed: int) -> tuple[Mutant, ...]:
    """`count` mutants of `cases`; fewer if nothing more can be changed. The same seed draws the same ones.

    Of a job, programs and cells of its set-ups are changed.
    """
    grounds = [ground for case in cases for ground in _programs_of(case, root)]
    drawn: dict[tuple[str, str, str], Mutant] = {}
    for number in range(count * _TRIES):
        mutant = _draw_one(grounds, root, Random(f"{seed}/{number}"))
        if mutant is not None:
            drawn.setdefault((mutant.case.name, mutant.file, mutant.mutation.text), mutant)
        if len(drawn) == count:
            break
    return tuple(drawn.values())


def _programs_of(case: Case, root: Path) -> list[_Ground]:
    """The program of a case and its cell; of a job those of all its set-ups."""
    if not is_job_file(case.program):
        return [(case, case.program, case.cell)]
    allowed = (top_of(case.program.parent), top_of(root), *case.allow_path)
    job = read_job_file(SourceText.read(case.program), case.program, allowed)
    return [(case, setup.program, setup.cell) for setup in job.setups or () if not setup.skip]


def _draw_one(grounds: Sequence[_Ground], root: Path, random: Random) -> Mutant | None:
    """A change of one case; None if the operator that was drawn finds nothing to change."""
    case, program, cell = random.choice(grounds)
    path, change, operators = program, mutate_program, list(PROGRAM_OPERATORS)
    if cell is not None and random.random() >= _SHARE_OF_PROGRAMS:
        path, change, operators = cell, mutate_cell, list(CELL_OPERATORS)
    text = "\n".join(read_program(path).lines) + "\n"
    mutation = change(random, text, random.choice(operators))
    if mutation is None or mutation.text == text:
        return None
    changed = replace(case, edits={path: mutation.text.encode()})
    return Mutant(case=changed, file=shown_path(path, root), mutation=mutation)


def judge_mutants(
    mutants: Sequence[Mutant], how: Judging, *, jobs: int = 1, progress: Callable[[Mutant], None] | None = None
) -> tuple[MutantVerdict, ...]:
    """The fate of each mutant, in order, found by `jobs` processes.

    The mutants of one case are judged one after another, so that each process runs an original only once.
    """
    order = sorted(range(len(mutants)), key=lambda index: mutants[index].case.name)
    run = uuid4().hex
    fates = in_parallel(partial(_fate, run), [mutants[index].case for index in order], how, jobs)
    verdicts: dict[int, MutantVerdict] = {}
    try:
        for index in order:
            fate, quantities = next(fates)
            verdicts[index] = MutantVerdict(mutant=mutants[index], fate=fate, quantities=quantities)
            if progress is not None:
                progress(mutants[index])
    finally:
        fates.close()
        _ORIGINALS.clear()
    return tuple(verdicts[index] for index in range(len(mutants)))


def _fate(run: str, case: Case, how: Judging) -> tuple[Fate, tuple[str, ...]]:
    from gcodesim.regress.facts import compare
    from gcodesim.regress.judge import judge

    verdict, outcome = judge(case, how)
    if verdict.status == "failed":
        return "seen", verdict.quantities
    comparison = compare(_original(run, case, how), outcome.facts, _EXACT)
    return ("no_effect", ()) if comparison.same else ("not_seen", comparison.quantities)


_ORIGINALS: Final[dict[tuple[str, str], Facts]] = {}
"""What the original of the latest unseen mutant showed in this process; by the call of `judge_mutants` and the case."""


def _original(run: str, case: Case, how: Judging) -> Facts:
    """The facts of the case without its change; a run of them is kept until another case comes."""
    from gcodesim.regress.judge import judge

    key = (run, case.name)
    if key not in _ORIGINALS:
        _ORIGINALS.clear()
        _ORIGINALS[key] = judge(replace(case, edits={}), how)[1].facts
    return _ORIGINALS[key]


def mutants_as_json(verdicts: Sequence[MutantVerdict], seed: int) -> dict[str, Any]:
    """All verdicts, with the counts on top."""
    fates: tuple[Fate, ...] = ("seen", "not_seen", "no_effect")
    return {
        "schema": SCHEMA,
        "seed": seed,
        "counts": {fate: sum(one.fate == fate for one in verdicts) for fate in fates},
        "mutants": [
            {
                "case": one.mutant.case.name,
                "file": one.mutant.file,
                "operator": one.mutant.mutation.operator,
                "change": one.mutant.mutation.what,
                "fate": one.fate,
                "quantities": list(one.quantities),
            }
            for one in verdicts
        ],
    }
