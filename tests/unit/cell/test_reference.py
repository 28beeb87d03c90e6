"""`docs/cell.md` says what the reader reads."""

from __future__ import annotations

import re
from pathlib import Path

from gcodesim.cell.cell import Cell
from gcodesim.cell.reference import reference
from gcodesim.declarations.keys import keys
from gcodesim.key_page import with_keys
from tests.unit.cell.text import sound

PAGE = Path(__file__).parents[3] / "docs" / "cell.md"


def test_the_page_is_up_to_date() -> None:
    """`python -m gcodesim.cell.reference docs/cell.md` rewrites it."""
    page = PAGE.read_text(encoding="utf-8")

    assert with_keys(page, reference()) == page


def test_every_key_of_the_top_level_is_there() -> None:
    text = reference()

    assert all(f"| `{name}`" in text for name in keys(Cell))


def test_the_examples_of_the_page_are_sound() -> None:
    examples = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)

    assert examples
    for example in examples:
        sound(example)
