"""Layers and parts of stocks: what they become, and what is wrong with them."""

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.cell.show import cell_as_text
from gcodesim.diagnostics import SourceText

HEAD = "gcodesim: 1\nmachine: gantry_xyz\nwork_offsets: {G54: {xyz: [400, 300, -300]}}\nstock:\n"
PLATE = "  plate: {box: [40, 30, 10], zero: top-center, in: G54, xyz: [1, 2, 3], rpy: [0, 0, 90]}\n"


def loaded(text):
    return read_cell(SourceText("cell.yaml", (HEAD + text).encode()), Path("cell.yaml"))


def test_a_part_stands_in_the_frame_of_its_stock():
    text = PLATE + "  pin: {cylinder: [4, 8], inside: plate, xyz: [10, 0, -2], rpy: [0, 90, 0]}\n"
    cell = loaded(text).cell
    place = cell.stocks["pin"].place

    assert place.frame == "G54"
    assert place.X.p == pytest.approx([0.001, 0.012, 0.001])
    turned = cell.stocks["plate"].place.X.R @ [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    assert np.allclose(place.X.R, turned, atol=1e-12)


def test_layers_become_stocks_and_are_shown_once():
    text = PLATE.replace("}\n", ", layers: [{height: 2, material: pvc}, {height: 1}]}\n")
    cell = loaded(text).cell

    assert list(cell.stocks) == ["plate", "plate_layer_1", "plate_layer_2"]
    assert [(s.shape.lower[2], s.shape.upper[2]) for s in list(cell.stocks.values())[1:]] == [
        (pytest.approx(-2e-3), pytest.approx(0.0)),
        (pytest.approx(-3e-3), pytest.approx(-2e-3)),
    ]
    assert cell.stocks["plate_layer_1"].place == cell.stocks["plate"].place
    shown = cell_as_text(cell)
    assert "layers: [{height: 2 mm, material: pvc}, {height: 1 mm}]" in shown
    assert "  plate_layer_1:" not in shown
    again = read_cell(SourceText("cell.yaml", shown.encode()), Path("cell.yaml"))
    assert not [f for f in again.findings if f.level.word == "error"]


@pytest.mark.parametrize(
    ("text", "code", "word"),
    [
        (PLATE + "  pin: {cylinder: [4, 8], inside: plaet}\n", "GS712", "plate"),
        (PLATE + "  pin: {cylinder: [4, 8], inside: pin}\n", "GS712", "no other stock"),
        (
            PLATE + "  pin: {cylinder: [4, 8], inside: plate}\n  core: {cylinder: [2, 8], inside: pin}\n",
            "GS719",
            "part itself",
        ),
        (PLATE.replace("}\n", ", layers: [{height: 12}]}\n"), "GS710", "12 mm"),
        (
            PLATE.replace("}\n", ", layers: [{height: 2}]}\n") + "  plate_layer_1: {cylinder: [4, 8]}\n",
            "GS719",
            "layer",
        ),
    ],
)
def test_what_is_wrong(text, code, word):
    found = [f for f in loaded(text).findings if f.level.word == "error"]
    assert [f.code for f in found] == [code]
    assert word in found[0].message + found[0].hint
    assert found[0].span.line > 4
