"""`docs/cell.md` says what the reader reads."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from gcodesim.cell.cell import Cell
from gcodesim.cell.reference import SECTIONS, reference, tool_reference
from gcodesim.declarations.files import Shelf
from gcodesim.declarations.keys import Key, all_keys, keys
from gcodesim.declarations.nodes import compose
from gcodesim.declarations.reading import UNREAD, Reading
from gcodesim.diagnostics import Findings, SourceText
from gcodesim.key_page import with_keys
from gcodesim.tools import TOOLS
from gcodesim.tools.sections import Holder
from tests.unit.cell.text import sound

PAGE = Path(__file__).parents[3] / "docs" / "cell.md"


def test_the_page_is_up_to_date() -> None:
    """`python -m gcodesim.cell.reference docs/cell.md` rewrites it."""
    page = PAGE.read_text(encoding="utf-8")

    assert with_keys(page, reference()) == page


def test_every_key_of_the_top_level_is_there() -> None:
    text = reference()

    assert all(f"| `{name}`" in text for name in keys(Cell))


def declared() -> list[Key]:
    classes = [Cell, *(cls for _, cls in SECTIONS), *(TOOLS[name] for name in TOOLS), Holder]
    return list({id(key): key for cls in classes for key in all_keys(cls).values()}.values())


@pytest.mark.parametrize("key", declared(), ids=lambda key: key.name)
def test_what_a_key_is_said_to_expect_is_what_it_takes(key: Key) -> None:
    """Each example in the tables is read by the key for which it stands."""
    for example in re.findall(r"such as `([^`]+)`", key.kind.expected):
        if "…" in example or key.name in ("packages", "suppress"):  # an outline; a folder that is not there
            continue
        is_entry = re.match(r"[\w ]+: ", example)
        source = SourceText("cell.yaml", f"{key.name}: {'{' + example + '}' if is_entry else example}\n".encode())
        to = Reading(file=source.name, findings=Findings(), shelf=Shelf(folder=Path()))
        root = compose(source, to.findings)
        assert root is not None
        [(name, node)] = root.entries

        assert key.read(node, to, (name.text,)) is not UNREAD, [f.message for f in to.findings]
        assert not to.findings.has_errors()


def test_examples_of_travel_and_boxes_make_sense() -> None:
    text = reference()

    assert "[10, 10" not in text and "[30, 30" not in text
    assert "| `travel` | a list of 2 lengths such as `[0, 600 mm]` | least and greatest position |" in text


def test_the_target_has_all_its_keys() -> None:
    part = reference().partition("### `target`")[2].partition("###")[0]

    assert all(f"| `{name}`" in part for name in ("mesh", "unit", "tolerance"))


def test_another_package_gets_the_tables_of_its_tools() -> None:
    text = tool_reference(["drill"])

    assert text.startswith("### Tool type `drill`\n\n| key |") and "### Units" not in text


def test_the_examples_of_the_page_are_sound() -> None:
    examples = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)

    assert examples
    for example in examples:
        sound(example)
