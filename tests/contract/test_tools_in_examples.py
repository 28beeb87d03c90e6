"""Every kind of tool, and every process, is used by an accepted example in both worlds, and drawn in its log.

After a new kind: write an example, `gcodesim accept` it, and run `python scripts/tools_in_examples.py`.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType

import pytest

from gcodesim.key_page import with_keys
from gcodesim.processes import PROCESSES
from gcodesim.recorder.bodies import tool_shapes
from gcodesim.tools import TOOLS

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def examples() -> ModuleType:
    sys.path.insert(0, str(ROOT / "scripts"))
    try:
        return importlib.import_module("tools_in_examples")
    finally:
        sys.path.pop(0)


@pytest.fixture(scope="module")
def table(examples: ModuleType) -> dict[str, dict[str, list[str]]]:
    found: dict[str, dict[str, list[str]]] = examples.table()
    return found


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("row", [*(f"tool {kind}" for kind in TOOLS), *(f"process {kind}" for kind in PROCESSES)])
def test_each_is_in_an_example_of_each_world(table: dict[str, dict[str, list[str]]], row: str, world: str) -> None:
    assert table[row][world], f"no accepted example in the {world} world has {row}"


def test_each_of_their_tools_is_drawn(examples: ModuleType) -> None:
    assert all(tool_shapes(use.tool) for use in examples.uses())


def test_the_table_of_the_gallery_is_up_to_date(examples: ModuleType) -> None:
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    assert with_keys(page, examples.as_text()) == page
