"""Values of frozen classes as JSON and back, by the types of their fields: no JSON says what to make of it."""

from __future__ import annotations

import math
import os
import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from datetime import date
from enum import Enum
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Any, Final, Literal, Union, get_args, get_origin, get_type_hints

_ODD: Final = "odd number"
_UNIONS: Final = (Union, types.UnionType)


def as_plain(value: Any, hint: Any, root: Path) -> Any:
    """JSON of a value of type `hint`; paths are told as seen from `root`."""
    if hint is Any:
        return _odd_numbers_named(value)
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in _UNIONS:
        return None if value is None else as_plain(value, _fitting(value, arguments), root)
    if is_dataclass(hint):
        assert isinstance(hint, type)
        return {name: as_plain(getattr(value, name), own, root) for name, own in _hints(hint).items()}
    if origin is tuple:
        return [as_plain(one, own, root) for one, own in zip(value, _of_tuple(arguments, len(value)), strict=True)]
    if origin is list:
        return [as_plain(one, arguments[0], root) for one in value]
    if _is_mapping(origin):
        key, content = arguments
        return [[as_plain(k, key, root), as_plain(v, content, root)] for k, v in value.items()]
    if hint is Path:
        return PurePosixPath(*Path(os.path.relpath(os.path.abspath(value), root)).parts).as_posix()
    if isinstance(hint, type) and issubclass(hint, Enum):
        return value.name
    if hint is date:
        return value.isoformat()
    if origin is Literal or hint in (str, int, bool, float):
        return _odd_numbers_named(value)
    raise TypeError(f"no JSON for {hint}")


def from_plain(value: Any, hint: Any, root: Path) -> Any:
    """The value of type `hint` that `as_plain` gave; TypeError, KeyError or ValueError for anything else."""
    if hint is Any:
        return _odd_numbers_read(value)
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in _UNIONS:
        return None if value is None else from_plain(value, _fitting_json(value, arguments), root)
    if is_dataclass(hint):
        assert isinstance(hint, type)
        return hint(**{name: from_plain(value[name], own, root) for name, own in _hints(hint).items()})
    if origin is tuple:
        return tuple(
            from_plain(one, own, root) for one, own in zip(value, _of_tuple(arguments, len(value)), strict=True)
        )
    if origin is list:
        return [from_plain(one, arguments[0], root) for one in value]
    if _is_mapping(origin):
        key, content = arguments
        return {from_plain(k, key, root): from_plain(v, content, root) for k, v in value}
    if hint is Path:
        return root / str(value)
    if isinstance(hint, type) and issubclass(hint, Enum):
        return hint[value]
    if hint is date:
        return date.fromisoformat(value)
    if origin is Literal:
        if value not in arguments:
            raise ValueError(f"{value!r} is none of {arguments}")
        return value
    if hint in (str, int, bool, float):
        return _checked(_odd_numbers_read(value), hint)
    raise TypeError(f"no JSON for {hint}")


def _checked(value: Any, hint: Any) -> Any:
    """A plain value that may stand in a field of type `hint`; whole numbers may be in fields of floats."""
    allowed = (int, float) if hint is float else hint
    if not isinstance(value, allowed):
        raise TypeError(f"{value!r} is no {hint.__name__}")
    return value


@cache
def _hints(cls: Any) -> Mapping[str, Any]:
    hints = get_type_hints(cls)
    return {field.name: hints[field.name] for field in fields(cls) if field.init}


def _is_mapping(origin: Any) -> bool:
    return isinstance(origin, type) and issubclass(origin, Mapping)


def _of_tuple(arguments: tuple[Any, ...], count: int) -> tuple[Any, ...]:
    return (arguments[0],) * count if arguments[1:] == (...,) else arguments


def _fitting(value: Any, hints: tuple[Any, ...]) -> Any:
    """Which of the types of a union a value has."""
    for hint in hints:
        kind = get_origin(hint) or hint
        if kind is Literal or kind is Any:
            return hint
        if isinstance(kind, type) and isinstance(value, (int, float) if kind is float else kind):
            return hint
    raise TypeError(f"{type(value).__name__} is none of {hints}")


def _fitting_json(value: Any, hints: tuple[Any, ...]) -> Any:
    """Which of the types of a union a value of JSON stands for."""
    plain = {str: (str,), int: (int,), bool: (bool,), float: (float, int)}
    for hint in hints:
        kind = get_origin(hint) or hint
        if kind in plain:
            if isinstance(value, plain[kind]) or (kind is float and isinstance(value, dict) and _ODD in value):
                return hint
        elif kind is not types.NoneType:
            return hint
    raise TypeError(f"{value!r} stands for none of {hints}")


def _odd_numbers_named(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return {_ODD: str(value)}
    if isinstance(value, Mapping):
        return {key: _odd_numbers_named(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_odd_numbers_named(one) for one in value]
    return value


def _odd_numbers_read(value: Any) -> Any:
    if isinstance(value, dict):
        if set(value) == {_ODD}:
            return float(value[_ODD])
        return {key: _odd_numbers_read(one) for key, one in value.items()}
    return [_odd_numbers_read(one) for one in value] if isinstance(value, list) else value
