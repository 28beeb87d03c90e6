"""Files on their way to a worker and back: names and bytes in one block, with nothing in it that could run.

A block is a line with the form's name, eight bytes that say how long the head is, the head as JSON (whatever belongs to
the files, their names and sizes), then the bytes of all files in that order.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any, Final

from gcodesim.frozen import frozen
from gcodesim.numbers import read_json

FORM: Final = b"gcodesim-bundle/1\n"
_COUNT: Final = 8  # bytes of the length of the head
_LEADING_OUT: Final = "" if os.sep == "/" else "\\:"  # where a backslash or a colon is part of a name, it stays so


class BundleError(ValueError):
    """Bytes that are no bundle; the text says what is wrong."""


@frozen
class FileBundle:
    """`files` by name, with `/` and below one folder; `said` is what is told with them, as JSON."""

    files: Mapping[str, bytes]
    said: Any = None

    def pack(self) -> bytes:
        """Equal bundles give equal bytes."""
        names = sorted(self.files)
        sizes = [[name, len(self.files[name])] for name in names]
        head = json.dumps({"said": self.said, "files": sizes}, allow_nan=False).encode()  # names may be no UTF-8
        return b"".join((FORM, len(head).to_bytes(_COUNT, "big"), head, *(self.files[name] for name in names)))

    @staticmethod
    def unpack(data: bytes) -> FileBundle:
        """BundleError for anything that `pack` does not give, such as names that lead out of the folder."""
        if not isinstance(data, (bytes, bytearray, memoryview)) or not bytes(data[: len(FORM)]) == FORM:
            raise BundleError("these bytes are no bundle of files")
        begin = len(FORM) + _COUNT
        end = begin + int.from_bytes(data[len(FORM) : begin], "big")
        try:
            head = read_json(bytes(data[begin:end]))
            sizes = [(_name(name), _size(size)) for name, size in head["files"]]
            said = head["said"]
        except (ValueError, TypeError, KeyError):
            raise BundleError("the head of a bundle cannot be read") from None
        if len(data) != end + sum(size for _, size in sizes) or len(dict(sizes)) != len(sizes):
            raise BundleError("a bundle is cut off, or longer than it says")
        files = {}
        for name, size in sizes:
            files[name] = bytes(data[end : end + size])
            end += size
        return FileBundle(files=files, said=said)

    def write(self, folder: Path) -> None:
        """Write all files below `folder`."""
        for name, content in self.files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


def digest_of(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _name(name: Any) -> str:
    parts = PurePosixPath(name).parts
    foreign = {"\0", *_LEADING_OUT}
    if not isinstance(name, str) or not parts or name.startswith("/") or ".." in parts or foreign & set(name):
        raise BundleError(f"{name!r} is no name of a file in a bundle")
    return name


def _size(size: Any) -> int:
    if type(size) is not int or size < 0:
        raise BundleError(f"{size!r} is no size of a file")
    return size
