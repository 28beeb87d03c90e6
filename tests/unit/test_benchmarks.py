"""Every benchmark runs, at a tiny size; how fast it is does not matter here."""

import importlib
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell

ROOT = Path(__file__).parents[2]

TINY = {
    "reading": 200,
    "time_law": 200,
    "removal": 300,
    "log": 200,
    "inverse_kinematics": 50,
    "editor": 300,
    "surface": 40,
}


@pytest.fixture(autouse=True)
def _from_the_root(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name == "editor" else name for name in TINY]
)
def test_it_prints_a_ratio(name, capsys):
    if name == "inverse_kinematics":
        pytest.importorskip("pybullet")
    importlib.import_module(f"benchmarks.{name}").main(TINY[name])

    numbers = [float(text.replace(",", "")) for text in re.findall(r"[0-9][0-9,]*\.?[0-9]*", capsys.readouterr().out)]
    assert len(numbers) >= 3
    assert max(numbers) > 0.0


@pytest.mark.parametrize("wrong", [["drillling", "100"], ["raster", "many"], ["raster", "0"], ["raster", "1", "2"]])
def test_the_interpreter_benchmark_refuses_what_it_does_not_know(wrong):
    command = [sys.executable, "-m", "benchmarks.interpreter", *wrong]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)

    assert done.returncode == 2
    assert "usage: python -m benchmarks.interpreter" in done.stderr


def test_the_reference_job_is_that_of_the_goals():
    job = importlib.import_module("benchmarks.job")
    lines = list(job.lines())

    assert sum(line.startswith("G1 X") for line in lines) == job.BLOCKS
    assert lines[9] == "F2000"
    assert lines[-2] == "M2"
    assert list(job.lines(250)) != list(job.lines(251))


def test_cases_of_two_channels_wait_for_each_other_and_run_alone(tmp_path):
    channels = importlib.import_module("benchmarks.channels")
    for make in channels.CASES.values():
        case = make(4)
        for chosen in ((0, 1), (0,), (1,)):
            cell = tmp_path / "cell.yaml"
            cell.write_text(channels.cell_of(case, chosen))
            assert load_cell(cell).cell is not None
        one, other = ([line for line in text.splitlines() if line.startswith("M20")] for text in case.programs)
        assert one == other or make is channels.of_two_lengths


def test_projects_of_scripts_take_the_program_beside_them(tmp_path, capsys):
    camotics = importlib.import_module("benchmarks.camotics")
    files = {"wave": ("wave.tpl", "wave.gcode"), "box": ("box.tpl", "box.txt"), "cat": ("c.nc", "c.nc")}
    for name, (file, beside) in files.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / f"{name}.camotics").write_text(json.dumps({"files": [file]}))
        (tmp_path / name / beside).write_text("M2\n")

    assert [program.name for _, program in camotics.projects(tmp_path)] == ["c.nc", "wave.gcode"]
    assert capsys.readouterr().out.split() == ["box", "left", "out:", "box.tpl"]


def test_volume_of_a_surface_that_camsim_wrote(tmp_path):
    camotics = importlib.import_module("benchmarks.camotics")
    corners = np.array([[0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 0, 5]], dtype="<f4") + np.array([10, 20, 30], dtype="<f4")
    faces = np.zeros(4, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    faces["corners"] = corners[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    surface = tmp_path / "surface.stl"
    surface.write_bytes(bytes(80) + np.uint32(4).tobytes() + faces.tobytes())

    assert camotics.volume(surface) == pytest.approx(10.0)


def test_stages_add_up_to_a_whole_run(tmp_path):
    job = importlib.import_module("benchmarks.job")
    program, cell = job.write(tmp_path, "gantry", 10)
    times = tmp_path / "stages.json"
    order = ["run", str(program), "--cell", str(cell), "--world", "kinematic", "--out", str(tmp_path / "out")]

    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.stages", str(times), *order],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.returncode in (0, 1), done.stderr
    stages = json.loads(times.read_text())
    assert all(seconds > -1e-3 for seconds in stages.values())
    for stage in ("read", "plan", "sample + joints", "material + process", "log: columns", "results + STL"):
        assert stages[stage] > 0.0, stage


def test_an_unknown_name_is_told(capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["benchmarks", "nonsense"])

    assert importlib.import_module("benchmarks.__main__").main() == 2
    assert "nonsense" in capsys.readouterr().err


@pytest.mark.slow
def test_a_checkout_against_itself(capsys):
    """Equal sources take about equal time; what counts here is that each command runs in both."""
    importlib.import_module("benchmarks.against").main(str(ROOT), 1, 10)

    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 8 and all(" x   goal 1.03 x" in line for line in lines)
