"""`run --from-line` and `restart`: the rest of a program with the stock that is there then."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import HEAD

STEPS = HEAD + "G61\nG0 X10 Y10 Z2\nG1 Z-1 F400\nG1 X30\nG1 Y20\nG1 X10\nG0 Z20\nM5\nM2\n"


def stock(folder: str) -> dict[str, float]:
    return json.loads(Path(folder, "results.json").read_text())["stocks"]["stock"]


def test_what_is_left_is_the_same(cli, write) -> None:
    write("steps.nc", STEPS)
    assert cli("run", "steps.nc", "--cell", "cell.yaml", "--out", "whole").status == 0
    done = cli("run", "steps.nc", "--cell", "cell.yaml", "--from-line", 9)

    assert done.status == 0
    assert "restart.nc" in done.out and "lines 1 to 8 were run for the shape of the stock" in done.err
    whole, rest, before = stock("whole"), stock("out"), stock("out/before")
    assert rest["initial_mm3"] == pytest.approx(before["remaining_mm3"], abs=1e-9)
    assert rest["remaining_mm3"] == pytest.approx(whole["remaining_mm3"], abs=1e-6)
    assert before["removed_mm3"] + rest["removed_mm3"] == pytest.approx(whole["removed_mm3"], abs=1e-3)
    inputs = json.loads(Path("out/results.json").read_text())["inputs"]
    assert inputs["from_line"] == 9 and inputs["program"]["name"] == "restart.nc"
    assert Path("out/stock.stl").read_bytes() == Path("whole/stock.stl").read_bytes()


def test_lines_before_are_run_once(cli, write) -> None:
    write("steps.nc", STEPS)
    cli("run", "steps.nc", "--cell", "cell.yaml", "--from-line", 9)
    first = Path("out/results.json").read_bytes()

    write("steps.nc", STEPS.replace("G1 X10\n", "G1 X12\n"))  # behind the line: nothing before has changed
    assert "lines 1 to 8 are known" in cli("run", "steps.nc", "--cell", "cell.yaml", "--from-line", 9).err
    assert Path("out/results.json").read_bytes() != first
    write("steps.nc", STEPS.replace("Z-1", "Z-2"))
    assert "lines 1 to 8 were run" in cli("run", "steps.nc", "--cell", "cell.yaml", "--from-line", 9).err


def test_what_restart_writes_is_what_was_run(cli, write) -> None:
    write("steps.nc", STEPS)
    cli("run", "steps.nc", "--cell", "cell.yaml", "--from-line", 9)
    printed = cli("restart", "steps.nc", "--cell", "cell.yaml", "--from-line", 9)

    assert printed.status == 0 and printed.out == Path("out/restart.nc").read_text()
    assert cli("restart", "steps.nc", "--from-line", 9, "-o", "own.nc").status == 0
    assert "T1 M6" in Path("own.nc").read_text()


def test_a_line_inside_a_loop_is_refused_with_another(cli, write) -> None:
    loop = HEAD + "G0 X10 Y10 Z2\n#1=0\no1 while [#1 LT 3]\n#1=[#1+1]\nG1 X[10*#1] Z-1 F400\no1 endwhile\n"
    loop += "G0 Z20\nM5\nM2\n"
    write("loop.nc", loop)
    done = cli("run", "loop.nc", "--cell", "cell.yaml", "--from-line", 9)

    assert done.status == 1 and not Path("out/results.json").exists()
    assert "loop.nc:9:1: error GS148" in done.out and "it is inside the `while` of line 7" in done.out
    assert "begin at line 5: `G0 X10 Y10 Z2`" in done.out
    as_json = cli("run", "loop.nc", "--cell", "cell.yaml", "--from-line", 9, "--format", "json")
    assert as_json.errors == [("GS148", 9, 1)]
    assert cli("restart", "loop.nc", "--from-line", 9).status == 1


def test_probing_before_the_line(cli, write) -> None:
    """What the probe has touched is known to the rest: the lines before are run, not only read."""
    probe = "{type: probe, diameter: 6, length: 60}"
    write("probe.yaml", Path("cell.yaml").read_text().replace("tools:\n", f"tools:\n  9: {probe}\n"))
    text = "G21 G90 G94\nT9 M6\nG43 H9\nG0 X10 Y10 Z5\nG38.2 Z-5 F100\n#<_top>=#5063\nG0 Z20\n" + HEAD[16:]
    write("probe.nc", text + "G0 X20 Y20 Z5\nG1 Z[#<_top>-1] F300\nX40\nG0 Z20\nM5\nM2\n")
    assert cli("run", "probe.nc", "--cell", "probe.yaml", "--out", "whole").status == 0
    assert cli("run", "probe.nc", "--cell", "probe.yaml", "--from-line", 12).status == 0

    assert stock("out")["remaining_mm3"] == pytest.approx(stock("whole")["remaining_mm3"], abs=1e-6)


@pytest.mark.parametrize("line", ["0", "x", "900"])
def test_no_such_line(cli, line: str) -> None:
    assert cli("run", "slot.nc", "--cell", "cell.yaml", "--from-line", line).status == 2


def test_a_job_has_no_line(cli, write) -> None:
    write("job.yaml", "setups: {top: {program: slot.nc, cell: cell.yaml}}\n")
    assert cli("run", "job.yaml", "--from-line", 3).status == 2


def test_files_of_others_are_kept(cli, write, tmp_path: Path) -> None:
    (tmp_path / "out/before").mkdir(parents=True)
    write("out/before/setup.json", "mine")
    done = cli("run", "slot.nc", "--cell", "cell.yaml", "--from-line", 8)

    assert done.status == 1 and "GS750" in done.out and Path("out/before/setup.json").read_text() == "mine"
    write("out/before/setup.json", "")
    write("out/restart.nc", "mine")
    done = cli("run", "slot.nc", "--cell", "cell.yaml", "--from-line", 8)
    assert done.status == 1 and "GS750" in done.out and Path("out/restart.nc").read_text() == "mine"
