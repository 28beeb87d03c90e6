"""What the text of every kernel keeps to: few arguments, and what belongs together has a name."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import gcodesim

ROOT = Path(gcodesim.__file__).parent
MOST = 10
"""Arguments of a kernel; what is more belongs together in some way, and becomes a named tuple."""


def kernels_in(text: str) -> Iterator[ast.FunctionDef]:
    """Functions that are declared with `kernel`, with or without options."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef):
            for decorator in node.decorator_list:
                name = decorator.func if isinstance(decorator, ast.Call) else decorator
                if isinstance(name, ast.Name) and name.id == "kernel":
                    yield node


def count_of(function: ast.FunctionDef) -> int:
    """How many arguments a function has."""
    arguments = function.args
    return len(arguments.posonlyargs) + len(arguments.args) + len(arguments.kwonlyargs)


def test_arguments_are_counted() -> None:
    text = (
        "@kernel\ndef one(a, b): ...\n"
        "@kernel(lean=True)\ndef other(a, /, b, *, c): ...\n"
        "def no_kernel(a, b, c, d): ...\n"
    )
    assert [(found.name, count_of(found)) for found in kernels_in(text)] == [("one", 2), ("other", 3)]


def test_no_kernel_takes_more_than_ten_arguments() -> None:
    found = [
        (path.relative_to(ROOT).as_posix(), function.name, count_of(function))
        for path in sorted(ROOT.rglob("*.py"))
        for function in kernels_in(path.read_text("utf-8"))
    ]

    assert len(found) > 100
    assert [kernel for kernel in found if kernel[2] > MOST] == []
