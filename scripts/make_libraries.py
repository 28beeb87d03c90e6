"""Compile all listed kernels into shared libraries, one for each set of instructions, as the wheel carries them.

    scripts/make_libraries.py FOLDER [LEVEL...]

Needs numba and a linker (`cc`). FOLDER is emptied of other libraries. Equal sources and versions give equal bytes.
LEVEL is a set of instructions, such as x86-64-v3; without it, all of them are made.
"""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from gcodesim.compiled.known import kernel_of, known_parts
from gcodesim.compiled.library import file_name
from gcodesim.compiled.object_code import symbol_of
from gcodesim.compiled.parallel import compile_all
from gcodesim.compiled.target import LEVELS


def main(folder: Path, levels: Sequence[str]) -> int:
    """Make the libraries; returns the exit status."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.so"):
        old.unlink()
    signatures = [signature for part in known_parts().values() for signature in part]
    for level in levels:
        with tempfile.TemporaryDirectory() as objects:
            count = len(signatures)

            def say(done: int, level: str = level, count: int = count) -> None:
                print(f"{level}: {done} of {count} kernels", file=sys.stderr)

            say(0)
            failed = compile_all(signatures, say, level=level, objects=objects)
            for signature, reason in failed.items():
                print(f"{signature}: {reason}", file=sys.stderr)
            if failed:
                return 1
            names = [symbol_of(*kernel_of(signature)) for signature in signatures]
            made = folder / file_name(level)
            link([Path(objects, f"{name}.o") for name in sorted(names)], made)
            ctypes.CDLL(str(made))  # OSError if it wants something that neither C nor Python has
            print(f"{made}: {made.stat().st_size} bytes, needs glibc {glibc_of(made)}")
    return 0


def link(objects: list[Path], made: Path) -> None:
    """One shared library of object files; what they want of Python is there when it is loaded."""
    compiler = shutil.which("cc")
    if compiler is None:
        raise SystemExit("a linker is needed: install a C compiler (`cc`)")
    options = ["-shared", "-nostartfiles", "-Wl,--build-id=none,-z,now,-z,relro,-z,noexecstack,--gc-sections,-s"]
    libraries = ["-Wl,--as-needed", "-lm", "-lc"]
    subprocess.run([compiler, *options, "-o", str(made), *map(str, objects), *libraries], check=True)


def glibc_of(library: Path) -> str:
    """The oldest glibc that has every function that a library wants, as `2.17`."""
    said = subprocess.run(["objdump", "-T", str(library)], check=True, capture_output=True, text=True).stdout
    versions = {tuple(map(int, found.split("."))) for found in re.findall(r"GLIBC_([0-9.]+)", said)}
    return ".".join(map(str, max(versions, default=(2, 2, 5))))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:] or list(LEVELS)))
