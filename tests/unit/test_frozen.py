"""Frozen classes behave as the standard library's frozen dataclasses do."""

from __future__ import annotations

import copy
import pickle
from dataclasses import FrozenInstanceError, asdict, dataclass, field, fields, is_dataclass, replace
from functools import cached_property
from inspect import signature
from typing import Any, ClassVar

import pytest

from gcodesim.frozen import frozen


@frozen
class Ours:
    """A value."""

    kind: ClassVar[str] = "value"
    name: str
    size: float = 2.0
    parts: list[int] = field(default_factory=list, compare=False)
    hidden: int = field(default=5, init=False, repr=False)

    @property
    def double(self) -> float:
        return 2 * self.size


@dataclass(frozen=True, slots=True, kw_only=True)
class Theirs:
    """A value."""

    kind: ClassVar[str] = "value"
    name: str
    size: float = 2.0
    parts: list[int] = field(default_factory=list, compare=False)
    hidden: int = field(default=5, init=False, repr=False)

    @property
    def double(self) -> float:
        return 2 * self.size


@frozen(kw_only=False, eq=False)
class Pair:
    first: int
    second: int = 7


@frozen(slots=False)
class Roomy:
    side: float

    @cached_property
    def area(self) -> float:
        return self.side**2


@frozen
class Derived(Ours):
    """Has a further field, and a base's with another default."""

    size: float = 3.0
    more: str

    def __post_init__(self) -> None:
        if not self.more:
            raise ValueError("more is wanted")


@frozen
class Named:
    """Has methods of its own."""

    name: str

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Named) and self.name.casefold() == other.name.casefold()

    def __repr__(self) -> str:
        return f"<{self.name}>"


BOTH = pytest.mark.parametrize("kind", [Ours, Theirs])


@BOTH
def test_behaves_as_a_dataclass(kind: Any) -> None:
    one = kind(name="a")
    assert repr(one) == f"{kind.__name__}(name='a', size=2.0, parts=[])"
    assert one == kind(name="a", parts=[1])
    assert one != kind(name="a", size=3.0)
    assert one != Pair(1)
    assert hash(one) == hash(kind(name="a")) == hash(("a", 2.0, 5))
    assert [one.name for one in fields(kind)] == ["name", "size", "parts", "hidden"]
    assert replace(one, size=4.0) == kind(name="a", size=4.0)
    assert asdict(one) == {"name": "a", "size": 2.0, "parts": [], "hidden": 5}
    assert is_dataclass(kind)
    assert kind.kind == "value"
    assert one.double == 4.0
    assert one.parts is not kind(name="b").parts
    assert kind.__match_args__ == ()
    assert not hasattr(one, "__dict__")
    assert list(signature(kind).parameters) == ["name", "size", "parts"]


@BOTH
def test_nothing_changes(kind: Any) -> None:
    one = kind(name="a")
    for name in ("name", "hidden"):
        with pytest.raises(FrozenInstanceError):
            setattr(one, name, "b")
        with pytest.raises(FrozenInstanceError):
            delattr(one, name)
    with pytest.raises((FrozenInstanceError, AttributeError, TypeError)):  # the standard library's ends in super()
        one.other = 1


@BOTH
@pytest.mark.parametrize("given", [{}, {"name": "a", "none": 1}, {"name": "a", "hidden": 1}])
def test_wrong_arguments(kind: Any, given: dict[str, Any]) -> None:
    with pytest.raises(TypeError, match=rf"{kind.__name__}\.__init__\(\)"):
        kind(**given)
    with pytest.raises(TypeError):
        kind("a")


@BOTH
def test_copies(kind: Any) -> None:
    one = kind(name="a", parts=[1])
    for made in (copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
        assert made == one
        assert made.parts == [1]
    assert copy.deepcopy(one).parts is not one.parts


def test_by_position_and_identity() -> None:
    assert Pair(1).second == 7
    assert Pair.__match_args__ == ("first", "second")
    one = Pair(1, 2)
    assert one != Pair(1, 2)
    assert len({one, Pair(1, 2), one}) == 2


def test_cached_properties() -> None:
    one = Roomy(side=3.0)
    assert one.area == 9.0
    assert vars(one) == {"side": 3.0, "area": 9.0}
    assert pickle.loads(pickle.dumps(one)) == one


def test_inheritance() -> None:
    one = Derived(name="a", more="b")
    assert (one.size, one.more, one.double) == (3.0, "b", 6.0)
    assert [one.name for one in fields(Derived)] == ["name", "size", "parts", "hidden", "more"]
    assert one != Ours(name="a", size=3.0)
    assert repr(one).startswith("Derived(name='a', size=3.0")
    with pytest.raises(ValueError, match="more is wanted"):
        Derived(name="a", more="")


def test_the_standard_library_inherits() -> None:
    @dataclass(frozen=True, slots=True, kw_only=True)
    class Third(Derived):
        last: int = 1

    one = Third(name="a", more="b")
    assert one == Third(name="a", more="b", last=1)
    assert replace(one, last=2).last == 2
    with pytest.raises(FrozenInstanceError):
        one.name = "c"  # type: ignore[misc]


def test_own_methods_stay() -> None:
    assert Named(name="A") == Named(name="a")
    assert repr(Named(name="A")) == "<A>"
    assert hash(Named(name="A")) == hash(("A",))


def test_methods_are_written_on_first_use() -> None:
    @frozen
    class Late:
        x: int

    late = type(Late.__dict__["__init__"])
    assert isinstance(Late.__dict__["__eq__"], late)
    assert Late(x=1) == Late(x=1)
    assert not any(isinstance(Late.__dict__[name], late) for name in ("__init__", "__eq__"))
    assert isinstance(Late.__dict__["__hash__"], late)


def test_what_cannot_be_a_field() -> None:
    with pytest.raises(TypeError, match="default_factory"):

        @frozen
        class Changing:
            x: list[int] = []  # noqa: RUF012

    with pytest.raises(TypeError, match="second needs a default, since first has one"):

        @frozen(kw_only=False)
        class Disordered:
            first: int = 1
            second: int  # type: ignore[misc]

    @dataclass
    class Changeable:
        x: int

    with pytest.raises(TypeError, match="Changeable is not"):

        @frozen
        class Fixed(Changeable):  # type: ignore[misc]
            y: int
