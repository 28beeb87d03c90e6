"""What every model of the calculator promises, whoever adds it."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from gcodesim.calculator import CALCULATORS
from gcodesim.calculator.answers import answer_cases, answers_of, model_named
from gcodesim.calculator.model import Model, all_spellings
from gcodesim.calculator.reading import InputsRefusedError, model_of_case, model_of_words
from gcodesim.declarations.keys import all_keys
from gcodesim.declarations.units import DIMENSIONS

DATA = Path(__file__).parents[1] / "data" / "physics"
CASES = {
    case["id"]: case
    for name in ("milling", "process", "calculator")
    for case in json.loads((DATA / f"{name}.json").read_text())["cases"]
}
KNOWN = {name: case for name, case in CASES.items() if model_named(case["model"]) is not None}


@pytest.mark.parametrize("kind", CALCULATORS)
def test_declares_itself(kind: str) -> None:
    cls = CALCULATORS[kind]

    assert issubclass(cls, Model) and cls.kind == kind
    assert cls.says and cls.source and "\n" not in cls.says + cls.source
    assert cls.gives and all(result.dimension in ("", *DIMENSIONS) for result in cls.gives)
    assert set(all_spellings(cls).values()) <= set(all_keys(cls))
    assert all(key.doc for key in all_keys(cls).values())


def test_no_two_models_or_quantities_share_a_name() -> None:
    models = [name for kind in CALCULATORS for name in (kind, *CALCULATORS[kind].also)]
    assert len(models) == len(set(models))
    for kind in CALCULATORS:
        names = [name for result in CALCULATORS[kind].gives for name in (result.name, *result.also)]
        assert len(names) == len(set(names)), kind


@pytest.mark.parametrize("kind", CALCULATORS.own())
def test_every_model_that_ships_has_a_case(kind: str) -> None:
    assert any(model_named(case["model"]) is CALCULATORS[kind] for case in KNOWN.values())


@pytest.mark.parametrize("name", KNOWN)
def test_case(name: str) -> None:
    case = KNOWN[name]
    found = answer_cases([case])

    assert found.complete and not found.told
    for quantity, wanted in case["expected"].items():
        near = {"rel": wanted["rel"], "abs": wanted.get("abs", 0.0)}
        assert found.results[name][quantity] == pytest.approx(wanted["value"], **near), quantity


@pytest.mark.parametrize("name", KNOWN)
def test_all_results_are_declared_and_finite(name: str) -> None:
    model, _ = model_of_case(model_named(KNOWN[name]["model"]), KNOWN[name]["inputs"])  # type: ignore[arg-type]

    for answer in answers_of(model):
        values = answer.value if isinstance(answer.value, list) else [answer.value]
        assert all(isinstance(value, (str, bool)) or math.isfinite(value) for value in values), answer.name


def test_words_and_cases_are_the_same_model() -> None:
    words = ["diameter=10 mm", "flutes=4", "ap=0.5 cm", "feed_per_tooth=50 um", "kc=2500 N/mm^2", "mc=0.26"]
    inputs = {"tool": {"diameter_mm": 10, "teeth": 4.0}, "ap_mm": 5, "fz_um": 50, "kc": 2500, "mc": 0.26}
    cls = CALCULATORS["endmill"]
    a, (b, unused) = model_of_words(cls, words), model_of_case(cls, inputs | {"title": "x"})

    assert a == b and unused == ["title"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["diameter=10 N", "ap=1", "kc=1 MPa"], "a force; a length such as `10 mm` is expected"),
        (["diametr=10", "ap=1"], "did you mean `diameter`?"),
        (["diameter=10", "ap=-1"], "`ap` is -1; it must be at least 0"),
        (["diameter=10"], "endmill lacks `ap`"),
        (["diameter=10", "ap=1", "kc=1500"], "without a unit"),
        (["diameter=10", "D=11"], "given twice"),
        (["diameter"], "NAME=VALUE"),
        (["diameter=[1"], "comma or `]`"),
    ],
)
def test_misuse_is_told(words: list[str], told: str) -> None:
    with pytest.raises(InputsRefusedError) as reason:
        model_of_words(CALCULATORS["endmill"], words)

    assert told in str(reason.value) and "\n" not in str(reason.value)


def test_what_cannot_be_answered_is_told() -> None:
    cases = [
        {"id": "a", "model": "nothing", "inputs": {}, "expected": {}},
        {"id": "b", "model": "kienzle", "inputs": {"kc": 1, "mc": 0, "b_mm": 1, "h_mm": 1}, "expected": {"Fq_N": {}}},
        {"id": "c", "model": "kienzle", "inputs": {"b_mm": 1, "h_mm": 1}, "expected": {}},
    ]
    found = answer_cases(cases)

    assert not found.complete and set(found.results) == {"b"}
    assert [line.partition(":")[0] for line in found.told] == ["a", "b", "c"]
