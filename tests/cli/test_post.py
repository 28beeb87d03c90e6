"""`gcodesim post` as a user runs it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gcodesim.cli import main

ROOT = Path(__file__).parents[2]
CELL = """gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}
work_offsets: {G54: {in: world, xyz: [600, 0, 300]}}
tools:
  1: {type: flat_end_mill, diameter: 6, length: 40}
simulation: {world: kinematic}
"""
PROGRAM = "G21 G90 G94\nT1 M6\nS6000 M3\nG0 X20 Y20 Z10\no<down> call\nG1 X60\nM2\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("arm.yaml").write_text(CELL)
    Path("part.nc").write_text(PROGRAM)
    Path("down.ngc").write_text("o<down> sub\nG1 Z2 F300\no<down> endsub\nM2\n")
    return tmp_path


def test_a_run_is_posted_like_its_program(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "part.nc", "--cell", "arm.yaml", "--out", "out"]) == 0
    Path("down.ngc").unlink()  # the log has it
    Path("arm.yaml").rename("elsewhere.yaml")
    capsys.readouterr()
    assert main(["post", "out", "--for", "krl", "-o", "of_run"]) == 0
    said = capsys.readouterr().out
    assert "part.nc:3:1: warning GS802: not posted: the spindle" in said
    assert f"wrote {Path('of_run') / 'part.src'}" in said

    Path("arm.yaml").write_text(CELL)
    Path("down.ngc").write_text("o<down> sub\nG1 Z2 F300\no<down> endsub\nM2\n")
    assert main(["post", "part.nc", "--cell", "arm.yaml", "--for", "krl", "-o", "of_program"]) == 0
    for name in ("part.src", "part.dat"):
        assert (folder / "of_run" / name).read_bytes() == (folder / "of_program" / name).read_bytes()


TWO = ROOT / "programs/two_arms.nc", ROOT / "cells/two_arms.yaml", f"right={ROOT / 'programs/two_arms.right.nc'}"


def test_every_channel_is_posted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, cell, right = map(str, TWO)
    words = [program, "--cell", cell, "--channel", right]
    meet = ["--meet", "main/right=5:6", "--meet", "right/main=5:6", "--fail-on", "never"]
    assert main(["post", *words, "--for", "krl", *meet]) == 0
    files = sorted(path.name for path in folder.iterdir() if path.suffix in (".src", ".dat"))
    assert files == ["two_arms.dat", "two_arms.src", "two_arms_right.dat", "two_arms_right.src"]
    assert "M200" not in capsys.readouterr().out
    for name in ("two_arms", "two_arms_right"):
        assert Path(f"{name}.src").read_text().count("WAIT FOR $IN[6]==TRUE") == 2

    assert main(["post", *words, "--for", "krl", "--only", "right", "-o", "one", *meet]) == 0
    assert Path("one/two_arms_right.src").read_bytes() == Path("two_arms_right.src").read_bytes()
    assert not Path("one/two_arms.src").exists()
    assert main(["post", *words, "--for", "krl", "--only", "left"]) == 2
    assert main(["post", *words, "--for", "krl", "--meet", "main/left=5:6"]) == 2
    assert main(["post", *words, "--for", "krl", "--meet", "main=5:6"]) == 2
    assert main(["post", *words, "--for", "krl", "--tool-change", "a b"]) == 2


def test_every_channel_of_a_run_is_posted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Also where programs have waited for each other."""
    Path("arms.yaml").write_text(CHANNELS)
    Path("part.nc").write_text("G21 G90\nG0 X0 Y0 Z0\nM200\nG0 X9\nM2\n")
    Path("b.nc").write_text("G21 G90\nG0 X9 Y9 Z0\nG4 P1\nM200\nG0 X0\nM2\n")
    words = ["part.nc", "--cell", "arms.yaml", "--channel", "other=b.nc"]
    assert main(["run", *words, "--out", "out"]) == 0
    assert main(["post", "out", "--for", "krl", "-o", "of_run"]) == 0
    assert main(["post", *words, "--for", "krl", "-o", "of_program"]) == 0

    of_run = {path.name: path.read_bytes() for path in Path("of_run").iterdir()}
    assert of_run == {path.name: path.read_bytes() for path in Path("of_program").iterdir()}
    assert sorted(of_run) == ["b_other.dat", "b_other.src", "part.dat", "part.src"]


CHANNELS = """robots:
  a: {model: kuka_kr10_r1100_2}
  b: {model: kuka_kr10_r1100_2, base: {in: world, xyz: [3000, 0, 0]}}
channels:
  main: {robot: a, work_offsets: {G54: {in: world, xyz: [600, 0, 500]}}, m_codes: {M200: {wait: both}}}
  other: {robot: b, work_offsets: {G54: {in: world, xyz: [3600, 0, 500]}}, m_codes: {M200: {wait: both}}}
simulation: {world: kinematic}
"""


def test_a_cell_that_has_changed_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "part.nc", "--cell", "arm.yaml", "--out", "out"]) == 0
    Path("arm.yaml").write_text(CELL.replace("600", "610"))

    assert main(["post", "out", "--for", "krl", "--cell", "arm.yaml", "-o", "x"]) == 2
    assert "has changed since" in capsys.readouterr().err
    assert not Path("x").exists()


def test_a_path_with_errors_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("part.nc").write_text("G21 G90 G94\nT1 M6\nG0 X20 Y20 Z10\nG1 X3000 F300\nM2\n")

    assert main(["run", "part.nc", "--cell", "arm.yaml", "--out", "out"]) == 1
    assert main(["post", "out", "--for", "krl"]) == 2
    assert main(["post", "part.nc", "--cell", "arm.yaml", "--for", "krl"]) == 2
    assert "no checked path" in capsys.readouterr().err
    assert not list(folder.glob("*.src"))


def test_files_of_others_are_not_overwritten(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("part.src").write_text("DEF part()\nEND\n")

    assert main(["post", "part.nc", "--cell", "arm.yaml", "--for", "krl"]) == 2
    assert "did not write it" in capsys.readouterr().err


def test_json_and_signals(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["post", "part.nc", "--cell", "arm.yaml", "--for", "urscript", "--format", "json"]
    assert main([*words, "--signal", "spindle=3", "--signal", "speed=0"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "schema": "gcodesim-post/1",
        "files": ["part.script"],
        "findings": [],
    }
    assert "set_standard_digital_out(3, True)" in Path("part.script").read_text()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--for", "krll"], "krl"),
        (["--for", "krl", "--signal", "spindle"], "NAME=OUTPUT"),
        (["--for", "krl", "--signal", "M11=7:x"], "no number"),
        (["--for", "krl", "--tolerance", "0"], "no length"),
    ],
)
def test_wrong_use(folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], says: str) -> None:
    try:
        status = main(["post", "part.nc", "--cell", "arm.yaml", *words])
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert says in capsys.readouterr().err


def test_another_control_that_reads_g_code(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["post", "part.nc", "--for", "fanuc", "-o", "other"]) == 0
    text = Path("other/part.fanuc.nc").read_text()
    assert "o<down>" not in text and "G1 Z2. F300." in text
    assert main(["post", "part.nc", "--for", "fanuc", "-o", "other"]) == 0  # its own file it may overwrite

    Path("part.nc").write_text("G0 X1\nM64 P1\nM2\n")
    assert main(["post", "part.nc", "--for", "grbl"]) == 1
    assert "part.nc:2:1: error GS801: not posted: grbl cannot say an output" in capsys.readouterr().out
    assert main(["post", "part.nc", "--for", "grbl", "--motion", "joint"]) == 2
    assert "--motion means nothing" in capsys.readouterr().err
