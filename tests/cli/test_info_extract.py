"""`gcodesim info LOG --extract DIR`: the files that a log carries."""

import json

import pytest

import gcodesim
from gcodesim.cli import main

PROGRAM = b"G21 G90\r\nG0 X100\r\nM2\r\n"


@pytest.fixture
def log(tmp_path):
    program, cell = tmp_path / "part.nc", tmp_path / "cell.yaml"
    program.write_bytes(PROGRAM)
    cell.write_text("gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n")
    gcodesim.simulate(program, cell, tmp_path / "out")
    return tmp_path / "out" / "run.mcap"


def test_attached_files_come_out_as_they_went_in(log, tmp_path, capsys):
    inside = tmp_path / "inside"

    assert main(["info", str(log), "--extract", str(inside)]) == 0

    assert (inside / "program.nc").read_bytes() == PROGRAM
    assert (inside / "cell.yaml").read_bytes() == (tmp_path / "cell.yaml").read_bytes()
    assert (inside / "results.json").read_bytes() == (tmp_path / "out" / "results.json").read_bytes()
    assert json.loads((inside / "layout.json").read_text())
    assert "wrote program.nc" in capsys.readouterr().out


def test_nothing_is_overwritten(log, tmp_path, capsys):
    assert main(["info", str(log), "--extract", str(tmp_path)]) == 2  # cell.yaml stands there

    assert not (tmp_path / "layout.json").exists()
    assert "is there already" in capsys.readouterr().err
