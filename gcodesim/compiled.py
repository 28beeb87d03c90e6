"""The one way to numba: where compiled kernels are cached, and how they are declared.

Import `kernel` from here and nowhere else. The cache folder is chosen before
numba is imported, because numba decides at import; its name carries a hash of
all kernel sources, the numba version and the processor, because numba's own
check does not see that a kernel in another file has changed. When no folder is
writable the kernels run uncached instead of failing.
"""

from __future__ import annotations

import hashlib
import os
import platform
import sys
import tempfile
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])


def _sources_digest() -> str:
    """Hash of every kernel source of this package, the compiler's version and the processor."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*kernels.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    digest.update(f"{version('numba')} {sys.version_info[:2]} {platform.machine()} {_processor()}".encode())
    return digest.hexdigest()[:16]


def _processor() -> str:
    """The processor's name and features: a cache made on another one may hold instructions this one lacks."""
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:
        return platform.processor()
    return "".join(sorted({line for line in lines if line.startswith(("model name", "flags"))}))


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _choose_cache() -> Path | None:
    """The first writable folder of: NUMBA_CACHE_DIR, the user's cache, the temporary folder."""
    user = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    roots = [Path(user) / "gcodesim", Path(tempfile.gettempdir()) / f"gcodesim-{os.getuid()}"]
    if "NUMBA_CACHE_DIR" in os.environ:
        roots.insert(0, Path(os.environ["NUMBA_CACHE_DIR"]))
    digest = _sources_digest()
    for root in roots:
        folder = root / digest
        if _writable(folder):
            return folder
    return None


cache_folder: Path | None = _choose_cache()
if cache_folder is not None:
    os.environ["NUMBA_CACHE_DIR"] = str(cache_folder)

import numba  # noqa: E402  (the cache folder has to be chosen first)

numba.config.CACHE_DIR = str(cache_folder or "")


def _load_without_scipy() -> None:
    """Let numba load its linear algebra while it cannot see scipy's.

    It asks scipy for BLAS as soon as the first kernel is called, which takes
    longer than all else at the start of a command; no kernel here uses BLAS.
    """
    name = "scipy.linalg"
    if name in sys.modules:
        return
    sys.modules[name] = None  # type: ignore[assignment]
    try:
        import numba.np.arraymath  # noqa: F401
    finally:
        del sys.modules[name]


_load_without_scipy()


def kernel(function: F) -> F:
    """Compile `function` on first call: no fast-math, no parallel reductions, so results are repeatable."""
    return numba.njit(cache=cache_folder is not None, error_model="numpy", nogil=True)(function)  # type: ignore[no-any-return]
