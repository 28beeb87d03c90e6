"""`parts:` of a cell: what they are, where they lie, and that a run shows them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.cell.show import cell_as_json
from gcodesim.diagnostics import SourceText
from gcodesim.playback import Recording
from gcodesim.shop import open_shop
from tests.physics.runs import run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
frames: {pallet: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: pallet}}
parts:
  plate: {box: [100, 60, 20], mass: 2 kg, in: pallet, xyz: [10, 0, 0], rpy: [0, 0, 90], friction: 0.4}
  bolt: {cylinder: [20, 50], in: pallet}
"""


def _cell(text: str = CELL):
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))
    return loaded.cell, [(f.code, f.span.line, f.message) for f in loaded.findings]


def test_parts_are_bodies_of_the_scene_with_mass_and_friction() -> None:
    cell, found = _cell()
    assert cell is not None and not found
    scene = open_shop(cell).scene
    plate, bolt = (body for body in scene.bodies if body.role == "part")

    assert (plate.name, plate.mass, plate.friction) == ("part/plate", 2.0, 0.4)
    assert bolt.mass == pytest.approx(7850.0 * np.pi * 0.01**2 * 0.05)
    assert scene.at_rest("part/plate").p == pytest.approx([0.41, 0.3, -0.4])
    assert cell_as_json(cell)["places"]["part plate"]["xyz_mm"] == pytest.approx([410.0, 300.0, -400.0])


def test_a_slip_in_a_part_is_found_at_its_place() -> None:
    cell, found = _cell(CELL.replace("2 kg", "0 kg").replace("50], in: pallet}", "50], in: palet}"))

    assert cell is None
    assert [(code, line) for code, line, _ in found] == [("GS710", 7), ("GS712", 8)]
    assert "palet" in found[1][2]


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_parts_lie_still_in_the_log(world: str, tmp_path: Path) -> None:
    run_texts("G21 G90\nG0 X50\nM2\n", CELL, tmp_path, world=world)
    recording = Recording.open(tmp_path)
    X = recording.frames().in_world("part/plate")

    assert len(X) > 1 and np.ptp(X, axis=0).max() == 0.0
    assert X[0, :3, 3] == pytest.approx([0.41, 0.3, -0.4])
    drawn = {drawing.id: drawing.frame for _, content in recording.drawings("/scene/cell") for drawing in content}
    assert drawn["part/plate"] == "part/plate" and drawn["part/bolt"] == "part/bolt"
