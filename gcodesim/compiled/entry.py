"""The entry of a kernel: a function in machine code that takes Python's objects.

It is of the kind METH_FASTCALL of Python's C interface. It first checks whether
the number and the types of the arguments are exactly right, and returns
NotImplemented if not. Then it takes numbers and arrays out of them, calls the
kernel while other threads may run, and makes Python objects of the results.
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
    NUMBER,
    ORDER,
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


def _has_array(kind: Any) -> bool:
    return isinstance(kind, types.Array) or (isinstance(kind, types.BaseTuple) and any(map(_has_array, kind)))


class _Entry:
    """The function under construction."""

    def __init__(self, made: Any, arguments: Arguments, symbol: str) -> None:
        self._context, description = made.target_context, made.fndesc
        self._owned = _has_array(description.restype)  # an array that comes out may be one that went in
        self.module = self._context.create_module(symbol)
        kind = ir.FunctionType(_POINTER, [_POINTER, _POINTER.as_pointer(), _INT64])
        function = ir.Function(self.module, kind, symbol)
        self._b = ir.IRBuilder(function.append_basic_block("entry"))
        self._api = self._context.get_python_api(self._b)
        _, given, count = function.args

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
        if self._owned:
            for value, kind in zip(values, description.argtypes, strict=True):
                if _has_array(kind):
                    self._context.nrt.decref(self._b, kind, value)
        with self._b.if_then(status.is_error, likely=False):
            self._api.err_set_string("PyExc_RuntimeError", f"the kernel {description.qualname} failed")
            self._b.ret(_POINTER(None))
        self._b.ret(self._object(description.restype, result))

    def _demand(self, condition: ir.Value) -> None:
        """Go on when the condition holds, else return NotImplemented."""
        with self._b.if_then(self._b.not_(condition), likely=False):
            answer = self._named("_Py_NotImplementedStruct")
            self._api.incref(answer)
            self._b.ret(answer)

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
        if self._owned:
            self._api.nrt_adapt_ndarray_from_python(thing, self._b.bitcast(array._getpointer(), _POINTER))
            return array._getvalue()
        shape = self._read(thing, ARRAY["shape"], _INT64.as_pointer())
        strides = self._read(thing, ARRAY["strides"], _INT64.as_pointer())
        lengths = [self._b.load(self._b.gep(shape, [_INT64(axis)])) for axis in range(dimensions)]
        steps = [self._b.load(self._b.gep(strides, [_INT64(axis)])) for axis in range(dimensions)]
        array.meminfo = ir.Constant(array.meminfo.type, None)
        array.parent = ir.Constant(array.parent.type, None)
        array.nitems = reduce(self._b.mul, lengths, _INT64(1))
        array.itemsize = _INT64(self._context.get_abi_sizeof(self._context.get_data_type(kind.dtype)))
        array.data = self._b.bitcast(self._read(thing, ARRAY["data"], _POINTER), array.data.type)
        array.shape = cgutils.pack_array(self._b, lengths, _INT64)
        array.strides = cgutils.pack_array(self._b, steps, _INT64)
        return array._getvalue()

    def _object(self, kind: Any, value: ir.Value) -> ir.Value:
        """Python's object for a result."""
        if isinstance(kind, types.NoneType):
            return self._api.make_none()
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
        import numpy as np
        from numba.np.numpy_support import as_dtype

        dtype = np.dtype(as_dtype(kind.dtype))
        function = cgutils.get_or_insert_function(
            self.module,
            ir.FunctionType(_POINTER, [_POINTER, _POINTER, _INT32, _INT32, _POINTER]),
            "NRT_adapt_ndarray_to_python_acqref",
        )
        place = self._b.bitcast(cgutils.alloca_once_value(self._b, value), _POINTER)
        more = [self._named(ARRAY_TYPE), _INT32(kind.ndim), _INT32(1), self._named(dtype_of(dtype.str[1:]))]
        made = self._b.call(function, [place, *more])
        self._context.nrt.decref(self._b, kind, value)
        return made

    def _item(self, thing: ir.Value, number: int) -> ir.Value:
        return self._read(thing, TUPLE_ITEMS + 8 * number, _POINTER)

    def _any(self, value: ir.Value, wanted: list[ir.Value]) -> ir.Value:
        return reduce(self._b.or_, (self._b.icmp_unsigned("==", value, one) for one in wanted))

    def _read(self, thing: ir.Value, offset: int, kind: ir.Type) -> ir.Value:
        return self._b.load(self._b.bitcast(self._b.gep(thing, [_INT64(offset)]), kind.as_pointer()))

    def _named(self, name: str) -> ir.Value:
        """Address of an object of Python."""
        return self._context.get_c_value(self._b, _INT8, name)
