"""The size of mesh files, and what is wrong with them, is known before a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.declarations.mesh_size import bounds

CORNERS = "v 0 0 0\nv 2 0 0\nv 0 3 0\n"
FACET = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex {x} 0 0\nvertex 0 3 0\nendloop\nendfacet\n"


def size_of(folder: Path, name: str, text: str) -> object:
    file = folder / name
    file.write_text(text)
    return bounds(file, file.read_bytes())


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.obj", CORNERS + "f 1 2 3\n"),
        ("a.obj", CORNERS + "vn 0 0 1\nf 1//1 2//1 3//1\n"),
        ("a.obj", CORNERS + "f -3 -2 -1\n"),
        ("a.stl", "solid a\n" + FACET.format(x=2) + "endsolid a\n"),
    ],
)
def test_a_sound_file_has_its_corners(name: str, text: str, tmp_path: Path) -> None:
    assert size_of(tmp_path, name, text) == ((0.0, 0.0, 0.0), (2.0, 3.0, 0.0))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.obj", CORNERS + "f 1 2 99\n"),
        ("a.obj", CORNERS + "f 1 2 99999999999\n"),
        ("a.obj", CORNERS + "f -1 -2 -9\n"),
        ("a.obj", CORNERS + "f 0 1 2\n"),
        ("a.obj", CORNERS + "f 1 2 3\nf 1//0 0//2 3//0\n"),
        ("a.obj", CORNERS + "f 1 2\nf 1 2 3\n"),
        ("a.obj", CORNERS + "f /1/1 /1/1 /1/1\nf 1 2 3\n"),
        ("a.obj", "f -1 -2 -3\n" + CORNERS + "f 1 2 3\n"),
        ("a.obj", CORNERS),
        ("a.obj", CORNERS + "v nan inf 1e999\nf 1 2 4\n"),
        ("a.stl", "solid a\n" + FACET.format(x="nan") + "endsolid a\n"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 3 0\n3 0 1 7\n"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n"),
    ],
)
def test_a_damaged_file_is_told(name: str, text: str, tmp_path: Path) -> None:
    assert isinstance(size_of(tmp_path, name, text), str)
