"""How kernels are declared; the one way to numba.

Import `kernel` from here and nowhere else. Declaring a kernel costs nothing. When
it is called first with arguments of some types, its machine code for them is
taken from the library that came with the package (`library`), else from the cache
(`object_code`), which needs a part of LLVM; where it is in neither, numba compiles
it (`compiling`), which takes 0.3 s to load and seconds to work, and it is kept.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import cached_property
from types import FunctionType
from typing import Any, Final, TypeVar, cast, overload

F = TypeVar("F", bound=Callable[..., Any])

# A call about this many rows is interpreted, where a kernel allows it: 3 to 50 µs per row, while loading
# machine code for the first time takes 0.05 s.
SHORT: Final = 256

# When so many rows have been interpreted, many short calls have cost what loading costs: from then on nothing is.
ENOUGH: Final = 1 << 14

# called before a kernel is compiled, so that nobody has to wait in silence; it gets the kernel's signature and the
# reason why code cannot be kept, empty if it can. It may compile this kernel and others into the cache.
when_cold: Callable[[str, str], None] | None = None


class Kernel:
    """A function of arrays and scalars that is compiled when it is called first.

    A `short` kernel gets as many rows as its first argument is long, or the
    first of its columns, and is interpreted when they are few, and few in all
    calls of the process before. Both ways give the same bits.

    A `lean` kernel makes no array of its own, and no two of its arguments share
    memory that it writes. So it is compiled without reference counting, which is
    an atomic operation at every slice and every call and was a third of the time
    of small hot kernels, and its loops may work on several elements at a time.
    The compiler refuses one that makes an array; separate arguments are the responsibility of
    the caller.

    An `inlined` kernel becomes a part of each kernel that calls it: a section of a long one that has a name of its own
    for the reader. Where many arrays would have to be handed on, a call costs more than the work of a short kernel.
    """

    rows_interpreted = 0
    """By all kernels of this process."""

    def __init__(
        self, function: Callable[..., Any], *, short: bool = False, lean: bool = False, inlined: bool = False
    ) -> None:
        self.py_func = function
        self.short = short
        self.lean = lean
        self.inlined = inlined
        self.declared_ns = time.time_ns()
        self.__doc__ = function.__doc__
        self.__wrapped__ = function
        self._entries: list[Callable[..., Any]] = []
        self._entry: Callable[..., Any] = _no_entry

    def __call__(self, *arguments: Any) -> Any:
        if self.short and Kernel.rows_interpreted < ENOUGH and (rows := _rows(arguments[0])) <= SHORT:
            Kernel.rows_interpreted += rows
            return self.interpreted(*arguments)
        result = self._entry(*arguments)
        return self._first_call(arguments) if result is NotImplemented else result

    def _first_call(self, arguments: tuple[Any, ...]) -> Any:
        """The result for arguments that are not of the types of the last call."""
        for entry in self._entries:
            result = entry(*arguments)
            if result is not NotImplemented:
                self._entry = entry
                return result
        self._entry = self._entry_for(arguments)
        self._entries.append(self._entry)
        result = self._entry(*arguments)
        return self.by_numba(*arguments) if result is NotImplemented else result

    def _entry_for(self, arguments: tuple[Any, ...]) -> Callable[..., Any]:
        """A function for arguments of these types, which returns NotImplemented for others."""
        if is_compiler_off():
            return self.py_func
        from gcodesim.compiled.arguments import argument_of
        from gcodesim.compiled.object_code import entry_of

        known = tuple(map(argument_of, arguments))
        try:
            entry = None if None in known else entry_of(self, known)  # type: ignore[arg-type]
            return entry or self.by_numba
        except ImportError as error:
            if (error.name or "").partition(".")[0] not in ("numba", "llvmlite"):
                raise
            from gcodesim.extras import ExtraMissingError

            raise ExtraMissingError(
                f"the kernel `{self.py_func.__module__}.{self.py_func.__qualname__}` has to be compiled for what it is "
                "called with; that needs the extra `compile`, which is not installed (no numba): "
                "pip install 'gcodesim[compile]'"
            ) from None

    @cached_property
    def by_numba(self) -> Callable[..., Any]:
        """The function called by way of numba, for types that `arguments` does not know."""
        from gcodesim.compiled.compiling import dispatcher_of

        return cast(Callable[..., Any], dispatcher_of(self))

    @cached_property
    def interpreted(self) -> Callable[..., Any]:
        """The function as plain Python, with all that it calls, and as silent: infinity, no warning."""
        import numpy as np

        return np.errstate(all="ignore")(self.plain)

    @cached_property
    def plain(self) -> Callable[..., Any]:
        """The function as plain Python, with all kernels that it calls."""
        function = cast(FunctionType, self.py_func)
        names = {
            name: value.plain if isinstance(value, Kernel) else value
            for name, value in function.__globals__.items()
            if name in function.__code__.co_names
        }
        return FunctionType(function.__code__, names, function.__name__, function.__defaults__)

    @property
    def _numba_type_(self) -> Any:
        """The kernel in the form that numba needs when another kernel calls it."""
        from gcodesim.compiled.compiling import part_of

        return part_of(self)._numba_type_


def _rows(first: Any) -> int:
    """The rows of the first argument of a kernel: a column, or a tuple of columns."""
    return len(first[0] if isinstance(first, tuple) else first)


def as_python(kernel: F) -> F:
    """The function behind a kernel as plain Python, for a few calls from Python."""
    return cast(F, cast(Kernel, kernel).plain)


def is_compiler_off() -> bool:
    """Whether kernels are to run as Python, which helps with debugging."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") != "0"


@overload
def kernel(function: F) -> F: ...
@overload
def kernel(*, short: bool = False, lean: bool = False, inlined: bool = False) -> Callable[[F], F]: ...
def kernel(
    function: F | None = None, *, short: bool = False, lean: bool = False, inlined: bool = False
) -> F | Callable[[F], F]:
    """Declare a kernel; `short`, `lean`, `inlined`: see `Kernel`."""
    if function is None:
        return lambda function: cast(F, Kernel(function, short=short, lean=lean, inlined=inlined))
    return cast(F, Kernel(function, short=short, lean=lean, inlined=inlined))


def _no_entry(*arguments: Any) -> Any:
    return NotImplemented
