"""A test run sees what changes a result, names the quantity, and sees nothing in edits that mean the same.

The seed stands in every message; `GCODESIM_MUTATION_SEED=… pytest` takes another one. Each slow run draws one anew.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random, SystemRandom
from typing import Any

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.material.stock import Stock
from gcodesim.regress import CaseVerdict
from gcodesim.regress.case import collect
from gcodesim.regress.mutation import CELL_OPERATORS, PROGRAM_OPERATORS, Mutation, mutate_cell
from gcodesim.regress.mutation import mutate_program as mutate
from gcodesim.regress.outcome import Judging
from gcodesim.regress.suite import run_suite
from gcodesim.simulation import prepare, run
from tests.unit.regress.neutral_edits import edit_neutrally

DRAWN = 20
SWEEP = 300
GIVEN = os.environ.get("GCODESIM_MUTATION_SEED")
SEED = int(GIVEN or 20261128)
PROGRAMS = ("holes", "pocket", "slot_arm")

# ---- the oracle: every number of the results and every column of the stock; nothing of it comes from the package

ALLOWED = {  # by the end of a path: absolute, relative
    **{f"path_accuracy.{name}_mm": (0.005, 0.02) for name in ("AT", "AT_engaged", "rms")},
    "_mm3": (0.5, 1e-3),
    "_mm": (0.01, 1e-4),
    "engaged_s": (0.05, 5e-3),
    "_s": (0.01, 1e-3),
    "_N": (0.5, 0.01),
    "_Nm": (0.01, 0.01),
    "_W": (1.0, 0.01),
    ".least": (0.01, 1e-3),
    ".most": (0.01, 1e-3),
    ".margin": (0.01, 1e-3),
    ".max_speed": (0.01, 0.02),
    ".max_acceleration": (1.0, 0.1),
    ".max_effort": (0.5, 0.02),
    ".count": (0.0, 0.0),
}
NO_RESULT = ("inputs", "findings", "schema", "stopped_at", "status", "operations")
NO_QUANTITY = (
    *("body", "air_share"),  # they follow from what is compared
    *("error_bound_mm3", "line_of_max_force", "line_of_margin", "first_line", "number", "word"),
)
NO_PLACE = ("line_of_AT", "time_of_AT_s")
NO_PACE = ("mean_feed_mm_min", "least_feed_mm_min", "share_at_feed")  # they follow from times that are compared
COLUMNS = 5e-9  # m³ by which columns have to differ, besides that walls may stand in the next column


@dataclass(frozen=True)
class Truth:
    """A run: its numbers by path, the material of each column [m³], the findings above notes."""

    numbers: dict[str, Any]
    columns: dict[str, np.ndarray]
    findings: list[tuple[str, str, int]]


def numbers_of(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in (*NO_QUANTITY, *NO_PLACE, *NO_PACE) and (path or key not in NO_RESULT):
                yield from numbers_of(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for inner in value:
            yield from numbers_of(inner, f"{path}.{inner.get('number', inner.get('name', inner.get('word')))}")
    else:
        yield path, value


def columns_of(stock: Stock) -> np.ndarray:
    material: np.ndarray = stock.relief().lengths * stock.spacing.prod()
    return material


def moved(old: np.ndarray, new: np.ndarray) -> float:
    """Material [m³] by which columns have more or less than all columns beside them in the other stock.

    A wall between two columns shows at one or the other of them: a millionth of a millimetre decides which.
    """
    differing = np.argwhere(old != new)

    def beyond_neighbours(one: np.ndarray, other: np.ndarray) -> float:
        near = [other[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2] for i, j in differing]
        return sum(
            max(n.min() - one[i, j], one[i, j] - n.max(), 0.0) for n, (i, j) in zip(near, differing, strict=True)
        )

    return max(beyond_neighbours(old, new), beyond_neighbours(new, old))


def truth_of(folder: Path, name: str) -> Truth:
    job = prepare(SourceText.read(folder / f"{name}.nc"), load_cell(folder / f"{name}.yaml"), Options())
    results = run(job)[0].as_json()
    stocks = {} if job.shop is None else job.shop.stocks
    return Truth(
        numbers=dict(numbers_of(results)),
        columns={stock: columns_of(placed.stock) for stock, placed in stocks.items()},
        findings=sorted((f["code"], f["severity"], f["count"]) for f in results["findings"] if f["severity"] != "note"),
    )


def beyond(old: Truth, new: Truth) -> list[str]:
    """Paths of the numbers that differ by more than is allowed, and what else does."""
    found = [path for path in new.numbers if path not in old.numbers]
    for path, value in old.numbers.items():
        now = new.numbers.get(path)
        if isinstance(value, (int, float)) and isinstance(now, (int, float)):
            absolute, relative = next(a for end, a in ALLOWED.items() if path.endswith(end))
            if abs(now - value) > 1.0001 * max(absolute, relative * abs(value)) + 1e-9:
                found.append(path)
        elif now != value:
            found.append(path)
    if any(
        columns.shape == new.columns[stock].shape and moved(columns, new.columns[stock]) > COLUMNS
        for stock, columns in old.columns.items()
        if stock in new.columns
    ):
        found.append("columns")
    return [*found, *["findings"] * (old.findings != new.findings)]


def verdict_on(folder: Path, name: str) -> CaseVerdict:
    (case,) = run_suite(collect([folder / f"{name}.test.yaml"], folder), Judging(root=folder)).cases
    return case


def is_named(path: str, quantities: tuple[str, ...]) -> bool:
    """Whether a difference is named: by its path, or that of the tool or joint that came or went with it."""
    if path == "columns":
        return any(name.startswith(("surface.", "stocks.")) for name in quantities)
    return any(path == name or path.startswith(f"{name}.") for name in quantities)


def shows(mutation: Mutation, quantities: tuple[str, ...]) -> bool:
    """Whether one of the quantities is what the operator changes."""
    return any(q == w or q.startswith((f"{w} ", f"{w}.")) for w in mutation.quantities for q in quantities)


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


def mutations_are_caught(folder: Path, count: int, seed: int = SEED) -> None:
    before = {name: truth_of(folder, name) for name in PROGRAMS}
    effective = 0
    for number in range(count):
        random = Random(seed + number)
        name = random.choice(PROGRAMS)
        path, mutation = drawn(random, folder, name)
        told = f"seed {seed}, mutation {number} ({mutation.operator}) of {path.name}: {mutation.what}"
        original = path.read_text()
        path.write_text(mutation.text)
        differing = beyond(before[name], truth_of(folder, name))
        verdict = verdict_on(folder, name)
        path.write_text(original)
        if differing:
            effective += 1
            unnamed = [one for one in differing if not is_named(one, verdict.quantities)]
            assert verdict.status == "failed", f"{told}: {differing}"
            assert not unnamed, f"{told}: {unnamed} not in {verdict.quantities}"
            assert shows(mutation, verdict.quantities), f"{told}: {verdict.quantities}"
    assert effective >= count // 2, f"seed {seed}: only {effective} of {count} mutations changed a result"


def neutral_edits_are_none(folder: Path, count: int, seed: int = SEED) -> None:
    for number in range(count):
        random = Random(seed + number)
        name = random.choice(PROGRAMS)
        path = folder / f"{name}.nc"
        original = path.read_text()
        edit = edit_neutrally(random, original)
        path.write_text(edit.text)
        verdict = verdict_on(folder, name)
        path.write_text(original)
        said = [(one.finding.code, one.finding.span.line, one.finding.message) for one in verdict.found]
        assert verdict.status == "passed", f"seed {seed}, edit {number} ({edit.operator}): {said}\n{edit.text}"


def test_clean_programs_give_no_finding(larger_suite: Path) -> None:
    verdict = run_suite(collect([larger_suite], larger_suite), Judging(root=larger_suite))
    assert [case.status for case in verdict.cases] == ["passed"] * 3
    assert [one for case in verdict.cases for one in case.found] == []


def test_mutations_are_caught_and_named(larger_suite: Path) -> None:
    mutations_are_caught(larger_suite, DRAWN)


def test_neutral_edits_are_none(larger_suite: Path) -> None:
    neutral_edits_are_none(larger_suite, DRAWN)


@pytest.mark.slow
def test_many_mutations_and_neutral_edits(larger_suite: Path) -> None:
    seed = int(GIVEN or SystemRandom().randrange(2**32))
    mutations_are_caught(larger_suite, SWEEP, seed)
    neutral_edits_are_none(larger_suite, SWEEP, seed)


def test_the_oracle_sees_what_it_should(suite: Path) -> None:
    """Half a millimetre deeper; without a difference, nothing."""
    before = truth_of(suite, "pocket")
    assert beyond(before, truth_of(suite, "pocket")) == []
    program = suite / "pocket.nc"
    program.write_text(program.read_text().replace("G1 Z-1 F300", "G1 Z-1.5 F300"))
    found = beyond(before, truth_of(suite, "pocket"))
    assert {"time.feed_s", "stocks.stock.removed_mm3", "tools.1.max_power_W", "columns"} <= set(found)


@pytest.mark.parametrize("operator", [*PROGRAM_OPERATORS, *CELL_OPERATORS])
def test_every_operator_finds_something_to_change(larger_suite: Path, operator: str) -> None:
    change, suffix = (mutate, "nc") if operator in PROGRAM_OPERATORS else (mutate_cell, "yaml")
    texts = [(larger_suite / f"{name}.{suffix}").read_text() for name in PROGRAMS]
    mutations = [change(Random(SEED), text, operator) for text in texts]
    assert any(m is not None and m.text != text for m, text in zip(mutations, texts, strict=True)), f"seed {SEED}"
