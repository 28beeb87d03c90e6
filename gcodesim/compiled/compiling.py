"""Machine code of kernels by numba. This file and `entry` are the only ones that know numba.

A kernel that Python calls is compiled with all that it calls into one piece of
code. Kernels that others call get no code of their own and no wrappers for
Python, which would be a good part of the work.
"""

from __future__ import annotations

import sys
from copy import copy
from functools import cache
from typing import TYPE_CHECKING, Any

from gcodesim import compiled
from gcodesim.compiled.arguments import Argument, Arguments, class_of
from gcodesim.compiled.folder import folders, obstacles, writable_folder

if TYPE_CHECKING:
    from gcodesim.compiled import Kernel
    from gcodesim.compiled.object_code import ObjectCode


def compile_entry(kernel: Kernel, arguments: Arguments, symbol: str) -> ObjectCode | None:
    """Code of the kernel for these types, with an entry for Python.

    None if it returns a type that an entry cannot, or if this version of numba is unknown to us.
    """
    return _compile_entry(kernel, arguments, symbol) if _knows_this_numba() else None


def _compile_entry(kernel: Kernel, arguments: Arguments, symbol: str) -> ObjectCode | None:
    numba = _numba()
    import llvmlite.binding as llvm
    from numba.core.compiler_lock import global_compiler_lock
    from numba.core.runtime import rtsys

    from gcodesim.compiled.entry import build_entry
    from gcodesim.compiled.object_code import ObjectCode, address_of

    part = _part_of(kernel)
    types = tuple(_type_of(numba, argument) for argument in arguments)
    with global_compiler_lock:
        part.compile(types)
        made = part.overloads[types]
        module = build_entry(made, arguments, symbol)
        if module is None:
            return None
        codegen = made.target_context.codegen()
        library = codegen.create_library(symbol)
        library.add_linking_library(made.library)
        if made.target_context.enable_nrt:
            library.add_linking_library(rtsys.library)
        library.add_ir_module(module)
        library.finalize()
        final = library._final_module
        outside = [thing.name for thing in (*final.functions, *final.global_variables) if thing.is_declaration]
        wanted = tuple(name for name in outside if not name.startswith("llvm."))
        if any(llvm.address_of_symbol(name) not in (None, address_of(name)) for name in wanted):
            return None
        return ObjectCode(symbol, wanted, codegen._tm.emit_object(final))


@cache
def dispatcher_of(kernel: Kernel) -> Any:
    """The kernel as numba calls it, for arguments and results that an entry cannot take.

    It is compiled again in each process, since numba would keep it as a pickle, which could run anything when read.
    """
    return _jit(kernel, "whole", nogil=True)


def part_of(kernel: Kernel) -> Any:
    """The kernel as others call it."""
    return _part_of(kernel) if _knows_this_numba() else dispatcher_of(kernel)


@cache
def _part_of(kernel: Kernel) -> Any:
    """The kernel as others call it, which Python cannot call."""
    return _jit(kernel, "part", no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=kernel.inlined)


def _jit(kernel: Kernel, kind: str, **options: bool) -> Any:
    """No fast-math, no parallel reductions, so results are repeatable."""
    if kernel.lean:
        options["_nrt"] = False
    numba = _numba()
    return numba.njit(error_model="numpy", pipeline_class=_compilers()[kind, kernel.lean], **options)(kernel.py_func)


@cache
def _knows_this_numba() -> bool:
    """Whether numba still makes entries as expected: parts of it are used that it may change."""
    from gcodesim.compiled.object_code import load

    kernel = compiled.Kernel(_second)
    try:
        code = _compile_entry(kernel, (Argument("f8", 1),), "gcodesim_second")
        entry = None if code is None else load(code)
    except Exception:  # of any kind: nobody knows how numba has changed
        return False
    import numpy as np

    return entry is not None and entry(np.array([1.5, 2.5])) == 2.5 and entry(2.5) is NotImplemented


def _second(values: Any) -> Any:
    return values[1]


@cache
def _compilers() -> dict[tuple[str, bool], Any]:
    """Compilers of whole kernels and of parts, and whether no two arguments share memory that is written."""
    from numba.core.compiler import Compiler

    class Whole(Compiler):  # type: ignore[misc]
        apart = False

        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments)
            self.state.flags.noalias = self.apart

    class Part(Whole):
        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments)
            context = self.state.targetctx
            quiet = _quiet(context.codegen())
            self.state.targetctx = context.subtarget(_internal_codegen=quiet, get_executable=_no_executable)

    class WholeApart(Whole):
        apart = True

    class PartApart(Part):
        apart = True

    return {("whole", False): Whole, ("whole", True): WholeApart, ("part", False): Part, ("part", True): PartApart}


@cache
def _quiet(codegen: Any) -> Any:
    """numba's maker of libraries; its libraries are for linking and for object code, and not loaded."""
    from numba.core.codegen import JITCodeLibrary

    class Library(JITCodeLibrary):  # type: ignore[misc]
        def _finalize_final_module(self) -> None:
            self._finalize_dynamic_globals()
            self._verify_declare_only_symbols()
            self._finalized = True

    quiet = copy(codegen)
    quiet._library_class = Library
    return quiet


def _no_executable(library: Any, description: Any, environment: Any) -> Any:
    """Replaces the function that numba would make for Python: it needs a C function, by name, for each overload."""
    return [description].index


def _type_of(numba: Any, argument: Argument) -> Any:
    if argument.parts is not None:
        kinds = tuple(_type_of(numba, part) for part in argument.parts)
        return numba.types.BaseTuple.from_types(kinds, class_of(argument.named) if argument.named else None)
    import numpy as np

    item = numba.from_dtype(np.dtype(argument.item))
    if argument.dimensions is None:
        return item
    return numba.types.Array(item, argument.dimensions, "C", readonly=argument.readonly, aligned=True)


@cache
def _numba() -> Any:
    """The module numba; if no code is kept yet, announces that something is going to be compiled."""
    import numba

    _load_without_scipy()
    if compiled.when_cold is not None:
        place = writable_folder()
        if place is None or not any(name.endswith(".kernel") for folder in folders() for name in folder.names()):
            compiled.when_cold("" if place else "; ".join(obstacles()))
    return numba


def _load_without_scipy() -> None:
    """Let numba load its linear algebra while it cannot see scipy's.

    It asks scipy for BLAS when the first kernel is compiled, which takes longer
    than the start of a command; no kernel here uses BLAS.
    """
    name = "scipy.linalg"
    if name in sys.modules:
        return
    sys.modules[name] = None  # type: ignore[assignment]
    try:
        import numba.np.arraymath  # noqa: F401
    finally:
        del sys.modules[name]
