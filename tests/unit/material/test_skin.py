"""The painted skin of a part: closed, right about distance and maker, the same from its file."""

import io

import numpy as np
import pytest
import trimesh

from gcodesim.material.skin import Maker, PaintedSkin, deviations, evenly_split, middles
from gcodesim.material.skin_file import SkinFileError, colours_by, read_skin, write_skin


def box(size, middle=(0.0, 0.0, 0.0)):
    mesh = trimesh.creation.box(size)
    return np.asarray(mesh.vertices) + middle, np.asarray(mesh.faces, dtype=np.int32)


@pytest.mark.parametrize("size", [0.5, 0.11, 0.04])
def test_halving_edges_keeps_a_surface_closed(size):
    points, faces = box((1.0, 0.7, 0.05))

    fine = trimesh.Trimesh(*evenly_split(points, faces, size), process=False)

    assert fine.is_watertight and fine.is_winding_consistent
    assert fine.volume == pytest.approx(0.035, rel=1e-12) and fine.edges_unique_length.max() <= size


def test_a_face_above_the_target_is_excess_and_one_below_a_gouge():
    points, faces = evenly_split(*box((0.010, 0.010, 0.010)), 0.002)
    middle, normal = middles(points, faces)

    larger, smaller = (deviations(box((0.010, 0.010, 0.010 + d)), middle, normal) for d in (2e-4, -2e-4))

    ends = np.abs(normal[:, 2]) > 0.9
    assert larger[ends] == pytest.approx(-1e-4, abs=1e-9)
    assert smaller[ends] == pytest.approx(1e-4, abs=1e-9)
    assert np.abs(larger[~ends]).max() < 1e-9  # sides lie in those of the target


def test_the_walls_of_a_dip_in_a_floor_are_a_gouge():
    """They are as near to the floor of the target on their one side as on the other."""
    points, faces = box((0.002, 0.002, 0.001), (0.0, 0.0, 0.0045))  # the dip, from outside
    middle, normal = middles(*evenly_split(points, faces[:, ::-1], 0.0004))
    walls = (np.abs(normal[:, 2]) < 0.1) & (middle[:, 2] < 0.0049)

    found = deviations(box((0.010, 0.010, 0.010)), middle, normal)

    assert found[walls] == pytest.approx(middle[walls, 2] - 0.005, abs=1e-9)


@pytest.fixture
def skin():
    points, faces = box((0.010, 0.020, 0.030))
    return PaintedSkin(
        vertices=points,
        faces=faces,
        deviation=np.linspace(-4e-4, 4e-4, 12),
        maker=np.arange(12, dtype=np.int32) % 3 - 1,
        makers=[Maker(file="a b.nc", line=7, tool=1), Maker(file="ü.nc", line=9, tool=2)],
        turn=np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]),
        tolerance=1e-4,
        spots=np.array([[[0.0, 0.0, 0.0], [0.001, 0.002, 0.003]]]),
    )


def written(skin, what="deviation"):
    file = io.BytesIO()
    write_skin(skin, file, what)
    return file.getvalue()


def test_a_skin_comes_back_from_its_file(skin):
    back = read_skin(written(skin), "skin")

    assert np.allclose(back.vertices, skin.vertices, atol=1e-9) and (back.faces == skin.faces).all()
    assert np.allclose(back.deviation, skin.deviation, atol=1e-9) and (back.maker == skin.maker).all()
    assert [(m.file, m.line, m.tool) for m in back.makers] == [("a b.nc", 7, 1), ("ü.nc", 9, 2)]
    assert back.tolerance == pytest.approx(1e-4) and np.allclose(back.spots, skin.spots)
    assert written(back) == written(skin)


def test_other_programs_read_the_file_in_the_frame_of_the_part(skin):
    mesh = trimesh.load(io.BytesIO(written(skin)), file_type="ply", process=False)

    assert np.allclose(mesh.vertices, skin.vertices * [1e3, -1e3, -1e3]) and mesh.is_watertight


def test_colours_tell_sides_tools_and_lines_apart(skin):
    by = {what: colours_by(skin, what) for what in ("deviation", "tool", "line")}

    reds, blues = by["deviation"][skin.deviation < -3e-4], by["deviation"][skin.deviation > 3e-4]
    assert (reds[:, 0] > reds[:, 2]).all() and (blues[:, 2] > blues[:, 0]).all()
    within = by["deviation"][np.abs(skin.deviation) <= 1e-4]
    assert len(np.unique(within, axis=0)) == 1
    assert len(np.unique(by["tool"], axis=0)) == len(np.unique(by["line"], axis=0)) == 3


HARMS = [lambda raw: raw[:-1], lambda raw: raw.replace(b"makers", b"nakers"), lambda raw: b"ply\n"]


@pytest.mark.parametrize("harm", HARMS)
def test_a_damaged_file_is_refused(skin, harm):
    with pytest.raises(SkinFileError):
        read_skin(harm(written(skin)), "skin")
