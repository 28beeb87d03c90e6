"""What lies in an own folder was put there by this user: everything else is refused."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from gcodesim.files import user_cache as module
from gcodesim.files.own_folder import NotOwn, OwnFolder, open_own_folder
from gcodesim.files.user_cache import kept_folders, refusals, user_cache

AS_ROOT = pytest.mark.skipif(os.getuid() != 0, reason="only root can give files away")
OTHER = 12345


def opened(path: Path, own: int = 1) -> OwnFolder | None:
    try:
        return open_own_folder(path, own=own)
    except NotOwn:
        return None


def test_files_come_and_go(tmp_path: Path) -> None:
    folder = open_own_folder(tmp_path / "a" / "b", make=True)
    assert (tmp_path / "a").stat().st_mode & 0o777 == folder.path.stat().st_mode & 0o777 == 0o700
    assert folder.read("x") is None and not folder.has("x")
    assert folder.write("x", b"1") and folder.write("x", b"2")
    assert folder.read("x") == b"2" and folder.has("x") and folder.names() == ["x"]
    assert (folder.path / "x").stat().st_mode & 0o777 == 0o600
    below = folder.folder("c", make=True)
    assert below is not None and below.write("y", b"3") and below.path == tmp_path / "a" / "b" / "c"
    folder.delete("x")
    assert folder.names() == ["c"] and folder.folder("d") is None
    for name in ("../x", "", ".."):
        with pytest.raises(ValueError):
            folder.read(name)


def chmod(mode: int) -> Callable[[Path], None]:
    return lambda path: path.chmod(mode)


def give(path: Path) -> None:
    os.chown(path, OTHER, OTHER, follow_symlinks=False)


def turn_into_a_link(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))
    path.symlink_to(path.with_name("elsewhere"))


def turn_into_a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


@pytest.mark.parametrize(
    "harm",
    [
        chmod(0o620),
        chmod(0o602),
        turn_into_a_link,
        turn_into_a_pipe,
        pytest.param(give, marks=AS_ROOT),
    ],
)
def test_a_file_that_others_may_have_written_is_not_read(tmp_path: Path, harm: Callable[[Path], None]) -> None:
    folder = open_own_folder(tmp_path / "own", make=True)
    folder.write("code", b"1")
    harm(folder.path / "code")
    assert folder.read("code") is None and not folder.has("code")
    assert folder.write("code", b"2") and folder.read("code") == b"2"  # a link is replaced, not followed


@pytest.mark.parametrize("harm", [chmod(0o770), chmod(0o707), chmod(0o1777), pytest.param(give, marks=AS_ROOT)])
def test_a_folder_that_others_may_have_filled_is_not_used(tmp_path: Path, harm: Callable[[Path], None]) -> None:
    folder = open_own_folder(tmp_path / "own" / "deep", make=True, own=2)
    folder.write("code", b"1")
    assert folder.is_there
    harm(folder.path)
    assert opened(folder.path) is None
    assert not folder.is_there and folder.read("code") is None  # also one that was opened before
    folder.path.chmod(0o700)
    os.chown(folder.path, os.getuid(), os.getgid())
    harm(folder.path.parent)
    assert opened(folder.path, 2) is None


@pytest.mark.parametrize("harm", [chmod(0o777), chmod(0o770), pytest.param(give, marks=AS_ROOT)])
def test_whoever_can_rename_a_folder_above_decides_what_lies_below(
    tmp_path: Path, harm: Callable[[Path], None]
) -> None:
    folder = open_own_folder(tmp_path / "above" / "between" / "own", make=True)
    harm(tmp_path / "above")
    assert opened(folder.path) is None
    with pytest.raises(NotOwn, match="above"):
        open_own_folder(folder.path)


def test_in_a_shared_folder_counts_what_nobody_else_can_rename(tmp_path: Path) -> None:
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o1777)
    assert open_own_folder(shared / "own", make=True).write("x", b"")
    assert opened(shared) is None


def test_links(tmp_path: Path) -> None:
    real = open_own_folder(tmp_path / "real" / "own", make=True)
    (tmp_path / "far").symlink_to(tmp_path / "real")
    (tmp_path / "near").symlink_to("far")
    (tmp_path / "up").symlink_to("real/../near/./own")
    (tmp_path / "round").symlink_to("round")
    for path in ("far/own", "near/own", "up"):
        known = opened(tmp_path / path)
        assert known is not None and known.path == real.path
    assert opened(tmp_path / "far" / "own", own=2) is not None  # what the user names may be a link
    assert opened(tmp_path / "near" / "own", own=3) is None
    assert opened(tmp_path / "round") is None
    (tmp_path / "real" / "linked").symlink_to("own")
    assert opened(tmp_path / "real" / "linked", own=2) is None


@AS_ROOT
def test_a_link_of_another_user_is_not_followed(tmp_path: Path) -> None:
    open_own_folder(tmp_path / "real" / "own", make=True)
    (tmp_path / "far").symlink_to(tmp_path / "real")
    give(tmp_path / "far")
    with pytest.raises(NotOwn, match="link of another user"):
        open_own_folder(tmp_path / "far" / "own")


@AS_ROOT
def test_what_belongs_to_root_is_not_a_users_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = open_own_folder(tmp_path / "own", make=True)
    monkeypatch.setattr(os, "geteuid", lambda: OTHER)
    with pytest.raises(NotOwn, match="another user"):
        open_own_folder(folder.path)


def test_no_relative_folder_of_a_strangers_project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NotOwn, match="absolute"):
        open_own_folder(Path("cache"), make=True)


def test_nothing_is_kept_below_the_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its names can be foreseen, so anybody could have been there first."""
    import getpass
    import tempfile

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    planted = tmp_path / f"gcodesim-{getpass.getuser()}" / "x"
    planted.mkdir(parents=True)
    for variable in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.setenv(variable, "/dev/null/none")
    assert list(kept_folders("x")) == [] and user_cache("x") is None
    assert len(refusals("x")) == 2 and all("/dev/null" in text for text in refusals("x"))


def test_the_users_folders_one_after_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "named"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "caches"))
    first = user_cache("x")
    assert first is not None and first.path == tmp_path / "named" / "x"
    assert [folder.path for folder in kept_folders("x")] == [first.path]
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    second = user_cache("x")
    assert second is not None and second.path == tmp_path / "caches" / "gcodesim" / "x"
    (tmp_path / "caches").chmod(0o1777)
    module._OPEN.clear()
    assert user_cache("x") is None  # a folder for everybody
