"""The points of a study: which values of its factors go together, in an order that never changes."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

from gcodesim.declarations.nodes import Node, Scalar
from gcodesim.frozen import frozen
from gcodesim.sweep.factor import Factor, text_of
from gcodesim.sweep.study_file import LATIN, ROWS, SOBOL, Study, spans_of_values


@frozen(kw_only=False)
class Level:
    """One value of a factor: as a node of the cell, and as tables show it, a number where all are numbers."""

    node: Node
    shown: float | str

    @property
    def node_text(self) -> str:
        """As the cell has it, with its unit."""
        return text_of(self.node)


Point = Mapping[str, Level]
"""The value of each factor, by its name."""


def points(study: Study) -> Iterator[Point]:
    """All points of the study, one after the other."""
    names = list(study.vary)
    if study.design.type in (SOBOL, LATIN):
        yield from _spread(study)
        return
    tabled = [name for name in names if study.vary[name].column is not None]
    levels = {name: all_levels(study.vary[name]) for name in names}
    if study.design.type == ROWS:
        for row in zip(*levels.values(), strict=True):
            yield dict(zip(names, row, strict=True))
        return
    free = [name for name in names if name not in tabled]
    lines = list(zip(*(levels[name] for name in tabled), strict=True)) if tabled else [()]
    for line in lines:
        for row in product(*(levels[name] for name in free)):
            taken = {**dict(zip(tabled, line, strict=True)), **dict(zip(free, row, strict=True))}
            yield {name: taken[name] for name in names}


def count(study: Study) -> int:
    """How many points there are."""
    if study.design.type in (SOBOL, LATIN):
        return (study.design.runs or 0) * _lines(study)
    counts = {name: len(factor.levels) if factor.levels else factor.steps or 1 for name, factor in study.vary.items()}
    if study.design.type == ROWS:
        return min(counts.values(), default=0)
    free = (number for name, number in counts.items() if study.vary[name].column is None)
    return _lines(study) * math.prod(free)


def _lines(study: Study) -> int:
    """Lines of the table that factors take their values from; 1 without one."""
    return next((len(f.levels or ()) for f in study.vary.values() if f.column is not None), 1)


def all_levels(factor: Factor) -> list[Level]:
    """The values of a factor in a grid."""
    if factor.levels is not None:
        return [_level(factor, node) for node in factor.levels]
    steps = factor.steps or 2
    numbers = dict.fromkeys(_of_range(factor, index / (steps - 1)) for index in range(steps))
    return [number_level(factor, number) for number in numbers]


def _of_range(factor: Factor, share: float) -> float:
    if factor.whole:
        return float(round(factor.low + share * (factor.high - factor.low)))
    return factor.between(share)


def level_at(factor: Factor, share: float) -> Level:
    """The value at a share 0 to 1 of a factor: of its range, or of its list, in equal parts."""
    if factor.levels is not None:
        return _level(factor, factor.levels[min(int(share * len(factor.levels)), len(factor.levels) - 1)])
    return number_level(factor, factor.between(share))


def number_level(factor: Factor, number: float) -> Level:
    return Level(Scalar(span=spans_of_values(factor.name), text=factor.text(number)), number)


def _level(factor: Factor, node: Node) -> Level:
    text = text_of(node)
    return Level(node, float(text.partition(" ")[0]) if factor.numeric else text)


def _spread(study: Study) -> Iterator[Point]:
    """Sobol points or a Latin hypercube over all factors that no table gives, for each line of the table."""
    free = [name for name, factor in study.vary.items() if factor.column is None]
    tabled = [name for name in study.vary if name not in free]
    shares = _shares(study.design.type, len(free), study.design.runs or 1, study.design.seed)
    levels = {name: all_levels(study.vary[name]) for name in tabled}
    for line in zip(*levels.values(), strict=True) if tabled else [()]:
        for row in shares:
            taken: dict[str, Level] = dict(zip(tabled, line, strict=True))
            taken |= {name: level_at(study.vary[name], share) for name, share in zip(free, row, strict=True)}
            yield {name: taken[name] for name in study.vary}


def _shares(design: str, factors: int, runs: int, seed: int) -> Sequence[Sequence[float]]:
    """Points of the unit cube (runs, factors)."""
    if not factors:
        return [()] * runs
    from scipy.stats import qmc

    engine: Any = qmc.Sobol(factors, rng=seed) if design == SOBOL else qmc.LatinHypercube(factors, rng=seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # numbers of points that are no power of 2 are balanced less well
        rows: list[list[float]] = engine.random(runs).tolist()
    return rows
