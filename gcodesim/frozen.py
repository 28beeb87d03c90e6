"""Classes whose objects never change: `dataclasses.dataclass(frozen=True)` whose methods are written on first use.

A run declares more than 300 such classes and makes objects of half of them. The dataclasses of the standard library
compile five or more methods for each while modules are imported, which was a third of the time of a short command.
Here declaring a class compiles nothing. `dataclasses.fields`, `replace`, `asdict` and `is_dataclass` know
these classes, and dataclasses of the standard library may inherit from them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from dataclasses import MISSING, Field, FrozenInstanceError, field, fields
from inspect import get_annotations
from itertools import pairwise
from types import MemberDescriptorType
from typing import Any, Final, NamedTuple, TypeVar, dataclass_transform, overload

C = TypeVar("C", bound=type)

_FIELDS: Final = "__dataclass_fields__"
_REAL: Final = dataclasses._FIELD  # type: ignore[attr-defined]  # the kind of field that `fields` tells


@overload
def frozen(cls: C) -> C: ...
@overload
def frozen(*, slots: bool = True, kw_only: bool = True, eq: bool = True) -> Callable[[C], C]: ...
@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(field,))
def frozen(cls: C | None = None, *, slots: bool = True, kw_only: bool = True, eq: bool = True) -> C | Callable[[C], C]:
    """Declare a class whose annotations are its fields, in the words of `dataclasses.dataclass`.

    Without `slots` there may be cached properties; without `kw_only` fields are also given by position; without `eq`
    an object equals only itself, which befits those that hold arrays. TypeError for what no field can be.
    """
    if cls is None:
        return lambda cls: _declared(cls, slots, kw_only, eq)
    return _declared(cls, slots, kw_only, eq)


class _Declaration(NamedTuple):
    """What the decorator was told, by the names in which the standard library keeps it."""

    init: bool
    repr: bool
    eq: bool
    order: bool
    unsafe_hash: bool
    frozen: bool


def _declared(cls: C, slots: bool, kw_only: bool, eq: bool) -> C:
    known = _inherited(cls)
    own = list(_own_fields(cls, kw_only))
    known |= {one.name: one for one in own}
    positional = [one for one in known.values() if one.init and not one.kw_only]
    for before, one in pairwise(positional):
        if _is_optional(before) and not _is_optional(one):
            raise TypeError(f"{cls.__qualname__}: {one.name} needs a default, since {before.name} has one")
    methods: dict[str, Any] = {
        _FIELDS: known,
        "__dataclass_params__": _Declaration(True, True, eq, False, False, True),
        "__match_args__": tuple(one.name for one in positional),
        "__init__": _Late("__init__", _init),
        "__repr__": _repr,
    }
    if eq:
        methods |= {"__eq__": _Late("__eq__", _eq), "__hash__": _Late("__hash__", _hash)}
    if slots:
        methods |= {"__getstate__": _state, "__setstate__": _set_state}
    given = set(cls.__dict__)
    if "__eq__" in given and cls.__dict__["__hash__"] is None:  # Python's own doing, not the class's
        given.discard("__hash__")
    methods = {name: value for name, value in methods.items() if name not in given}
    methods |= {"__setattr__": _refuse_to_set, "__delattr__": _refuse_to_delete}
    if slots:
        return _with_slots(cls, own, methods)
    for name, value in methods.items():
        setattr(cls, name, value)
    return cls


def _inherited(cls: type) -> dict[str, Field[Any]]:
    """The fields of the bases of `cls` by name."""
    known: dict[str, Field[Any]] = {}
    for base in cls.__mro__[-1:0:-1]:
        if _FIELDS in base.__dict__:
            if not base.__dataclass_params__.frozen:  # type: ignore[attr-defined]
                raise TypeError(f"{cls.__qualname__} cannot be frozen, since {base.__qualname__} is not")
            known |= base.__dict__[_FIELDS]
    return known


def _own_fields(cls: type, kw_only: bool) -> Iterator[Field[Any]]:
    """The fields that `cls` itself declares; their defaults become its attributes."""
    for name, kind in get_annotations(cls).items():
        if not isinstance(kind, str):
            raise TypeError(f"{cls.__qualname__}.{name}: `from __future__ import annotations` is missing")
        if kind.startswith(("ClassVar[", "ClassVar")):
            continue
        if kind.startswith(("InitVar", "KW_ONLY", "dataclasses.", "typing.")):
            raise TypeError(f"{cls.__qualname__}.{name} cannot be {kind}")
        default = getattr(cls, name, MISSING)
        if isinstance(default, MemberDescriptorType):  # the slot of a base
            default = MISSING
        made: Any = default if isinstance(default, Field) else field(default=default)
        if made.default.__class__.__hash__ is None:
            raise TypeError(f"{cls.__qualname__}.{name}: a default that can change needs `default_factory`")
        made.name, made.type, made._field_type = name, kind, _REAL
        if made.kw_only is MISSING:
            made.kw_only = kw_only
        if made.default is not MISSING:
            setattr(cls, name, made.default)
        elif made is default:
            delattr(cls, name)
        yield made


def _is_optional(one: Field[Any]) -> bool:
    return one.default is not MISSING or one.default_factory is not MISSING


def _with_slots(cls: C, own: Sequence[Field[Any]], methods: dict[str, Any]) -> C:
    """The class made anew, with room for its own fields only: slots cannot be added later."""
    taken = {name for base in cls.__mro__[1:-1] for name in base.__dict__.get("__slots__", ())}
    names = {one.name for one in own}
    content = {
        name: value
        for name, value in cls.__dict__.items()
        if name not in names and name not in ("__dict__", "__weakref__")
    }
    content |= methods
    content["__slots__"] = tuple(one.name for one in own if one.name not in taken)
    content["__qualname__"] = cls.__qualname__
    return type(cls)(cls.__name__, cls.__bases__, content)


class _Late:
    """A method of a class, written when it is asked for first, and from then on as if it had always been there."""

    def __init__(self, name: str, write: Callable[[type], Callable[..., Any]]) -> None:
        self._name = name
        self._write = write

    def __get__(self, instance: object, owner: type) -> Any:
        name = self._name
        cls = next((one for one in owner.__mro__ if one.__dict__.get(name) is self), None)
        if cls is None:  # another thread has just written it
            return getattr(owner if instance is None else instance, name)
        method: Any = self._write(cls)
        method.__qualname__ = f"{cls.__qualname__}.{name}"
        method.__module__ = cls.__module__
        setattr(cls, name, method)
        return method.__get__(instance, owner)


def _init(cls: type) -> Callable[..., None]:
    """What sets the fields in their order, then calls `__post_init__`."""
    known = {"SET": object.__setattr__, "MADE": object()}
    positional, by_name, lines = ["self"], ["*"], []
    for one in cls.__dict__[_FIELDS].values():
        name = one.name
        known |= {f"DEFAULT_{name}": one.default, f"MAKE_{name}": one.default_factory}
        value, default = name, ""
        if one.default_factory is not MISSING:
            value, default = f"MAKE_{name}() if {name} is MADE else {name}", "=MADE"
        elif one.default is not MISSING:
            default = f"=DEFAULT_{name}"
        if one.init:
            (by_name if one.kw_only else positional).append(name + default)
        elif one.default_factory is not MISSING:
            value = f"MAKE_{name}()"
        elif one.default is not MISSING:
            value = f"DEFAULT_{name}"
        else:
            continue
        lines.append(f"SET(self, {name!r}, {value})")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    init = _written("__init__", positional + (by_name if len(by_name) > 1 else []), lines, known)
    init.__annotations__ = {one.name: one.type for one in fields(cls) if one.init} | {"return": "None"}
    return init


def _eq(cls: type) -> Callable[..., Any]:
    same = f"{_tuple('self', cls)} == {_tuple('other', cls)}"
    text = f"return {same} if other.__class__ is self.__class__ else ELSE"
    return _written("__eq__", ["self", "other"], [text], {"ELSE": NotImplemented})


def _hash(cls: type) -> Callable[..., Any]:
    return _written("__hash__", ["self"], [f"return HASH({_tuple('self', cls)})"], {"HASH": hash})


def _tuple(of: str, cls: Any) -> str:
    return "(" + "".join(f"{of}.{one.name}," for one in fields(cls) if one.compare) + ")"


def _written(name: str, parameters: Sequence[str], lines: Sequence[str], known: dict[str, Any]) -> Callable[..., Any]:
    """A function made of its text; `known` are the names that it uses."""
    body = "".join(f"\n {line}" for line in lines or ["pass"])
    exec(f"def {name}({', '.join(parameters)}):{body}", known)
    return known[name]  # type: ignore[no-any-return]


def _repr(self: Any) -> str:
    told = ", ".join(f"{one.name}={getattr(self, one.name)!r}" for one in fields(self) if one.repr)
    return f"{type(self).__qualname__}({told})"


def _refuse_to_set(self: Any, name: str, value: object) -> None:
    if _is_fixed(self, name):
        raise FrozenInstanceError(f"cannot assign to field {name!r}")
    object.__setattr__(self, name, value)


def _refuse_to_delete(self: Any, name: str) -> None:
    if _is_fixed(self, name):
        raise FrozenInstanceError(f"cannot delete field {name!r}")
    object.__delattr__(self, name)


def _is_fixed(self: Any, name: str) -> bool:
    """Whether nobody may change what has this name: a subclass that declares nothing may have attributes of its own."""
    return _FIELDS in type(self).__dict__ or name in self.__dataclass_fields__


def _state(self: Any) -> list[Any]:
    """For copies and other processes: without a room of their own, values cannot be taken from it."""
    return [getattr(self, one.name) for one in fields(self)]


def _set_state(self: Any, state: list[Any]) -> None:
    for one, value in zip(fields(self), state, strict=True):
        object.__setattr__(self, one.name, value)
