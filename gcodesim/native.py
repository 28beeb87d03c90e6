"""A kernel as machine code of its own: compiled by numba once, from then on loaded without numba.

Loading numba and what it has cached takes 0.3 s, loading its object code by
LLVM alone 0.05 s; a command that needs one kernel only should not wait for
more than that. The object code lies in the cache folder of all kernels, whose
name says for which sources, versions and processor it was made.

Such a kernel takes C-contiguous arrays first and integers behind, and returns
an integer. Its code must be complete in itself: when anything but mathematical
functions of C is missing (as after an allocation or an exception), or anything
else goes wrong, the kernel runs by way of numba.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
from collections.abc import Callable, Sequence
from functools import cached_property
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from gcodesim.compiled import Kernel, digest
from gcodesim.user_cache import user_cache
from gcodesim.whole_file import write_whole

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_FROM_C: Final = frozenset(
    "atan2 sqrt fabs sin cos tan asin acos exp log pow floor ceil copysign fmod".split()  # noqa: SIM905
)
_NEVER_CALLED: Final = "NRT_MemInfo_call_dtor"  # frees arrays that numba has made: there are none


class ArrayType(NamedTuple):
    """Type of an array argument: numpy's name of the items, the number of dimensions, whether it is only read."""

    item: str
    dimensions: int = 1
    readonly: bool = False


class NativeKernel:
    """The kernel `name` of `module`, which takes arrays of `types` and then `integers` integers."""

    def __init__(self, module: str, name: str, types: Sequence[ArrayType], integers: int) -> None:
        self._module = module
        self._name = name
        self._types = tuple(types)
        self._integers = integers

    def is_ready(self) -> bool:
        """Whether a call needs no compiler."""
        return self._path is not None and self._path.exists()

    def prepare(self) -> None:
        """Compile, should that not be done; calls are quick from now on."""
        _ = self._function or self._kernel.compiled

    def bind(self, *arrays: NDArray[np.generic]) -> Callable[..., int]:
        """The kernel for these arrays, which have to stay alive; it is called with the integers alone."""
        function = self._function
        if function is None:
            kernel = self._kernel
            return lambda *integers: int(kernel(*arrays, *integers))
        result, problem = ctypes.c_int64(), ctypes.c_void_p()
        words: list[Any] = [ctypes.byref(result), ctypes.byref(problem)]
        for array in arrays:
            # as numba passes arrays: owner, parent, items, size of an item, data, shape, strides
            data = array.__array_interface__["data"][0]
            words += map(ctypes.c_int64, (0, 0, array.size, array.itemsize, data, *array.shape, *array.strides))
        places = [ctypes.c_int64() for _ in range(self._integers)]
        words += places

        def call(*integers: int) -> int:
            for place, integer in zip(places, integers, strict=True):
                place.value = integer
            if function(*words) != 0:
                raise RuntimeError(f"{self._name} failed")
            return result.value

        return call

    @cached_property
    def _kernel(self) -> Kernel:
        return getattr(import_module(self._module), self._name)  # type: ignore[no-any-return]

    @cached_property
    def _path(self) -> Path | None:
        """Where the object code lies or will lie; None when nothing can be kept, or nothing is to be compiled."""
        if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
            return None
        folder = user_cache(digest(version("numba")))
        signature = f"{self._module} {self._name} {self._types} {self._integers} {version('llvmlite')}"
        return folder and folder / f"{self._name}-{hashlib.sha256(signature.encode()).hexdigest()[:8]}.native"

    @cached_property
    def _function(self) -> Callable[..., int] | None:
        """The machine code; None when the kernel has to go by way of numba."""
        path = self._path
        if path is None:
            return None
        try:
            known = _unsealed(path.read_bytes()) if path.exists() else None
            if known is None:
                known = self._compile()
                if known is None:
                    return None
                write_whole(path, _sealed(*known))
            return self._load(*known)
        except (OSError, RuntimeError, ImportError, AttributeError):
            return None

    def _load(self, symbol: str, code: bytes) -> Callable[..., int]:
        import llvmlite.binding as llvm

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        abort = ctypes.cast(ctypes.CDLL(None).abort, ctypes.c_void_p).value
        llvm.add_symbol(_NEVER_CALLED, abort)
        machine = llvm.Target.from_default_triple().create_target_machine(jit=True)
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        self._engine = engine  # owns the code
        # without types of its arguments, which are ctypes' own then: converting some eighty takes twice as long
        return ctypes.CFUNCTYPE(ctypes.c_int32)(engine.get_function_address(symbol))

    def _compile(self) -> tuple[str, bytes] | None:
        """Symbol and object code; None when the code needs more than this file gives it."""
        kernel = self._kernel
        kernel.compiled  # noqa: B018  (prepares numba as for every kernel)
        import numba
        import numpy as np

        arrays = [
            numba.types.Array(numba.from_dtype(np.dtype(kind.item)), kind.dimensions, "C", readonly=kind.readonly)
            for kind in self._types
        ]
        signature = numba.int64(*arrays, *[numba.int64] * self._integers)
        compiled = numba.njit(signature, no_cpython_wrapper=True, no_cfunc_wrapper=True, error_model="numpy")(
            kernel.py_func
        )
        (result,) = compiled.overloads.values()
        declared = [line.split("@", 1)[1].split("(", 1)[0] for line in _declarations(result.library.get_llvm_str())]
        if not all(name.startswith("llvm.") or name == _NEVER_CALLED or name in _FROM_C for name in declared):
            return None
        return result.fndesc.llvm_func_name, result.library._get_compiled_object()


def _sealed(symbol: str, code: bytes) -> bytes:
    """What a file holds: a hash first, because LLVM ends the process when it meets damaged code."""
    rest = symbol.encode() + b"\n" + code
    return hashlib.sha256(rest).hexdigest().encode() + b"\n" + rest


def _unsealed(data: bytes) -> tuple[str, bytes] | None:
    """Symbol and object code; None when the file is damaged."""
    seal, _, rest = data.partition(b"\n")
    if hashlib.sha256(rest).hexdigest().encode() != seal:
        return None
    symbol, _, code = rest.partition(b"\n")
    return symbol.decode(), code


def _declarations(assembly: str) -> list[str]:
    return [line for line in assembly.splitlines() if line.startswith("declare ")]
