"""Shortcuts through numba: equal code with less work, while kernels are compiled.

What numba does again and again for kernels is done once here: how an operator or a function of numpy is typed for
given types, above all. Outside of `taken` numba is as it was.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from numba import types
from numba.core import compiler_lock, targetconfig
from numba.core.types.functions import BaseFunction
from numba.extending import overload
from numba.np import arrayobj


@contextmanager
def taken() -> Iterator[None]:
    """Take the shortcuts. The lock of numba's compiler is held."""
    replaced = [(owner, name, getattr(owner, name)) for owner, name, _ in _shortcuts()]
    try:
        for owner, name, shortcut in _shortcuts():
            setattr(owner, name, shortcut)
        yield
    finally:
        for owner, name, before in replaced:
            setattr(owner, name, before)


@cache
def _shortcuts() -> tuple[tuple[Any, str, Any], ...]:
    return (
        (BaseFunction, "get_call_type", _remembered(BaseFunction.get_call_type)),
        (targetconfig.TargetConfig, "values", _values),
        (targetconfig.TargetConfig, "__hash__", _hash),
        (compiler_lock.ev, "broadcast", _unheard),
        (arrayobj, "raise_with_shape_context", _other_shape),
    )


def _remembered(resolve: Callable[..., Any]) -> Callable[..., Any]:
    """How numba finds the signature of a function that it knows, asked once for the same types.

    What is compiled for its arguments is asked again, since it depends on the options of the kernel that calls it.
    """
    known: dict[Any, Any] = {}

    def get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
        key = (self, context, tuple(args), tuple(kws.items()))
        try:
            found = known.get(key)
        except TypeError:  # something without a hash
            return resolve(self, context, args, kws)
        if found is not None:
            self._impl_keys[found.args] = self.typing_key
            return found
        found = resolve(self, context, args, kws)
        if self.get_impl_key(found) == self.typing_key:
            known[key] = found
        return found

    return get_call_type


def _values(self: Any) -> dict[str, Any]:
    kind: Any = type(self)
    values: dict[str, Any] = _defaults(kind) | self._values
    return values


def _hash(self: Any) -> int:
    kind: Any = type(self)
    return _hash_of_names(kind)


@cache
def _defaults(kind: Any) -> dict[str, Any]:
    return {name: option.default for name, option in kind.options.items()}


@cache
def _hash_of_names(kind: Any) -> int:
    return hash(tuple(sorted(kind.options)))


def _unheard(event: Any) -> None:
    """Nobody is told how long numba waits for its locks."""


def _other_shape(shape: Any, place: Any) -> None:
    """Replaces an error that tells the shapes, for which numba compiles texts."""


@overload(_other_shape)  # type: ignore[untyped-decorator]
def _ol_other_shape(shape: Any, place: Any) -> Any:
    def fail(shape: Any, place: Any) -> None:
        raise ValueError("arrays of different shapes")

    return fail if isinstance(shape, types.BaseTuple) else None
