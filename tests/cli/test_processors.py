"""Runs on other processors give the same files: libraries are told to choose their code as they would there."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import numpy as np
import pytest

TOP: Final = Path(__file__).resolve().parents[2]
HEAD: Final = "G21 G90 G17 G94 G64 P0.01\nT4 M6\nG43 H4\nS8000 M3\n"
CUT: Final = "G0 X10 Y10\nG0 Z3\nG1 Z-1 F600\nG1 X16 Y11\nG3 X20 Y15 R4.5\nG1 Y19\nG0 Z30\nM5\nM2\n"
SHORT: Final = {"bracket_kr10": HEAD + CUT}
LONG: Final = {
    "bracket_kr10": "bracket.nc",
    "contour_kr10": "contour.nc",
    "engraving_kr10": "engraving.ngc",
    "wall_kr10": "wall.nc",
}
SIMD: Final = np.show_config(mode="dicts")["SIMD Extensions"]  # type: ignore[call-overload]
# variables of the libraries, and what a processor has that makes them choose other code than here
SETTINGS: Final[dict[str, tuple[dict[str, str], str]]] = {
    "BLAS as on Haswell": ({"OPENBLAS_CORETYPE": "Haswell"}, "avx512f"),
    "BLAS as on Nehalem": ({"OPENBLAS_CORETYPE": "Nehalem"}, "fma"),
    "C without FMA": ({"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}, "fma"),
    "numpy of 2009": ({"NPY_DISABLE_CPU_FEATURES": " ".join(SIMD.get("found", ()))}, "avx512f"),
}

RUN: Final = """
import hashlib, json, math, sys
import numpy as np
from gcodesim.cli import main
x = np.linspace(-9.0, 9.0, 4001)
square = np.outer(x[:6], x[7:13]) + np.eye(6)
witness = [list(map(math.sin, x)), list(map(math.exp, x)), np.exp(x), np.arctan(x)]
witness += [square @ square, np.linalg.inv(square), x @ x]
print(hashlib.sha256(b"".join(np.asarray(part).tobytes() for part in witness)).hexdigest(), file=sys.stderr)
for arguments in json.loads(sys.argv[1]):
    status = main(arguments)
    assert status == 0, (status, arguments)
"""


def flags() -> set[str]:
    """What this processor has, as Linux calls it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return set()
    return set(next((line.partition(":")[2].split() for line in lines if line.startswith("flags")), ()))


def run_all(programs: dict[str, Path], folder: Path, setting: dict[str, str]) -> str:
    """Every program in its cell and in both worlds, each with a folder; a digest of what the libraries give."""
    calls = [
        ["run", program, "--cell", TOP / "cells" / f"{cell}.yaml", "--world", world, "--out", folder / world / cell]
        for cell, program in programs.items()
        for world in worlds()
    ]
    told = {name for variables, _ in SETTINGS.values() for name in variables}
    known = {name: value for name, value in os.environ.items() if name not in told}
    done = subprocess.run(
        [sys.executable, "-c", RUN, json.dumps(calls, default=str)],
        env={**known, **setting},
        cwd=TOP,
        capture_output=True,
        text=True,
        timeout=1800,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stderr.split()[0]


def worlds() -> tuple[str, ...]:
    return ("kinematic", "bullet") if find_spec("pybullet") else ("kinematic",)


def digests(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def check(programs: dict[str, Path], folder: Path) -> None:
    here = run_all(programs, folder / "here", {})
    wanted = digests(folder / "here")
    assert len(wanted) >= 4 * len(programs) * len(worlds())
    for name, (setting, other_with) in SETTINGS.items():
        place = folder / name.replace(" ", "_")
        there = run_all(programs, place, setting)
        if sys.platform == "linux" and other_with in flags():
            assert there != here, f"{name}: the libraries have not chosen other code, so this shows nothing"
        found = digests(place)
        different = {path for path in wanted | found if wanted.get(path) != found.get(path)}
        assert not different, (name, sorted(different))


def test_a_short_program_on_a_shipped_arm_gives_the_same_files_on_every_processor(tmp_path: Path) -> None:
    programs = {cell: tmp_path / f"{cell}.nc" for cell in SHORT}
    for cell, path in programs.items():
        path.write_text(SHORT[cell])
    check(programs, tmp_path / "out")


@pytest.mark.slow
def test_shipped_programs_on_arms_give_the_same_files_on_every_processor(tmp_path: Path) -> None:
    check({cell: TOP / "programs" / name for cell, name in LONG.items()}, tmp_path / "out")
