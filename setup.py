"""What `pyproject.toml` cannot say: a wheel with compiled kernels needs no compiler, any other installation does.

With `GCODESIM_LIBRARIES` naming a folder that `scripts/make_libraries.py` has filled, the wheel carries these
libraries, is for this system only, and does not require numba. `make wheel` does both.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

REQUIRED = [
    "foxglove-schemas-protobuf>=0.3",
    # wheels exist for these processors; elsewhere zlib makes the same checksums
    "isal>=1.6; platform_machine in 'x86_64 AMD64 aarch64 arm64'",
    "lark>=1.2",
    "mcap>=1.2",
    "numpy>=1.26",
    "protobuf>=5",
    # wheels exist for Python up to 3.11 on x86-64 Linux; elsewhere the kinematic world works without it
    "pybullet>=3.2.6; python_version < '3.12' and platform_machine == 'x86_64' and sys_platform == 'linux'",
    "rich>=13.7",
    "ruamel.yaml>=0.18",
    "scipy>=1.12",
    "trimesh>=4.4",
    "zstandard>=0.22",
]
COMPILER = ["numba>=0.60"]

named = os.environ.get("GCODESIM_LIBRARIES")
libraries = sorted(Path(named).glob("*.so")) if named else []
if named and not libraries:
    raise SystemExit(f"there are no libraries in {named}; scripts/make_libraries.py makes them")


class BuildWithLibraries(build_py):
    """Also copies the libraries."""

    def run(self):
        super().run()
        if libraries and not self.editable_mode:
            folder = Path(self.build_lib, "gcodesim", "compiled", "libraries")
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            for library in libraries:
                shutil.copyfile(library, folder / library.name)


class Contents(Distribution):
    """With libraries it is no pure Python."""

    def has_ext_modules(self):
        return bool(libraries)


class WheelForThisSystem(bdist_wheel):
    """Any Python, but only systems with a C library that has what the libraries want."""

    def get_tag(self):
        if not libraries:
            return super().get_tag()
        wanted = subprocess.run(["objdump", "-T", *libraries], check=True, capture_output=True, text=True).stdout
        versions = [tuple(map(int, text.split("."))) for text in re.findall(r"GLIBC_(\d+\.\d+)", wanted)]
        return "py3", "none", "manylinux_{}_{}_x86_64".format(*max([(2, 17), *versions]))


setup(
    distclass=Contents,
    install_requires=REQUIRED if libraries else REQUIRED + COMPILER,
    cmdclass={"build_py": BuildWithLibraries, "bdist_wheel": WheelForThisSystem},
)
