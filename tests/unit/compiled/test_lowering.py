"""Kernels are compiled with fewer instructions than numba makes, which do the same; so do kernels without that."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from gcodesim.compiled import Kernel, as_python, compiling, kernel, shortcuts
from gcodesim.compiled.arguments import argument_of


class Pair(NamedTuple):
    values: Any
    rows: Any


def branches(pair: Pair, count: int) -> float:
    """Variables that one way to the end uses and another does not, and that are set anew."""
    total = 0.0
    row = pair.rows[0]
    for i in range(count):
        part = pair.rows[i % 2, 1:]
        if i % 3:
            total += part[-1] * row[0]
            row = pair.rows[-1]
        last = pair.values
        if total > 20.0:
            total -= last[i % 3]
        else:
            made = last * 2.0
            total += made[0]
    return total


def handed(values: Any, count: int) -> Any:
    """An array that is an argument at first and made here later."""
    row = values
    for i in range(count):
        if i % 2:
            row = row + 1.0
        elif i == 4:
            row = values[1:].copy()
    return row


def part(values: Any) -> Any:
    return values[1:]


def unpacked(pair: Pair, lengths: Any) -> Any:
    values, rows = pair
    lengths[0], lengths[1] = values.shape[0], rows.shape[1]
    for row in rows:
        lengths[2] += row[-1]
    return values[rows.shape[0] :]


def arguments() -> tuple[Any, ...]:
    values, rows = np.array([1.5, 2.5, 3.5]), np.arange(6.0).reshape(2, 3)
    return values, rows, Pair(values, rows)


def results(cache: Path) -> list[Any]:
    """What freshly compiled kernels return for each way through them, beside what Python says."""
    values, _, pair = arguments()
    found = []
    for function, calls in (
        (branches, [(pair, count) for count in range(9)]),
        (handed, [(values, count) for count in range(9)]),
        (part, [(values,)]),
        (unpacked, [(pair, np.zeros(3))]),
    ):
        made = kernel(function)
        for given in calls:
            expected = as_python(made)(*given)
            assert np.array_equal(made(*given), expected)
            found.append(expected)
    return found


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    return tmp_path


@pytest.fixture
def no_shortcuts(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(shortcuts, "_ALL", ())
    shortcuts._shortcuts.cache_clear()
    yield
    shortcuts._shortcuts.cache_clear()


def test_every_way_through_a_kernel_gives_what_python_gives(cache: Path) -> None:
    assert results(cache)


def test_it_does_so_without_shortcuts(cache: Path, no_shortcuts: None) -> None:
    assert results(cache)


def test_arrays_that_go_in_are_not_held_or_let_go(cache: Path) -> None:
    values, rows, pair = arguments()
    before = sys.getrefcount(values), sys.getrefcount(rows)
    through = kernel(handed)
    assert through(values, 1) is values
    for count in range(9):
        kernel_result = through(values, count)
        kernel(branches)(pair, count)
    del kernel_result
    assert (sys.getrefcount(values), sys.getrefcount(rows)) == before


def test_there_are_fewer_instructions(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    counts = {}
    for all_ in (shortcuts._ALL, ()):
        monkeypatch.setattr(shortcuts, "_ALL", all_)
        shortcuts._shortcuts.cache_clear()
        counts[bool(all_)] = instructions(kernel(branches), arguments()[2], 3)
    shortcuts._shortcuts.cache_clear()
    assert counts[True] < 0.75 * counts[False]


def instructions(made: Any, *given: Any) -> int:
    """How many instructions a kernel has before LLVM optimises it."""
    assert isinstance(made, Kernel)
    known = tuple(map(argument_of, given))
    library = compiling._codegen()._library_class
    texts = []
    add = library.add_llvm_module

    def noted(self: Any, module: Any) -> None:
        if self.name.endswith(made.py_func.__name__):
            texts.append(str(module))
        add(self, module)

    library.add_llvm_module = noted
    try:
        compiling.compile_entry(made, known, "counted")  # type: ignore[arg-type]
    finally:
        library.add_llvm_module = add
    return sum(text.count("\n  ") for text in texts)
