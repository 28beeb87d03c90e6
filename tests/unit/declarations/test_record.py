"""Mappings that become dataclasses, by name, by family."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import pytest

from gcodesim.declarations.keys import inline, key
from gcodesim.declarations.map_of import MapOf, NameRule
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.declarations.variant import Variant
from tests.unit.declarations.text import codes, read


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    at: float = key("length", "where", default=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Spring:
    """A spring."""

    kind: ClassVar[str] = "spring"

    load: float = key("force", "its load", example="5 N")
    way: float = key("length", "its way", default=0.01)
    rate: float = key("stiffness", "its rate", derive=lambda spring: spring.load / spring.way, rule="load by way")
    place: Place = inline(Place)
    doubled: bool = False

    def checked(self, to: Reading, path: Path) -> Spring | Unread:
        if self.load == 13.0:
            return to.fault("GS710", to.span((*path, "load")), "13 is no number for a spring")
        return replace(self, doubled=True)


SPRING = Record(Spring, "the spring", "load")
LETTER = NameRule(what="letter", pattern="[a-z]", canonical=lambda t: t if len(t) == 1 else None)
SPRINGS = MapOf(LETTER, SPRING, "springs")
ONE = Variant(family={"spring": Spring}, what="part", example="{type: spring}")


def test_defaults_and_what_follows_are_filled_in_and_noted() -> None:
    spring, to = read(SPRING, "{load: 5 N, at: 3}")

    assert spring == Spring(load=5.0, way=0.01, rate=500.0, place=Place(at=0.003), doubled=True)
    assert [(d.path, d.value, d.why) for d in to.defaults] == [
        (("x", "way"), 0.01, ""),
        (("x", "rate"), 500.0, "load by way"),
    ]


def test_a_lone_value_is_the_short_form() -> None:
    assert read(SPRING, "5 N")[0].load == 5.0
    assert SPRING.expected == "a force such as `5 N` or a mapping with `load`, `way`, `rate` …"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("{way: 3}", ["GS705"]),
        ("{load: 5 N, weigh: 3}", ["GS704"]),
        ("{lod: 5 W}", ["GS704", "GS709"]),
        ("{load: 13 N}", ["GS710"]),
        ("{load: 5 N, x-mine: 1}", []),
        ("[5 N]", ["GS706"]),
    ],
)
def test_faults(text: str, found: list[str]) -> None:
    value, to = read(SPRING, text)

    assert codes(to) == found and (value is UNREAD) is bool([c for c in found if c != "GS704"])


def test_shown_is_what_was_declared() -> None:
    spring, _ = read(SPRING, "{load: 5 N}")

    assert SPRING.show(spring) == {"load": "5 N", "way": "10 mm", "rate": "0.5 N/mm", "at": "0 mm"}
    assert SPRING.plain(spring) == ("", {"load_N": 5.0, "way_mm": 10.0, "rate_N_mm": 0.5, "at_mm": 0.0})


def test_names_have_one_spelling_each() -> None:
    assert list(read(SPRINGS, "{a: 1 N, b: 2 N}")[0]) == ["a", "b"]
    assert codes(read(SPRINGS, "{a: 1 N, bb: 2 N}")[1]) == ["GS711"]


def test_a_word_names_the_class_of_a_family() -> None:
    spring, _ = read(ONE, "{type: spring, load: 5 N}")

    assert spring.load == 5.0 and ONE.show(spring)["type"] == "spring"
    assert codes(read(ONE, "{load: 5 N}")[1]) == ["GS705"]
    assert codes(read(ONE, "{type: sprig}")[1]) == ["GS711"]


def test_the_schema_has_a_definition_a_class_and_a_member() -> None:
    definitions: dict[str, Any] = {}

    assert ONE.schema(definitions) == {"oneOf": [{"$ref": "#/$defs/spring"}]}
    assert definitions["spring"]["required"] == ["type", "load"]
    assert list(definitions["spring"]["properties"]) == ["type", "load", "way", "rate", "at"]
    assert SPRING.schema(definitions)["anyOf"][1] == {"$ref": "#/$defs/tests.Spring"}
    assert definitions["tests.Spring"]["description"] == "A spring."
