"""A process that compiles kernels: it reads a signature a line and answers each with a line, empty if all went well."""

from __future__ import annotations

import gc
import os
import sys
from pathlib import Path
from typing import Final

from gcodesim.compiled.folder import writable_folder
from gcodesim.compiled.known import kernel_of
from gcodesim.compiled.object_code import compile_and_keep, symbol_of
from gcodesim.compiled.target import choose

_OBJECTS: Final = (200_000, 5, 5)
"""After how many new objects of Python the collector of garbage looks at them; usually 700.

A kernel is millions of objects, most of which live until it is compiled.
"""


def work(level: str = "", objects: str = "") -> None:
    """Compile into the cache; or into files of object code in the folder `objects`, for the instructions `level`."""
    if level:
        choose(level)
    gc.set_threshold(*_OBJECTS)
    os.environ["NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING"] = "1"  # colours in texts that nearly nobody reads
    for line in sys.stdin:
        try:
            _compile(line.rstrip("\n"), objects)
            answer = ""
        except Exception as error:  # of numba: it is told by the process that needs the kernel
            answer = f"{type(error).__name__}: {error}".replace("\n", " ")
        print(answer, flush=True)


def _compile(signature: str, objects: str) -> None:
    kernel, arguments = kernel_of(signature)
    if not objects:
        compile_and_keep(kernel, arguments, writable_folder())
        return
    from gcodesim.compiled.compiling import compile_for_library

    symbol = symbol_of(kernel, arguments)
    Path(objects, f"{symbol}.o").write_bytes(compile_for_library(kernel, arguments, symbol))
