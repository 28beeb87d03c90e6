"""What a process can do that works for others: the same code with the same libraries, or it must not work."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Final

from gcodesim.extras import EXTRAS
from gcodesim.files.code_digest import code_digest
from gcodesim.version import __version__

CODE: Final = "code"
_NEEDED: Final = ("dae", "xacro")
"""Extras without which a cell may be read in another way. Results do not depend on the others."""
_LIBRARIES: Final = ("numpy", "scipy", "numba", "pybullet", "trimesh")
_NOTHING: Final = "none"


@cache
def abilities() -> Mapping[str, str]:
    """Versions by name, and the hash of all code that decides results."""
    packages = [*_LIBRARIES, *(package for extra in _NEEDED for package in EXTRAS.get(extra, (extra,)))]
    return {
        "gcodesim": __version__,
        "python": ".".join(platform.python_version_tuple()[:2]),
        **{name: _version(name) for name in packages},
        CODE: code_digest(),
    }


def misfits(worker: Mapping[str, str], needed: Mapping[str, str]) -> list[str]:
    """In words, why a process with the abilities `worker` must not do work of one with those `needed`; empty: it may.

    Other versions of Python, and more packages than needed, do no harm.
    """
    found = []
    for name, own in needed.items():
        theirs = worker.get(name, _NOTHING)
        if name in ("python", CODE) or theirs == own:
            continue
        optional = name not in ("gcodesim", *_LIBRARIES)
        if optional and (own == _NOTHING or theirs != _NOTHING):
            continue
        found.append(f"no {name}" if theirs == _NOTHING else f"{name} {theirs} in place of {own}")
    if not found and worker.get(CODE) != needed.get(CODE):
        found.append("the sources of gcodesim, or of packages that extend it, differ from those here")
    return found


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return _NOTHING
