"""numba's passes over the statements of a kernel, with less work: what cannot find anything is not sought.

Each generator gives shortcuts (see `shortcuts`) with which a pass ends in the same statements and types.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from importlib import import_module
from types import TracebackType
from typing import Any, Final

Shortcut = tuple[Any, str, Any]
"""What is replaced: owner, name, and by what."""


def running() -> Iterator[Shortcut]:
    """A pass is run, and nobody is told its arguments in words nor how long it takes."""
    from numba.core.compiler_machinery import PassManager

    def run(self: Any, index: int, one: Any, state: Any) -> None:
        one.analysis = self._analysis
        for step in (one.run_initialization, one.run_pass, one.run_finalizer):
            step(state)

    PassManager("")._analysis  # noqa: B018  AttributeError where numba has changed
    yield PassManager, "_runPass", run


def contexts() -> Iterator[Shortcut]:
    """What an error says of the statement where it came up: made when there is one."""
    from numba.core import lowering, typeinfer

    say = import_module("numba.core.errors").new_error_context

    class Context:
        def __init__(self, text: str, *words: Any, **named: Any) -> None:
            self._all = text, words, named

        def __enter__(self) -> None:
            pass

        def __exit__(
            self, kind: type[BaseException] | None, error: BaseException | None, way: TracebackType | None
        ) -> None:
            if error is not None:
                text, words, named = self._all
                with say(text, *words, **named):
                    raise error

    for module in (typeinfer, lowering):
        yield module, "new_error_context", Context


def warnings() -> Iterator[Shortcut]:
    """Warnings go their usual way, not by a list for each statement."""

    class Aside:
        def __enter__(self) -> None:
            pass

        def __exit__(self, *error: object) -> None:
            pass

    nowhere = Aside()
    yield (
        import_module("numba.core.errors").WarningsFixer,
        "catch_warnings",
        lambda self, filename=None, lineno=None: nowhere,
    )


def hashes() -> Iterator[Shortcut]:
    """A type is looked up many times, and its hash is that of all its parts."""
    from numba.core.types.abstract import Type

    def hash_of(self: Any) -> int:
        try:
            known: int = self._hash_of_key
        except AttributeError:
            known = self._hash_of_key = hash(self.key)
        return known

    yield Type, "__hash__", hash_of


def lifetimes() -> Iterator[Shortcut]:
    """Which variables live where: asked where it is wanted, and not after each pass."""
    from numba.core.postproc import PostProcessor, VariableLifetime
    from numba.core.transforms import canonicalize_cfg

    run_all = PostProcessor.run
    PostProcessor._insert_var_dels  # noqa: B018  AttributeError where numba has changed

    def run(self: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
        if self.func_ir.is_generator:
            run_all(self, emit_dels, extend_lifetimes)
            return
        self.func_ir.blocks = canonicalize_cfg(self.func_ir.blocks)
        self.func_ir.variable_lifetime = VariableLifetime(self.func_ir.blocks)
        self.func_ir.generator_info = None
        if emit_dels:
            self._insert_var_dels(extend_lifetimes=extend_lifetimes)

    yield PostProcessor, "run", run


def closures() -> Iterator[Shortcut]:
    """Functions within functions, `reduce`, stencils and arrays of lists, where there are any."""
    from numba.core import ir
    from numba.core.untyped_passes import InlineClosureLikes

    inline = InlineClosureLikes.run_pass

    def run_pass(self: Any, state: Any) -> bool:
        return bool(inline(self, state)) if any(map(is_one, _values_in(state.func_ir))) else True

    def is_one(value: Any) -> bool:
        if isinstance(value, ir.Expr):
            return value.op in ("make_function", "build_list")
        if not isinstance(value, ir.Global | ir.FreeVar):
            return False
        return value.value is list or _module_of(value.value) in _INLINED

    yield InlineClosureLikes, "run_pass", run_pass


_INLINED: Final = {"functools", "_functools", "numba", "numba.stencils.stencil"}
"""Where functions come from whose calls are replaced by statements."""


def _module_of(thing: Any) -> str:
    return str(getattr(thing, "__module__", None) or getattr(thing, "__name__", ""))


def array_expressions() -> Iterator[Shortcut]:
    """Expressions of whole arrays, lists that become arrays, and parts that have a text for a name."""
    from numba.core import ir, types
    from numba.core.typed_passes import NopythonRewrites
    from numba.core.types.containers import List
    from numba.core.types.misc import StringLiteral

    rewrite = NopythonRewrites.run_pass

    def run_pass(self: Any, state: Any) -> bool:
        return bool(rewrite(self, state)) if is_needed(state) else False

    def is_needed(state: Any) -> bool:
        kinds = state.typemap
        if any(isinstance(kind, StringLiteral | List) for kind in kinds.values()):
            return True
        for block in state.func_ir.blocks.values():
            for statement in block.body:
                if type(statement) is not ir.Assign or not isinstance(statement.value, ir.Expr):
                    continue
                if statement.value.op in _MAKES and isinstance(kinds.get(statement.target.name), types.Array):
                    return True
        return False

    yield NopythonRewrites, "run_pass", run_pass


_MAKES: Final = ("unary", "binop", "inplace_binop", "call", "build_list", "arrayexpr")


def _values_in(func_ir: Any) -> Iterator[Any]:
    """What variables are set to."""
    from numba.core import ir

    for block in func_ir.blocks.values():
        for statement in block.body:
            if type(statement) is ir.Assign:
                yield statement.value


def renaming() -> Iterator[Shortcut]:
    """A name for each value of a variable: only blocks with the variable in them are gone through."""
    from numba.core import errors, ssa

    fresh, fix, lists = ssa._FreshVarHandler, ssa._FixSSAVars, ssa._CacheListVars
    rewrite, phi_places, fronts = ssa._run_block_rewrite, ssa._compute_phi_locations, ssa._iterated_domfronts
    find_names, new_state, graph_of = ssa._find_defs_violators, ssa._make_states, ssa.compute_cfg_from_blocks

    def run(blocks: Any) -> Any:
        if not blocks:
            return {}
        graph = graph_of(blocks)
        names, reached, seen = find_names(blocks, graph), fronts(graph), lists()
        places = places_of(set(names), blocks)
        for name in names:
            state = new_state(blocks) | {"varname": name, "defmap": defaultdict(list)}
            blocks = rewritten(blocks, places[name], state, fresh())
            state |= {"phimap": defaultdict(list), "cfg": graph, "phi_locations": phi_places(reached, state["defmap"])}
            blocks = rewritten(blocks, places[name], state, fix(seen))
            for place, joined in state["phimap"].items():
                blocks[place].body = joined + blocks[place].body
        if graph_of(blocks) != graph:
            raise errors.CompilerError("the order of blocks has changed")
        return blocks

    def places_of(names: set[str], blocks: Any) -> dict[str, set[int]]:
        found: dict[str, set[int]] = defaultdict(set)
        for place, block in blocks.items():
            for statement in block.body:
                for variable in statement.list_vars():
                    if variable.name in names:
                        found[variable.name].add(place)
        return found

    def rewritten(blocks: Any, places: set[int], state: Any, handler: Any) -> Any:
        new = rewrite({place: block for place, block in blocks.items() if place in places}, state, handler)
        return {place: new.get(place, block) for place, block in blocks.items()}

    yield ssa, "_run_ssa", run


def inference() -> Iterator[Shortcut]:
    """Types go from statement to statement until nothing is new: a statement that reads nothing new is left out."""
    from numba.core import typeinfer, types

    look_up = typeinfer.TypeVarMap.__getitem__

    def variable(self: Any, name: str) -> Any:
        found = look_up(self, name)
        if (read := self.__dict__.get("read")) is not None:
            read[name] = found
        return found

    ask_all = typeinfer.ConstraintNetwork.propagate

    def propagate(self: Any, inferer: Any) -> list[Any]:
        variables = inferer.typevars
        known: dict[int, list[tuple[Any, Any]]] = self.__dict__.setdefault("known", {})
        alone, errors = typeinfer.ConstraintNetwork(), []
        for place, constraint in enumerate(self.constraints):
            if place in known and all(one.type is kind for one, kind in known[place]):
                continue
            alone.constraints, variables.read = [constraint], {}
            failed = ask_all(alone, inferer)
            read = [(one, one.type) for one in variables.read.values()]
            variables.read = None
            known.pop(place, None)
            if not failed and not any(isinstance(kind, types.RecursiveCall) for _, kind in read):
                known[place] = read
            errors += failed
        return errors

    yield typeinfer.TypeVarMap, "__getitem__", variable
    yield typeinfer.ConstraintNetwork, "propagate", propagate


def inlining() -> Iterator[Shortcut]:
    """Functions of numba's own that ask to become a part of their caller: most are known not to."""
    from numba.core.typed_passes import InlineOverloads

    look, attribute = InlineOverloads._do_work_expr, InlineOverloads._get_attr_info
    known: dict[Any, bool] = {}

    def do_work(self: Any, state: Any, work_list: Any, block: Any, place: int, expr: Any, worker: Any) -> Any:
        if stays(self, state, expr):
            return False
        return look(self, state, work_list, block, place, expr, worker)

    def stays(self: Any, state: Any, expr: Any) -> bool:
        if expr.op == "call":
            kind = state.typemap.get(expr.func.name)
            method = getattr(kind, "template", None)
            return all(map(is_never, getattr(kind, "templates", None) or () if method is None else [method]))
        if expr.op == "getattr":
            key = state.typemap[expr.value.name], expr.attr
            if key not in known:
                found = attribute(self, state, expr)
                known[key] = not found or all(map(is_never, found[0]))
            return known[key]
        if expr.op in _OPERATORS:
            if expr.fn not in known:
                kind = state.typingctx.resolve_value_type(expr.fn)
                known[expr.fn] = all(map(is_never, getattr(kind, "templates", None) or ()))
            return known[expr.fn]
        return False

    def is_never(template: Any) -> bool:
        wish = getattr(template, "_inline", None)
        return wish is None or bool(wish.is_never_inline)

    yield InlineOverloads, "_do_work_expr", do_work


_OPERATORS: Final = ("unary", "binop", "inplace_binop")


ALL: Final = (
    running,
    contexts,
    warnings,
    hashes,
    lifetimes,
    closures,
    array_expressions,
    renaming,
    inference,
    inlining,
)
