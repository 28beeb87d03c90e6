"""Pictures of the README show what the programs leave today, and the command that makes them works."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]


@pytest.fixture
def pictures(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    return importlib.import_module("make_pictures")


@pytest.mark.parametrize("cell", ["bracket.yaml", "bracket_kr10.yaml"])
def test_no_picture_is_stale(pictures, tmp_path, cell):
    own = {name: picture for name, picture in pictures.PICTURES.items() if picture.cell == cell}
    part = pictures.run(next(iter(own.values())), tmp_path / "out")

    for name in own:
        assert pictures.part_of((ROOT / "docs" / name).read_bytes()) == part, f"scripts/make_pictures.py {name}"


def test_the_command_makes_a_picture(pictures, tmp_path, monkeypatch):
    """Drawn anew it is the picture of the README, pixel by pixel."""
    monkeypatch.setattr(sys, "argv", ["make_pictures.py", "bracket.png", "--into", str(tmp_path)])
    pictures.main()

    made, kept = (np.asarray(Image.open(folder / "bracket.png")) for folder in (tmp_path, ROOT / "docs"))
    assert np.array_equal(made, kept)


def test_every_picture_of_the_readme_is_made_by_the_command(pictures):
    text = (ROOT / "README.md").read_text(encoding="utf-8")

    assert set(pictures.PICTURES) == {path.name for path in (ROOT / "docs").glob("*.png")}
    assert all(f"(docs/{name})" in text for name in pictures.PICTURES)


def test_a_stamp_is_read_back(pictures):
    png = (ROOT / "docs/bracket.png").read_bytes()

    assert pictures.part_of(pictures.stamped(png.replace(pictures.STAMP, b"Else"), "ab12")) == "ab12"


def test_no_picture_of_the_gallery_is_stale(pictures):
    """Each shows the result that is accepted now, and stands on the page."""
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")

    assert {*pictures.GALLERY, *pictures.SCRIPTED} == {path.name for path in (ROOT / "docs" / "gallery").glob("*.png")}
    for name, shot in pictures.GALLERY.items():
        png = (ROOT / "docs" / "gallery" / name).read_bytes()
        assert pictures.part_of(png) == pictures.digest_of(shot), f"scripts/make_pictures.py {name}"
        assert f"(gallery/{name})" in page and f"`{shot.example}`" in page


@pytest.mark.parametrize("name", ["force_control.png", "painted_together.png", "taught_poses.png"])
def test_no_picture_of_a_script_is_stale(pictures, tmp_path, name):
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    scripted = pictures.SCRIPTED[name]

    png = (ROOT / "docs" / "gallery" / name).read_bytes()
    assert pictures.part_of(png) == pictures.said_by(scripted, tmp_path), f"scripts/make_pictures.py {name}"
    assert f"(gallery/{name})" in page and f"`{scripted.example}.py`" in page


def test_a_picture_of_the_gallery_is_drawn_from_a_log(pictures, tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["make_pictures.py", "scan_heads.png", "--into", str(tmp_path)])
    pictures.main()

    made, kept = (np.asarray(Image.open(folder / "gallery/scan_heads.png")) for folder in (tmp_path, ROOT / "docs"))
    assert np.array_equal(made, kept)
