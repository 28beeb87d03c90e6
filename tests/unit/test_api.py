"""`import gcodesim` as a Python program uses it."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import gcodesim

PROGRAM = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 X5 Y5 Z5\nG1 Z-1 F300\nG1 X15\nG3 X5 I-5 J0\nG0 Z5\nM5\nM2\n"
CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [20, 15, 8], zero: top-front-left, material: al6082_t6, resolution: 0.5}
tools:
  1: {type: flat_end_mill, diameter: 6, length: 40}
simulation: {world: kinematic}
"""


@pytest.fixture
def program(tmp_path):
    path = tmp_path / "part.nc"
    path.write_text(PROGRAM)
    return path


@pytest.fixture
def cell(tmp_path):
    path = tmp_path / "cell.yaml"
    path.write_text(CELL)
    return path


def test_every_public_name_is_there():
    for name in gcodesim.__all__:
        assert getattr(gcodesim, name) is not None
    assert set(gcodesim.__all__) <= set(dir(gcodesim))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = gcodesim.nothing


def test_importing_it_imports_nothing_heavy():
    code = (
        "import sys, gcodesim; print([m for m in ('numpy', 'numba', 'scipy', 'pybullet', 'lark') if m in sys.modules])"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert answer.stdout.strip() == "[]"


def test_read_gives_the_path_of_a_program(program):
    path = gcodesim.read(program)

    assert isinstance(path, gcodesim.ToolPath)
    assert len(path) == 5
    assert path.length[2] == pytest.approx(10e-3)  # G1 X15
    assert path.length[3] == pytest.approx(np.pi * 5e-3)  # the half circle
    assert path.span(3).line == 8


def test_read_takes_a_text_for_the_place(program):
    assert len(gcodesim.read(str(program))) == 5


def test_a_program_with_an_error_has_no_path(program):
    program.write_text(PROGRAM.replace("I-5", "I-4"))

    with pytest.raises(gcodesim.InputError, match=r"part\.nc:8:1: error GS111") as caught:
        gcodesim.read(program)

    assert [finding.code for finding in caught.value.findings] == ["GS111"]


def test_a_cell_with_an_error_is_none(cell):
    assert gcodesim.load_cell(cell).tools[1].diameter == pytest.approx(6e-3)

    cell.write_text(CELL.replace("diameter: 6", "diametre: 6"))
    with pytest.raises(gcodesim.InputError, match=r"cell\.yaml:5:\d+: error GS704") as caught:
        gcodesim.load_cell(cell)
    assert caught.value.findings


def test_a_file_that_is_not_there(tmp_path, cell):
    with pytest.raises(FileNotFoundError):
        gcodesim.read(tmp_path / "none.nc")
    with pytest.raises(FileNotFoundError):
        gcodesim.simulate(tmp_path / "none.nc", cell)


def test_simulate_writes_what_it_returns(program, cell, tmp_path):
    results = gcodesim.simulate(program, cell, out=tmp_path / "out")

    assert isinstance(results, gcodesim.Results)
    assert results.status == "ok"
    assert results.stocks["stock"].removed > 1e-7
    assert json.loads((tmp_path / "out" / "results.json").read_text()) == results.as_json()
    assert (tmp_path / "out" / "run.mcap").stat().st_size > 0


def test_a_changed_cell_runs_without_a_file(program, cell):
    """A thinner tool takes less; the numbers of the unchanged cell are those of the file."""
    own = gcodesim.load_cell(cell)
    from_file = gcodesim.simulate(program, cell)
    unchanged = gcodesim.simulate(program, own)
    thinner = gcodesim.simulate(program, replace(own, tools={1: replace(own.tools[1], diameter=3e-3)}))

    def numbers(results):
        return {key: value for key, value in results.as_json().items() if key != "inputs"}

    assert numbers(unchanged) == numbers(from_file)
    assert thinner.stocks["stock"].removed < 0.7 * from_file.stocks["stock"].removed
    assert thinner.inputs["cell"]["sha256"] != unchanged.inputs["cell"]["sha256"]


def test_faults_of_the_program_are_findings_of_the_run(program, cell):
    program.write_text(PROGRAM.replace("I-5", "I-4"))

    results = gcodesim.simulate(program, cell)

    assert results.status == "failed"
    assert results.stopped_at.line == 8
    assert "GS111" in [finding.code for finding in results.findings]
