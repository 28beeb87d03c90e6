"""Files that are there as a whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from gcodesim.files.whole_file import whole_file, write_whole


def test_a_file_gets_its_name_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    write_whole(path, b"old")
    with whole_file(path) as file:
        file.write(b"new")
        assert path.read_bytes() == b"old"
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    write_whole(path, b"old")
    with pytest.raises(ZeroDivisionError), whole_file(path) as file:
        file.write(b"half")
        raise ZeroDivisionError
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == {"a.bin": b"old"}
    with pytest.raises(OSError):
        write_whole(path / "a.bin", b"")  # a file is no folder


def test_folders_on_the_way_are_made(tmp_path: Path) -> None:
    write_whole(tmp_path / "reports" / "today" / "j.xml", b"<a/>")
    assert (tmp_path / "reports" / "today" / "j.xml").read_bytes() == b"<a/>"


def test_nothing_is_written_through_a_link(tmp_path: Path) -> None:
    """As one that somebody planted in a folder of outputs, in a repository or where everybody may write."""
    victim = tmp_path / "victim"
    victim.write_bytes(b"mine")
    out = tmp_path / "out"
    out.mkdir()
    for name in ("a.bin", "a.bin.part"):
        (out / name).symlink_to(victim)
    write_whole(out / "a.bin", b"new")
    assert victim.read_bytes() == b"mine" and (out / "a.bin").read_bytes() == b"new"
    assert not (out / "a.bin").is_symlink() and [path.name for path in out.iterdir()] == ["a.bin"]


def test_a_device_stays_one(tmp_path: Path) -> None:
    """As root a null device was replaced by a file, and with it everybody's."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_whole(pipe, b"told")
    assert os.read(reader, 100) == b"told" and pipe.is_fifo()
    (tmp_path / "link").symlink_to(pipe)  # that somebody planted
    write_whole(tmp_path / "link", b"mine")
    assert not (tmp_path / "link").is_symlink() and (tmp_path / "link").read_bytes() == b"mine"
    os.close(reader)
    write_whole(Path(os.devnull), b"gone")
    assert not Path(os.devnull).is_file()
