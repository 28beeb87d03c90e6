"""The finished part in colours: beside the run, on the page, as PLY and 3MF."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

from gcodesim.material.skin_file import read_skin

TOP = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pocket with one wrong digit, run in a coarse stock."""
    from gcodesim.cli import main

    folder = tmp_path_factory.mktemp("painted")
    cell = (TOP / "cells/pocket.yaml").read_text().replace("resolution: 0.25", "resolution: 0.5")
    (folder / "pocket.yaml").write_text(cell)
    (folder / "pocket_target.stl").write_bytes((TOP / "cells/pocket_target.stl").read_bytes())
    out = folder / "out"
    words = ["--cell", str(folder / "pocket.yaml"), "--world", "kinematic", "--out", str(out)]
    assert main(["run", str(TOP / "programs/pocket.nc"), *words]) == 1
    return out


def test_faces_know_their_depth_and_their_line(ran) -> None:
    """Line 24 goes down to Z-4.5 where Z-4 was meant; what is deepest there was made by it."""
    skin = read_skin((ran / "stock.skin.ply").read_bytes(), "skin")
    results = json.loads((ran / "results.json").read_text())

    deepest = skin.deviation < -0.45e-3
    lines = {skin.makers[maker].line for maker in skin.maker[deepest]}
    assert skin.deviation.min() == pytest.approx(1e-3 * results["target"]["least_deviation_mm"], abs=2e-5)
    assert lines <= {24, 25} and 24 in lines
    untouched = skin.maker < 0
    assert (np.abs(skin.deviation[untouched]) < 0.5e-3).all() and len(skin.spots) == results["target"]["gouges"]
    mesh = trimesh.Trimesh(skin.vertices, skin.faces, process=False)
    assert mesh.is_watertight
    assert mesh.volume * 1e9 == pytest.approx(results["stocks"]["stock"]["remaining_mm3"], rel=1e-3)


@pytest.mark.parametrize("by", [None, "tool", "line"])
def test_ply_and_3mf_have_the_same_colours(cli, ran, by) -> None:
    more = [] if by is None else ["--by", by]
    for kind in ("ply", "3mf"):
        done = cli("export", str(ran), "--to", kind, *more, "-o", f"part.{kind}")
        assert done.status == 0 and f"coloured by {by or 'deviation'}" in done.out

    ply = trimesh.load("part.ply", process=False)
    with zipfile.ZipFile("part.3mf") as archive:
        root = ET.fromstring(archive.read("3D/3dmodel.model"))
    triangles = root.findall(".//{*}triangle")
    inks = [ink.get("color") for ink in root.findall(".//{*}color")]
    assert root.get("unit") == "millimeter" and len(triangles) == len(ply.faces)
    own = ["#{:02X}{:02X}{:02X}".format(*colour[:3]) for colour in ply.visual.face_colors]
    assert [inks[int(triangle.get("p1"))] for triangle in triangles] == own
    assert len(set(own)) >= (1 if by == "tool" else 5)


def test_without_a_target_there_are_no_colours(cli) -> None:
    assert cli("run", "slot.nc", "--cell", "cell.yaml").status == 0
    done = cli("export", "out", "--to", "ply", "--by", "line")
    assert done.status == 2 and "`target`" in done.err
    assert cli("export", "out", "--to", "ply", "-o", "part.ply").status == 0
    assert trimesh.load("part.ply", process=False).is_watertight
    done = cli("export", "out", "--to", "csv", "--by", "line")
    assert done.status == 2 and "--by means nothing for csv" in done.err
