"""A folder that belongs to this user alone, so that its contents can be trusted, even machine code.

Whoever can write to a folder above it can put another one in its place, so each of them is checked. The way down is
by descriptors, and a file is read from the descriptor that was checked: nothing can be exchanged in between.
"""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import Final

_OTHERS_WRITE: Final = stat.S_IWGRP | stat.S_IWOTH
_MOST_LINKS: Final = 40
_HAS_OWNERS: Final = hasattr(os, "geteuid") and os.open in os.supports_dir_fd


class NotOwn(Exception):  # noqa: N818
    """The folder does not exist, or others may have put something into it; the text says what the problem is."""


class OwnFolder:
    """An open folder; its files are read and written through it, never by their paths."""

    def __init__(self, path: Path, descriptor: int | None) -> None:
        self.path = path
        self._descriptor = descriptor  # None where files have no owners

    def __del__(self) -> None:
        if self._descriptor is not None:
            with suppress(OSError):
                os.close(self._descriptor)

    @property
    def is_there(self) -> bool:
        """Whether the folder is unchanged: not deleted, given away or opened to others since."""
        if self._descriptor is None:
            return self.path.is_dir()
        known = os.fstat(self._descriptor)
        return known.st_nlink > 0 and _fault(known) is None

    def has(self, name: str) -> bool:
        """Whether `read` would find something."""
        descriptor = self._open(name)
        if descriptor is None:
            return False
        os.close(descriptor)
        return True

    def read(self, name: str) -> bytes | None:
        """The contents of the file; None if it does not exist, or is not a file that only this user can write."""
        descriptor = self._open(name)
        if descriptor is None:
            return None
        try:
            with os.fdopen(descriptor, "rb") as file:
                return file.read()
        except OSError:
            return None

    def write(self, name: str, data: bytes) -> bool:
        """Write a file as a whole; False if the disk does not take it. Several processes may do so at once."""
        part = f"{name}.{os.getpid()}-{os.urandom(4).hex()}.part"
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
        try:
            with os.fdopen(os.open(self._place(part), flags, 0o600, dir_fd=self._descriptor), "wb") as file:
                file.write(data)
            os.replace(self._place(part), self._place(name), src_dir_fd=self._descriptor, dst_dir_fd=self._descriptor)
        except OSError:
            self.delete(part)
            return False
        return True

    def delete(self, name: str) -> None:
        """Delete a file if it exists."""
        with suppress(OSError):
            os.unlink(self._place(name), dir_fd=self._descriptor)

    def names(self) -> list[str]:
        """The names of everything in the folder, in order."""
        try:
            return sorted(os.listdir(self._self))
        except OSError:
            return []

    def last_used_ns(self) -> int:
        """When `mark_used` was last called, or a file was added or deleted; 0 if the folder is gone."""
        try:
            return os.stat(self._self).st_mtime_ns
        except OSError:
            return 0

    def mark_used(self) -> None:
        """Set the time of last use to now, if the system allows it."""
        with suppress(OSError, NotImplementedError):
            os.utime(self._self)

    def delete_folder(self, name: str) -> None:
        """Delete the folder `name` in this one if it is empty."""
        with suppress(OSError):
            os.rmdir(self._place(name), dir_fd=self._descriptor)

    @property
    def _self(self) -> int | Path:
        return self.path if self._descriptor is None else self._descriptor

    def changed_ns(self, name: str) -> int:
        """When a file was last written; 0 if it does not exist."""
        try:
            return os.stat(self._place(name), dir_fd=self._descriptor, follow_symlinks=False).st_mtime_ns
        except OSError:
            return 0

    def folder(self, name: str, *, make: bool = False) -> OwnFolder | None:
        """The folder `name` in this one; None if it does not exist, is not this user's own, or cannot be made."""
        if self._descriptor is None:
            try:
                return _plain_folder(self.path / name, make)
            except NotOwn:
                return None
        try:
            descriptor = _step(self._descriptor, self._place(name), make, _READ)
        except OSError:
            return None
        below = OwnFolder(self.path / name, descriptor)
        return below if below.is_there else None

    def _place(self, name: str) -> str:
        """The name for system calls; the whole path where there are no descriptors of folders."""
        if os.path.basename(name) != name or name in ("", ".", ".."):
            raise ValueError(name)
        return str(self.path / name) if self._descriptor is None else name

    def _open(self, name: str) -> int | None:
        """A descriptor of the file, if only this user can write it."""
        flags = os.O_RDONLY | getattr(os, "O_BINARY", 0)
        if self._descriptor is not None:
            flags |= os.O_NOFOLLOW | os.O_NONBLOCK
        try:
            descriptor = os.open(self._place(name), flags, dir_fd=self._descriptor)
        except OSError:
            return None
        known = os.fstat(descriptor)
        if stat.S_ISREG(known.st_mode) and (self._descriptor is None or (self.is_there and _fault(known) is None)):
            return descriptor
        os.close(descriptor)
        return None


def open_own_folder(path: Path, *, own: int = 1, make: bool = False) -> OwnFolder:
    """The folder `path`, if nobody but this user (and root) can change its contents.

    The last `own` parts of the path have to be this user's, and only the first of them may be a link. Those above may
    also be root's, and may be shared if nobody can rename files of others there, as in a temporary folder. Links count
    if this user or root made them. `make` creates missing folders. NotOwn says what the problem is.
    """
    if not path.is_absolute() or ".." in path.parts:
        raise NotOwn(f"`{path}` is no absolute path")
    if not _HAS_OWNERS:
        return _plain_folder(path, make)
    way = _Way()
    ahead = list(reversed(path.parts[1:]))
    links = 0
    try:
        while ahead:
            name = ahead.pop()
            if name == "..":  # of a link
                way.up()
                continue
            target = way.link(name)
            if target is None:
                way.down(name, make=make, last=not ahead)
                way.check(own=len(ahead) < own)
                continue
            links += 1
            if len(ahead) < own - 1 or links > _MOST_LINKS:
                raise NotOwn(f"`{way.path / name}` is a link")
            ahead += [part for part in reversed(Path(target).parts) if part != os.sep]
            if os.path.isabs(target):
                way.to_top()
        return way.folder()
    except OSError as error:
        raise NotOwn(f"`{path}` cannot be used ({error.strerror})") from None
    finally:
        way.close()


class _Way:
    """The folders from the top down to where we are, all open and checked."""

    def __init__(self) -> None:
        self.path = Path(os.sep)
        self._open = [os.open(os.sep, _PASS)]
        self.check(own=False)

    def check(self, *, own: bool) -> None:
        """NotOwn if others may change what is in this folder."""
        known = os.fstat(self._open[-1])
        fault = _fault(known) if own else _fault_above(known)
        if fault is not None:
            raise NotOwn(f"`{self.path}` {fault}")

    def link(self, name: str) -> str | None:
        """Where the link `name` points; None if it is not a link."""
        try:
            known = os.stat(name, dir_fd=self._open[-1], follow_symlinks=False)
        except FileNotFoundError:
            return None
        if not stat.S_ISLNK(known.st_mode):
            return None
        if known.st_uid not in (os.geteuid(), 0):
            raise NotOwn(f"`{self.path / name}` is a link of another user")
        return os.readlink(name, dir_fd=self._open[-1])

    def down(self, name: str, *, make: bool, last: bool) -> None:
        """Open `name`; `make` creates it first if it is missing."""
        self._open.append(_step(self._open[-1], name, make, _READ if last else _PASS))
        self.path /= name

    def up(self) -> None:
        """Go one folder back; from the top, nowhere."""
        if len(self._open) > 1:
            os.close(self._open.pop())
            self.path = self.path.parent

    def to_top(self) -> None:
        """Go all the way back."""
        while len(self._open) > 1:
            self.up()

    def folder(self) -> OwnFolder:
        """The folder where we are."""
        return OwnFolder(self.path, self._open.pop())

    def close(self) -> None:
        """Forget the way."""
        for descriptor in self._open:
            os.close(descriptor)


_READ: Final = os.O_RDONLY | getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0)
_PASS: Final = _READ | getattr(os, "O_PATH", 0)  # folders that may be passed, and perhaps not listed


def _step(above: int, name: str, make: bool, flags: int) -> int:
    try:
        return os.open(name, flags, dir_fd=above)
    except FileNotFoundError:
        if not make:
            raise
    with suppress(FileExistsError):
        os.mkdir(name, 0o700, dir_fd=above)
    return os.open(name, flags, dir_fd=above)


def _fault(known: os.stat_result) -> str | None:
    """Why a file or folder is not this user's own; None if it is."""
    if known.st_uid != os.geteuid():
        return f"belongs to another user (number {known.st_uid})"
    if known.st_mode & _OTHERS_WRITE:
        return "can be written by others (`chmod go-w` changes that)"
    return None


def _fault_above(known: os.stat_result) -> str | None:
    """Why others may replace files in a folder that are not theirs; None if they cannot."""
    if known.st_uid not in (os.geteuid(), 0):
        return f"belongs to another user (number {known.st_uid})"
    if known.st_mode & _OTHERS_WRITE and not known.st_mode & stat.S_ISVTX:
        return "can be written by others (`chmod go-w` changes that)"
    return None


def _plain_folder(path: Path, make: bool) -> OwnFolder:
    """A folder where files have no owners as on Unix."""
    try:
        if make:
            path.mkdir(parents=True, exist_ok=True)
        if path.is_dir():
            return OwnFolder(path, None)
    except OSError as error:
        raise NotOwn(f"`{path}` cannot be used ({error.strerror})") from None
    raise NotOwn(f"`{path}` is not there")
