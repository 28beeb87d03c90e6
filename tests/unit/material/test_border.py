"""The border of the stock: nobody outside of `material` names what is in it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import get_type_hints

import pytest

from gcodesim.material.field_kernels import Columns, Field, Grid
from gcodesim.material.stock import Stock

TOP = Path(__file__).parents[3]
OUTSIDE = sorted(
    path
    for folder in ("gcodesim", "tests", "benchmarks", "scripts")
    for path in (TOP / folder).rglob("*.py")
    if not path.is_relative_to(TOP / "gcodesim/material") and not path.is_relative_to(TOP / "tests/unit/material")
)
NAMES = {*Columns._fields, *Field._fields, *Grid._fields}
"""What a field holds. Others have columns, grids and numbers too, so it counts what they are asked of."""
OF_A_FIELD = {"field", "stock", "view"}
KERNELS = "gcodesim.material.kernels"
OWN = {
    "sweep_kernels": {"CONE", "CYLINDER", "Shape"},
    "field_kernels": {"Field"},
    "column_kernels": {
        *("breadth", "column_at", "columns_of_patch", "finest", "index_at", "interval_of", "is_of_one_layer"),
        *("middle_of", "patch_room", "patches_within", "sides"),
    },
}
"""What is taken from other files with kernels: shapes of tools, and columns by what may be asked of them."""


def last_name(node: ast.expr) -> str:
    """Name of a variable, attribute or called function."""
    if isinstance(node, ast.Call):
        return last_name(node.func)
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def is_number(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int)


def taken(tree: ast.AST) -> Iterator[str]:
    """What a file takes out of a field, or imports from kernels that are not for others."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            if node.attr == "field" and last_name(node.value) in {"stock", "placed", "target"}:
                yield f"line {node.lineno}: {ast.unparse(node)}"
            if node.attr in NAMES and last_name(node.value) in OF_A_FIELD:
                yield f"line {node.lineno}: {ast.unparse(node)}"
        elif isinstance(node, ast.Subscript) and last_name(node.value) in {"field", "view"} and is_number(node.slice):
            yield f"line {node.lineno}: {ast.unparse(node)}"
        elif isinstance(node, ast.Assign) and last_name(node.value) in {"field", "view"}:
            if any(isinstance(target, ast.Tuple) for target in node.targets):
                yield f"line {node.lineno}: {ast.unparse(node)}"
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("gcodesim.material."):
            module = (node.module or "").removeprefix("gcodesim.material.")
            inner = {name.name for name in node.names} - OWN.get(module, set())
            if module.endswith("_kernels") and inner:
                yield f"line {node.lineno}: {node.module}: {sorted(inner)}"


def test_nobody_outside_names_the_arrays() -> None:
    found = [f"{path.relative_to(TOP)}, {what}" for path in OUTSIDE for what in taken(ast.parse(path.read_text()))]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "text",
    [
        "stock.field",
        "placed.stock.field.columns",
        "field.grid.dx",
        "stock.view(axis).walls",
        "lo, hi, count = field.columns",
        "field[0]",
        "columns, grid, walls, dirty, tops = field",
        "from gcodesim.material.wall_kernels import reckon_walls",
    ],
)
def test_the_test_sees_it(text: str) -> None:
    assert list(taken(ast.parse(text)))


def test_a_stock_has_no_array_but_its_field() -> None:
    """What everybody may ask for is no array that a cut changes."""
    assert set(Stock.__slots__) == {
        *(
            "doses",
            "exact",
            "field",
            "first_ridges",
            "first_walls",
            "lattice",
            "material",
            "original",
            "parting",
            "resolution",
        ),
        *("ridges", "turn", "z_range"),
    }
    assert get_type_hints(Stock.view)["return"] is Field
