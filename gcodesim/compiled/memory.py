"""What numba has in C for the code it makes, above all memory for arrays: here a part of each piece of machine code.

A block begins with the head that numba's code knows: count of users, function that ends it, that function's
information, address of the data, size. The functions have numba's names and do what its own do (numba,
`core/runtime/nrt.cpp` and `_helperlib.c`), without its statistics and its allocators of others.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from llvmlite import ir
from numba.core import cgutils

_INT32, _INT64, _DOUBLE, _VOID = ir.IntType(32), ir.IntType(64), ir.DoubleType(), ir.VoidType()
_POINTER: Final = ir.IntType(8).as_pointer()
_PLACES: Final = _INT64.as_pointer()
_HEAD: Final = ir.LiteralStructType([_INT64, _POINTER, _POINTER, _POINTER, _INT64, _POINTER])
_USERS, _END, _INFO, _DATA, _SIZE, _OTHERS = range(6)
_HEAD_BYTES: Final = 48
_END_TYPE: Final = ir.FunctionType(_VOID, [_POINTER, _INT64, _POINTER])
_ITEM_END_TYPE: Final = ir.FunctionType(_VOID, [_POINTER])


def add_memory(module: ir.Module) -> None:
    """Define the functions in a module."""
    _Memory(module).define()


class _Memory:
    def __init__(self, module: ir.Module) -> None:
        self._module = module
        self._malloc = ir.Function(module, ir.FunctionType(_POINTER, [_INT64]), "malloc")
        self._realloc = ir.Function(module, ir.FunctionType(_POINTER, [_POINTER, _INT64]), "realloc")
        self._free = ir.Function(module, ir.FunctionType(_VOID, [_POINTER]), "free")
        self._end_of_room = self._function("gcodesim_end_of_room", _VOID, [_POINTER, _INT64, _POINTER])

    def define(self) -> None:
        self._exponents()
        self._plain()
        self._blocks()
        self._end_of_block()
        self._rooms()
        self._reshape()

    def _exponents(self) -> None:
        """Fraction and power of two of a number, and back; 0 and what is not finite stay as they are."""
        kind = ir.FunctionType(_DOUBLE, [_DOUBLE, _INT32.as_pointer()])
        split = ir.Function(self._module, kind, "frexp")
        function, b = self._begun("numba_frexp", kind.return_type, kind.args)
        value, exponent = function.args
        b.store(_INT32(0), exponent)
        with b.if_then(_is_common(b, value)):
            b.ret(b.call(split, [value, exponent]))
        b.ret(value)

        kind = ir.FunctionType(_DOUBLE, [_DOUBLE, _INT32])
        scale = ir.Function(self._module, kind, "ldexp")
        scale.args[1].add_attribute("signext")
        function, b = self._begun("numba_ldexp", kind.return_type, kind.args)
        with b.if_then(_is_common(b, function.args[0])):
            b.ret(b.call(scale, function.args))
        b.ret(function.args[0])

    def _plain(self) -> None:
        """Memory without a head."""
        function, b = self._begun("NRT_Allocate", _POINTER, [_INT64])
        b.ret(b.call(self._malloc, function.args))
        function, b = self._begun("NRT_Reallocate", _POINTER, [_POINTER, _INT64])
        b.ret(b.call(self._realloc, function.args))
        function, b = self._begun("NRT_Free", _VOID, [_POINTER])
        b.call(self._free, function.args)
        b.ret_void()

    def _blocks(self) -> None:
        """Head and data in one piece; null if there is no memory."""
        function, b = self._begun("NRT_MemInfo_alloc", _POINTER, [_INT64])
        (size,) = function.args
        block = self._some(b, b.add(size, _INT64(_HEAD_BYTES)))
        self._fill(b, block, _null(), b.gep(block, [_INT64(_HEAD_BYTES)]), size)
        b.ret(block)

        function, b = self._begun("NRT_MemInfo_alloc_aligned", _POINTER, [_INT64, _INT32])
        size, align = function.args[0], b.zext(function.args[1], _INT64)
        block = self._some(b, b.add(b.add(size, align), _INT64(_HEAD_BYTES)))
        begin = b.add(b.ptrtoint(block, _INT64), _INT64(_HEAD_BYTES))
        rest = b.urem(begin, align)
        data = b.add(begin, b.select(b.icmp_unsigned("==", rest, _INT64(0)), _INT64(0), b.sub(align, rest)))
        self._fill(b, block, _null(), b.inttoptr(data, _POINTER), size)
        b.ret(block)

    def _end_of_block(self) -> None:
        function, b = self._begun("NRT_MemInfo_call_dtor", _VOID, [_POINTER])
        (block,) = function.args
        end = self._get(b, block, _END)
        with b.if_then(b.icmp_unsigned("!=", end, _null())):
            parts = [self._get(b, block, place) for place in (_DATA, _SIZE, _INFO)]
            b.call(b.bitcast(end, _END_TYPE.as_pointer()), parts)
        b.call(self._free, [block])
        b.ret_void()

    def _rooms(self) -> None:
        """A head whose data lies elsewhere and may grow, as for lists."""
        b = ir.IRBuilder(self._end_of_room.append_basic_block())
        data, _, info = self._end_of_room.args
        with b.if_then(b.icmp_unsigned("!=", info, _null())):
            b.call(b.bitcast(info, _ITEM_END_TYPE.as_pointer()), [data])
        b.call(self._free, [data])
        b.ret_void()

        for name, more in (("NRT_MemInfo_new_varsize", []), ("NRT_MemInfo_new_varsize_dtor", [_POINTER])):
            function, b = self._begun(name, _POINTER, [_INT64, *more])
            data, block = self._some(b, function.args[0]), self._some(b, _INT64(_HEAD_BYTES))
            self._fill(b, block, b.bitcast(self._end_of_room, _POINTER), data, function.args[0])
            if more:
                b.store(function.args[1], self._place(b, block, _INFO))
            b.ret(block)

        for name, allocate in (("NRT_MemInfo_varsize_alloc", False), ("NRT_MemInfo_varsize_realloc", True)):
            function, b = self._begun(name, _POINTER, [_POINTER, _INT64])
            block, size = function.args
            if allocate:
                data = b.call(self._realloc, [self._get(b, block, _DATA), size])
            else:
                data = b.call(self._malloc, [size])
            b.store(data, self._place(b, block, _DATA))
            b.store(size, self._place(b, block, _SIZE))
            b.ret(data)

        function, b = self._begun("NRT_MemInfo_varsize_free", _VOID, [_POINTER, _POINTER])
        block, data = function.args
        b.call(self._free, [data])
        with b.if_then(b.icmp_unsigned("==", data, self._get(b, block, _DATA))):
            b.store(_null(), self._place(b, block, _DATA))
        b.ret_void()

    def _reshape(self) -> None:
        """Steps [bytes] of an array in C order that gets another shape; 0 if the array is not in C order."""
        kinds = [_INT64, _PLACES, _PLACES, _INT64, _PLACES, _PLACES, _INT64, _INT32]
        function, b = self._begun("numba_attempt_nocopy_reshape", _INT32, kinds)
        count, shape, steps, new_count, new_shape, new_steps, item, _ = function.args
        step = b.alloca(_INT64)
        b.store(item, step)
        with cgutils.for_range(b, count) as loop:
            axis = b.sub(b.sub(count, _INT64(1)), loop.index)
            length = b.load(b.gep(shape, [axis]))
            long = b.icmp_signed("!=", length, _INT64(1))
            other = b.icmp_signed("!=", b.load(b.gep(steps, [axis])), b.load(step))
            with b.if_then(b.and_(long, other)):
                b.ret(_INT32(0))
            b.store(b.mul(b.load(step), length), step)
        b.store(item, step)
        with cgutils.for_range(b, new_count) as loop:
            axis = b.sub(b.sub(new_count, _INT64(1)), loop.index)
            b.store(b.load(step), b.gep(new_steps, [axis]))
            b.store(b.mul(b.load(step), b.load(b.gep(new_shape, [axis]))), step)
        b.ret(_INT32(1))

    def _function(self, name: str, result: ir.Type, takes: Sequence[ir.Type]) -> ir.Function:
        return ir.Function(self._module, ir.FunctionType(result, takes), name)

    def _begun(self, name: str, result: ir.Type, takes: Sequence[ir.Type]) -> tuple[ir.Function, ir.IRBuilder]:
        function = self._function(name, result, takes)
        return function, ir.IRBuilder(function.append_basic_block())

    def _some(self, b: ir.IRBuilder, size: Any) -> Any:
        """Memory of this size; the function ends with null if there is none."""
        block = b.call(self._malloc, [size])
        with b.if_then(b.icmp_unsigned("==", block, _null()), likely=False):
            b.ret(_null())
        return block

    def _fill(self, b: ir.IRBuilder, block: Any, end: Any, data: Any, size: Any) -> None:
        for place, value in ((_USERS, _INT64(1)), (_END, end), (_INFO, _null()), (_DATA, data), (_SIZE, size)):
            b.store(value, self._place(b, block, place))
        b.store(_null(), self._place(b, block, _OTHERS))

    def _get(self, b: ir.IRBuilder, block: Any, place: int) -> Any:
        return b.load(self._place(b, block, place))

    def _place(self, b: ir.IRBuilder, block: Any, place: int) -> Any:
        return b.gep(b.bitcast(block, _HEAD.as_pointer()), [_INT32(0), _INT32(place)])


def _is_common(b: ir.IRBuilder, value: Any) -> Any:
    """Whether a number is neither 0 nor infinite nor none at all."""
    bits = b.shl(b.bitcast(value, _INT64), _INT64(1))  # without the sign
    infinite = _INT64(0x7FF0_0000_0000_0000 << 1)
    return b.and_(b.icmp_unsigned("!=", bits, _INT64(0)), b.icmp_unsigned("<", bits, infinite))


def _null() -> ir.Constant:
    return ir.Constant(_POINTER, None)
