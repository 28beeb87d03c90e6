"""Shortcuts through numba: equal code with less work, while kernels are compiled.

What numba does again and again for kernels is done once here: how an operator or a function of numpy is typed for
given types, above all. Outside of `taken` numba is as it was. A shortcut whose place this numba does not have is left
out: the work takes longer and gives the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from types import SimpleNamespace
from typing import Any, Final

from gcodesim.compiled import passes
from gcodesim.compiled.passes import Shortcut


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
def _shortcuts() -> tuple[Shortcut, ...]:
    """Those that this numba has a place for."""
    found: list[Shortcut] = []
    for make in _ALL:
        try:
            shortcuts = list(make())
            for owner, name, _ in shortcuts:
                getattr(owner, name)
        except (ImportError, AttributeError):
            continue
        found.extend(shortcuts)
    return tuple(found)


def _typing() -> Iterator[Shortcut]:
    """How numba finds the signature of a function that it knows, asked once for the same types.

    What is compiled for its arguments is asked again, since it depends on the options of the kernel that calls it.
    """
    from numba.core.types.functions import BaseFunction

    resolve = BaseFunction.get_call_type
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

    yield BaseFunction, "get_call_type", get_call_type


def _options() -> Iterator[Shortcut]:
    """The options of a compilation, which are asked for with every function."""
    from numba.core.targetconfig import TargetConfig

    @cache
    def defaults(kind: Any) -> dict[str, Any]:
        return {name: option.default for name, option in kind.options.items()}

    @cache
    def hash_of_names(kind: Any) -> int:
        return hash(tuple(sorted(kind.options)))

    def values(self: Any) -> dict[str, Any]:
        kind: Any = type(self)
        all_values: dict[str, Any] = defaults(kind) | self._values
        return all_values

    def hash_of(self: Any) -> int:
        kind: Any = type(self)
        return hash_of_names(kind)

    yield TargetConfig, "values", values
    yield TargetConfig, "__hash__", hash_of


def _waiting() -> Iterator[Shortcut]:
    """Nobody is told how long numba waits for its locks."""
    from numba.core import compiler_lock

    yield compiler_lock.ev, "broadcast", lambda event: None


def _shapes() -> Iterator[Shortcut]:
    """An error that tells the shapes of arrays, for which numba compiles texts."""
    from numba.np import arrayobj

    yield arrayobj, "raise_with_shape_context", _other_shape()


@cache
def _other_shape() -> Callable[..., Any]:
    from numba import types
    from numba.extending import overload

    def other_shape(shape: Any, place: Any) -> None:
        """Replaces the error."""

    @overload(other_shape)  # type: ignore[untyped-decorator]
    def ol_other_shape(shape: Any, place: Any) -> Any:
        def fail(shape: Any, place: Any) -> None:
            raise ValueError("arrays of different shapes")

        return fail if isinstance(shape, types.BaseTuple) else None

    return other_shape


def _variables() -> Iterator[Shortcut]:
    """Which variables a statement of numba names: asked ten times for each, so without a list for each of its parts."""
    from numba.core import ir

    def gather(value: Any, found: list[Any]) -> None:
        if isinstance(value, ir.Var):
            found.append(value)
        elif isinstance(value, ir.Inst):
            found.extend(value.list_vars())
        elif isinstance(value, list | tuple):
            for part in value:
                gather(part, found)
        elif isinstance(value, dict):
            for part in value.values():
                gather(part, found)

    def in_statement(self: Any) -> list[Any]:
        return of_parts(self.__dict__)

    def in_expression(self: Any) -> list[Any]:
        return of_parts(self._kws)

    def of_parts(parts: dict[str, Any]) -> list[Any]:
        found: list[Any] = []
        for part in parts.values():
            kind = type(part)
            if kind is ir.Var:
                found.append(part)
            elif kind is ir.Expr:
                found.extend(of_parts(part._kws))
            elif kind not in simple:
                gather(part, found)
        return found

    simple = {ir.Loc, ir.Const, ir.Global, ir.FreeVar, ir.Arg, str, int, bool, type(None)}
    yield ir.Stmt, "list_vars", in_statement
    yield ir.Expr, "list_vars", in_expression


def _sizes() -> Iterator[Shortcut]:
    """Sizes of types, for which LLVM reads a text each time."""
    from llvmlite.ir import Type

    def once(name: str) -> Callable[..., Any]:
        ask = getattr(Type, name)
        known: dict[Any, int] = {}

        def asked(self: Any, target_data: Any, context: Any = None) -> Any:
            key = self, target_data
            if context is not None:
                return ask(self, target_data, context)
            if key not in known:
                known[key] = ask(self, target_data)
            return known[key]

        return asked

    for name in ("get_abi_size", "get_abi_alignment"):
        yield Type, name, once(name)


def _names() -> Iterator[Shortcut]:
    """Names of LLVM's values, of which most are new when they are asked for."""
    from llvmlite.ir._utils import DuplicatedNameError, NameScope

    NameScope.deduplicate  # noqa: B018  AttributeError where llvmlite has changed

    def register(self: Any, name: str, deduplicate: bool = False) -> str:
        used = self._useset
        if name in used:
            if not deduplicate:
                raise DuplicatedNameError(name)
            name = self.deduplicate(name)
        used.add(name)
        return name

    yield NameScope, "register", register


def _location() -> Iterator[Shortcut]:
    """Whether an implementation of numba's wants to know the line of a program."""
    from numba.core import base

    yield base, "_has_loc", cache(base._has_loc)


def _registries() -> Iterator[Shortcut]:
    """numba's own declarations: imported once, not anew with every function; what was added since is looked up."""
    from numba.core.cpu import CPUContext
    from numba.core.typing.context import Context

    for kind in (CPUContext, Context):
        yield kind, "load_additional_registries", _loaded_once(kind.load_additional_registries)


def _loaded_once(load: Callable[[Any], None]) -> Callable[[Any], None]:
    registries: list[Any] = []

    def again(self: Any) -> None:
        for registry in registries:
            self.install_registry(registry)

    def first(self: Any) -> None:
        if registries:
            again(self)
            return
        install = self.install_registry

        def noted(registry: Any) -> None:
            install(registry)
            registries.append(registry)

        self.install_registry = noted
        try:
            load(self)
        finally:
            del self.install_registry

    return first


def _silence() -> Iterator[Shortcut]:
    """What numba tells those who work on it, statement by statement."""
    from numba.core import byteflow, ssa

    for module in (byteflow, ssa):
        yield module, "_logger", SimpleNamespace(debug=lambda *words: None)


def _values() -> Iterator[Shortcut]:
    """Instructions of LLVM for the statements of a kernel, see `lowering`."""
    from numba.core.typed_passes import NativeLowering
    from numba.np import arrayobj

    from gcodesim.compiled.lowering import array_maker, index_fixer, lower_class

    lower = lower_class()
    yield NativeLowering, "lowering_class", property(lambda self: lower)
    yield arrayobj, "make_array", array_maker(arrayobj.make_array)
    yield arrayobj, "fix_integer_index", index_fixer(arrayobj.fix_integer_index)


_ALL: Final[tuple[Callable[[], Iterator[Shortcut]], ...]] = (
    _typing,
    _options,
    _waiting,
    _shapes,
    _variables,
    _sizes,
    _location,
    _registries,
    _silence,
    _values,
    _names,
    *passes.ALL,
)
