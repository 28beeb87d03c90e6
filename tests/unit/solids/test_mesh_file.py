"""Meshes out of files, which are read when somebody asks for them, and no other file with them."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from gcodesim.solids import Mesh, MeshError, MeshFile, read_mesh

MM = 1e-3


def test_reading_a_file(tmp_path: Path) -> None:
    trimesh.creation.box((30, 20, 10)).export(tmp_path / "block.stl")
    vertices, faces = read_mesh(tmp_path / "block.stl", MM)
    assert Mesh.of(vertices, faces).volume == pytest.approx(6000 * MM**3, rel=1e-6)


def test_a_binary_stl_is_read_as_the_library_reads_it_and_without_it(tmp_path: Path) -> None:
    trimesh.creation.icosphere(2, 0.7).export(tmp_path / "ball.stl")
    raw = (tmp_path / "ball.stl").read_bytes()
    theirs = trimesh.load(io.BytesIO(raw), file_type="stl", process=False)
    code = (
        "import sys\nfrom pathlib import Path\nfrom gcodesim.solids import read_mesh\n"
        "points, faces = read_mesh(Path(sys.argv[1]))\nassert 'trimesh' not in sys.modules\n"
        "sys.stdout.buffer.write(points[faces].tobytes())"
    )
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path / "ball.stl")], capture_output=True, check=True)
    assert done.stdout == np.asarray(theirs.triangles, dtype=np.float64).tobytes()


@pytest.mark.parametrize("cut", [1, 50])
def test_a_binary_stl_that_is_cut_off_is_refused(tmp_path: Path, cut: int) -> None:
    trimesh.creation.box((30, 20, 10)).export(tmp_path / "block.stl")
    (tmp_path / "block.stl").write_bytes((tmp_path / "block.stl").read_bytes()[:-cut])
    with pytest.raises(MeshError, match=r"block\.stl"):
        read_mesh(tmp_path / "block.stl")


def test_a_mesh_opens_no_other_file(tmp_path: Path) -> None:
    """Not the file of materials that an OBJ names, which may lie anywhere and be a pipe that never ends."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "m.obj").write_text(
        "mtllib pipe\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl a\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    )
    vertices, faces = read_mesh(tmp_path / "m.obj")
    assert len(vertices) == len(faces) == 4


def test_a_file_is_read_when_somebody_asks_and_scaled_along_each_axis(tmp_path: Path) -> None:
    mesh = Mesh(source=MeshFile(path=tmp_path / "block.stl", scale=(MM, 2.0 * MM, MM)))
    trimesh.creation.box((30, 20, 10)).export(tmp_path / "block.stl")

    assert mesh.bounds == ((-0.015, -0.02, -0.005), (0.015, 0.02, 0.005))


def test_a_file_without_triangles_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty.obj").write_text("v 0 0 0\n")

    with pytest.raises(ValueError, match=r"empty\.obj"):
        read_mesh(tmp_path / "empty.obj")


def test_corners_counted_backwards_count_from_their_face(tmp_path: Path) -> None:
    """Not from the end of the file: two triangles of their own, as a program writes them that knows no total."""
    (tmp_path / "two.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 \\\n -1 # first\nv 0 0 5\nv 1 0 5\nv 0 1 5\n f -3//7 -2/2 -1\n"
    )
    vertices, faces = read_mesh(tmp_path / "two.obj")
    assert vertices[faces][:, :, 2].tolist() == [[0.0, 0.0, 0.0], [5.0, 5.0, 5.0]]


@pytest.mark.parametrize(
    ("face", "message"),
    [
        ("f 0 1 2", "line 4 names corner 0, but corners count from 1"),
        ("f 1 2 4", "line 4 names corner 4, but there are 3"),
        ("f 1 2 -4", "line 4 names corner -4, but there are 3"),
        ("f 1 2", "line 4 has 2 corners"),
        ("f 1.5 2 3", "line 4 names the corner `1.5`"),
    ],
)
def test_a_face_that_names_no_corner_is_told_with_its_line(face: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\nf 1 2 3\n")
    with pytest.raises(MeshError, match=message):
        read_mesh(tmp_path / "a.obj")


def test_collada_is_read_with_its_extra_and_names_it_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trimesh.creation.box((30, 20, 10)).export(tmp_path / "block.dae")
    vertices, faces = read_mesh(tmp_path / "block.dae", MM)
    assert Mesh.of(vertices, faces).volume == pytest.approx(6000 * MM**3, rel=1e-6)

    monkeypatch.setattr("gcodesim.extras._is_installed", lambda package: package != "pycollada")
    with pytest.raises(MeshError, match=r"Collada.*gcodesim\[dae\]"):
        read_mesh(tmp_path / "block.dae")
