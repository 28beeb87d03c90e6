"""A function of Python out of the machine code of an entry, wherever that lies in memory."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any, Final

import numpy as np

from gcodesim.compiled.arguments import ARRAY, NUMBER, ORDER, TUPLE_ITEMS, TUPLE_SIZE, TYPE, objects_called


def new_function(name: str, address: int, names: int) -> Callable[..., Any] | None:
    """The function as Python calls it; None if it needs an object that is not here.

    `address` is that of an entry as `entry.py` builds them, `names` that of the text with the names of its objects.
    """
    objects = objects_called(ctypes.string_at(names).decode().split())
    if objects is None:
        return None
    method = _Method(name.encode(), address, _FASTCALL, None)
    _KEPT.append(method)
    return _new_function(ctypes.byref(method), objects, None)  # type: ignore[no-any-return]


class _Method(ctypes.Structure):
    """PyMethodDef of Python's C interface."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("address", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


_FASTCALL: Final = 0x80  # METH_FASTCALL
_KEPT: Final[list[object]] = []  # what has to live as long as the process

_new_function = ctypes.pythonapi.PyCFunction_NewEx
_new_function.restype = ctypes.py_object
_new_function.argtypes = [ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p]


@cache
def objects_are_as_known() -> bool:
    """Whether arrays and tuples lie in memory as the entries read them, which is as the headers in C have it."""
    if ctypes.sizeof(ctypes.c_void_p) != 8:
        return False
    array = np.zeros((2, 3), dtype="f4")
    pair = (array, 1.5)

    def read(address: int, kind: Any) -> int:
        return int(kind.from_address(address).value)

    if read(id(array) + TYPE, ctypes.c_size_t) != id(np.ndarray):  # what follows reads through pointers
        return False
    at = {name: id(array) + offset for name, offset in ARRAY.items()}
    shape, strides, item = (read(at[name], ctypes.c_size_t) for name in ("shape", "strides", "dtype"))
    return (
        read(at["data"], ctypes.c_size_t) == array.__array_interface__["data"][0]
        and read(at["dimensions"], ctypes.c_int) == 2
        and item == id(array.dtype)
        and [read(shape + 8 * axis, ctypes.c_ssize_t) for axis in (0, 1)] == [2, 3]
        and [read(strides + 8 * axis, ctypes.c_ssize_t) for axis in (0, 1)] == [12, 4]
        and read(item + NUMBER, ctypes.c_int) == array.dtype.num
        and chr(read(item + ORDER, ctypes.c_byte)) == "="
        and read(at["flags"], ctypes.c_int) == array.flags.num
        and read(id(pair) + TUPLE_SIZE, ctypes.c_ssize_t) == 2
        and [read(id(pair) + TUPLE_ITEMS + 8 * i, ctypes.c_size_t) for i in (0, 1)] == [id(thing) for thing in pair]
    )
