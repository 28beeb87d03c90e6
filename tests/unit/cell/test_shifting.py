"""A place that is moved: which one it is, and that nothing else in the file changes."""

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.cell.shifting import NotMovableError, rewritten, shifted_robot, shifted_work
from gcodesim.diagnostics import SourceText

TURNED = """# a table that is turned\r
gcodesim: 1\r
frames:\r
  room: {in: world, xyz: [500, 0, 100], rpy: [0, 0, 90]}  # the outermost\r
  table: {in: room, xyz: [0, 0, 20]}\r
robots:\r
  arm: {model: ur10e}\r
work_offsets: {G54: {in: table}, G55: {xyz: [300, 0, 0]}}\r
"""
BLOCK = """robots:
  arm:
    model: ur10e
    base:
      in: world
work_offsets:
  G54:
    in: arm/base
    xyz: [600,
      0, 0]
"""


def loaded(folder, text):
    path = folder / "cell.yaml"
    path.write_bytes(text.encode())
    return load_cell(path).cell, SourceText.read(path)


def again(folder, source):
    path = folder / "again.yaml"
    path.write_bytes(source.raw)
    result = load_cell(path)
    assert not result.findings.has_errors()
    return result.cell


def test_the_outermost_frame_is_moved_in_axes_of_its_own_frame(tmp_path):
    cell, source = loaded(tmp_path, TURNED)
    moved = shifted_work(cell, "main", "G54", np.array([0.1, -0.02, 0.003]))
    assert moved.keys == ("frames", "room")
    written = rewritten(source, moved)
    assert written.text == TURNED.replace("[500, 0, 100]", "[600, -20, 103 mm]")
    before, after = cell.frames["table"], again(tmp_path, written).frames["table"]
    assert after.p - before.p == pytest.approx([0.1, -0.02, 0.003])


def test_a_work_system_in_the_world_is_moved_itself(tmp_path):
    cell, source = loaded(tmp_path, TURNED)
    moved = shifted_work(cell, "main", "G55", np.array([0.0, 0.05, 0.0]))
    assert moved.keys == ("work_offsets", "G55")
    assert "G55: {xyz: [300, 50, 0 mm]}" in rewritten(source, moved).text


def test_entries_that_are_not_there_are_added(tmp_path):
    cell, source = loaded(tmp_path, TURNED)
    moved = shifted_robot(cell, "arm", np.array([-0.1, 0.0, 0.0]))
    written = rewritten(source, moved)
    assert "arm: {model: ur10e, base: {xyz: [-100, 0, 0 mm]}}" in written.text
    assert again(tmp_path, written).robots["arm"].X_WB.p == pytest.approx([-0.1, 0.0, 0.0])
    cell, source = loaded(tmp_path, BLOCK)
    written = rewritten(source, shifted_robot(cell, "arm", np.array([0.0, 0.25, 0.0])))
    assert again(tmp_path, written).robots["arm"].X_WB.p == pytest.approx([0.0, 0.25, 0.0])
    assert written.text.replace("      xyz: [0, 250, 0 mm]\n", "", 1).split() == BLOCK.split()


def test_a_list_over_two_lines_is_replaced(tmp_path):
    cell, source = loaded(tmp_path, BLOCK)
    moved = shifted_work(cell, "main", "G54", np.array([0.0, 0.0, 0.01]))
    assert "    xyz: [600, 0, 10 mm]\n" in rewritten(source, moved).text


def test_a_system_without_a_place_is_refused(tmp_path):
    cell, _ = loaded(tmp_path, TURNED)
    with pytest.raises(NotMovableError, match="G56"):
        shifted_work(cell, "main", "G56", np.zeros(3))
