"""A run opened by its folder or its log alone."""

import shutil

import numpy as np
import pytest

from gcodesim.diagnostics.plain import table_text
from gcodesim.playback import Recording, RecordingError
from gcodesim.playback.timeline import Timeline
from tests.log_columns import read_columns


def test_folder_and_log_say_the_same(slot_folder):
    by_folder, by_log = Recording.open(slot_folder), Recording.open(slot_folder / "run.mcap")

    assert by_folder.results == by_log.results and by_folder.results["status"] == "ok"
    assert by_folder.name == "slot.nc" and by_log.sources["slot.nc"].lines[2] == "T1 M6"
    assert by_folder.line_rows[0]["file"] == "slot.nc" and by_log.line_rows is None


@pytest.mark.parametrize("name", ["", "nothing.mcap", "text.mcap"])
def test_what_is_no_run_is_refused_in_words(tmp_path, name):
    (tmp_path / "text.mcap").write_text("no log")

    with pytest.raises(RecordingError, match=r"no run\.mcap|is not there|cannot be read"):
        Recording.open(tmp_path / name)


def test_the_timeline_knows_line_and_tool(slot):
    timeline = slot.timeline
    # the second tool is called in line 14
    begin, end = timeline.span_of_lines(14, 14, slot.end_ns)
    before, after = timeline.at(np.array([begin - 1, end]))

    assert timeline.modals[timeline.modal[before]].tool == 1
    assert timeline.modals[timeline.modal[after]].tool == 2
    assert end - begin == 4_000_000_000  # the change
    assert timeline.span_of_lines(1, 1, slot.end_ns) is None  # a comment


def test_the_tip_is_where_the_tree_of_frames_has_it(slot):
    tree = slot.frames()
    tcp = read_columns(slot.log.path, "/tcp", ["pose.position.x", "pose.position.y", "pose.position.z"])
    truth = np.stack([tcp[f"pose.position.{axis}"] for axis in "xyz"], axis=1)
    # flange and tool length lead there, too
    X_WT = tree.in_world("tool")

    assert np.allclose(tree.in_world("tcp")[:, :3, 3], truth, atol=1e-12)
    assert np.allclose(X_WT[:, :3, 3], truth, atol=1e-9)
    assert np.allclose(tree.at("tcp", int(tcp["t_ns"][40]))[:3, 3], truth[40])


def test_stock_at_a_moment_is_the_last_one_drawn(slot):
    first = sum(len(shape.triangles) for drawing in slot.stock_at(0) for shape in drawing.shapes)
    last = sum(len(shape.triangles) for drawing in slot.stock_at(slot.end_ns) for shape in drawing.shapes)

    assert len(slot.stock_at(0)) == len(slot.stock_at(slot.end_ns)) == len(slot.tile_topics)
    assert last > first > 0


def test_rows_of_a_program_whose_name_has_hidden_characters_are_found(slot_folder, tmp_path, monkeypatch):
    folder = tmp_path / "run"
    shutil.copytree(slot_folder, folder)
    table = folder / "lines.csv"
    name = "=a\n::error::b\x1b[2J.nc"
    table.write_text(table.read_text().replace("slot.nc", table_text(name)))
    monkeypatch.setattr(Timeline, "files", lambda _: (name,))

    assert {row["file"] for row in Recording.open(folder).line_rows} == {name}
