"""`export --simplify`: a lighter file of the part, and what it cannot be asked together with."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh


@pytest.fixture
def out(cli) -> str:
    assert cli("run", "slot.nc", "--cell", "cell.yaml").status == 0
    return "out"


def test_a_lighter_part_of_the_same_volume(cli, out: str) -> None:
    assert cli("export", out, "--to", "stl", "-o", "fine.stl").status == 0
    done = cli("export", out, "--to", "stl", "--simplify", "0.05", "-o", "light.stl")
    fine, light = trimesh.load("fine.stl"), trimesh.load("light.stl")

    assert done.status == 0 and "as computed within 0.05 mm" in done.out
    assert light.is_watertight and light.volume == pytest.approx(fine.volume, rel=1e-5)
    assert len(light.faces) < len(fine.faces) / 4
    for other in ("ply", "3mf"):
        assert cli("export", out, "--to", other, "--simplify", "0.05 mm", "-o", f"light.{other}").status == 0
    assert len(trimesh.load("light.ply").faces) == len(light.faces)
    assert cli("export", out, "--to", "stl", "--simplify", "0.002 in", "--at", "0.5", "-o", "early.stl").status == 0
    assert trimesh.load("early.stl").is_watertight


def test_what_it_is_not_for(cli, out: str) -> None:
    for words in (("stl", "0"), ("stl", "-1"), ("stl", "x"), ("stl", "1 kg"), ("csv", "0.1")):
        assert cli("export", out, "--to", words[0], "--simplify", words[1]).status == 2
    done = cli("export", out, "--to", "ply", "--by", "line", "--simplify", "0.1", "-o", "part.ply")
    assert done.status == 2 and "colours belong" in done.err and not Path("part.ply").exists()
