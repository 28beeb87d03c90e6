"""A cell in an editor."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import pytest
from documents import CELL, at

from gcodesim.cell import load_cell
from gcodesim.editor.cell_document import CellDocument
from gcodesim.editor.fixes import fixes_of


def cell(tmp_path, text=CELL):
    path = tmp_path / "cell.yaml"
    path.write_text(text)
    return CellDocument(path, text)


def offered(document, needle, nth=0):
    line, column = at(document.source.text, needle, nth)
    return [one.text for one in document.offers(line, column + len(needle))]


def test_findings_are_those_of_validate(tmp_path):
    document = cell(tmp_path, CELL.replace("tools:", "tols:").replace("6 mm", "6 deg"))

    assert document.findings == list(load_cell(document.path).findings)
    (fix,) = [fix for finding in document.findings for fix in fixes_of(finding, document.source)]
    assert (fix.text, fix.range.line) == ("tools", 3)


def test_hover(tmp_path):
    document = cell(tmp_path)
    text = document.source.text

    assert document.hover(*at(text, "tools")).text.startswith("**tools** ")
    assert document.hover(*at(text, "diameter")).text == "**diameter** cutting diameter"
    assert document.hover(*at(text, "box")).text == "**box** edge lengths"
    assert document.hover(*at(text, "6 mm")) is None


def test_offers(tmp_path):
    document = cell(tmp_path, f"{CELL}sim\nlimits:\n  spi\nsimulation: {{world: k}}\nmagazine: {{change_time: 6 s}}\n")

    assert {"simulation", "fixtures", "robots"} <= set(offered(document, "sim"))
    assert {"spindle_power", "force"} <= set(offered(document, "  spi"))
    assert {"kinematic", "bullet"} <= set(offered(document, "{world: "))
    assert {"flutes", "helix"} <= set(offered(document, "type: flat_end_mill, di"))
    assert {"flat_end_mill", "drill"} <= set(offered(document, "type: "))
    assert {"mm", "s", "N", "rpm"} <= set(offered(document, "6 s"))


def test_parts(tmp_path):
    parts = cell(tmp_path).parts()

    assert [name for name, _, _ in parts] == ["gcodesim", "machine", "stock", "tools"]
    assert parts[3][2].line == 3
    assert parts[3][2].end_line >= 5


@pytest.mark.parametrize("text", ["", "[1", "\t- a: [\x00\n", "a:\n\tb: 1\n", "tools: {1: {type: fl\n", "- a\n"])
def test_a_cell_that_cannot_be_read_has_no_parts(tmp_path, text):
    assert [name for name, *_ in cell(tmp_path, text).parts()] in ([], ["tools"])
