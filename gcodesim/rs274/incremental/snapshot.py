"""Copies of a run half-way: everything that decides how it goes on, apart from the text."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from copy import copy as _copy_shallow
from enum import Enum
from types import MethodType
from typing import TYPE_CHECKING, Any, Final

from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.reader import Reader

if TYPE_CHECKING:
    from gcodesim.rs274.executor import Executor

# what is counted, said or cached, and decides nothing that comes after
_ASIDE: Final = frozenset(
    (
        *("run", "file", "reader", "settings", "dialect", "lanes", "endless", "allowance"),
        *("blocks", "told", "block_number", "span", "notes"),
        *("not_simulated", "undo", "changes", "files", "touched", "folders", "source_of_limits"),
    )
)
_SHARED: Final = (ProgramFile, Reader)
_PLAIN: Final = (int, float, str, bytes, bool, type(None))


def copied(executor: Executor, file: ProgramFile) -> Executor:
    """A run of its own that stands where `executor` stands, and goes on in `file`, the same lines up to there."""
    memo: dict[int, Any] = {id(executor.lanes): None, id(executor.file): file, id(executor.run.source): file.source}
    memo[id(None)] = None
    twin: Executor = _copy(executor, memo)
    twin.flow.files = {file.name if name == executor.file.name else name: one for name, one in twin.flow.files.items()}
    for frame in twin.flow.frames:
        if frame.file is file:
            frame.resume(file)
    return twin


def _copy(value: Any, memo: dict[int, Any]) -> Any:
    """A copy of all that can change; what never does is shared."""
    if isinstance(value, _PLAIN):
        return value
    known = memo.get(id(value), memo)
    if known is not memo:
        return known
    kind = type(value)
    if kind is tuple or (isinstance(value, tuple) and hasattr(kind, "_fields")):
        parts = [_copy(one, memo) for one in value]
        same = all(new is old for new, old in zip(parts, value, strict=True))
        made: Any = value if same else tuple.__new__(kind, parts)
    elif isinstance(value, dict):
        made = memo[id(value)] = _copy_shallow(value)
        made.clear()
        made.update((_copy(key, memo), _copy(one, memo)) for key, one in value.items())
    elif kind in (list, deque):
        made = memo[id(value)] = kind()
        made.extend(_copy(one, memo) for one in value)
    elif kind is set:
        made = {_copy(one, memo) for one in value}
    elif isinstance(value, MethodType):
        made = MethodType(value.__func__, _copy(value.__self__, memo))
    elif _is_ours(kind) and not isinstance(value, _SHARED) and not _is_fixed(kind):
        made = memo[id(value)] = object.__new__(kind)
        for name, one in _attributes(value):
            object.__setattr__(made, name, _copy(one, memo))
    else:
        made = value
    memo[id(value)] = made
    return made


def _is_ours(kind: type) -> bool:
    return kind.__module__.startswith("gcodesim.")


def _is_fixed(kind: type) -> bool:
    """Whether objects of a class never change."""
    declared = getattr(kind, "__dataclass_params__", None)
    return issubclass(kind, type | Enum) or (declared is not None and declared.frozen)


def _attributes(value: Any) -> Iterator[tuple[str, Any]]:
    yield from getattr(value, "__dict__", {}).items()
    for kind in type(value).__mro__:
        slots = kind.__dict__.get("__slots__", ())
        for name in (slots,) if isinstance(slots, str) else slots:
            if hasattr(value, name):
                yield name, getattr(value, name)


def is_same(one: Any, other: Any, seen: set[tuple[int, int]] | None = None) -> bool:
    """Whether two runs that stand at the same line go on alike: all that decides it has the same values."""
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, _PLAIN):
        return bool(one == other)
    if isinstance(one, ProgramFile):
        return bool(one.name == other.name)
    seen = set() if seen is None else seen
    if (id(one), id(other)) in seen:
        return True
    seen.add((id(one), id(other)))
    if isinstance(one, dict):
        keys = one.keys() == other.keys()
        return keys and all(is_same(value, other[key], seen) for key, value in one.items())
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(is_same(a, b, seen) for a, b in zip(one, other, strict=True))
    if callable(one) and hasattr(one, "__func__"):
        return bool(one.__func__ is other.__func__)
    parts = _parts(one)
    if parts is None:
        return bool(one == other)
    return all(is_same(value, getattr(other, name, None), seen) for name, value in parts)


def _parts(value: Any) -> list[tuple[str, Any]] | None:
    """Names and values of what an object of ours holds; None for other values, which are compared as they are."""
    if not _is_ours(type(value)) or _is_fixed(type(value)):
        return None
    return [(name, one) for name, one in _attributes(value) if name not in _ASIDE]
