"""What is installed: the same answers as the standard library's reader of metadata."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

from gcodesim import installed


@pytest.fixture
def shelf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder that is the whole search path for packages."""
    monkeypatch.setattr(sys, "path", [str(tmp_path)])
    monkeypatch.setattr(sys, "meta_path", [f for f in sys.meta_path if not hasattr(f, "find_distributions")])
    installed._wheels.cache_clear()
    yield tmp_path
    installed._wheels.cache_clear()


def package(shelf: Path, folder: str, entry_points: str = "", said: str = "1.0") -> None:
    (shelf / folder).mkdir()
    (shelf / folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: thing\nVersion: {said}\n", encoding="utf-8")
    if entry_points:
        (shelf / folder / "entry_points.txt").write_text(entry_points, encoding="utf-8")


@pytest.mark.parametrize("name", ["numpy", "mcap", "zstandard", "ruamel.yaml", "pybullet"])
def test_versions_are_those_of_the_metadata(name: str) -> None:
    assert installed.version_of(name) == version(name)


def test_a_package_that_is_not_there(shelf: Path) -> None:
    with pytest.raises(PackageNotFoundError):
        installed.version_of("thing")


def test_names_are_compared_as_indexes_do(shelf: Path) -> None:
    package(shelf, "some_thing.more-2.5+local.dist-info")
    assert installed.version_of("Some-Thing_More") == "2.5+local"


def test_two_versions_of_one_package_are_left_to_the_standard_library(
    shelf: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package(shelf, "thing-1.0.dist-info", said="1.0")
    package(shelf, "Thing-2.0.dist-info", said="2.0")
    monkeypatch.setattr("importlib.metadata.version", lambda name: "asked")
    assert installed.version_of("thing") == "asked"


@pytest.mark.parametrize(
    ("points", "may"),
    [
        ("", False),
        ("[console_scripts]\ngcodesim = gcodesim.__main__:main\n", False),
        ("[pytest11]\ngcodesim = gcodesim.pytest_plugin\n", False),
        ("[console_scripts]\na = b:c\n\n[gcodesim.tools]\nmine = thing:Tool\n", True),
        ("\r\n [ gcodesim.tools ]\r\nmine = thing:Tool\r\n", True),
    ],
)
def test_a_package_extends_by_a_group_of_ours(shelf: Path, points: str, may: bool) -> None:
    package(shelf, "thing-1.0.dist-info", points)
    assert installed.may_extend() is may


def test_an_egg_may_extend(shelf: Path) -> None:
    assert not installed.may_extend()
    (shelf / "thing-1.0-py3.11.egg").mkdir()
    assert installed.may_extend()


def test_whoever_has_a_finder_of_its_own_is_asked(shelf: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Finder:
        def find_distributions(self, context: object = None) -> list[object]:
            return []

    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, Finder()])
    assert installed.may_extend()
