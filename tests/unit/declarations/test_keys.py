"""What a field that is declared as a key tells the reader."""

from __future__ import annotations

import math
from dataclasses import dataclass, make_dataclass

import pytest

from gcodesim.declarations.keys import Key, all_keys, fill_derived, inline, key, keys, written
from gcodesim.declarations.plain_kinds import Choice, Switch, Text, Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.record import Record
from gcodesim.declarations.units import DIMENSIONS
from gcodesim.tools import TOOLS
from gcodesim.tools.sections import Holder
from gcodesim.units import DEG, MM


@dataclass(frozen=True, slots=True, kw_only=True)
class Nozzle:
    bore: float = key("length", "its bore")
    angle: float = key("angle", "its angle", default=0.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Base:
    name: str = key("text", "name", default="", quiet=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Jet(Base):
    nozzle: Nozzle = inline(Nozzle)
    pressure: float = key("pressure", "pressure in the hose")
    flow: float | None = key(
        "volume flow", "what comes out", derive=lambda jet: jet.pressure * 1e-12, rule="by the pressure"
    )


def of_tool(kind: str) -> dict[str, Key]:
    return keys(TOOLS[kind])


@pytest.mark.parametrize("name", DIMENSIONS)
def test_every_dimension_is_a_word_for_a_kind(name: str) -> None:
    kind = keys(make_dataclass("Any", [("x", object, key(name, "something"))]))["x"].kind

    assert isinstance(kind, Quantity) and kind.dimension == name


@pytest.mark.parametrize(("word", "kind"), [("count", Whole), ("text", Text), ("switch", Switch)])
def test_words_for_values_without_unit(word: str, kind: type) -> None:
    cls = make_dataclass("Any", [("x", object, key(word, "something"))])

    assert isinstance(keys(cls)["x"].kind, kind)


def test_a_word_that_names_no_kind_is_a_fault_where_it_is_declared() -> None:
    with pytest.raises(ValueError, match="`forse` is no kind of value; did you mean `force`"):
        key("forse", "how hard it presses")


def test_kinds_are_taken_as_they_are() -> None:
    kind = Choice(("a", "b"))
    cls = make_dataclass("Any", [("x", object, key(kind, "something"))])

    assert keys(cls)["x"].kind is kind


def test_required_keys_come_first_where_keys_are_inherited() -> None:
    found = list(of_tool("bull_nose_end_mill").values())

    assert [k.name for k in found if k.required] == ["diameter", "corner_radius"]
    assert [k.required for k in found] == sorted((k.required for k in found), reverse=True)


def test_a_class_is_a_group_with_keys_of_its_own() -> None:
    holder = of_tool("flat_end_mill")["holder"].kind

    assert isinstance(holder, Record) and holder.cls is Holder
    assert list(keys(holder.cls)) == ["diameter", "length", "upper_diameter", "above"]


def test_keys_of_an_inlined_class_stand_among_ours() -> None:
    assert list(keys(Jet)) == ["pressure", "name", "flow"]
    assert list(all_keys(Jet)) == ["pressure", "name", "flow", "bore", "angle"]


def test_defaults_are_constants_or_rules_in_words() -> None:
    drill = of_tool("drill")

    assert drill["point_angle"].default == pytest.approx(math.radians(118.0))
    assert drill["length"].default is None and drill["length"].derived and not drill["length"].required
    assert "4 times the diameter" in drill["length"].rule and drill["length"].rule in drill["length"].doc


def test_what_follows_from_others_is_filled_in() -> None:
    jet = Jet(pressure=2e8, nozzle=Nozzle(bore=1e-4))
    fill_derived(jet)

    assert jet.flow == pytest.approx(2e-4)
    assert [name for name, _, _ in written(jet)] == ["pressure", "bore", "angle", "flow"]


@pytest.mark.parametrize(("diameter_mm", "length_mm"), [(6.0, 40.0), (10.0, 40.0), (20.0, 80.0)])
def test_length_follows_the_diameter(diameter_mm: float, length_mm: float) -> None:
    tool = TOOLS["flat_end_mill"](diameter=diameter_mm * MM)

    assert tool.length == pytest.approx(length_mm * MM)
    assert tool.flute_length == tool.length


def test_given_values_stay() -> None:
    tool = TOOLS["drill"](number=7, name="pilot", diameter=5.0 * MM, point_angle=140.0 * DEG, length=90.0 * MM)

    assert (tool.name, tool.length, tool.flute_length) == ("pilot", 90.0 * MM, 90.0 * MM)
    assert tool.point_angle == 140.0 * DEG
