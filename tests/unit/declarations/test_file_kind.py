"""Files that a key names."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.declarations.file_kind import File
from gcodesim.declarations.reading import UNREAD
from tests.unit.declarations.text import codes, read


def test_a_file_is_found_beside_and_hashed(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_bytes(b"solid")

    value, to = read(File("a mesh"), "a.stl", tmp_path)

    assert (value.name, value.path) == ("a.stl", tmp_path / "a.stl")
    assert [file.name for file in to.shelf.files()] == ["a.stl"]


@pytest.mark.parametrize(("name", "code"), [("b.stl", "GS714"), ("../b.stl", "GS715"), ("package://p/b", "GS714")])
def test_no_other_file_is_read(name: str, code: str, tmp_path: Path) -> None:
    value, to = read(File("a mesh"), name, tmp_path)

    assert value is UNREAD and codes(to) == [code]
