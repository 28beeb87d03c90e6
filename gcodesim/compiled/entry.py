"""The entry of a kernel: a function in machine code that takes Python's objects.

It is of the kind METH_FASTCALL of Python's C interface. It first checks whether
the number and the types of the arguments are exactly right, and returns
NotImplemented if not. Then it takes numbers and arrays out of them, calls the
kernel while other threads may run, and makes Python objects of the results.

Its `self` is a tuple of all objects of Python that it needs, so machine code
contains no address of this process; their names are a text beside the entry.
"""

from __future__ import annotations

from functools import reduce
from typing import Any, Final

import numba
from llvmlite import ir
from numba.core import cgutils

from gcodesim.compiled.arguments import (
    ARRAY,
    ARRAY_TYPE,
    EMPTY,
    FAILURE,
    NAMES_OF,
    NONE,
    NUMBER,
    ORDER,
    OTHER_TYPES,
    TUPLE_ITEMS,
    TUPLE_SIZE,
    TUPLE_TYPE,
    TYPE,
    Argument,
    Arguments,
    dtype_numbers,
    dtype_of,
    name_of,
    types_of,
)

types: Any = numba.types
_C_ORDER, _ALIGNED, _WRITEABLE = 0x1, 0x100, 0x400  # flags of numpy's arrays
_INT8, _INT32, _INT64 = ir.IntType(8), ir.IntType(32), ir.IntType(64)
_POINTER: Final = _INT8.as_pointer()


def build_entry(made: Any, arguments: Arguments, symbol: str) -> ir.Module | None:
    """The entry `symbol` of what numba has made of a kernel for these types; None when its result has no known type."""
    if not _is_known(made.fndesc.restype):
        return None
    return _Entry(made, arguments, symbol).module


def _is_known(kind: Any) -> bool:
    if isinstance(kind, types.BaseTuple):
        named = isinstance(kind, types.BaseNamedTuple)
        return all(map(_is_known, kind)) and not (named and name_of(kind.instance_class) is None)
    if isinstance(kind, types.Array):
        return isinstance(kind.dtype, types.Integer | types.Float | types.Boolean) and kind.layout == "C"
    return isinstance(kind, types.Integer | types.Float | types.Boolean | types.NoneType)


class _Entry:
    """The function under construction."""

    def __init__(self, made: Any, arguments: Arguments, symbol: str) -> None:
        self._context, description = made.target_context, made.fndesc
        self._names: list[str] = []
        self.module = self._context.create_module(symbol)
        kind = ir.FunctionType(_POINTER, [_POINTER, _POINTER.as_pointer(), _INT64])
        function = ir.Function(self.module, kind, symbol)
        self._b = ir.IRBuilder(function.append_basic_block("entry"))
        self._api = self._context.get_python_api(self._b)
        self._objects, given, count = function.args

        self._demand(self._b.icmp_signed("==", count, _INT64(len(arguments))))
        objects = [self._b.load(self._b.gep(given, [_INT64(i)])) for i in range(len(arguments))]
        for thing, argument in zip(objects, arguments, strict=True):
            self._look_at(thing, argument)
        pairs = zip(objects, arguments, description.argtypes, strict=True)
        values = [self._value(thing, argument, kind) for thing, argument, kind in pairs]

        convention = self._context.call_conv
        kind = convention.get_function_type(description.restype, description.argtypes)
        kernel = ir.Function(self.module, kind, description.llvm_func_name)
        thread = self._api.save_thread()
        # not put into the entry, so that it is the same code whoever calls it
        status, result = convention.call_function(
            self._b, kernel, description.restype, description.argtypes, values, attrs=("noinline",)
        )
        self._api.restore_thread(thread)
        with self._b.if_then(status.is_error, likely=False):
            self._api.err_set_string(self._named(FAILURE), f"the kernel {description.qualname} failed")
            self._b.ret(_POINTER(None))
        self._b.ret(self._object(description.restype, result))
        self._write_names(f"{symbol}{NAMES_OF}")

    def _demand(self, condition: ir.Value) -> None:
        """Go on when the condition holds, else return NotImplemented."""
        with self._b.if_then(self._b.not_(condition), likely=False):
            self._b.ret(self._own(self._named(OTHER_TYPES)))

    def _look_at(self, thing: ir.Value, argument: Argument) -> None:
        """Demand that an object is of the type."""
        known = self._read(thing, TYPE, _POINTER)
        if argument.parts is not None:
            self._demand(self._any(known, [self._named(argument.named or TUPLE_TYPE)]))
            self._demand(self._any(self._read(thing, TUPLE_SIZE, _INT64), [_INT64(len(argument.parts))]))
            for i, part in enumerate(argument.parts):
                self._look_at(self._item(thing, i), part)
            return
        if argument.dimensions is None:
            self._demand(self._any(known, [self._named(name) for name in types_of(argument.item)]))
            return
        self._demand(self._any(known, [self._named(ARRAY_TYPE)]))
        flags = self._b.and_(self._read(thing, ARRAY["flags"], _INT32), _INT32(_C_ORDER | _ALIGNED | _WRITEABLE))
        wanted = _C_ORDER | _ALIGNED | (0 if argument.readonly else _WRITEABLE)
        self._demand(self._b.icmp_unsigned("==", flags, _INT32(wanted)))
        dimensions = self._read(thing, ARRAY["dimensions"], _INT32)
        self._demand(self._b.icmp_unsigned("==", dimensions, _INT32(argument.dimensions)))
        dtype = self._read(thing, ARRAY["dtype"], _POINTER)
        with self._b.if_then(self._b.icmp_unsigned("!=", dtype, self._named(dtype_of(argument.item))), likely=False):
            numbers = [_INT32(number) for number in dtype_numbers(argument.item)]
            self._demand(self._any(self._read(dtype, NUMBER, _INT32), numbers))
            orders = [_INT8(ord(order)) for order in "=|"]
            self._demand(self._any(self._read(dtype, ORDER, _INT8), orders))

    def _value(self, thing: ir.Value, argument: Argument, kind: Any) -> ir.Value:
        """What the kernel gets for an object."""
        if argument.parts is not None:
            parts = zip(argument.parts, kind, strict=True)
            values = [self._value(self._item(thing, i), part, its) for i, (part, its) in enumerate(parts)]
            return self._context.make_tuple(self._b, kind, values)
        if argument.dimensions is not None:
            return self._array(thing, argument.dimensions, kind)
        if isinstance(kind, types.Boolean):
            return self._b.icmp_signed("!=", self._api.object_istrue(thing), _INT32(0))
        if isinstance(kind, types.Float):
            number = self._api.float_as_double(thing)
            return number if kind.bitwidth == 64 else self._b.fptrunc(number, ir.FloatType())
        if kind == types.uint64:
            return self._api.long_as_ulonglong(self._api.number_long(thing))
        number = self._api.long_as_longlong(thing)
        with self._b.if_then(self._b.icmp_signed("==", number, _INT64(-1)), likely=False):
            failed = cgutils.is_not_null(self._b, self._api.err_occurred())
            with self._b.if_then(failed, likely=False):
                self._b.ret(_POINTER(None))
        return number if kind.bitwidth == 64 else self._b.trunc(number, ir.IntType(kind.bitwidth))

    def _array(self, thing: ir.Value, dimensions: int, kind: Any) -> ir.Value:
        array = self._context.make_array(kind)(self._context, self._b)
        shape = self._read(thing, ARRAY["shape"], _INT64.as_pointer())
        strides = self._read(thing, ARRAY["strides"], _INT64.as_pointer())
        lengths = [self._b.load(self._b.gep(shape, [_INT64(axis)])) for axis in range(dimensions)]
        steps = [self._b.load(self._b.gep(strides, [_INT64(axis)])) for axis in range(dimensions)]
        array.meminfo = ir.Constant(array.meminfo.type, None)
        array.parent = self._b.bitcast(thing, array.parent.type)  # so that it is known when it comes out again
        array.nitems = reduce(self._b.mul, lengths, _INT64(1))
        array.itemsize = _INT64(self._context.get_abi_sizeof(self._context.get_data_type(kind.dtype)))
        array.data = self._b.bitcast(self._read(thing, ARRAY["data"], _POINTER), array.data.type)
        array.shape = cgutils.pack_array(self._b, lengths, _INT64)
        array.strides = cgutils.pack_array(self._b, steps, _INT64)
        return array._getvalue()

    def _object(self, kind: Any, value: ir.Value) -> ir.Value:
        """Python's object for a result."""
        if isinstance(kind, types.NoneType):
            return self._own(self._named(NONE))
        if isinstance(kind, types.BaseTuple):
            tuple_ = self._api.tuple_new(len(kind))
            for i, item in enumerate(kind):
                self._api.tuple_setitem(tuple_, i, self._object(item, self._b.extract_value(value, i)))
            if not isinstance(kind, types.BaseNamedTuple):
                return tuple_
            named = self._api.call(self._named(str(name_of(kind.instance_class))), args=tuple_)
            self._api.decref(tuple_)
            return named
        if isinstance(kind, types.Array):
            return self._array_object(kind, value)
        return self._api.from_native_value(kind, value)

    def _array_object(self, kind: Any, value: ir.Value) -> ir.Value:
        """The array that went in if it is that, else a new one of numpy with the same numbers."""
        array = self._context.make_array(kind)(self._context, self._b, value)
        lengths = [self._b.extract_value(array.shape, axis) for axis in range(kind.ndim)]
        parent = self._b.bitcast(array.parent, _POINTER)
        place = cgutils.alloca_once_value(self._b, parent)
        with self._b.if_else(self._is_whole(parent, kind, self._b.bitcast(array.data, _POINTER), lengths)) as (
            old,
            new,
        ):
            with old:
                self._own(parent)
            with new:
                self._b.store(self._copy(kind, array, lengths), place)
        if self._context.enable_nrt:
            self._context.nrt.decref(self._b, kind, value)
        return self._b.load(place)

    def _is_whole(self, parent: ir.Value, kind: Any, data: ir.Value, lengths: list[ir.Value]) -> ir.Value:
        """Whether `parent` is an array with these data, and not null."""
        place = cgutils.alloca_once_value(self._b, ir.Constant(ir.IntType(1), 0))
        with self._b.if_then(self._b.icmp_unsigned("!=", parent, _POINTER(None))):
            dimensions = self._read(parent, ARRAY["dimensions"], _INT32)
            same = [
                self._b.icmp_unsigned("==", self._read(parent, ARRAY["data"], _POINTER), data),
                self._b.icmp_unsigned("==", dimensions, _INT32(kind.ndim)),
                self._any(self._read(self._read(parent, ARRAY["dtype"], _POINTER), NUMBER, _INT32), _numbers_of(kind)),
            ]
            with self._b.if_then(reduce(self._b.and_, same)):
                shape = self._read(parent, ARRAY["shape"], _INT64.as_pointer())
                ends = [self._b.load(self._b.gep(shape, [_INT64(axis)])) for axis in range(kind.ndim)]
                equal = [self._b.icmp_unsigned("==", *pair) for pair in zip(ends, lengths, strict=True)]
                self._b.store(reduce(self._b.and_, equal, ir.Constant(ir.IntType(1), 1)), place)
        return self._b.load(place)

    def _copy(self, kind: Any, array: Any, lengths: list[ir.Value]) -> ir.Value:
        """A new array; the entry ends with Python's error when there is no memory."""
        shape = self._api.tuple_new(len(lengths))
        for axis, length in enumerate(lengths):
            self._api.tuple_setitem(shape, axis, self._api.long_from_longlong(length))
        made = self._api.call_function_objargs(self._named(EMPTY), [shape, self._named(dtype_of(_item_of(kind)))])
        self._api.decref(shape)
        with self._b.if_then(cgutils.is_null(self._b, made), likely=False):
            self._b.ret(_POINTER(None))
        size = self._b.mul(array.nitems, array.itemsize)
        into = self._read(made, ARRAY["data"], _POINTER)
        cgutils.raw_memcpy(self._b, into, self._b.bitcast(array.data, _POINTER), size, 1)
        return made

    def _item(self, thing: ir.Value, number: int) -> ir.Value:
        return self._read(thing, TUPLE_ITEMS + 8 * number, _POINTER)

    def _any(self, value: ir.Value, wanted: list[ir.Value]) -> ir.Value:
        return reduce(self._b.or_, (self._b.icmp_unsigned("==", value, one) for one in wanted))

    def _read(self, thing: ir.Value, offset: int, kind: ir.Type) -> ir.Value:
        return self._b.load(self._b.bitcast(self._b.gep(thing, [_INT64(offset)]), kind.as_pointer()))

    def _own(self, thing: ir.Value) -> ir.Value:
        self._api.incref(thing)
        return thing

    def _named(self, name: str) -> ir.Value:
        """An object of Python."""
        if name not in self._names:
            self._names.append(name)
        return self._read(self._objects, TUPLE_ITEMS + 8 * self._names.index(name), _POINTER)

    def _write_names(self, symbol: str) -> None:
        text = cgutils.make_bytearray(" ".join(self._names).encode() + b"\0")
        names = ir.GlobalVariable(self.module, text.type, symbol)
        names.initializer, names.global_constant = text, True


def _item_of(kind: Any) -> str:
    import numpy as np
    from numba.np.numpy_support import as_dtype

    return np.dtype(as_dtype(kind.dtype)).str[1:]


def _numbers_of(kind: Any) -> list[ir.Value]:
    return [_INT32(number) for number in dtype_numbers(_item_of(kind))]
