"""What decides results besides the inputs: sources of gcodesim and its extensions, versions of libraries."""

from __future__ import annotations

import hashlib
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

from gcodesim.family import extensions
from gcodesim.version import __version__

_LIBRARIES: Final = ("numpy", "scipy", "numba", "pybullet", "trimesh")
_OURS: Final = Path(__file__).parents[1]


def code_digest() -> str:
    """A hash of all of that, the same wherever the same sources are installed."""
    digest = hashlib.sha256(__version__.encode())
    _add_sources(digest, _OURS, "*.py")
    for point in extensions():
        digest.update(f"{point.group} {point.name} {point.value}\n".encode())
    for module in sorted({point.module.partition(".")[0] for point in extensions()}):
        spec = find_spec(module)
        for folder in (spec and spec.submodule_search_locations) or ():
            _add_sources(digest, Path(folder), "*")
        if spec is not None and spec.origin is not None:
            _add_source(digest, Path(spec.origin), module)
    for name in _LIBRARIES:
        try:
            digest.update(f"{name} {version(name)}\n".encode())
        except PackageNotFoundError:
            digest.update(f"{name} none\n".encode())
    return digest.hexdigest()


def _add_sources(digest: Any, top: Path, pattern: str) -> None:
    """What lies below a folder, but for what Python itself puts there."""
    for path in sorted(top.rglob(pattern)):
        if "__pycache__" not in path.parts and path.is_file():
            _add_source(digest, path, path.relative_to(top).as_posix())


def _add_source(digest: Any, path: Path, name: str) -> None:
    digest.update(f"{name}\n".encode())
    digest.update(hashlib.sha256(path.read_bytes()).digest())
