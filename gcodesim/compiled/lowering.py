"""Statements of kernels as instructions of LLVM: as numba does it, with half as many of them.

numba keeps most variables in memory, takes tuples apart and puts them together again with each call, copies an array
into memory to index it, and leaves it to LLVM to find out what of that is needed. Here a value that is known is taken
as it is, and what nobody needs is not handed on. What LLVM makes of it in the end is the same.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Final

from llvmlite import ir
from llvmlite.ir import instructions as made_by


@cache
def lower_class() -> Any:
    """numba's maker of instructions for a function, with our builder and fewer variables in memory."""
    from numba import types
    from numba.core.ir import Arg, Del, Expr, Var
    from numba.core.lowering import Lower

    for name in ("_find_singly_assigned_variable", "lower_assign", "lower_inst", "setup_function", "storevar"):
        getattr(Lower, name)  # AttributeError where numba has changed

    class ShortLower(Lower):  # type: ignore[misc]
        def setup_function(self, fndesc: Any) -> None:
            super().setup_function(fndesc)
            self.builder = _Builder(self.entry_block)
            self.call_helper = self.call_conv.init_call_helper(self.builder)

        def _find_singly_assigned_variable(self) -> None:
            super()._find_singly_assigned_variable()
            self._lent: set[str] = set()
            once = _made_once(self.func_ir)
            for name, value in once.items():
                if self._is_lent(value):
                    self._lent.add(name)
            self._singly_assigned_vars.update(name for name in once if not self._is_counted(name))

        def _is_lent(self, value: Any) -> bool:
            """Whether an array lives longer than this function, as one of its arguments or a part or row of one."""
            if isinstance(value, Arg):
                return True
            if isinstance(value, Var):
                return value.name in self._lent
            if not (isinstance(value, Expr) and value.op in _PARTS and value.value.name in self._lent):
                return False
            if isinstance(self.typeof(value.value.name), types.BaseTuple):
                return True
            if value.op in ("getattr", "exhaust_iter"):
                return False
            index = value.index if value.op == "getitem" else value.index_var
            return index is not None and _is_row(self.typeof(index.name))

        def lower_assign(self, ty: Any, inst: Any) -> Any:
            if inst.target.name not in self._lent:
                return super().lower_assign(ty, inst)
            counts, self.context.enable_nrt = self.context.enable_nrt, False
            try:
                return super().lower_assign(ty, inst)
            finally:
                self.context.enable_nrt = counts

        def storevar(self, value: Any, name: str, argidx: Any = None) -> None:
            if name in self._singly_assigned_vars or self._is_counted(name):
                super().storevar(value, name, argidx)
            else:
                self._alloca_var(name, self.typeof(name))
                self.builder.store(value, self.getvar(name))

        def lower_inst(self, inst: Any) -> None:
            if not isinstance(inst, Del) or self._is_counted(inst.value):
                super().lower_inst(inst)

        def _is_counted(self, name: str) -> bool:
            """Whether references to what is in a variable are counted, so that the end of its life matters."""
            if name in self._lent or not self.context.enable_nrt:
                return False
            return _has_references(self.context.data_model_manager, self.typeof(name))

    return ShortLower


_PARTS: Final = ("getattr", "getitem", "static_getitem", "exhaust_iter")


def _is_row(index: Any) -> bool:
    """Whether an index of this type takes a part of an array, not numbers from here and there in a new one."""
    from numba import types

    parts = index.types if isinstance(index, types.BaseTuple) else (index,)
    return all(isinstance(part, types.Integer | types.SliceType) for part in parts)


@cache
def _has_references(models: Any, kind: Any) -> bool:
    return bool(models[kind].contains_nrt_meminfo())


def _made_once(func_ir: Any) -> dict[str, Any]:
    """Variables that are set in one place, which every path to a use of them goes through before, and to what."""
    from numba.core.analysis import compute_cfg_from_blocks, compute_use_defs, must_use_alloca
    from numba.core.ir import Assign

    if func_ir.func_id.is_generator:
        return {}
    made: dict[str, list[tuple[int, Any]]] = {}
    for place, block in sorted(func_ir.blocks.items()):
        for statement in block.find_insts(Assign):
            made.setdefault(statement.target.name, []).append((place, statement.value))
    used: dict[str, list[int]] = {}  # where a variable is used that comes from elsewhere, or before it is set
    for place, names in compute_use_defs(func_ir.blocks).usemap.items():
        for name in names:
            used.setdefault(name, []).append(place)
    above = compute_cfg_from_blocks(func_ir.blocks).dominators()
    in_memory = must_use_alloca(func_ir.blocks)
    found = {}
    for name, ((home, value), *others) in made.items():
        # blocks are lowered in the order of their places
        if not others and name not in in_memory and all(home < at and home in above[at] for at in used.get(name, ())):
            found[name] = value
    return found


class _Builder(ir.IRBuilder):  # type: ignore[misc]
    """Finds again what was put into a tuple or an array, without an instruction."""

    def extract_value(self, agg: Any, idx: Any, name: str = "") -> Any:
        path = tuple(idx) if isinstance(idx, list | tuple) else (idx,)
        while path and (part := _part_of(agg, path[0])) is not None:
            agg, path = part, path[1:]
        return super().extract_value(agg, path, name) if path else agg


def _part_of(whole: Any, number: int) -> Any:
    """What was put into a value as its part `number`; None if that is not known."""
    while isinstance(whole, made_by.InsertValue) and len(whole.indices) == 1:
        if whole.indices[0] == number:
            return whole.value
        whole = whole.aggregate
    return None


def array_maker(make_array: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """numba's way to the fields of an array, by the value where it is known; `make_array` goes through memory."""

    @cache
    def make(kind: Any) -> Any:
        through_memory = make_array(kind)
        if kind.as_array is not kind or kind.ndim == 0:
            return through_memory

        def array(context: Any, builder: Any, value: Any = None, ref: Any = None) -> Any:
            if value is None or ref is not None:
                return through_memory(context, builder, value, ref)
            return _ArrayValue(context, builder, value, kind, through_memory)

        return array

    return make


class _ArrayValue:
    """The fields of an array; it goes into memory as soon as anything but a field is wanted of it."""

    def __init__(self, context: Any, builder: Any, value: Any, kind: Any, through_memory: Any) -> None:
        self.__dict__["_field"] = lambda name: builder.extract_value(
            value, context.data_model_manager[kind].get_field_position(name)
        )
        self.__dict__["_in_memory"] = cache(lambda: through_memory(context, builder, value))
        self.__dict__["_value"] = value

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or self._in_memory.cache_info().currsize:
            return getattr(self._in_memory(), name)
        return self._field(name)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self._in_memory(), name, value)


def index_fixer(fix_index: Callable[..., Any]) -> Callable[..., Any]:
    """How numba counts a negative index from the end: a number that is written in the kernel is known not to be one."""

    def fix(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
        from numba.core import types

        if isinstance(index, ir.Constant) and isinstance(index.constant, int) and index.constant >= 0:
            return context.cast(builder, index, kind, types.intp)
        return fix_index(context, builder, kind, index, size)

    return fix


def prune(module: ir.Module) -> None:
    """Drop instructions whose result nobody needs."""
    for function in module.functions:
        everything = [one for block in function.blocks for one in block.instructions]
        needed = {id(one) for one in everything if not _is_droppable(one)}
        ahead = [one for one in everything if id(one) in needed]
        while ahead:
            one = ahead.pop()
            for operand in (value for value, _ in one.incomings) if isinstance(one, made_by.PhiInstr) else one.operands:
                if isinstance(operand, made_by.Instruction) and id(operand) not in needed:
                    needed.add(id(operand))
                    ahead.append(operand)
        for block in function.blocks:
            block.instructions[:] = [one for one in block.instructions if id(one) in needed]


def _is_droppable(instruction: Any) -> bool:
    return instruction.opname in _DROPPABLE


_MEMORY: Final = {"alloca", "load", "getelementptr", "insertvalue", "extractvalue"}
_NUMBERS: Final = {"add", "sub", "mul", "and", "or", "xor", "fadd", "fsub", "fmul", "icmp", "fcmp", "select"}
_KINDS: Final = {"bitcast", "zext", "sext", "trunc", "sitofp", "fpext"}
_DROPPABLE: Final = _MEMORY | _NUMBERS | _KINDS
"""Instructions that do nothing but make a value. Nothing is loaded for another reason: no kernel shares memory."""
