"""What `cell show` prints can be read again and means the same."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gcodesim.cell import load_cell, read_cell
from gcodesim.cell.show import cell_as_json, cell_as_text
from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.show import as_text
from tests.unit.cell.text import sound

TESTS = Path(__file__).parents[2]
SOUND = sorted([*(TESTS / "data" / "cells" / "sound").glob("*.yaml"), *(TESTS.parent / "cells").glob("*.yaml")])


@pytest.mark.parametrize("path", SOUND, ids=lambda path: path.stem)
def test_the_shown_cell_is_a_cell_that_means_the_same(path: Path) -> None:
    cell = load_cell(path).cell
    assert cell is not None

    again = read_cell(SourceText(cell.name, cell_as_text(cell).encode()), path)

    assert again.cell is not None, "\n".join(as_text(f, again.sources) for f in again.findings)
    shown, second = cell_as_json(cell), cell_as_json(again.cell)
    assert second["cell"] == shown["cell"]
    assert second["places"] == shown["places"]
    assert [d for d in again.cell.defaults_used if d.path[0] == "tools"] == []  # all is written now


def test_files_are_named_as_the_cell_names_them(tmp_path: Path) -> None:
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot" / "arm.urdf").write_bytes((TESTS / "data" / "cells" / "sound" / "arm.urdf").read_bytes())
    path = tmp_path / "cell.yaml"
    path.write_text("gcodesim: 1\nrobots: {arm: {urdf: robot/arm.urdf}}\n")
    cell = load_cell(path).cell
    assert cell is not None

    assert "    urdf: robot/arm.urdf\n" in cell_as_text(cell)
    assert cell_as_json(cell)["cell"]["robots"]["arm"]["urdf"] == "robot/arm.urdf"


def test_defaults_are_marked() -> None:
    text = cell_as_text(sound("machine: gantry_xyz\ntools: {1: {type: flat_end_mill, diameter: 6 mm}}"))

    assert "    flutes: 2  # default" in text
    assert "    length: 40 mm  # default: 4 times the diameter, at least 40 mm" in text
    assert "    diameter: 6 mm\n" in text


def test_assumed_accelerations_are_said() -> None:
    text = cell_as_text(sound("machine: {axes: {X: {travel: [0, 1 m], speed: 60 m/min}}}"))

    assert "acceleration: 4 m/s^2  # default: assumed: full speed in 0.25 s" in text


def test_json_has_units_in_its_names_and_no_infinity() -> None:
    cell = sound(
        "machine: gantry_xyz\nstock: {box: [4, 3, 1 in], material: al6082_t6}\nlimits: {spindle_speed: 24000 rpm}"
    )
    shown = cell_as_json(cell)

    text = json.dumps(shown, allow_nan=False)
    assert shown["cell"]["stock"]["stock"]["box_mm"] == [101.6, 76.2, 25.4]
    assert shown["cell"]["limits"] == {"spindle_speed_rpm": 24000.0}
    assert shown["cell"]["machine"]["axes"]["X"]["speed_mm_min"] == 30000.0
    assert shown["places"]["G54"]["xyz_mm"] == [600 - 50.8, 400 - 38.1, -125.4]
    assert "-0.0" not in text


def test_own_materials_are_shown_with_their_constants() -> None:
    text = cell_as_text(
        sound(
            """
            machine: gantry_xyz
            materials:
              m: {kc11: 1700 MPa, mc: 0.25}
              e: {Ktc: 631 N/mm^2, Kte: 13 N/mm, Krc: 99 N/mm^2, Kre: 10 N/mm}
            """
        )
    )

    assert "kc11: 1700 N/mm^2" in text and "normal_ratio: 0.3  # default: assumed" in text
    assert "Kte: 13 N/mm" in text
