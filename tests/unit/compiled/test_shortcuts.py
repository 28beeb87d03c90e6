"""Kernels are compiled with less work than numba does, into code that says the same."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcodesim.compiled import compiling, kernel, shortcuts
from gcodesim.compiled.shortcuts import taken


@kernel
def item(values: Any, at: int) -> float:
    return float(values[at])


@kernel
def items(values: Any, at: int) -> float:
    return item(values, 0) + item(values, 1) + item(values, at)


@kernel
def put(values: Any, part: Any) -> float:
    values[:2] = part
    return float(values[1])


@kernel
def most(values: Any) -> float:
    return float(max((values[0], values[1])))


@kernel
def unused(values: Any) -> float:
    max((values[0], values[1]))
    return float(values[0])


@kernel
def both(values: Any) -> float:
    return unused(values) + most(values)


def test_a_kernel_is_compiled_once_for_a_type(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # nothing of it is kept
    assert items(np.array([1.0, 2.0, 4.0]), 2) == 7.0
    assert len(compiling._part_of(item).overloads) == 1


def test_arrays_of_another_shape_fail() -> None:
    assert put(np.zeros(3), np.array([1.0, 2.0])) == 2.0
    with pytest.raises(RuntimeError, match="the kernel put failed"):
        put(np.zeros(3), np.zeros(3))


def test_what_one_kernel_calls_for_nothing_another_may_need() -> None:
    assert both(np.array([1.0, 3.0])) == 4.0


def test_numba_is_left_as_it_was() -> None:
    from numba.core import targetconfig
    from numba.core.types.functions import BaseFunction
    from numba.np import arrayobj

    def found() -> list[Any]:
        return [BaseFunction.get_call_type, targetconfig.TargetConfig.values, arrayobj.raise_with_shape_context]

    before = found()
    with taken():
        assert all(inside is not outside for inside, outside in zip(found(), before, strict=True))
    assert found() == before


def test_a_shortcut_whose_place_numba_no_longer_has_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from numba.np import arrayobj

    def gone() -> Iterator[shortcuts.Shortcut]:
        yield arrayobj, "a_place_that_was_renamed", None

    def not_there() -> Iterator[shortcuts.Shortcut]:
        from numba import a_module_that_was_moved

        yield a_module_that_was_moved, "place", None

    known = len(shortcuts._shortcuts())
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(shortcuts, "_ALL", (gone, *shortcuts._ALL, not_there))
    shortcuts._shortcuts.cache_clear()
    assert len(shortcuts._shortcuts()) == known
    assert compiling._knows_this_numba.__wrapped__()
    assert kernel(items.py_func)(np.array([1.0, 2.0, 4.0]), 2) == 7.0  # type: ignore[attr-defined]
    shortcuts._shortcuts.cache_clear()
