"""Every shipped program of an arm, posted for every control: the poses that come back are those of the plan."""

from __future__ import annotations

import itertools
from collections import defaultdict
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import SourceText, Span
from gcodesim.jobs.job import Job, Options
from gcodesim.post import LANGUAGES
from gcodesim.post.from_plan import NotPostedError, Wish, program_of
from gcodesim.post.language import name_in
from gcodesim.post.moves import RobotMove, RobotProgram
from gcodesim.regress.case import collect
from gcodesim.simulation import prepare

from .readers import READERS, Read

ROOT = Path(__file__).parents[3]
JOBS = {"flip"}
"""Cases of several set-ups, all on machine tools."""
PROGRAMS = sorted({path.name.removesuffix(".test.yaml") for path in (ROOT / "programs").glob("*.test.yaml")} - JOBS)


@cache
def jobs(name: str) -> tuple[Job, ...]:
    """All programs of a shipped case."""
    (case,) = collect([ROOT / "programs" / f"{name}.test.yaml"], ROOT).cases
    channels = {channel: SourceText.read(path) for channel, path in case.channels.items()}
    assert case.cell is not None
    return prepare(SourceText.read(case.program), load_cell(case.cell, [ROOT]), Options(channels=channels)).all


def back(program: RobotProgram, kind: str) -> list[Read]:
    language = LANGUAGES[kind]()
    name = name_in(language, program.name)
    reads = READERS[kind](language.write(program).files, name.upper() if kind == "fanuc-ls" else name)
    return [one for one in reads if one.to is not None]


@pytest.mark.slow
@pytest.mark.parametrize("kind", LANGUAGES)
@pytest.mark.parametrize("name", PROGRAMS)
def test_poses_come_back(name: str, kind: str) -> None:
    """To 0.01 mm; joints to as many digits as are written. What is not posted says why."""
    language = LANGUAGES[kind]()
    for one in jobs(name):
        try:
            program, _ = program_of(one, language, Wish(), jobs(name))
        except NotPostedError as reason:
            assert any(word in str(reason) for word in ("machine tool", "probe", "external axes"))
            continue
        moves = [step for step in program.steps if isinstance(step, RobotMove)]
        X_BK = language.X_BK(program)
        reads = back(program, kind)
        assert len(reads) == len(moves) > 1
        for read, move in zip(reads, moves, strict=True):
            for found, told in ((read.to, move.to), (read.via, move.via)):
                assert (found is None) == (told is None)
                if found is None or told is None:
                    continue
                if found.joints is not None:
                    np.testing.assert_allclose(found.joints, told.q, atol=1e-6)
                else:
                    X_BT = X_BK.matrix @ found.X_KT
                    np.testing.assert_allclose(X_BT[:3, 3], told.X_BT.p, atol=1e-5)
                    np.testing.assert_allclose(X_BT[:3, :3], told.X_BT.R, atol=1e-5)
        check_against_the_plan(one, moves)


def check_against_the_plan(job: Job, moves: list[RobotMove]) -> None:
    """Where the robot stops, the plan has the tip at the same moment of the same block, by its own kinematics."""
    plan = job.plan
    assert plan is not None
    t = plan.trajectory
    ends = _visits([plan.path.span(row) for row in range(len(plan.path))])
    checked = 0
    for span, last_moves in _visits([move.span for move in moves]).items():
        if len(ends.get(span, ())) != len(last_moves):  # of one of them the robot is told nothing
            continue
        for row, number in zip(ends[span], last_moves, strict=True):
            move = moves[number]
            if move.blend or t.sample(t.row_end[row : row + 1]).speed[0] > 1e-9:
                continue
            sample = t.sample(np.array([t.row_end[row] - 1e-9]))
            X_BT = plan.tip(plan.joints(sample), sample.row)[0]
            np.testing.assert_allclose(X_BT[:3, 3], move.to.X_BT.p, atol=1e-5)
            checked += 1
    assert checked


def _visits(spans: list[Span]) -> dict[Span, list[int]]:
    """The last place of each stretch of a block, for blocks of a loop one for each time."""
    last: dict[Span, list[int]] = defaultdict(list)
    for number, (span, following) in enumerate(itertools.pairwise([*spans, None])):
        if span is not None and span != following:
            last[span].append(number)
    return last
