"""Methods that dataclasses generate: compiled once, and kept.

For each class `dataclass` writes the source of some five methods and has Python
compile it, whenever a process starts. For the classes of this project that is
0.09 s, a third of a short command. What a source is compiled to depends on
nothing but the source and the version of Python, so it is kept, as Python keeps
what it compiles of files.
"""

from __future__ import annotations

import dataclasses
import marshal
import os
import zlib
from hashlib import blake2b
from importlib.util import MAGIC_NUMBER
from typing import Any, Final

from gcodesim.user_cache import kept_folders, user_cache

_FOLDER: Final = "generated"
_FILE: Final = f"{MAGIC_NUMBER.hex()}.code"
_MOST: Final = 4_000
"""Sources to keep; a version has some 1,100. With more the file is begun anew, as versions leave some behind."""

_code_of: dict[bytes, bytes] = {}  # by a hash of the source
_met: list[bytes] = []


def use_kept() -> None:
    """From here on dataclasses of this package find their methods compiled."""
    _code_of.update(_read())
    # they call it by this name, and Python looks for it here before it looks among its own functions
    dataclasses.exec = _execute  # type: ignore[attr-defined]


def keep() -> None:
    """Write what this process had to compile; where the disk does not take it, nothing is kept."""
    if not _met or (folder := user_cache(_FOLDER)) is None:
        return
    if len(_code_of) > _MOST:
        known = {source: _code_of[source] for source in _met}
        _code_of.clear()
        _code_of.update(known)
    data = marshal.dumps(_code_of)
    part = folder / f"{_FILE}.{os.getpid()}.part"
    try:
        part.write_bytes(_seal(data) + data)
        part.replace(folder / _FILE)
    except OSError:
        part.unlink(missing_ok=True)
    _met.clear()


def _execute(source: str, names: dict[str, Any], results: dict[str, Any]) -> None:
    """What `exec` does."""
    if not str(names.get("__name__")).startswith("gcodesim."):
        exec(source, names, results)
        return
    key = blake2b(source.encode(), digest_size=16).digest()
    kept = _code_of.get(key)
    if kept is not None:
        code = marshal.loads(kept)
    else:
        code = compile(source, "<string>", "exec", dont_inherit=True)
        _code_of[key] = marshal.dumps(code)
        _met.append(key)
    exec(code, names, results)


def _read() -> dict[bytes, bytes]:
    """What is kept; nothing when it is damaged, since Python does not look at what it loads."""
    for folder in kept_folders(_FOLDER):
        try:
            data = (folder / _FILE).read_bytes()
        except OSError:
            continue
        if _seal(data[4:]) == data[:4]:
            return dict(marshal.loads(data[4:]))
    return {}


def _seal(data: bytes) -> bytes:
    return zlib.crc32(data).to_bytes(4, "big")
