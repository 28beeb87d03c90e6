"""Answers: results of a model by name and unit, and those of a whole file of cases."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import Any

from gcodesim.calculator import CALCULATORS
from gcodesim.calculator.model import CannotComputeError, Model, Value
from gcodesim.calculator.reading import InputsRefusedError, model_of_case
from gcodesim.calculator.unit_names import named_unit, splits, suffix_unit
from gcodesim.declarations.units import DIMENSIONS, Unit, find, in_unit
from gcodesim.frozen import frozen


@frozen
class Answer:
    """A quantity that a model found: `value` in `unit`, `key` is its name with the unit as in JSON."""

    name: str
    key: str
    value: Any
    unit: str
    says: str


def model_named(name: str) -> type[Model] | None:
    """The class of a model, by its own name or another one, or by what follows the dot if that is clear."""
    if name in CALCULATORS:
        found: type[Model] = CALCULATORS[name]
        return found
    classes: list[type[Model]] = [CALCULATORS[own] for own in CALCULATORS]
    for cls in classes:
        if name in cls.also:
            return cls
    near = [cls for cls in classes if any(_alike(name, other) for other in (cls.kind, *cls.also))]
    return near[0] if len(near) == 1 else None


def _alike(name: str, other: str) -> bool:
    """Whether both names end alike, and do not begin differently: `spray.gaussian` is no `laser.gaussian`."""
    (before, _, last), (begin, _, end) = name.rpartition("."), other.rpartition(".")
    return last == end and (not before or not begin or before == begin)


def names_of_models() -> list[str]:
    """All models, in the order of their table."""
    return list(CALCULATORS.in_order(CALCULATORS))


def answers_of(model: Model) -> list[Answer]:
    """All results in the units in which they are shown; CannotComputeError."""
    found = []
    for name, value in model.compute().items():
        result = model.result_named(name)
        assert result is not None, f"{model.kind} does not declare {name}"
        dimension = DIMENSIONS[result.dimension] if result.dimension else None
        unit = find(dimension.shown, result.dimension) if dimension is not None and dimension.shown else None
        key = f"{name}_{dimension.suffix}" if dimension is not None and dimension.suffix else name
        found.append(
            Answer(name=name, key=key, value=_in(value, unit), unit="" if unit is None else unit.name, says=result.says)
        )
    return found


def _in(value: Value, unit: Unit | None) -> Any:
    if isinstance(value, (str, bool)):
        return value
    if isinstance(value, (int, float)):
        return float(value) if unit is None else in_unit(float(value), unit)
    return [_in(float(one), unit) for one in value]


def quantity(model: Model, values: Mapping[str, Value], asked: str) -> Any:
    """A quantity by its name with any unit of its dimension, `power_kW`; None where the model has none."""
    for stem, suffix in [(asked, ""), *splits(asked)]:
        result = model.result_named(stem)
        if result is None:
            continue
        unit = suffix_unit(suffix or named_unit(stem, result.dimension), result.dimension)
        if suffix and unit is None:
            continue
        own = next((name for name in values if name == stem), None)
        if own is None and stem in result.also and "{}" not in result.name:
            own = result.name if result.name in values else None
        if own is None:
            continue
        if not suffix and result.dimension and DIMENSIONS[result.dimension].shown:
            unit = find(DIMENSIONS[result.dimension].shown, result.dimension)
        return _in(values[own], unit)
    return None


@frozen
class CaseAnswers:
    """Case id → quantity → value for all that could be computed; `told` says what could not, and what was not used."""

    results: dict[str, dict[str, Any]]
    told: tuple[str, ...]
    complete: bool


def answer_cases(cases: Iterable[Mapping[str, Any]]) -> CaseAnswers:
    """Answer cases `{"id", "model", "inputs", "expected"}`; of `expected` only the names of quantities are read."""
    results: dict[str, dict[str, Any]] = {}
    told: list[str] = []
    complete = True
    for case in cases:
        name, kind = str(case.get("id", "?")), str(case.get("model", ""))
        cls = model_named(kind)
        if cls is None:
            near = get_close_matches(kind, names_of_models(), n=1)
            told.append(f"{name}: there is no model {kind}" + (f"; did you mean {near[0]}?" if near else ""))
            complete = False
            continue
        try:
            model, unused = model_of_case(cls, case.get("inputs", {}))
            values = model.compute()
        except (InputsRefusedError, CannotComputeError) as reason:
            told.append(f"{name}: {reason}")
            complete = False
            continue
        if unused:
            told.append(f"{name}: {cls.kind} does not use {', '.join(unused)}")
        found = {answer.key: answer.value for answer in answers_of(model)}
        for asked in case.get("expected", {}):
            value = quantity(model, values, asked)
            if value is None:
                known = ", ".join(result.name for result in cls.gives)
                told.append(f"{name}: {cls.kind} does not give {asked}, only {known}")
                complete = False
            else:
                found[asked] = value
        results[name] = found
    return CaseAnswers(results=results, told=tuple(told), complete=complete)
