"""A command line inside this process, in a folder of its own, and the programs and cells that several tests share."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from gcodesim.cli import main

CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 1}
tools:
  1: {type: flat_end_mill, diameter: 6 mm}
  2: {type: flat_end_mill, diameter: 10 mm}
simulation: {world: kinematic}
"""
ARM = """gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2}}
work_offsets: {G54: {in: world, xyz: [600, 0, 300]}}
stock: {box: [40, 30, 10], in: G54, zero: top-front-left, material: al6082_t6, resolution: 1}
tools: {1: {type: flat_end_mill, diameter: 6 mm, length: 40}}
simulation: {world: kinematic}
"""
HEAD = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\n"
SLOT = HEAD + "G0 X10 Y10\nG0 Z2\nG1 Z-1 F400\nG1 X30\nG0 Z20\nM5\nM2\n"


@dataclass(frozen=True)
class Outcome:
    """How a command ended and what it said."""

    status: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out, parse_constant=lambda text: pytest.fail(f"{text} in the JSON"))

    @property
    def errors(self) -> list[tuple[str, int, int]]:
        """Code, line and column of the errors of a JSON answer."""
        return [(f["code"], f["line"], f["column"]) for f in self.json["findings"] if f["severity"] == "error"]


Cli = Callable[..., Outcome]


@pytest.fixture
def cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Cli:
    """Run a command line in a fresh folder with `cell.yaml`, `arm.yaml` and `slot.nc`."""
    monkeypatch.chdir(tmp_path)
    for name, text in (("cell.yaml", CELL), ("arm.yaml", ARM), ("slot.nc", SLOT)):
        (tmp_path / name).write_text(text)

    def run(*arguments: object) -> Outcome:
        capsys.readouterr()
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as end:  # argparse
            status = int(end.code or 0)
        said = capsys.readouterr()
        return Outcome(status, said.out, said.err)

    return run


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str, str | bytes], Path]:
    """Write a file into the folder of the test."""

    def write(name: str, text: str | bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write
