"""What machine code asks of an argument: a number of one kind, or an array of such numbers."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any, Final, NamedTuple, cast

import numpy as np

ITEMS: Final = ("b1", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "f4", "f8")
"""Numbers that kernels know, as numpy calls them."""

_ITEM_OF: Final = {int: "i8", float: "f8", bool: "b1"} | {np.dtype(item).type: item for item in ITEMS}
_DESCRIPTIONS: Final = {np.dtype(item): item for item in ITEMS}
_LARGEST: Final = 1 << 63

TYPE: Final = 8
"""Where an object of Python has its type: 64 bits of address, behind a count of as many."""
ARRAY: Final = {"data": 16, "dimensions": 24, "shape": 32, "strides": 40, "dtype": 56, "flags": 64}
"""Where numpy's `PyArrayObject_fields` has what an entry reads."""
ORDER, NUMBER = 26, 28
"""Where numpy's `PyArray_Descr`, a dtype, has the order of bytes and the number of its type."""


TUPLE_SIZE, TUPLE_ITEMS = 16, 24
"""Where a tuple has its length and its first item."""


class Argument(NamedTuple):
    """Type of an argument: a kind of number, an array of such numbers in C order, or a tuple of such arguments.

    `named` is the class of a named tuple, see `name_of`.
    """

    item: str = ""
    dimensions: int | None = None  # of an array
    readonly: bool = False
    parts: tuple[Argument, ...] | None = None  # of a tuple
    named: str = ""


Arguments = tuple[Argument, ...]


def argument_of(value: Any) -> Argument | None:
    """Type of a value; None when only numba knows what to do with it."""
    if isinstance(value, tuple):
        parts = tuple(map(argument_of, value))
        named = "" if type(value) is tuple else name_of(type(value))
        if None in parts or not parts or named is None:
            return None
        return Argument(parts=parts, named=named)  # type: ignore[arg-type]
    if type(value) is np.ndarray:
        flags = value.flags
        item = _DESCRIPTIONS.get(value.dtype)
        if item is None or not (flags.c_contiguous and flags.aligned):
            return None
        return Argument(item, value.ndim, not flags.writeable)
    item = _ITEM_OF.get(type(value))
    if item is None or (type(value) is int and not -_LARGEST <= value < _LARGEST):
        return None
    return Argument(item)


def name_of(kind: type) -> str | None:
    """Name in machine code of a class of named tuples; None when it is none that can be found by its name."""
    module = sys.modules.get(kind.__module__)
    found = hasattr(kind, "_fields") and getattr(module, kind.__qualname__, None) is kind
    return f"{kind.__module__}:{kind.__qualname__}" if found else None


def class_of(name: str) -> type | None:
    """The class of named tuples that has this name; None when its module is not there, or has changed."""
    module, kind = name.split(":")
    return cast("type | None", getattr(sys.modules.get(module), kind, None))


def objects_called(names: Sequence[str]) -> tuple[object, ...] | None:
    """The objects of Python that machine code knows by these names; None if one is missing."""
    things = []
    for name in names:
        thing = class_of(name) if ":" in name else OBJECTS.get(name)
        if thing is None and name != NONE:
            return None
        things.append(thing)
    return tuple(things)


def types_of(item: str) -> tuple[str, ...]:
    """Names in `OBJECTS` of the Python types whose values are numbers of this kind."""
    return tuple(_name(python) for python, kind in _ITEM_OF.items() if kind == item)


def dtype_of(item: str) -> str:
    """Name in `OBJECTS` of what numpy says of such numbers."""
    return f"dtype.{item}"


def dtype_numbers(item: str) -> tuple[int, ...]:
    """numpy's numbers of such a type: it has one for each that C has, though some are equal."""
    return tuple(np.dtype(letter).num for letter in "?bBhHiIlLqQfd" if np.dtype(letter) == np.dtype(item))


def _name(kind: type) -> str:
    return f"{kind.__module__}.{kind.__name__}"


ARRAY_TYPE, TUPLE_TYPE, EMPTY = "numpy.ndarray", "builtins.tuple", "numpy.empty"
OTHER_TYPES, FAILURE, NONE = "builtins.NotImplemented", "builtins.RuntimeError", "builtins.None"
NAMES_OF: Final = "_objects"
"""Behind the name of an entry: the text with the names of its objects."""
OBJECTS: Final[dict[str, object]] = (
    {ARRAY_TYPE: np.ndarray, TUPLE_TYPE: tuple, EMPTY: np.empty, OTHER_TYPES: NotImplemented}
    | {FAILURE: RuntimeError, NONE: None}
    | {_name(python): python for python in _ITEM_OF}
    | {dtype_of(item): np.dtype(item) for item in ITEMS}
)
"""Objects of Python that machine code gets, by their names there; named tuples have theirs by `name_of`."""


def as_text(arguments: Sequence[Argument]) -> str:
    """Equal for equal types, and different otherwise: `f8 i4[2] (u1[1]r f8) package.module:Name(f8)`."""
    return " ".join(map(_as_text, arguments))


def _as_text(argument: Argument) -> str:
    if argument.parts is not None:
        return f"{argument.named}({as_text(argument.parts)})"
    if argument.dimensions is None:
        return argument.item
    return f"{argument.item}[{argument.dimensions}]{'r' if argument.readonly else ''}"


def of_text(text: str) -> Arguments:
    """The types that `as_text` gives as this text; ValueError if it is none. Modules of named tuples are imported."""
    words = re.findall(r"[^\s()]*\(|\)|[^\s()]+", text)
    words.reverse()
    arguments = _of_words(words)
    if words:
        raise ValueError(text)
    return arguments


def _of_words(words: list[str]) -> Arguments:
    arguments = []
    while words and words[-1] != ")":
        word = words.pop()
        if word.endswith("("):
            named = word[:-1]
            if named:
                import_module(named.split(":")[0])
                if class_of(named) is None:
                    raise ValueError(f"there is no `{named}`")
            parts = _of_words(words)
            if named and len(parts) != len(getattr(class_of(named), "_fields", ())):
                raise ValueError(f"`{named}` has other fields today")
            arguments.append(Argument(parts=parts, named=named))
            if not words:
                raise ValueError("a parenthesis is open")
            words.pop()
            continue
        item, _, dimensions = word.rstrip("]r").partition("[")
        if item not in ITEMS:
            raise ValueError(word)
        arguments.append(Argument(item, int(dimensions) if dimensions else None, word.endswith("r")))
    return tuple(arguments)


def fields_of(arguments: Sequence[Argument]) -> str:
    """The fields of all named tuples, whose order is compiled in."""
    texts = []
    for argument in arguments:
        if argument.parts is not None:
            fields = getattr(class_of(argument.named), "_fields", ()) if argument.named else ()
            texts.append(f"{','.join(fields)}({fields_of(argument.parts)})")
    return " ".join(texts)
