"""Machine code of kernels: kept in files, and loaded without numba.

Loading numba and what it has cached takes 0.3 s and more, object code by LLVM
alone 0.05 s. So each kernel that Python calls has one file for each combination
of types, named after both. It begins with a hash of the rest, since LLVM ends
the process when it meets damaged code, and names what the code wants from
outside: functions of C and of Python, and small helpers of numba (arrays that a
kernel makes), whose modules load without numba itself.
"""

from __future__ import annotations

import builtins
import ctypes
import hashlib
import sys
from collections.abc import Callable
from functools import cache
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from threading import Lock
from types import FunctionType
from typing import Any, Final, NamedTuple, cast

import numpy as np

from gcodesim.compiled import Kernel, is_compiler_off
from gcodesim.compiled.arguments import ARRAY, NUMBER, OBJECTS, ORDER, TYPE, Arguments, as_text, class_of, is_named
from gcodesim.compiled.folder import folders, package, source_beside, writable_folder
from gcodesim.files.own_folder import OwnFolder


class ObjectCode(NamedTuple):
    """The function `symbol`, an entry as `entry.py` builds them, and the symbols that it wants from outside."""

    symbol: str
    wanted: tuple[str, ...]
    code: bytes


def is_kept(kernel: Kernel, arguments: Arguments) -> bool:
    """Whether a call with arguments of these types needs no compiler."""
    return not is_compiler_off() and any(folder.has(_file(kernel, arguments)) for folder in folders())


def entry_of(kernel: Kernel, arguments: Arguments) -> Callable[..., Any] | None:
    """The kernel for these types, compiled when that has not been done; None when it has to be called by numba.

    The function answers other types by NotImplemented. RuntimeError when the kernel fails, as when memory is short.
    """
    if not _arrays_are_as_known():
        return None
    for folder in folders():
        known = _read(folder, _file(kernel, arguments))
        if known is not None and (entry := load(known)) is not None:
            return entry
    from gcodesim.compiled.compiling import compile_entry

    compiled = compile_entry(kernel, arguments, _symbol(kernel, arguments))
    if compiled is None or (entry := load(compiled)) is None:
        return None
    place = writable_folder()
    if place is not None:
        place.write(_file(kernel, arguments), _sealed(compiled))
    return entry


def _file(kernel: Kernel, arguments: Arguments) -> str:
    return f"{_symbol(kernel, arguments)}.kernel"


def _symbol(kernel: Kernel, arguments: Arguments) -> str:
    """A different file for each kernel and each combination of types."""
    function = kernel.py_func
    signature = f"{function.__module__} {function.__qualname__} {kernel.lean} {as_text(arguments)}"
    code = hashlib.sha256(signature.encode() + source_beside(cast(FunctionType, function).__code__))
    return f"{function.__name__}_{code.hexdigest()[:12]}"


def _read(folder: OwnFolder, name: str) -> ObjectCode | None:
    """None if there is no such file, if somebody else can write it, or if it is damaged."""
    data = folder.read(name)
    if data is None:
        return None
    seal, _, rest = data.partition(b"\n")
    if hashlib.sha256(rest).hexdigest().encode() != seal:
        return None
    names, _, code = rest.partition(b"\n")
    symbol, *wanted = names.decode().split()
    return ObjectCode(symbol, tuple(wanted), code)


def _sealed(known: ObjectCode) -> bytes:
    """What a file holds."""
    rest = " ".join((known.symbol, *known.wanted)).encode() + b"\n" + known.code
    return hashlib.sha256(rest).hexdigest().encode() + b"\n" + rest


def load(known: ObjectCode) -> Callable[..., Any] | None:
    """The function as Python calls it; None if the code needs a symbol that is not here."""
    if not all(map(_is_there, known.wanted)):
        return None
    import llvmlite.binding as llvm

    with _LOCK:
        engine = _engine()
        engine.add_object_file(llvm.ObjectFileRef.from_data(known.code))
        engine.finalize_object()
        address = engine.get_function_address(known.symbol)
    if not address:
        return None
    method = _Method(known.symbol.encode(), address, _FASTCALL, None)
    _KEPT.append(method)
    return _new_function(ctypes.byref(method), None, None)  # type: ignore[no-any-return]


class _Method(ctypes.Structure):
    """PyMethodDef of Python's C interface."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("address", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


_FASTCALL: Final = 0x80  # METH_FASTCALL
_LOCK: Final = Lock()
_KEPT: Final[list[object]] = []  # objects that live as long as the process

_new_function = ctypes.pythonapi.PyCFunction_NewEx
_new_function.restype = ctypes.py_object
_new_function.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]


@cache
def _engine() -> Any:
    """The part of LLVM that loads object code."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(jit=True)
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)


@cache
def _is_there(name: str) -> bool:
    """Whether code may call or read what has this name, which LLVM is told here."""
    import llvmlite.binding as llvm

    address = address_of(name)
    if address:
        llvm.add_symbol(name, address)
    return address is not None


def address_of(name: str) -> int | None:
    """The address of a symbol of the code, the same one that numba uses; None if there is none."""
    if name in OBJECTS:
        return id(OBJECTS[name])
    if is_named(name):
        kind = class_of(name)
        return None if kind is None else id(kind)
    if name.startswith("PyExc_"):  # to C a variable with the address; to numba, and so here, the exception itself
        return id(getattr(builtins, name.removeprefix("PyExc_")))
    for prefix, module in _HELPERS.items():
        if name.startswith(prefix):
            return _helpers(module).get(name.removeprefix(prefix))
    mathematics = _helpers(_HELPERS["numba_"])  # of the library of C that numba was made for
    if name in mathematics:
        return mathematics[name]
    for where in (ctypes.pythonapi, ctypes.CDLL(None)):
        if hasattr(where, name):
            return ctypes.cast(getattr(where, name), ctypes.c_void_p).value
    return None


_HELPERS: Final = {"NRT_": "core/runtime/_nrt_python", "numba_": "_helperlib"}


@cache
def _helpers(module: str) -> dict[str, int]:
    """Addresses of the functions of a module of numba that is written in C; only this module is loaded."""
    loaded = sys.modules.get("numba." + module.replace("/", "."))
    if loaded is None:
        stem = package("numba") / module
        path = next(path for path in map(Path, map(f"{stem}{{}}".format, EXTENSION_SUFFIXES)) if path.exists())
        spec = spec_from_file_location(stem.name, path)
        assert spec is not None and spec.loader is not None
        loaded = module_from_spec(spec)
        spec.loader.exec_module(loaded)
        _KEPT.append(loaded)
    return loaded.c_helpers  # type: ignore[no-any-return]


@cache
def _arrays_are_as_known() -> bool:
    """Whether numpy's arrays lie in memory as the entries read them, which is as numpy's headers have it."""
    array = np.zeros((2, 3), dtype="f4")

    def read(address: int, kind: Any) -> int:
        return int(kind.from_address(address).value)

    at = {name: id(array) + offset for name, offset in ARRAY.items()}
    shape, strides, item = (read(at[name], ctypes.c_size_t) for name in ("shape", "strides", "dtype"))
    return (
        read(id(array) + TYPE, ctypes.c_size_t) == id(np.ndarray)
        and read(at["data"], ctypes.c_size_t) == array.__array_interface__["data"][0]
        and read(at["dimensions"], ctypes.c_int) == 2
        and [read(shape + 8 * axis, ctypes.c_ssize_t) for axis in (0, 1)] == [2, 3]
        and [read(strides + 8 * axis, ctypes.c_ssize_t) for axis in (0, 1)] == [12, 4]
        and item == id(array.dtype)
        and read(item + NUMBER, ctypes.c_int) == array.dtype.num
        and chr(read(item + ORDER, ctypes.c_byte)) == "="
        and read(at["flags"], ctypes.c_int) == array.flags.num
    )
