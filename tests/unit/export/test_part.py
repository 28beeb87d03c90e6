"""The part at a moment, as STL."""

from io import BytesIO

import numpy as np
import pytest
import trimesh

from gcodesim.export.part import NoPartError, write_part
from gcodesim.playback import Recording
from tests.log_columns import read_columns

BLOCK = 60 * 40 * 12  # mm³


def mesh(recording, **options):
    out = BytesIO()
    written = write_part(recording, out, **options)
    found = trimesh.load(BytesIO(out.getvalue()), file_type="stl")
    assert len(found.faces) == written.triangles
    return found, written


def test_the_end_is_the_stock_as_computed(slot, slot_folder):
    out = BytesIO()

    assert write_part(slot, out).exact
    assert out.getvalue() == (slot_folder / "stock.stl").read_bytes()


def test_at_the_start_the_block_is_whole(slot):
    found, written = mesh(slot, t_ns=0)

    assert found.is_watertight and not written.exact
    assert found.volume == pytest.approx(BLOCK, rel=1e-4)


def test_half_way_as_much_is_gone_as_the_log_says(slot):
    t_ns = 9_000_000_000
    columns = read_columns(slot.log.path, "/process", ["removed_m3"])
    removed = columns["removed_m3"][np.searchsorted(columns["t_ns"], t_ns)] * 1e9
    found, _ = mesh(slot, t_ns=t_ns)

    assert found.is_watertight
    # drawn at most half a second late, at 1 mm
    assert BLOCK - found.volume == pytest.approx(removed, abs=0.25 * removed)
    assert removed > 20.0


def test_a_log_alone_gives_the_end_as_drawn(slot_folder):
    exact, _ = mesh(Recording.open(slot_folder))
    drawn, written = mesh(Recording.open(slot_folder / "run.mcap"))

    assert not written.exact and drawn.is_watertight
    assert drawn.volume == pytest.approx(exact.volume, rel=1e-3)


def test_in_the_world_the_part_stands_where_its_frame_is(slot):
    own, _ = mesh(slot, t_ns=0)
    world, _ = mesh(slot, t_ns=0, world=True)

    assert np.allclose(world.bounds - own.bounds, 1e3 * slot.frames().at("stock", 0)[:3, 3], atol=0.01)


def test_a_stock_that_is_not_there_is_refused(slot):
    with pytest.raises(NoPartError, match="it has stock"):
        mesh(slot, stock="other")
