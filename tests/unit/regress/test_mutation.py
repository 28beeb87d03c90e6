"""A test run sees what changes a result, names the quantity, and sees nothing in edits that mean the same.

The seed is drawn anew by each run and stands in every message; `GCODESIM_MUTATION_SEED=… pytest` repeats it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random, SystemRandom

import pytest

import gcodesim
from gcodesim.regress import CaseVerdict
from gcodesim.regress.case import collect
from gcodesim.regress.judge import Judging
from gcodesim.regress.mutation import CELL_OPERATORS, PROGRAM_OPERATORS, Mutation, edit_neutrally, mutate_cell
from gcodesim.regress.mutation import mutate_program as mutate
from gcodesim.regress.suite import run_suite

DRAWN = 20
SEED = int(os.environ.get("GCODESIM_MUTATION_SEED") or SystemRandom().randrange(2**32))
PROGRAMS = ("pocket", "slot_arm")

# the oracle: figures of the results, by their paths, and what may differ; not read from the package
FIGURES: dict[str, Callable[[dict], Iterator[tuple[str, float]]]] = {
    "time": lambda r: iter([("time.total_s", r["time"]["total_s"])]),
    "way": lambda r: iter([("distance.feed_mm", r["distance"]["feed_mm"])]),
    "volume": lambda r: iter([(f"stocks.{n}.removed_mm3", s["removed_mm3"]) for n, s in r["stocks"].items()]),
    "force": lambda r: iter([(f"tools.{t['number']}.max_force_N", t["max_force_N"]) for t in r["tools"]]),
}
ALLOWED = {"time": (0.01, 1e-3), "way": (0.01, 1e-4), "volume": (0.5, 1e-3), "force": (0.5, 0.01)}


def results_of(folder: Path, name: str) -> dict:
    return gcodesim.simulate(folder / f"{name}.nc", folder / f"{name}.yaml").as_json()


def beyond(old: dict, new: dict) -> list[str]:
    """Paths of the figures that differ by more than is allowed."""
    found = []
    for kind, figures in FIGURES.items():
        absolute, relative = ALLOWED[kind]
        now = dict(figures(new))
        for path, value in figures(old):
            if path in now and abs(now[path] - value) > 1.001 * max(absolute, relative * abs(value)):
                found.append(path)
    return found


def verdict_on(folder: Path, name: str) -> CaseVerdict:
    (case,) = run_suite(collect([folder / f"{name}.test.yaml"], folder), Judging(root=folder)).cases
    return case


def is_named(wanted: tuple[str, ...], quantities: tuple[str, ...]) -> bool:
    return any(q == w or q.startswith((f"{w} ", f"{w}.")) for w in wanted for q in quantities)


def drawn(random: Random, folder: Path, name: str) -> tuple[Path, Mutation]:
    """A mutation of the program or its cell, of an operator that finds something to change."""
    while True:
        if random.random() < 0.6:
            path, change, operators = folder / f"{name}.nc", mutate, list(PROGRAM_OPERATORS)
        else:
            path, change, operators = folder / f"{name}.yaml", mutate_cell, list(CELL_OPERATORS)
        mutation = change(random, path.read_text(), random.choice(operators))
        if mutation is not None:
            return path, mutation


def test_mutations_are_caught_and_named(suite: Path) -> None:
    random = Random(SEED)
    before = {name: results_of(suite, name) for name in PROGRAMS}
    effective = 0
    for number in range(DRAWN):
        name = random.choice(PROGRAMS)
        path, mutation = drawn(random, suite, name)
        told = f"seed {SEED}, mutation {number} ({mutation.operator}) of {path.name}: {mutation.what}"
        original = path.read_text()
        path.write_text(mutation.text)
        differing = beyond(before[name], results_of(suite, name))
        verdict = verdict_on(suite, name)
        path.write_text(original)
        if differing:
            effective += 1
            assert verdict.status == "failed", told
            assert set(differing) <= set(verdict.quantities), f"{told}: {differing} not in {verdict.quantities}"
            assert is_named(mutation.quantities, verdict.quantities), f"{told}: {verdict.quantities}"
    assert effective >= DRAWN // 4, f"seed {SEED}: only {effective} of {DRAWN} mutations changed a result"


def test_neutral_edits_are_none(suite: Path) -> None:
    random = Random(SEED)
    for number in range(DRAWN):
        name = random.choice(PROGRAMS)
        path = suite / f"{name}.nc"
        original = path.read_text()
        edit = edit_neutrally(random, original)
        path.write_text(edit.text)
        verdict = verdict_on(suite, name)
        path.write_text(original)
        said = [(one.finding.code, one.finding.span.line, one.finding.message) for one in verdict.found]
        assert verdict.status == "passed", f"seed {SEED}, edit {number} ({edit.operator}): {said}\n{edit.text}"


def test_clean_programs_give_no_finding(suite: Path) -> None:
    verdict = run_suite(collect([suite], suite), Judging(root=suite))
    assert [case.status for case in verdict.cases] == ["passed", "passed"]
    assert [one for case in verdict.cases for one in case.found] == []


@pytest.mark.parametrize("operator", [*PROGRAM_OPERATORS, *CELL_OPERATORS])
def test_every_operator_finds_something_to_change(suite: Path, operator: str) -> None:
    change, suffix = (mutate, "nc") if operator in PROGRAM_OPERATORS else (mutate_cell, "yaml")
    texts = [(suite / f"{name}.{suffix}").read_text() for name in PROGRAMS]
    mutations = [change(Random(SEED), text, operator) for text in texts]
    assert any(m is not None and m.text != text for m, text in zip(mutations, texts, strict=True)), f"seed {SEED}"
