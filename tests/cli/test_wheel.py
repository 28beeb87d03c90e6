"""The wheel: with libraries it is for this system and needs no compiler, without them it requires one."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from email import message_from_string
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from zipfile import ZipFile

import pytest

from gcodesim.compiled.library import file_name
from gcodesim.compiled.target import levels
from scripts.make_libraries import link

ROOT = Path(__file__).parents[2]
SOURCES = ("gcodesim", "programs", "cells", "pyproject.toml", "setup.py", "README.md", "LICENSE")
LINUX = pytest.mark.skipif(
    sysconfig.get_platform() != "linux-x86_64", reason="wheels with libraries are for x86-64 Linux"
)
# Python with numpy starts in 0.15 s of processor here, so this many starts are less than 10 s
MOST_STARTS = 60
BUILD = "import sys; from setuptools import build_meta; print(build_meta.build_wheel(sys.argv[1]))"


def built(folder: Path, libraries: Path | None = None) -> Path:
    """A wheel of the sources as they are, built without a network."""
    source = folder / "source"
    for name in SOURCES:
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        source.mkdir(exist_ok=True)
        copy(ROOT / name, source / name, **({"ignore": ignored} if copy is shutil.copytree else {}))  # type: ignore[operator]
    environment = {**os.environ, **({} if libraries is None else {"GCODESIM_LIBRARIES": str(libraries)})}
    done = subprocess.run(
        [sys.executable, "-c", BUILD, str(folder)], cwd=source, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return folder / done.stdout.split()[-1]


def ignored(_: str, names: list[str]) -> list[str]:
    return [name for name in names if name == "__pycache__"]


def required(wheel: Path) -> list[str]:
    """Names of the packages that a wheel requires without an extra."""
    with ZipFile(wheel) as files:
        (name,) = (name for name in files.namelist() if name.endswith(".dist-info/METADATA"))
        lines = message_from_string(files.read(name).decode()).get_all("Requires-Dist") or []
    return [re.split(r"[^\w.-]", line)[0] for line in lines if "extra ==" not in line]


def test_without_libraries_it_is_for_all_systems_and_requires_the_compiler(tmp_path: Path) -> None:
    wheel = built(tmp_path)
    assert wheel.name.endswith("-py3-none-any.whl")
    assert {"numba", "numpy", "lark"} <= set(required(wheel))
    with ZipFile(wheel) as files:
        names = files.namelist()
    assert not any(name.endswith(".so") for name in names)
    assert "gcodesim/compiled/known_kernels.txt" in names


@LINUX
def test_with_libraries_it_is_for_this_system_and_requires_no_compiler(tmp_path: Path) -> None:
    (tmp_path / "empty.c").write_text("#include <math.h>\ndouble f(double x) { return sin(x); }\n")
    subprocess.run(["cc", "-fPIC", "-c", tmp_path / "empty.c", "-o", tmp_path / "empty.o"], check=True)
    libraries = tmp_path / "libraries"
    libraries.mkdir()
    link([tmp_path / "empty.o"], libraries / file_name(levels()[0]))
    wheel = built(tmp_path, libraries)
    assert re.search(r"-py3-none-manylinux_2_\d+_x86_64\.whl$", wheel.name)
    assert "numpy" in required(wheel) and "numba" not in required(wheel)
    with ZipFile(wheel) as files:
        assert f"gcodesim/compiled/libraries/{file_name(levels()[0])}" in files.namelist()


@LINUX
@pytest.mark.slow
def test_it_runs_where_there_is_no_compiler(tmp_path: Path) -> None:
    """An environment of its own with the wheel and what it requires, and nothing else; no program can be found.

    `init` and `run` together take less than 10 s behind the installation: as many starts of Python with numpy.
    """
    libraries = tmp_path / "libraries"
    making = [sys.executable, "scripts/make_libraries.py", str(libraries), levels()[0]]
    subprocess.run(making, cwd=ROOT, check=True, timeout=1800)
    python = environment_of(built(tmp_path, libraries), tmp_path / "environment")
    (tmp_path / "home").mkdir()

    def run(*arguments: str) -> str:
        done = subprocess.run(
            [python, "-X", "importtime", "-m", "gcodesim", *arguments],
            cwd=tmp_path / "home",
            env={"HOME": str(tmp_path / "home"), "PATH": ""},
            capture_output=True,
            text=True,
            timeout=600,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stderr

    start = [python, "-c", "import numpy"]
    yardstick = min(effort_of(lambda: subprocess.run(start, check=True)) for _ in range(3))
    loaded = ""

    def first_run() -> None:
        nonlocal loaded
        run("init", "demo")
        loaded = run("run", "demo/part.nc", "--cell", "demo/cell.yaml")

    assert effort_of(first_run) < MOST_STARTS * yardstick
    assert "gcodesim.compiled.library" in loaded
    assert not re.search(r"\| +(numba|llvmlite)\b", loaded)
    assert "compiling" not in loaded
    assert not list((tmp_path / "home").rglob("*.kernel"))


def effort_of(act: Callable[[], object]) -> float:
    """Seconds of processor that the processes take which `act` starts and waits for."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    act()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def environment_of(wheel: Path, folder: Path) -> Path:
    """An environment with a wheel and links to what it requires; returns its Python."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    (site,) = folder.glob("lib/python*/site-packages")
    with ZipFile(wheel) as files:
        files.extractall(site)
    ahead, seen = required(wheel), set()
    while ahead:
        name = ahead.pop()
        try:
            found = distribution(name)
        except PackageNotFoundError:  # not for this system
            continue
        if name in seen:
            continue
        seen.add(name)
        for top in {path.parts[0] for path in found.files or () if path.parts[0] not in ("..", "__pycache__")}:
            if not (site / top).exists():
                (site / top).symlink_to(Path(str(found.locate_file(top))))
        lines = found.requires or []
        ahead += [re.split(r"[^\w.-]", line)[0] for line in lines if "extra" not in line.partition(";")[2]]
    return folder / "bin" / "python"
