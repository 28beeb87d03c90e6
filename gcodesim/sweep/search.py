"""A search among the values of a study: for the best point within its limits, or for one that keeps them.

Storn and Price 1997, differential evolution, as scipy has it, with whole generations at once: so a search depends on
its seed and on nothing else, whoever does the runs. A run that stopped is worse than one beyond a limit, and that is
worse than any other (Deb 2000, feasibility before aim).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final

from gcodesim.frozen import frozen
from gcodesim.sweep.design import Level, Point, level_at, number_level
from gcodesim.sweep.factor import Factor
from gcodesim.sweep.measure import figure
from gcodesim.sweep.row import Row
from gcodesim.sweep.study_file import Search, Study

_BEYOND: Final = 1e12
_STOPPED: Final = 1e15
_GENERATIONS: Final = 4  # at least, before the number of runs is used up
_A_FACTOR: Final = 15  # points of a generation, as Storn and Price advise about ten

Runs = Callable[[Sequence[Point]], Sequence[Row | None]]
"""Does runs; None for one that could not be done."""


@frozen(eq=False)
class SearchOutcome:
    """All points that were tried, each once, in their order; `best` is one of them, None if none is within limits."""

    points: Sequence[Point]
    best: int | None


def search(study: Study, runs: Runs) -> SearchOutcome:
    """Search as `find` of the study says."""
    from scipy.optimize import Bounds, differential_evolution

    aim = study.find
    assert aim is not None
    factors = list(study.vary.values())
    tried: dict[tuple[str, ...], int] = {}
    points: list[Point] = []
    costs: list[float] = []

    def evaluate(_: Any, vectors: Iterable[Sequence[float]]) -> list[float]:
        wanted = [_point(factors, vector) for vector in vectors]
        new: dict[tuple[str, ...], Point] = {}
        for point in wanted:
            if _name(point) not in tried:
                new.setdefault(_name(point), point)
        for (name, point), row in zip(new.items(), runs(list(new.values())), strict=True):
            tried[name] = len(points)
            points.append(point)
            costs.append(cost(study, aim, row))
        return [costs[tried[_name(point)]] for point in wanted]

    def enough(intermediate_result: Any) -> bool:
        return aim.least is aim.most is None and float(intermediate_result.fun) <= 0.0

    def alone(vector: Any) -> float:
        return evaluate(None, [vector])[0]

    size = _generation(len(factors), aim.runs)
    differential_evolution(
        alone,
        Bounds([_bounds(factor)[0] for factor in factors], [_bounds(factor)[1] for factor in factors]),
        integrality=[factor.levels is not None for factor in factors],
        popsize=math.ceil(size / len(factors)),
        maxiter=max(aim.runs // size - 1, 1),
        rng=aim.seed,
        polish=False,
        updating="deferred",
        workers=evaluate,
        callback=enough,  # type: ignore[arg-type]
    )
    best = min(range(len(costs)), key=lambda index: costs[index])
    return SearchOutcome(points=points, best=best if costs[best] < _BEYOND and _is_good(aim, costs[best]) else None)


def cost(study: Study, aim: Search, row: Row | None) -> float:
    """What the search makes small."""
    if row is None or row.status == "failed":
        return _STOPPED
    beyond = sum(max(limit.excess(row.figures) or 0.0, 0.0) for limit in row.broken)
    name = aim.least or aim.most
    if name is None:
        return beyond + float(len(row.broken))
    value = figure(name, row.figures)
    if value is None:
        return _STOPPED
    if row.broken:
        return _BEYOND * (1.0 + beyond)
    return value if aim.most is None else -value


def _is_good(aim: Search, value: float) -> bool:
    return aim.least is not None or aim.most is not None or value <= 0.0


def _generation(factors: int, runs: int) -> int:
    """Points of a generation: a whole number of times the factors, and never fewer than five."""
    size = max(min(_A_FACTOR * factors, runs // _GENERATIONS), 5)
    return factors * math.ceil(size / factors)


def _bounds(factor: Factor) -> tuple[float, float]:
    if factor.levels is not None:
        return 0.0, float(max(len(factor.levels) - 1, 0))
    return factor.low, factor.high


def _point(factors: Sequence[Factor], vector: Sequence[float]) -> Point:
    return {factor.name: _level(factor, float(number)) for factor, number in zip(factors, vector, strict=True)}


def _level(factor: Factor, number: float) -> Level:
    if factor.levels is not None:
        return level_at(factor, (round(number) + 0.5) / len(factor.levels))
    if factor.whole:
        return number_level(factor, float(round(number)))
    return number_level(factor, factor.between((number - factor.low) / (factor.high - factor.low)))


def _name(point: Point) -> tuple[str, ...]:
    return tuple(level.node_text for level in point.values())
