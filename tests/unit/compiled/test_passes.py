"""Shortcuts through numba's passes: the machine code stays the same, with all of them and without any one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import reduce
from typing import Any, NamedTuple

import llvmlite.binding as llvm
import numpy as np
import pytest

from gcodesim.compiled import Kernel, compiling, kernel, passes, shortcuts
from gcodesim.compiled.arguments import argument_of


class Pair(NamedTuple):
    values: Any
    rows: Any


def turns(pair: Pair, count: int) -> float:
    """Variables that are set on some ways only, and whose type is known late."""
    total = 0
    last = 0
    for i in range(count):
        if i % 3:
            total = total + pair.values[i % 2]
        while last < i:
            last += 1
            if last == 5:
                break
        else:
            total -= pair.rows[0, 1]
    return total + last


def expression(values: Any) -> float:
    """Expressions of whole arrays."""
    made = 2.0 * values + values * values
    return float(made[0])


def listed(value: float) -> Any:
    """An array of a list, and one of a list that is made in a loop."""
    first = np.array([value, 2.0 * value, 1.0])
    second = np.array([value * i for i in range(4)])
    return first[1] + second[3]


def inner(value: float) -> float:
    """A function within a function."""

    def double(one: float) -> float:
        return 2.0 * one

    return double(value) + double(1.0)


def together(values: Any) -> float:
    """`reduce`, whose calls numba replaces."""
    return float(reduce(lambda one, other: one + other, values, 0.5))


ARRAY = np.array([1.5, 2.5, 4.0])
CALLS: list[tuple[Callable[..., Any], tuple[Any, ...]]] = [
    (turns, (Pair(ARRAY, np.arange(6.0).reshape(2, 3)), 7)),
    (expression, (ARRAY,)),
    (listed, (3.0,)),
    (inner, (3.0,)),
    (together, (ARRAY,)),
]


@pytest.fixture(autouse=True)
def _forget() -> Iterator[None]:
    yield
    shortcuts._shortcuts.cache_clear()


@pytest.mark.parametrize(("function", "given"), CALLS)
def test_the_machine_code_is_the_same(function: Any, given: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = instructions(function, given, monkeypatch, leave_out=passes.ALL)
    assert instructions(function, given, monkeypatch, leave_out=()) == usual


@pytest.mark.parametrize("left_out", passes.ALL)
def test_each_may_be_missing(left_out: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    function, given = CALLS[0]
    usual = instructions(function, given, monkeypatch, leave_out=passes.ALL)
    assert instructions(function, given, monkeypatch, leave_out=(left_out,)) == usual


@pytest.mark.parametrize(("function", "given"), CALLS)
def test_kernels_say_what_python_says(
    function: Any, given: Any, tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert kernel(function)(*given) == function(*given)


def test_an_error_tells_its_statement() -> None:
    def wrong(values: Any) -> Any:
        return values.a_name_that_arrays_do_not_have

    with pytest.raises(
        Exception, match=r"(?s)a_name_that_arrays_do_not_have.*typing of get attribute at .*test_passes"
    ):
        compiling._compile_entry(Kernel(wrong), (argument_of(ARRAY),), "wrong")  # type: ignore[arg-type]


def test_types_are_asked_for_again_only_where_something_is_new(monkeypatch: pytest.MonkeyPatch) -> None:
    from numba.core.typeinfer import CallConstraint

    asked = []
    resolve = CallConstraint.resolve

    def noted(self: Any, *given: Any, **named: Any) -> Any:
        asked.append(self)
        return resolve(self, *given, **named)

    monkeypatch.setattr(CallConstraint, "resolve", noted)
    counts = []
    for left_out in ((), passes.ALL):
        asked.clear()
        instructions(expression, (ARRAY,), monkeypatch, leave_out=left_out)
        counts.append(len(asked))
    assert counts[0] < 0.7 * counts[1]


def instructions(function: Any, given: Any, monkeypatch: pytest.MonkeyPatch, leave_out: tuple[Any, ...]) -> bytes:
    """The machine code of a function that is compiled without some of the shortcuts."""
    shortcuts._shortcuts.cache_clear()
    with monkeypatch.context() as patch:
        patch.setattr(shortcuts, "_ALL", [one for one in shortcuts._ALL if one not in leave_out])
        code = compiling._compile_entry(Kernel(function), tuple(map(argument_of, given)), "one")  # type: ignore[arg-type]
    assert code is not None
    parts = llvm.ObjectFileRef.from_data(code.code).sections()
    return b"".join(part.data() for part in parts if part.is_text())
