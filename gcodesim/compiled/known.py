"""The list of what is compiled ahead of time: kernels with the types they are called with, in parts.

`known_kernels.txt` is written by `scripts/list_kernels.py`. Kernels and types that are not in it work too; they are
compiled when they are called first.
"""

from __future__ import annotations

from functools import cache, reduce
from importlib import import_module
from pathlib import Path
from typing import Final

from gcodesim.compiled import Kernel
from gcodesim.compiled.arguments import Arguments, of_text
from gcodesim.compiled.object_code import is_kept

LIST: Final = Path(__file__).with_name("known_kernels.txt")


@cache
def known_parts() -> dict[str, tuple[str, ...]]:
    """Signatures by what they are for, as in "an arm"; the parts that most runs need come first."""
    parts: dict[str, list[str]] = {}
    for line in LIST.read_text(encoding="ascii").splitlines():
        if line.startswith("# "):
            here = parts.setdefault(line[2:], [])
        elif line:
            here.append(line)
    return {name: tuple(signatures) for name, signatures in parts.items()}


def part_with(signature: str) -> tuple[str, tuple[str, ...]] | None:
    """The name and the signatures of the part in which a signature is; None if it is in none."""
    return next((part for part in known_parts().items() if signature in part[1]), None)


def kernel_of(signature: str) -> tuple[Kernel, Arguments]:
    """The kernel and the types that a signature names; ValueError if either is not there."""
    name, _, types = signature.partition(" ")
    module, _, place = name.partition(":")
    try:
        kernel = reduce(getattr, place.split("."), import_module(module))
        if isinstance(kernel, Kernel):
            return kernel, of_text(types)
    except (ImportError, AttributeError):
        pass
    raise ValueError(f"there is no kernel {signature}")


def missing(signatures: tuple[str, ...]) -> list[str]:
    """Those that are neither in a library nor in the cache; what no kernel fits is left out.

    The list may be older than the sources, as while somebody edits them, and no run may end because of that.
    """
    return [signature for signature in signatures if _is_missing(signature)]


def _is_missing(signature: str) -> bool:
    try:
        return not is_kept(*kernel_of(signature))
    except ValueError:
        return False
