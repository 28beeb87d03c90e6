"""The library of kernels that came with the package: shared libraries, one for each set of instructions.

The name of each entry says for which sources it was made, so an edited kernel is compiled anew, and only that one.
"""

from __future__ import annotations

import ctypes
import platform
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Final

from gcodesim.compiled.arguments import NAMES_OF
from gcodesim.compiled.function import new_function
from gcodesim.compiled.target import levels

FOLDER: Final = Path(__file__).parent / "libraries"


def file_name(level: str) -> str:
    """Name of the library for a set of instructions."""
    return f"kernels-{level}.so"


def has(symbol: str) -> bool:
    """Whether the library has the entry `symbol`."""
    library = _library()
    return library is not None and hasattr(library, symbol)


def entry_of(symbol: str) -> Callable[..., Any] | None:
    """The entry `symbol` as Python calls it; None if there is no such library, or the entry is not in it."""
    library = _library()
    if library is None or not hasattr(library, symbol):
        return None
    address, names = (
        ctypes.cast(getattr(library, name), ctypes.c_void_p).value for name in (symbol, symbol + NAMES_OF)
    )
    return new_function(symbol, address, names) if address and names else None


@cache
def _library() -> ctypes.CDLL | None:
    if not (sys.platform == "linux" and platform.python_implementation() == "CPython" and FOLDER.is_dir()):
        return None
    for level in levels():
        path = FOLDER / file_name(level)
        if path.exists():
            try:
                return ctypes.CDLL(str(path))
            except OSError:  # of another libc, or damaged
                continue
    return None
