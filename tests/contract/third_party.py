"""Installs the package of `tests/data/third_party` without a network and without touching what is installed here.

A folder with the package and its `dist-info` on the search path is a valid installation; `pyproject.toml` is the only
place where the entry points are written.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gcodesim

SOURCE = Path(__file__).parents[1] / "data" / "third_party"
PROJECT: dict[str, Any] = tomllib.loads((SOURCE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
OURS = Path(gcodesim.__file__).parents[1]


@dataclass(frozen=True)
class Done:
    """How a command ended and what it said."""

    status: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


def install(site: Path) -> None:
    """Copy the package and write its metadata, as an installer does."""
    shutil.copytree(SOURCE / "bright_engraver", site / "bright_engraver")
    add_metadata(site, PROJECT["name"], PROJECT["version"], PROJECT["entry-points"])


def add_metadata(site: Path, name: str, version: str, groups: Mapping[str, Mapping[str, str]]) -> None:
    """The `dist-info` of a package with these entry points."""
    folder = site / f"{name.replace('-', '_')}-{version}.dist-info"
    folder.mkdir(parents=True)
    (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    lines = [line for group, points in groups.items() for line in (f"[{group}]", *map(" = ".join, points.items()))]
    (folder / "entry_points.txt").write_text("\n".join(lines) + "\n")


def gcodesim_with(site: Path, folder: Path, *arguments: object) -> Done:
    """Run the command line in `folder`, in a process that finds what is installed in `site`."""
    paths = [str(site), str(OURS), *filter(None, [os.environ.get("PYTHONPATH")])]
    done = subprocess.run(
        [sys.executable, "-m", "gcodesim", *map(str, arguments)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Traceback" not in done.stderr or done.returncode == 70, done.stderr
    return Done(done.returncode, done.stdout, done.stderr)
