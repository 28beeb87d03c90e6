"""Machine code of kernels that is compiled on this machine: kept in files, and loaded without numba.

Loading numba and what it has cached takes 0.3 s and more, object code by LLVM
alone 0.05 s. So each kernel that Python calls has one file for each combination
of types, named after both. It begins with a hash of the rest, since LLVM ends
the process when it meets damaged code, and names what the code wants from
outside: functions of C and of Python.
"""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Callable, Iterator
from functools import cache
from threading import Lock
from types import FunctionType
from typing import Any, Final, NamedTuple, cast

from gcodesim import compiled
from gcodesim.compiled import Kernel, is_compiler_off, library
from gcodesim.compiled.arguments import NAMES_OF, Arguments, as_text, fields_of
from gcodesim.compiled.folder import delete_old, folders, mark_used, obstacles, writable_folder
from gcodesim.compiled.function import new_function, objects_are_as_known
from gcodesim.compiled.sources import edited_since, hash_of_sources
from gcodesim.files.own_folder import OwnFolder


class ObjectCode(NamedTuple):
    """The function `symbol`, an entry as `entry.py` builds them, and the symbols that it wants from outside.

    Its signature is the kernel's name and the types of its arguments, see `signature_of`.
    """

    symbol: str
    signature: str
    wanted: tuple[str, ...]
    code: bytes


def is_kept(kernel: Kernel, arguments: Arguments) -> bool:
    """Whether a call with arguments of these types needs no compiler."""
    symbol = symbol_of(kernel, arguments)
    return not is_compiler_off() and (library.has(symbol) or any(folder.has(_file(symbol)) for folder in folders()))


def entry_of(kernel: Kernel, arguments: Arguments) -> Callable[..., Any] | None:
    """The kernel for these types, compiled when that has not been done; None when it has to be called by numba.

    The function answers other types by NotImplemented. RuntimeError when the kernel fails, as when memory is short;
    ImportError when it has to be compiled and numba is not installed.
    """
    symbol = symbol_of(kernel, arguments)
    if not objects_are_as_known():
        return None
    if (entry := library.entry_of(symbol)) is not None:
        return entry
    return _kept_entry(symbol) or _made_entry(kernel, arguments, symbol)


def _kept_entry(symbol: str) -> Callable[..., Any] | None:
    for folder in folders():
        known = _read(folder, _file(symbol))
        if known is not None and (entry := load(known)) is not None:
            mark_used(folder)
            return entry
    return None


def _made_entry(kernel: Kernel, arguments: Arguments, symbol: str) -> Callable[..., Any] | None:
    place = writable_folder()
    delete_old()
    if compiled.when_cold is not None:
        compiled.when_cold(signature_of(kernel, arguments), "" if place else "; ".join(obstacles()))
        if (entry := _kept_entry(symbol)) is not None:
            return entry
    code = compile_and_keep(kernel, arguments, place)
    return None if code is None else load(code)


def compile_and_keep(kernel: Kernel, arguments: Arguments, place: OwnFolder | None) -> ObjectCode | None:
    """Compile the kernel for these types into a folder; None if it returns what an entry cannot.

    Code of sources that were edited since they were loaded is not kept: its name would be that of the new ones.
    """
    from gcodesim.compiled.compiling import compile_entry

    code = compile_entry(kernel, arguments, symbol_of(kernel, arguments))
    edited = edited_since(cast(FunctionType, kernel.py_func).__code__, kernel.declared_ns)
    if code is not None and place is not None and not edited:
        place.write(_file(code.symbol), _sealed(code))
    return code


def _file(symbol: str) -> str:
    return f"{symbol}{_ENDING}"


_ENDING: Final = ".kernel"


def signature_of(kernel: Kernel, arguments: Arguments) -> str:
    """Name of the kernel and the types: `package.module:function f8[1] i8`."""
    return f"{kernel.py_func.__module__}:{kernel.py_func.__qualname__} {as_text(arguments)}"


def symbol_of(kernel: Kernel, arguments: Arguments) -> str:
    """A different name for each kernel, each combination of types and each state of the sources behind it."""
    function = cast(FunctionType, kernel.py_func)
    sources = hash_of_sources(function.__code__)
    text = f"{signature_of(kernel, arguments)} {kernel.lean} {fields_of(arguments)} {sources}"
    return f"{function.__name__}_{hashlib.sha256(text.encode()).hexdigest()[:16]}"


def codes_in(folder: OwnFolder) -> Iterator[ObjectCode]:
    """All code in a folder."""
    for name in folder.names():
        if name.endswith(_ENDING) and (known := _read(folder, name)) is not None:
            yield known


def _read(folder: OwnFolder, name: str) -> ObjectCode | None:
    """None if there is no such file, if somebody else can write it, or if it is damaged."""
    data = folder.read(name)
    if data is None:
        return None
    seal, _, rest = data.partition(b"\n")
    if hashlib.sha256(rest).hexdigest().encode() != seal:
        return None
    signature, names, code = rest.split(b"\n", 2)
    symbol, *wanted = names.decode().split()
    return ObjectCode(symbol, signature.decode(), tuple(wanted), code)


def _sealed(known: ObjectCode) -> bytes:
    """What a file holds."""
    names = " ".join((known.symbol, *known.wanted))
    rest = f"{known.signature}\n{names}\n".encode() + known.code
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
        names = engine.get_global_value_address(known.symbol + NAMES_OF)
    return new_function(known.symbol, address, names) if address and names else None


_LOCK: Final = Lock()


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

    address = _address_of(name)
    if address:
        llvm.add_symbol(name, address)
    return address is not None


def _address_of(name: str) -> int | None:
    """The address of a function of Python or C; None if there is none."""
    for where in (ctypes.pythonapi, ctypes.CDLL(None)):
        if hasattr(where, name):
            return ctypes.cast(getattr(where, name), ctypes.c_void_p).value
    return None
