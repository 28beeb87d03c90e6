"""The one way to numba: how kernels are declared, when they are compiled, and where they are cached.

Import `kernel` from here and nowhere else. Declaring a kernel costs nothing:
numba is loaded when the first one is needed in its compiled form. The cache
folder's name carries a hash of all kernel sources, the numba version and the
processor, because numba's own check does not see that a kernel in another file
has changed. When no folder is writable the kernels run uncached instead of failing.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache, cached_property
from pathlib import Path
from types import FunctionType
from typing import Any, Final, TypeVar, cast, overload

from gcodesim.user_cache import user_cache

F = TypeVar("F", bound=Callable[..., Any])

# A call about so many rows is interpreted, where a kernel allows it: some 50 µs a row, while loading numba
# and what it has cached takes 0.3 s.
SHORT: Final = 256

# what is called before a long compilation, so that nobody has to wait in silence
when_cold: Callable[[], None] | None = None


class Kernel:
    """A function of arrays and scalars that is compiled when it is called first.

    A `short` kernel gets as many rows as its first argument is long, and is
    interpreted when they are few. That depends on nothing but the arguments,
    so equal input takes the same way in every process.

    A `lean` kernel makes no array of its own, and no two of its arguments share
    memory that it writes. So it is compiled without reference counting, which is
    an atomic operation at every slice and every call and was a third of the time
    of small hot kernels, and its loops may work on several elements at a time.
    The compiler refuses one that makes an array; that arguments are apart is on
    who calls it.
    """

    def __init__(self, function: Callable[..., Any], *, short: bool, lean: bool = False) -> None:
        self.py_func = function
        self.short = short
        self.lean = lean
        self.__doc__ = function.__doc__
        self.__wrapped__ = function

    def __call__(self, *arguments: Any) -> Any:
        if self.short and len(arguments[0]) <= SHORT:
            return self.interpreted(*arguments)
        return self.compiled(*arguments)

    @cached_property
    def compiled(self) -> Callable[..., Any]:
        """The compiled function: no fast-math, no parallel reductions, so results are repeatable."""
        numba, folder = _numba()
        options = {"_nrt": False, "pipeline_class": _apart()} if self.lean else {}
        return numba.njit(  # type: ignore[no-any-return]
            cache=folder is not None, error_model="numpy", nogil=True, **options
        )(self.py_func)

    @cached_property
    def interpreted(self) -> Callable[..., Any]:
        """The function as plain Python, with all kernels that it calls."""
        import numpy as np

        function = cast(FunctionType, self.py_func)
        names = {
            name: value.interpreted if isinstance(value, Kernel) else value
            for name, value in function.__globals__.items()
            if name in function.__code__.co_names
        }
        plain = FunctionType(function.__code__, names, function.__name__, function.__defaults__)
        return np.errstate(all="ignore")(plain)  # as the compiled one: infinity, no warning

    @property
    def _numba_type_(self) -> Any:
        """What a kernel is to numba when another kernel calls it."""
        return self.compiled._numba_type_  # type: ignore[attr-defined]


@overload
def kernel(function: F) -> F: ...
@overload
def kernel(*, short: bool = False, lean: bool = False) -> Callable[[F], F]: ...
def kernel(function: F | None = None, *, short: bool = False, lean: bool = False) -> F | Callable[[F], F]:
    """Declare a kernel; `short`, `lean`: see `Kernel`."""
    if function is None:
        return lambda function: cast(F, Kernel(function, short=short, lean=lean))
    return cast(F, Kernel(function, short=short, lean=lean))


@cache
def _numba() -> tuple[Any, Path | None]:
    """numba, told where to cache, and the folder; None when there is none to write to."""
    import numba

    folder = user_cache(digest(numba.__version__))
    numba.config.CACHE_DIR = str(folder or "")
    _load_without_scipy()
    if when_cold is not None and (folder is None or not any(folder.rglob("*.nbi"))):
        when_cold()
    return numba, folder


@cache
def _apart() -> Any:
    """The compiler, told that no two arguments share memory that is written."""
    from numba.core.compiler import Compiler

    class Apart(Compiler):  # type: ignore[misc]
        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments)
            self.state.flags.noalias = True

    return Apart


def digest(version: str) -> str:
    """Hash of every kernel source of this package, the compiler's version and the processor."""
    import hashlib
    import platform

    digest = hashlib.sha256()
    for path in (Path(__file__), *sorted(Path(__file__).parent.rglob("*kernels.py"))):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    digest.update(f"{version} {sys.version_info[:2]} {platform.machine()} {_processor()}".encode())
    return digest.hexdigest()[:16]


def _processor() -> str:
    """The processor's name and features: a cache made on another one may hold instructions this one lacks."""
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:
        import platform

        return platform.processor()
    return "".join(sorted({line for line in lines if line.startswith(("model name", "flags"))}))


def _load_without_scipy() -> None:
    """Let numba load its linear algebra while it cannot see scipy's.

    It asks scipy for BLAS as soon as the first kernel is called, which takes
    longer than all else at the start of a command; no kernel here uses BLAS.
    """
    name = "scipy.linalg"
    if name in sys.modules:
        return
    sys.modules[name] = None  # type: ignore[assignment]
    try:
        import numba.np.arraymath  # noqa: F401
    finally:
        del sys.modules[name]
