"""Machine code of kernels by numba. This file, `entry` and `memory` are the only ones that know numba.

A kernel that Python calls is compiled with all that it calls into one piece of
code. Kernels that others call get no code of their own and no wrappers for
Python, which would be a good part of the work.
"""

from __future__ import annotations

import sys
from functools import cache
from typing import TYPE_CHECKING, Any

from gcodesim import compiled
from gcodesim.compiled.arguments import Argument, Arguments, class_of
from gcodesim.compiled.target import level, tuning

if TYPE_CHECKING:
    from gcodesim.compiled import Kernel
    from gcodesim.compiled.object_code import ObjectCode


def compile_entry(kernel: Kernel, arguments: Arguments, symbol: str) -> ObjectCode | None:
    """Code of the kernel for these types, with an entry for Python.

    None if it returns a type that an entry cannot, or if this version of numba is unknown to us.
    """
    return _compile_entry(kernel, arguments, symbol) if _knows_this_numba() else None


def compile_for_library(kernel: Kernel, arguments: Arguments, symbol: str) -> bytes:
    """Code like that of `compile_entry`, but such that it can stand at any address.

    ValueError if no entry can be made.
    """
    code = _compile_entry(kernel, arguments, symbol, movable=True)
    if code is None:
        raise ValueError(f"the kernel {symbol} has no entry")
    return code.code


def _compile_entry(kernel: Kernel, arguments: Arguments, symbol: str, *, movable: bool = False) -> ObjectCode | None:
    numba = _numba()
    from numba.core.compiler_lock import global_compiler_lock
    from numba.core.runtime import rtsys

    from gcodesim.compiled.entry import build_entry
    from gcodesim.compiled.object_code import ObjectCode, signature_of
    from gcodesim.compiled.shortcuts import taken

    part = _part_of(kernel)
    types = tuple(_type_of(numba, argument) for argument in arguments)
    with global_compiler_lock, taken():
        part.compile(types)
        made = part.overloads[types]
        module = build_entry(made, arguments, symbol)
        if module is None:
            return None
        codegen = _codegen()
        library = codegen.create_library(symbol)
        library.add_linking_library(made.library)
        if made.target_context.enable_nrt:
            library.add_linking_library(rtsys.library)
        library.add_linking_library(_memory())  # behind those that call it
        library.add_ir_module(module)
        final = library.link_all(symbol)
        things = (*final.functions, *final.global_variables)
        wanted = [thing.name for thing in things if thing.is_declaration and not thing.name.startswith("llvm.")]
        machine = codegen.movable if movable else codegen._tm
        return ObjectCode(symbol, signature_of(kernel, arguments), tuple(wanted), machine.emit_object(final))


@cache
def dispatcher_of(kernel: Kernel) -> Any:
    """The kernel as numba calls it, for arguments and results that an entry cannot take.

    It is compiled again in each process, since numba would keep it as a pickle, which could run anything when read.
    """
    return _jit(kernel, _compilers()["whole", kernel.lean], nogil=True)


def part_of(kernel: Kernel) -> Any:
    """The kernel as others call it."""
    return _part_of(kernel) if _knows_this_numba() else dispatcher_of(kernel)


@cache
def _part_of(kernel: Kernel) -> Any:
    """The kernel as others call it, which Python cannot call."""
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "forceinline": kernel.inlined}
    made = _jit(kernel, _compilers()["part", kernel.lean], **options)
    made.__class__ = _part_dispatcher()
    return made


@cache
def _part_dispatcher() -> Any:
    """A dispatcher that compiles once for a type; numba would do it anew for each number that is written in a call."""
    from numba.core.registry import CPUDispatcher

    unliteral = _numba().types.unliteral

    class PartDispatcher(CPUDispatcher):  # type: ignore[misc]
        def get_call_template(self, args: Any, kws: Any) -> Any:
            return super().get_call_template(tuple(map(unliteral, args)), {k: unliteral(v) for k, v in kws.items()})

    return PartDispatcher


def _jit(kernel: Kernel, compiler: Any, **options: bool) -> Any:
    """No fast-math, no parallel reductions, so results are repeatable."""
    if kernel.lean:
        options["_nrt"] = False
    return _numba().njit(error_model="numpy", pipeline_class=compiler, **options)(kernel.py_func)


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
            self.state.targetctx = context.subtarget(_internal_codegen=_codegen(), get_executable=_no_executable)

    class WholeApart(Whole):
        apart = True

    class PartApart(Part):
        apart = True

    return {("whole", False): Whole, ("whole", True): WholeApart, ("part", False): Part, ("part", True): PartApart}


@cache
def _codegen() -> Any:
    """numba's maker of machine code, for named instructions; its libraries are for linking, and not loaded."""
    import llvmlite.binding as llvm
    from numba.core.codegen import JITCodeLibrary, JITCPUCodegen

    from gcodesim.compiled.lowering import prune

    class Library(JITCodeLibrary):  # type: ignore[misc]
        """The code of one part, or of an entry with all parts that it needs.

        Parts are left as they are: linked and optimised once, in the entry. numba would do both for each part that
        calls others, so that what lies deep would be optimised once for each level above it.
        """

        def _optimize_functions(self, ll_module: Any) -> None:
            ll_module.data_layout = self._codegen._data_layout
            for function in ll_module.functions:
                if not function.is_declaration:
                    passes, builder = self._codegen._function_pass_manager()
                    passes.run(function, builder)

        def add_ir_module(self, ir_module: Any) -> None:
            prune(ir_module)
            super().add_ir_module(ir_module)

        def finalize(self) -> None:
            self._raise_if_finalized()
            self._finalized = True

        def link_all(self, symbol: str) -> Any:
            """The module with everything that is called from it, optimised; names that begin with `symbol` are seen.

            That nobody else calls the rest is known beforehand: a function that is called once becomes a part of
            its caller, and arguments that are always the same a part of the function.
            """
            for library in self._needed():
                self._final_module.link_in(library._get_module_for_linking(), preserve=True)
            for thing in (*self._final_module.functions, *self._final_module.global_variables):
                if not thing.is_declaration and not thing.name.startswith(symbol):
                    thing.linkage = "internal"
            self._optimize_final_module()
            self._final_module.verify()
            self._finalize_dynamic_globals()
            self._verify_declare_only_symbols()
            return self._final_module

        def _needed(self) -> list[Any]:
            """All libraries behind this one, each behind those that call it: LLVM leaves out what nobody calls yet."""
            found: dict[Any, None] = {}

            def visit(library: Any) -> None:
                for other in reversed(library._linking_libraries):
                    if other not in found:
                        visit(other)
                found[library] = None

            visit(self)
            return list(reversed(found))[1:]

    class Codegen(JITCPUCodegen):  # type: ignore[misc]
        _library_class = Library

        def _get_host_cpu_name(self) -> str:
            return level()

        def _get_host_cpu_features(self) -> str:
            return tuning()

    made = Codegen("gcodesim")
    target = llvm.Target.from_triple(llvm.get_process_triple())
    made.movable = target.create_target_machine(cpu=level(), features=tuning(), opt=3, reloc="pic", codemodel="small")
    return made


@cache
def _memory() -> Any:
    """The functions of `memory` as a library to be linked."""
    from gcodesim.compiled.memory import add_memory

    library = _codegen().create_library("memory")
    module = library.create_ir_module("memory")
    add_memory(module)
    library.add_ir_module(module)
    library.finalize()
    return library


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
    """The module numba."""
    import numba

    _load_without_scipy()
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
